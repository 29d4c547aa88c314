//! USB on the chip's full-speed core, with its own transceiver, as a device.
//!
//! VBUS is not sensed: two of the boards have given PA9 away. The core then stays connected, and a cable without a host
//! looks like a bus that sleeps.

use embassy_stm32::interrupt::typelevel::{Binding, Interrupt};
use embassy_stm32::peripherals::USB_OTG_FS;
use embassy_stm32::usb::{Config, DmPin, DpPin, Driver, Instance, InterruptHandler};
use embassy_stm32::{Peri, pac, uid};
use sophie_tasks::usb::Identity;
use sophie_tasks::usb::port::PACKET;
use static_cell::ConstStaticCell;

use crate::cortex_m::BELOW_FLIGHT;

/// Send budget of MAVLink over USB, bytes/s. The bus carries fifty times as much; the limit is the background level's
/// time, some 60 us a frame.
pub const USB_BYTES_PER_SECOND: u32 = 20_000;
/// Cores that `embassy-stm32` knows: at another it panics.
const CORES: [u32; 8] = [0x1000, 0x1100, 0x1200, 0x2000, 0x2100, 0x2300, 0x3000, 0x3100];

/// A packet from the host for each of the control and the bulk endpoint.
static FROM_HOST: ConstStaticCell<[u8; 2 * PACKET as usize]> = ConstStaticCell::new([0; 2 * PACKET as usize]);

/// Driver of the core.
pub type UsbDriver = Driver<'static, USB_OTG_FS>;

/// The device port of a board.
pub struct UsbPort {
    /// Driver of the core; `None` if the core is unknown, does not answer or has no supply.
    pub driver: Option<UsbDriver>,
    /// Identification sent to the host.
    pub identity: Identity,
}

impl UsbPort {
    /// The port at `dp` and `dm`, named `product`. Its interrupt priority is below the flight level, so no host
    /// traffic delays that level. Called once.
    pub fn new(
        core: Peri<'static, USB_OTG_FS>,
        dp: Peri<'static, impl DpPin<USB_OTG_FS>>,
        dm: Peri<'static, impl DmPin<USB_OTG_FS>>,
        irqs: impl Binding<<USB_OTG_FS as Instance>::Interrupt, InterruptHandler<USB_OTG_FS>> + 'static,
        product: &'static str,
    ) -> Self {
        <USB_OTG_FS as Instance>::Interrupt::set_priority(BELOW_FLIGHT);
        let driver = answers().then(|| {
            let mut config = Config::default();
            config.vbus_detection = false;
            Driver::new_fs(core, irqs, dp, dm, FROM_HOST.take(), config)
        });
        let serial = uid::uid_hex();
        Self {
            driver,
            identity: Identity { product, serial },
        }
    }
}

/// Checks that the core has its supply, has a known ID, is idle, and its flags can be cleared; otherwise the driver
/// would wait or serve interrupts without end.
fn answers() -> bool {
    if !has_supply() {
        return false;
    }
    enable_clock();
    let core = pac::USB_OTG_FS;
    if !CORES.contains(&core.cid().read().0) || !core.grstctl().read().ahbidl() {
        return false;
    }
    core.gintsts().write(|w| {
        w.set_usbrst(true);
        w.set_enumdne(true);
    });
    let flags = core.gintsts().read();
    !flags.usbrst() && !flags.enumdne()
}

/// Starts the detector of the transceiver's own supply.
#[cfg(family = "h7")]
fn has_supply() -> bool {
    use embassy_time::{Duration, Instant};

    /// Longest wait: it is there or not.
    const LONGEST: Duration = Duration::from_millis(2);
    pac::PWR.cr3().modify(|w| w.set_usb33den(true));
    let since = Instant::now();
    while since.elapsed() < LONGEST {
        if pac::PWR.cr3().read().usb33rdy() {
            return true;
        }
    }
    false
}

#[cfg(not(family = "h7"))]
const fn has_supply() -> bool {
    true
}

#[cfg(family = "h7")]
fn enable_clock() {
    pac::RCC.ahb1enr().modify(|w| w.set_usb_otg_fsen(true));
    // The write takes effect by the time it is read back (RM0433 §8.5.11).
    let _ = pac::RCC.ahb1enr().read();
}

#[cfg(not(family = "h7"))]
fn enable_clock() {
    pac::RCC.ahb2enr().modify(|w| w.set_usb_otg_fsen(true));
    // As above (RM0090 §7.3.11).
    let _ = pac::RCC.ahb2enr().read();
}
