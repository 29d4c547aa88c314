//! The four arm sensors on two I2C buses; a broken bus costs one side.
//!
//! | arm | index | bus | address |
//! |---|---|---|---|
//! | 1 front-left | 0 | left | 0x28 (COM3 low) |
//! | 2 rear-left | 1 | left | 0x29 (COM3 high) |
//! | 3 front-right | 2 | right | 0x28 (COM3 low) |
//! | 4 rear-right | 3 | right | 0x29 (COM3 high) |

use embedded_hal_async::i2c::I2c;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::maths::vector::Vec3;
use sophie_ports::error::PortError;
use sophie_ports::sensors::ArmImus;

use crate::bno055::{Address, Bno055, Calibration, Config};
use crate::fault::Fault;

/// The arm sensors, two each on bus `I1` (left) and `I2` (right), at 400 or 100 kHz. A busy-waiting bus driver times a
/// stretched clock out after [`crate::bno055::TRANSACTION`].
pub struct ArmBuses<I1, I2> {
    left: I1,
    right: I2,
    chips: PerArm<Bno055>,
}

impl<I1: I2c, I2: I2c> ArmBuses<I1, I2> {
    /// Left sensors on `left`, right ones on `right`; `configs` per arm.
    pub const fn new(left: I1, right: I2, configs: PerArm<Config>) -> Self {
        let [one, two, three, four] = configs;
        let chips = [
            Bno055::new(Address::Low, one),
            Bno055::new(Address::High, two),
            Bno055::new(Address::Low, three),
            Bno055::new(Address::High, four),
        ];
        Self { left, right, chips }
    }

    /// Last calibration of arm `arm` (0..=3); `None` without readings.
    pub fn calibration(&self, arm: usize) -> Option<Calibration> {
        self.chips
            .get(arm)
            .filter(|chip| chip.is_running())
            .map(Bno055::calibration)
    }

    /// Last fault of arm `arm` (0..=3).
    pub fn last_fault(&self, arm: usize) -> Option<Fault> {
        self.chips.get(arm).and_then(Bno055::last_fault)
    }
}

impl<I1: I2c, I2: I2c> ArmImus for ArmBuses<I1, I2> {
    async fn gravity(&mut self, arm: usize) -> Result<Vec3, PortError> {
        let Some(chip) = self.chips.get_mut(arm) else {
            return Err(PortError::Absent);
        };
        match arm {
            0 | 1 => chip.gravity(&mut self.left).await,
            _ => chip.gravity(&mut self.right).await,
        }
    }
}
