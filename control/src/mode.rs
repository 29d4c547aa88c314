//! The states of the vehicle.

/// What the vehicle is doing; the commander alone changes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Sensors are being calibrated at rest; arming is refused.
    #[default]
    Calibrating,
    /// Motors stopped, ready to be armed.
    Disarmed,
    /// Rotors idle on the ground, throttle low.
    Armed,
    /// Free flight under the pilot's sticks.
    Flight,
    /// Resting on the pipe with the rotors still helping; attitude held, yaw given up.
    Contact,
    /// Tendons closing the chosen arms under the pressure loop.
    Clamping,
    /// Grip proven, rotors stopped or spooling down.
    Perched,
    /// Rotors spooled up again, tendons paying out until every arm is proven free.
    Releasing,
    /// On the ground again, rotors idle, about to disarm.
    Landed,
    /// The pilot is lost or a vital sensor failed: level, descend, stop.
    Failsafe,
}

impl Mode {
    /// Every mode, in the order of a mission.
    pub const ALL: [Self; 10] = [
        Self::Calibrating,
        Self::Disarmed,
        Self::Armed,
        Self::Flight,
        Self::Contact,
        Self::Clamping,
        Self::Perched,
        Self::Releasing,
        Self::Landed,
        Self::Failsafe,
    ];

    /// Name for displays and telemetry, at most 12 ASCII characters.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Calibrating => "CALIBRATING",
            Self::Disarmed => "DISARMED",
            Self::Armed => "ARMED",
            Self::Flight => "FLIGHT",
            Self::Contact => "CONTACT",
            Self::Clamping => "CLAMPING",
            Self::Perched => "PERCHED",
            Self::Releasing => "RELEASING",
            Self::Landed => "LANDED",
            Self::Failsafe => "FAILSAFE",
        }
    }
}
