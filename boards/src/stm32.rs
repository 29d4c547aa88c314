//! Common to the STM32 boards: the ports of `sophie_ports` over embassy-stm32's drivers, generic over the instance.
//!
//! Differences between chips depend on `family`, which the build script takes from the board feature's chip, never on
//! the board.

#![allow(
    dead_code,
    unused_imports,
    reason = "each board takes the ports that its parts need"
)]

#[cfg(not(any(family = "f4", family = "f7", family = "h7")))]
compile_error!(
    "the ports have been written for the families f4, f7 and h7: see what goes by `family` in boards/src"
);

#[cfg(family = "f4")]
mod accelerator;
#[cfg_attr(family = "h7", path = "stm32/adc_h7.rs")]
#[cfg_attr(not(family = "h7"), path = "stm32/adc_f4.rs")]
mod adc;
mod analog;
mod chip;
mod clock;
mod data_ready;
mod escs;
mod flash;
#[cfg(family = "h7")]
mod flash_ecc;
mod frame_stream;
mod i2c_bus;
mod lights;
mod loader;
#[cfg_attr(family = "h7", path = "stm32/options_h7.rs")]
#[cfg_attr(not(family = "h7"), path = "stm32/options_f4.rs")]
mod options;
mod pads;
mod ports;
mod pulse_timer;
mod rails;
mod reset;
mod serial;
mod servo_pairs;
mod servos;
mod silicon;
mod spi;
mod storage;
mod tone;
mod usb;
mod watchdog;

pub use analog::AnalogInputs;
pub use chip::{ThisChip, restart};
pub use clock::{micros, start};
pub use data_ready::{ReadyLine, ReadyStamp};
pub use escs::{EscTimer, EscTimers};
pub use flash::ParamFlash;
pub(crate) use i2c_bus::i2c_bus;
pub use i2c_bus::{ArmBus, BusParts, BusRegisters, i2c_config};
#[cfg(any(family = "f7", family = "h7"))]
pub use i2c_bus::{BusErrors, WatchErrors, set_times};
pub use lights::{Lamp, Lights};
pub use loader::{enter_or_leave_loader, leave_for_loader};
pub use pads::{Pad, Pupdr, Taken, Wiring, pad};
pub(crate) use ports::ports;
pub use rails::{PortLevels, drive, hold};
pub use reset::take_reset_cause;
pub use serial::{
    BufferedInput, BufferedLine, BufferedOutput, GroundLine, MAVLINK_BYTES_PER_SECOND, ReceiverLine,
    TelemetryLine, ground_line, receiver_line,
};
pub use servo_pairs::ServoPairs;
pub use servos::ServoTimer;
pub use silicon::look;
pub use spi::{DmaChip, PlainChip, Selected, plain_chip, spi_config};
pub use storage::{BoardStorage, StorageCell, load_parameters};
pub use tone::Tone;
pub use usb::{USB_BYTES_PER_SECOND, UsbDriver, UsbPort};
pub use watchdog::{WatchdogPort, stop_with_core};

/// A buffer for DMA bursts of up to 16 bytes, which must not cross a 1 KiB boundary.
#[repr(C, align(32))]
pub struct Aligned<T>(pub T);
