//! The USB core without a host: its interrupt flags, which the emulator's models store as written, and the suspend of
//! an idle bus (RM0090 §34.16.2, RM0433 §57.14.6).

use rigless::device::{Device, DeviceContext, Level, RegisterFile};
use rigless::emulator::InterruptLine;
use rigless::soc::stm32f427::{generated::otg_fs_global as f4, peripherals::otg::Otg as F4Otg};
use rigless::soc::stm32h743::{generated::otg1_hs_global as h7, peripherals::otg::Otg as H7Otg};
use rigless::time::{EventId, VirtualNanos};

/// Flags that a written one clears; the others follow their state.
const CLEARED_BY_ONE: u64 = 0xF0B0_FC0A;
/// `ESUSP` and `USBSUSP`, which rise after 3 ms of an idle bus.
const SUSPENDED: u64 = 1 << 10 | 1 << 11;
const IDLE: u64 = 3_000_000;
/// Lets the flags through to the interrupt.
const ENABLED: u64 = 1;

/// Where a part's core has its flags, and which interrupt they raise.
pub trait Global: Device<Register: Copy + PartialEq> {
    const CONTROL: Self::Register;
    const FLAGS: Self::Register;
    const MASK: Self::Register;

    /// Drives the core's interrupt.
    fn interrupt(level: Level, c: &mut DeviceContext<'_>);
}

impl Global for F4Otg {
    const CONTROL: f4::Register = f4::Register::FsGahbcfg;
    const FLAGS: f4::Register = f4::Register::FsGintsts;
    const MASK: f4::Register = f4::Register::FsGintmsk;

    fn interrupt(level: Level, c: &mut DeviceContext<'_>) {
        // The first one wakes the part.
        c.interrupt(1, level);
    }
}

impl Global for H7Otg {
    const CONTROL: h7::Register = h7::Register::OtgHsGahbcfg;
    const FLAGS: h7::Register = h7::Register::OtgHsGintsts;
    const MASK: h7::Register = h7::Register::OtgHsGintmsk;

    fn interrupt(level: Level, c: &mut DeviceContext<'_>) {
        // In the emulator's tables the host's half has it (RM0433, table 147).
        if let Some(line) = InterruptLine::new(101) {
            c.drive_line(line, level);
        }
    }
}

/// A core.
#[derive(Debug, Default)]
pub struct UsbCore<D> {
    resets: D,
    flags: u64,
    falls_asleep: Option<EventId>,
}

impl<D: Global> UsbCore<D> {
    fn show(&self, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        let others = file.get(D::FLAGS) & !CLEARED_BY_ONE;
        file.set(D::FLAGS, others | self.flags);
        let raised = file.get(D::CONTROL) & ENABLED != 0 && self.flags & file.get(D::MASK) != 0;
        D::interrupt(Level::from(raised), c);
    }
}

impl<D: Global> Device for UsbCore<D> {
    type Register = D::Register;

    fn write(&mut self, r: D::Register, value: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.resets.write(r, value, file, c);
        if r == D::FLAGS {
            self.flags &= !value;
        } else if r == D::CONTROL && value & ENABLED != 0 && self.falls_asleep.is_none() {
            // The driver has connected the device: from here on the bus is silent.
            self.falls_asleep = Some(c.schedule(VirtualNanos(c.now().0 + IDLE)));
        } else if r != D::MASK && r != D::CONTROL {
            return;
        }
        self.show(file, c);
    }

    fn on_event(&mut self, event: EventId, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        if self.falls_asleep == Some(event) {
            self.flags |= SUSPENDED;
            self.show(file, c);
        }
    }

    fn reset(&mut self) {
        self.resets.reset();
        self.flags = 0;
        self.falls_asleep = None;
    }
}
