//! External interrupts and their pin routing, which the emulator's F427 lacks (RM0090 §12, §9).

use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::soc::stm32f427::generated::{exti, syscfg};

/// System configuration: keeps its registers, which [`routed_to`] reads.
#[derive(Debug, Default)]
pub struct Syscfg;

impl Device for Syscfg {
    type Register = syscfg::Register;
}

/// Port (0 is A) of the pin that raises interrupt line `line` (§9.2.3 to §9.2.6).
pub fn routed_to(line: u8, file: &RegisterFile) -> usize {
    let register = match line / 4 {
        0 => syscfg::Register::Exticr1,
        1 => syscfg::Register::Exticr2,
        2 => syscfg::Register::Exticr3,
        _ => syscfg::Register::Exticr4,
    };
    (file.get(register) >> (4 * (line % 4)) & 0xF) as usize
}

/// Table index and lines of each vector (table 62, F405).
const VECTORS: [(usize, u64); 7] = [
    (1, 1 << 0),
    (2, 1 << 1),
    (3, 1 << 2),
    (4, 1 << 3),
    (5, 1 << 4),
    (6, 0x03E0),
    (7, 0xFC00),
];

/// The controller, lines 0 to 15.
#[derive(Debug, Default)]
pub struct Exti {
    pending: u64,
}

impl Exti {
    pub fn edge(&mut self, line: u8, level: Level, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        let selected = file.get(match level {
            Level::High => exti::Register::Rtsr,
            Level::Low => exti::Register::Ftsr,
        });
        self.pend(selected & 1 << line, file, c);
    }

    fn pend(&mut self, lines: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.pending |= lines & file.get(exti::Register::Imr);
        self.raise(file, c);
    }

    fn raise(&self, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        file.set(exti::Register::Pr, self.pending);
        let active = self.pending & file.get(exti::Register::Imr);
        for (position, lines) in VECTORS {
            c.interrupt(position, Level::from(active & lines != 0));
        }
    }
}

impl Device for Exti {
    type Register = exti::Register;

    fn write(
        &mut self,
        register: exti::Register,
        value: u64,
        file: &mut RegisterFile,
        c: &mut DeviceContext<'_>,
    ) {
        match register {
            exti::Register::Pr => {
                self.pending &= !value;
                // Clearing a pending bit also clears the software trigger (§12.3.5).
                let software = file.get(exti::Register::Swier) & !value;
                file.set(exti::Register::Swier, software);
                self.raise(file, c);
            }
            exti::Register::Swier => self.pend(value, file, c),
            exti::Register::Imr => self.raise(file, c),
            _ => {}
        }
    }

    fn reset(&mut self) {
        self.pending = 0;
    }
}
