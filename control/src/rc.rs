//! What the sticks and switches of the transmitter mean.

/// How the sticks are read in flight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StickMode {
    /// Sticks give roll and pitch angle and yaw rate.
    #[default]
    Angle,
    /// Sticks give the three body rates.
    Rate,
    /// Sticks give thrust and the three torques, as in the paper.
    Direct,
}

/// Which arms the tendons close.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArmChoice {
    /// All four.
    #[default]
    All,
    /// The front pair, 1 and 3.
    Front,
    /// The rear pair, 2 and 4.
    Rear,
}

impl ArmChoice {
    /// True for each chosen arm.
    pub const fn mask(self) -> crate::wrench::PerArm<bool> {
        match self {
            Self::All => [true; 4],
            Self::Front => [true, false, true, false],
            Self::Rear => [false, true, false, true],
        }
    }
}

/// The pilot's wishes, scaled and finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sticks {
    /// Right positive, -1..1.
    pub roll: f32,
    /// Nose up positive, -1..1.
    pub pitch: f32,
    /// Clockwise from above positive, -1..1.
    pub yaw: f32,
    /// Share of the largest collective thrust, 0..1.
    pub throttle: f32,
    /// The arming switch permits running motors; off stops them at once.
    pub arm_switch: bool,
    /// The perch switch asks to close the arms (on) or to release them (off).
    pub perch_switch: bool,
    /// How the sticks are read.
    pub stick_mode: StickMode,
    /// Which arms are to close.
    pub arms: ArmChoice,
}
