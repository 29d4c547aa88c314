//! The independent watchdog, missing in the emulator's H743: its F427's, under the H743's registers.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::Layout;
use rigless::soc::stm32f427::generated::iwdg as f4;
use rigless::soc::stm32f427::peripherals::iwdg::Iwdg as F4Iwdg;
use rigless::soc::stm32h743::generated::iwdg as h7;
use rigless::time::EventId;

/// IWDG1. Registers 0 to 3 are alike; the fifth, the window, has no effect.
#[derive(Debug, Default)]
pub struct Watchdog(F4Iwdg);

impl Device for Watchdog {
    type Register = h7::Register;

    fn read(
        &mut self,
        register: h7::Register,
        file: &mut RegisterFile,
        c: &mut DeviceContext<'_>,
    ) -> Option<u64> {
        f4::Register::from_index(register.index()).and_then(|r| self.0.read(r, file, c))
    }

    fn write(
        &mut self,
        register: h7::Register,
        value: u64,
        file: &mut RegisterFile,
        c: &mut DeviceContext<'_>,
    ) {
        if let Some(register) = f4::Register::from_index(register.index()) {
            self.0.write(register, value, file, c);
        }
    }

    fn on_event(&mut self, event: EventId, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.0.on_event(event, file, c);
    }

    fn on_clock(&mut self, hz: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.0.on_clock(hz, file, c);
    }

    fn reset(&mut self) {
        self.0.reset();
    }
}
