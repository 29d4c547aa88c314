//! Faults of chips.

use core::fmt;

use sophie_ports::error::PortError;

/// A chip's fault, at start-up or in flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Fault {
    /// Bus peripheral error: wiring, clock or DMA.
    Bus,
    /// Wrong identity; 0x00 and 0xFF: nothing drives the line.
    Identity {
        /// Identity of this part.
        expected: u8,
        /// Value read.
        found: u8,
    },
    /// No reset value after a reset.
    Reset {
        /// Register.
        register: u8,
        /// Value read.
        found: u8,
    },
    /// A register not written, or lost in a brown-out.
    Configuration {
        /// Bank.
        bank: u8,
        /// Register.
        register: u8,
        /// Required value, masked.
        expected: u8,
        /// Value read, masked.
        found: u8,
    },
    /// No sample, by line or status, with right registers.
    Silent,
    /// All zeros or ones, or the mark of "no sample yet".
    Garbled,
    /// A repeated sample: a real sensor has noise.
    Stuck,
    /// Response to actuation differs from the factory's.
    SelfTest {
        /// Sensor.
        sensor: Sensor,
        /// Axis of the part: 0 x, 1 y, 2 z.
        axis: u8,
        /// Response, % of the factory's, or of the least allowed.
        percent: u16,
    },
    /// Gyroscope offset at rest too large: bad part, or motion.
    Offset {
        /// Axis of the part: 0 x, 1 y, 2 z.
        axis: u8,
    },
}

/// Half of an inertial part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Sensor {
    /// Angular rate.
    Gyro,
    /// Specific force.
    Accel,
}

impl Fault {
    /// Short text for an arming message.
    pub const fn what(&self) -> &'static str {
        match self {
            Self::Bus => "bus error",
            Self::Identity {
                found: 0x00 | 0xFF, ..
            } => "no answer",
            Self::Identity { .. } => "wrong chip",
            Self::Reset { .. } => "reset had no effect",
            Self::Configuration { .. } => "lost its configuration",
            Self::Silent => "no data-ready",
            Self::Garbled => "garbled data",
            Self::Stuck => "data stuck",
            Self::SelfTest { .. } => "self-test failed",
            Self::Offset { .. } => "offset too large",
        }
    }

    /// The port's error.
    pub const fn port_error(&self) -> PortError {
        match self {
            Self::Identity {
                found: 0x00 | 0xFF, ..
            } => PortError::Absent,
            Self::Identity { .. } => PortError::WrongPart,
            Self::Silent | Self::Reset { .. } => PortError::Timeout,
            _ => PortError::Corrupt,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.what())?;
        match *self {
            Self::Identity { expected, found } => {
                write!(f, ": identity 0x{found:02X}, expected 0x{expected:02X}")
            }
            Self::Reset { register, found } => write!(f, ": register 0x{register:02X} holds 0x{found:02X}"),
            Self::Configuration {
                bank,
                register,
                expected,
                found,
            } => write!(
                f,
                ": bank {bank} register 0x{register:02X} holds 0x{found:02X}, expected 0x{expected:02X}"
            ),
            Self::SelfTest {
                sensor,
                axis,
                percent,
            } => {
                write!(
                    f,
                    ": {} {} responds with {percent} %",
                    sensor.name(),
                    axis_name(axis)
                )
            }
            Self::Offset { axis } => write!(f, ": gyro {}", axis_name(axis)),
            Self::Bus | Self::Silent | Self::Garbled | Self::Stuck => Ok(()),
        }
    }
}

impl Sensor {
    /// Name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gyro => "gyro",
            Self::Accel => "accel",
        }
    }
}

const fn axis_name(axis: u8) -> char {
    match axis {
        0 => 'x',
        1 => 'y',
        _ => 'z',
    }
}

/// Logs the loss of a chip (feature `defmt`).
pub(crate) fn report(chip: &'static str, fault: &Fault) {
    #[cfg(feature = "defmt")]
    defmt::warn!("{=str}: {=str} ({})", chip, fault.what(), fault);
    #[cfg(not(feature = "defmt"))]
    let _ = (chip, fault);
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::string::ToString;

    use super::*;

    #[test]
    fn a_fault_names_itself_and_its_numbers() {
        let wrong = Fault::Identity {
            expected: 0x47,
            found: 0x98,
        };
        assert_eq!(wrong.to_string(), "wrong chip: identity 0x98, expected 0x47");
        assert_eq!(wrong.port_error(), PortError::WrongPart);
        let nothing = Fault::Identity {
            expected: 0x47,
            found: 0xFF,
        };
        assert_eq!(nothing.what(), "no answer");
        assert_eq!(nothing.port_error(), PortError::Absent);
        let test = Fault::SelfTest {
            sensor: Sensor::Gyro,
            axis: 2,
            percent: 12,
        };
        assert_eq!(test.to_string(), "self-test failed: gyro z responds with 12 %");
    }
}
