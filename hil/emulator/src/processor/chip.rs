//! Interface of a run to an emulated processor. The emulator has a type for each part; [`same_on_this_part!`]
//! implements the methods that all parts share.

use std::fmt::Debug;

use rigless::device::Level;
use rigless::mcu::Mcu;
use rigless::time::VirtualNanos;
use sophie_control::params::ArmBusSpeed;

use super::edge_probe::Edge;
use super::pads::{At, Pads, ServoPin};
use super::serial::Setup;
use crate::chips::bno055::Bno055;
use crate::chips::dps310::Barometer;
use crate::chips::icm42688p::Imu;
use crate::chips::line::Line;

/// Contents of the option bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Options {
    Factory,
    /// With the firmware's brown-out level.
    BrownOut,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    Crystal,
    /// The core's PLL.
    Pll,
}

/// In the clock control register (RM0090 §7.3.1, RM0433 §8.7.2).
pub const CRYSTAL_READY: u64 = 1 << 17;
/// Core PLL locked bit, in the same register.
pub const PLL_LOCKED: u64 = 1 << 25;

/// A processor with the emulated chips on its interfaces.
pub trait Chip: Mcu + Debug + Send + 'static {
    fn attach(&mut self, pads: &Pads);
    fn imu(&mut self, interface: usize) -> Option<&mut Imu>;
    /// Disconnects (true) or connects it.
    fn silence_imu(&mut self, interface: usize, silent: bool);
    /// Flips `mask` in its next word.
    fn flip_imu_word(&mut self, interface: usize, mask: u64);
    fn arm(&mut self, bus: usize, nth: usize) -> Option<&mut Bno055>;
    fn barometer(&mut self, bus: usize, nth: usize) -> Option<&mut Barometer>;
    /// Disconnects (true) or connects the `nth` part of a bus.
    fn silence_on_bus(&mut self, bus: usize, nth: usize, silent: bool);
    fn set_input(&mut self, channel: u8, millivolts: u32);
    fn line(&mut self, port: usize) -> Option<&mut Line>;
    fn function(&mut self, now: VirtualNanos, pin: At) -> Option<u8>;
    fn drive(&mut self, now: VirtualNanos, pin: At, level: Level);
    /// The pin is an output, or a peripheral's except the debug port's.
    fn drives(&mut self, now: VirtualNanos, pin: At) -> bool;
    fn pulls_up(&mut self, now: VirtualNanos, pin: At) -> bool;
    fn is_high(&mut self, now: VirtualNanos, pin: At) -> bool;
    /// Edges since the last call, oldest first.
    fn motor_edges(&mut self) -> Vec<Edge>;
    /// High time and period, ns, if any.
    fn servo_pulse(&mut self, servo: ServoPin) -> Option<(u64, u64)>;
    /// PLLs in a wrong range, if there are ranges.
    fn pll_ranges(&self) -> Option<String> {
        None
    }
    /// Times that breach the bus specification, if there are such registers.
    fn bus_times(&self, bus: usize, speed: ArmBusSpeed) -> Option<String> {
        let _ = (bus, speed);
        None
    }
    /// Flags a spurious bus error in one of about `every` bytes; false if the part has no such errata.
    fn err_on_bus(&mut self, bus: usize, every: u32) -> bool {
        let _ = (bus, every);
        false
    }
    /// Stretches the clock by `hold` ns after each byte; false if the emulator cannot.
    fn hold_clock(&mut self, bus: usize, hold: u64) -> bool;
    /// Makes the next reset a brown-out.
    fn brown_out(&mut self);
    fn serial_setup(&self, port: usize) -> Setup;
    /// Has `per_million` of the words to a port arrive right, but with the noise flag.
    fn noisy_line(&mut self, port: usize, per_million: u32);
    fn set_options(&mut self, options: Options);
    fn age(&mut self);
    /// From the next clock reset on.
    fn stop_clock(&mut self, clock: Clock);
    /// Starts the clocks as the chip's loader leaves them, and again after each reset if `always`.
    fn start_from_loader(&mut self, now: VirtualNanos, always: bool);
    /// Whether the write changes flash while its data cache is on.
    fn changes_cached_flash(&self, address: u64, value: u64) -> bool;
    /// First address of the flash sector that the write erases.
    fn erased(&self, address: u64, value: u64) -> Option<u64>;
    /// The core, at `speed` instructions per clock cycle.
    ///
    /// # Errors
    /// One line: the emulator cannot make it.
    fn core(&self, speed: f64) -> Result<rigless::emulator::CoreSpec, String>;
}

/// Methods of [`Chip`] common to every part; `$soc` is its module.
macro_rules! same_on_this_part {
    ($soc:ident) => {
        fn attach(&mut self, pads: &Pads) {
            self.inner.rcc.attach_crystals(pads.crystal, 0);
            self.inner.set_supply(SUPPLY);
            for converter in &mut self.inner.adc {
                converter.set_reference(SUPPLY);
            }
            let (port, pin) = pads.imu_select;
            if let Some(pin) = rigless::soc::$soc::peripherals::gpio::Pin::new(pin) {
                self.inner.spi[pads.imu].attach_selected(
                    Imu::default(),
                    rigless::soc::$soc::peripherals::spi::Select {
                        port,
                        pin,
                        active: Level::Low,
                    },
                );
            }
            for (bus, address) in pads.arms {
                self.i2c(bus).attach(Bno055::new(address));
            }
            if let Some((bus, _)) = pads.barometer {
                self.i2c(bus).attach(Barometer::new());
            }
            for port in [pads.receiver, pads.console, pads.mavlink, pads.ground] {
                self.inner.usart[port].attach(Line::default());
            }
        }

        fn imu(&mut self, interface: usize) -> Option<&mut Imu> {
            self.inner.spi[interface].chip_mut(0)
        }

        fn silence_imu(&mut self, interface: usize, silent: bool) {
            // False only without a chip there.
            let _ = self.inner.spi[interface].silence(0, silent);
        }

        fn flip_imu_word(&mut self, interface: usize, mask: u64) {
            if let Some(place) = self.inner.spi[interface].place_mut(0) {
                place.flip(mask);
            }
        }

        fn arm(&mut self, bus: usize, nth: usize) -> Option<&mut Bno055> {
            self.i2c(bus).chip_mut(nth)
        }

        fn barometer(&mut self, bus: usize, nth: usize) -> Option<&mut Barometer> {
            self.i2c(bus).chip_mut(nth)
        }

        fn silence_on_bus(&mut self, bus: usize, nth: usize, silent: bool) {
            let _ = self.i2c(bus).silence(nth, silent);
        }

        fn set_input(&mut self, channel: u8, millivolts: u32) {
            if let Some(channel) = rigless::soc::$soc::peripherals::adc::Channel::new(channel) {
                self.inner.adc[0].set_input(channel, millivolts);
            }
        }

        fn line(&mut self, port: usize) -> Option<&mut Line> {
            let port = &mut self.inner.usart[port];
            let noise = *port.errors_mut();
            let line: &mut Line = port.chip_mut()?;
            line.align(noise);
            Some(line)
        }

        fn function(&mut self, now: VirtualNanos, pin: At) -> Option<u8> {
            use rigless::soc::$soc::peripherals::gpio::{Gpio, Pin};

            let number = Pin::new(pin.1)?;
            self.inner
                .drive_port(now, pin.0, |_, file, _| Gpio::function(number, file))
        }

        fn drive(&mut self, now: VirtualNanos, pin: At, level: Level) {
            if let Some(number) = rigless::soc::$soc::peripherals::gpio::Pin::new(pin.1) {
                self.inner.drive_port(now, pin.0, |port, file, c| {
                    port.drive(number, Some(level), file, c);
                });
            }
        }

        fn is_high(&mut self, now: VirtualNanos, pin: At) -> bool {
            rigless::soc::$soc::peripherals::gpio::Pin::new(pin.1).is_some_and(|number| {
                self.inner.drive_port(now, pin.0, |port, file, _| {
                    port.level(number, file) == Level::High
                })
            })
        }

        fn noisy_line(&mut self, port: usize, per_million: u32) {
            self.inner.usart[port].errors_mut().noise = rigless::chip::uart::Rate {
                name: "line.noise_errors",
                per_million,
            };
        }

        fn start_from_loader(&mut self, now: VirtualNanos, always: bool) {
            self.loader_clocks = always;
            self.write_clocks(now, LOADER_CLOCKS);
            self.write_clocks(now, NO_FLAGS);
        }

        fn stop_clock(&mut self, clock: Clock) {
            match clock {
                Clock::Crystal => self.missing |= CRYSTAL_READY,
                Clock::Pll => self.missing |= PLL_LOCKED,
            }
        }

        fn drives(&mut self, now: VirtualNanos, pin: At) -> bool {
            use rigless::soc::$soc::generated::gpioa::Register;

            let mode = self.inner.drive_port(now, pin.0, |_, file, _| {
                file.get(Register::Moder) >> (2 * pin.1) & 3
            });
            // RM0090 §8.4.1, RM0433 §11.4.1: output, alternate function. The debug port's function is 0.
            mode == 1 || mode == 2 && self.function(now, pin) != Some(0)
        }

        fn pulls_up(&mut self, now: VirtualNanos, pin: At) -> bool {
            use rigless::soc::$soc::generated::gpioa::Register;

            self.inner.drive_port(now, pin.0, |_, file, _| {
                file.get(Register::Pupdr) >> (2 * pin.1) & 3 == 1
            })
        }

        fn brown_out(&mut self) {
            self.browned_out = true;
        }

        fn motor_edges(&mut self) -> Vec<Edge> {
            std::mem::take(&mut self.motors.edges)
        }
    };
}

pub(crate) use same_on_this_part;
