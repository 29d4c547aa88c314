//! Faults of a closing arm.

/// Fault of an arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GripFault {
    /// No fresh pressure; ends with the next one.
    Stale,
    /// The pressure sensor failed; stays until release.
    Sensor,
    /// An obstacle that the sensor does not detect; stays until release.
    Unfelt,
    /// The pressure stayed below that of a grip while the force rose: the sensor cannot read it; stays until release.
    Ceiling,
    /// The tilt is missing; ends when it returns.
    Tilt,
    /// A value is not finite; ends when it is.
    NotFinite,
}

impl GripFault {
    /// Stays until release.
    pub const fn is_latched(self) -> bool {
        matches!(self, Self::Sensor | Self::Unfelt | Self::Ceiling)
    }

    /// Text for the pilot.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Stale => "pressure reading lost",
            Self::Sensor => "pressure sensor fault",
            Self::Unfelt => "arm stopped, no pressure felt",
            Self::Ceiling => "pressure sensor at its ceiling",
            Self::Tilt => "arm tilt lost",
            Self::NotFinite => "reading is no number",
        }
    }
}
