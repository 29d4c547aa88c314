//! The modes by name.

/// Hands every mode, in mission order, to the macro `declare`: name, file of its state, number in records, name on displays.
macro_rules! for_each_mode {
    ($declare:ident) => {
        $declare! {
                /// Sensors are being calibrated at rest; arming is refused.
                #[default]
                Calibrating in calibrating = 0, "CALIBRATING";
                /// Motors stopped, ready to be armed.
                Disarmed in disarmed = 1, "DISARMED";
                /// Rotors idle on the ground, throttle low.
                Armed in armed = 2, "ARMED";
                /// Free flight under the pilot's sticks.
                Flight in flight = 3, "FLIGHT";
                /// Free flight that holds the position; the sticks ask for velocities.
                Hold in hold = 11, "HOLD";
                /// Autonomous free flight onto the pipe, or off it.
                Approach in approach = 12, "APPROACH";
                /// Resting on the pipe with the rotors still helping; attitude held, yaw given up.
                Contact in contact = 4, "CONTACT";
                /// Tendons closing the chosen arms under the pressure loop; rotors spool down once the grip is proven.
                Clamping in clamping = 5, "CLAMPING";
                /// Grip proven, rotors stopped.
                Perched in perched = 6, "PERCHED";
                /// Rotors spooled up again, tendons paying out until every arm is proven free.
                Releasing in releasing = 7, "RELEASING";
                /// Leaving the pipe autonomously after a slide or an abandoned closing, until the pilot takes the
                /// throttle.
                Escaping in escaping = 10, "ESCAPING";
                /// On the ground again, rotors idle, about to disarm.
                Landed in landed = 8, "LANDED";
                /// Radio lost or battery empty: descend, stop on any support.
                Failsafe in failsafe = 9, "FAILSAFE";
        }
    };
}
pub(super) use for_each_mode;

/// Declares [`Mode`].
macro_rules! declare_modes {
    ($($(#[$doc:meta])+ $name:ident in $file:ident = $number:literal, $text:literal;)+) => {
        /// Mode of the vehicle; only the commander changes it.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub enum Mode { $($(#[$doc])+ $name = $number,)+ }

        impl Mode {
            /// Every mode, in mission order.
            pub const ALL: [Self; [$($number),+].len()] = [$(Self::$name),+];

            /// Name for displays and telemetry, at most 12 ASCII characters.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => $text,)+ }
            }
        }
    };
}

for_each_mode!(declare_modes);

impl Mode {
    /// The mode called `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }

    /// The rotors are stopped. In other modes the transitions that stop everything apply.
    pub const fn rotors_stand(self) -> bool {
        matches!(self, Self::Calibrating | Self::Disarmed | Self::Perched)
    }
}
