//! The STM32F405, modelled by the emulator's STM32F427 with five additions: external interrupts, the routing of pins to
//! them, the timers' DMA requests, the end of an I2C read by DMA, and the two-channel timer.
//!
//! The F427 has everything that the F405 has, under the same addresses, and more: twice the flash, a third more RAM, an
//! over-drive for 180 MHz, more ports and timers. The image is held to the F405's memory when it is read. The emulator
//! does not let an F427 write its flash.

mod exti;
mod i2c;
mod small_timer;

use std::num::{NonZeroU32, NonZeroU64};
use std::sync::LazyLock;

use rigless::cpu::armv7m::windows;
use rigless::device::{Device, ErasedDevice, Level, ResetCause};
use rigless::emulator::CoreSpec;
use rigless::machine::armv7m;
use rigless::mcu::{Mcu, Operate};
use rigless::soc::stm32f427::generated::dbg::Register as Debug;
use rigless::soc::stm32f427::generated::dma2::Register as DmaRegister;
use rigless::soc::stm32f427::generated::flash::Register as Flash;
use rigless::soc::stm32f427::generated::rcc::Register as Clocks;
use rigless::soc::stm32f427::generated::usart6::Register as Serial;
use rigless::soc::stm32f427::peripherals::dma::{Dma, Wire};
use rigless::soc::stm32f427::peripherals::i2c::I2c;
use rigless::soc::stm32f427::peripherals::otg::Otg;
use rigless::soc::stm32f427::peripherals::rcc::HSI_HZ;
use rigless::soc::stm32f427::peripherals::tim::{Advanced, Channel, Counter, Tim, UPDATE_REQUEST};
use rigless::soc::stm32f427::peripherals::{CONTROLLERS, SERIAL_PORTS, TIMERS};
use rigless::soc::stm32f427::{Stm32f427, generated};
use rigless::soc::{Bus, Layout, Width};
use rigless::time::VirtualNanos;

use self::exti::{Exti, Syscfg, routed_to};
use self::i2c::DmaI2c;
use self::small_timer::{TwoChannels, tim12};
use crate::chips::bno055::Bno055;
use crate::chips::dps310::Barometer;
use crate::chips::icm42688p::Imu;
use crate::chips::line::Line;
use crate::processor::chip::{CRYSTAL_READY, Chip, Clock, Options, PLL_LOCKED, same_on_this_part};
use crate::processor::clock_stretch::ClockStretch;
use crate::processor::count::Marks;
use crate::processor::edge_probe::{Edge, EdgeProbe};
use crate::processor::ignore_dma::IgnoreDma;
use crate::processor::pads::{AnalogPad, At, Pads, ServoPin, TimerPins};
use crate::processor::serial::Setup;
use crate::processor::usb::UsbCore;

/// Supply and converter reference, mV.
const SUPPLY: u32 = 3300;
/// Core clock, Hz.
const CLOCK: f64 = 168e6;
/// Clocks of the serial ports, Hz: USART1 and USART6 have the faster one (RM0090 figure 16, table 1).
const SERIAL_CLOCK: f64 = 42e6;
const FAST_SERIAL_CLOCK: f64 = 84e6;
const FAST_SERIAL: [&str; 2] = ["USART1", "USART6"];
/// Registers of running clocks (RM0090 §7.3): the PLL as after a reset, on.
const LOADER_CLOCKS: &[(Clocks, u64)] = &[(Clocks::Cr, 1 << 24 | 0x83)];
/// Removes the reset flags.
const NO_FLAGS: &[(Clocks, u64)] = &[(Clocks::Csr, 1 << 24)];
/// The servos' timer that has two channels.
const SMALL_TIMER: &str = "TIM12";
/// The motors' timer, and the one whose DMA request moves their frames (RM0090 table 43).
const MOTOR_TIMER: &str = "TIM8";
/// Remaining counts of DMA1 streams 0 and 2, which read the arms' buses.
const BUS_COUNTS: [DmaRegister; 2] = [DmaRegister::S0ndtr, DmaRegister::S2ndtr];

/// Bits of the flash's control register that program and that start an erase, and that of its access register that has the
/// data cache on (RM0090 §3.9.8, §3.9.2).
const CHANGES: u64 = 1 << 16 | 1;
const DATA_CACHE: u64 = 1 << 10;

/// The control path: data-ready on PC4, the sensor's words by DMA2 stream 2, the motors on TIM8.
pub const MARKS: Marks = Marks {
    ready: "EXTI4",
    received: "DMA2_STREAM2",
    motors: 0x4001_0400,
};

/// The pads of `docs/wiring.md`.
pub static PADS: Pads = Pads {
    name: "f405",
    part: "stm32f427",
    crystal: 8_000_000,
    imu: 0,
    imu_select: ("GPIOA", 4),
    imu_ready: At(2, 4),
    // Marking up, x forward: the chip's y points left and its z up.
    imu_axes: |[x, y, z]| [x, -y, -z],
    arms: [(0, 0x28), (0, 0x29), (1, 0x28), (1, 0x29)],
    barometer: None,
    pressure: [
        AnalogPad::bare(At(2, 0), 10),
        AnalogPad::bare(At(2, 1), 11),
        AnalogPad::bare(At(2, 2), 12),
        AnalogPad::bare(At(2, 3), 13),
    ],
    // 1:11 and 40 A/V.
    battery: AnalogPad::divided(At(0, 0), 0, 11.0),
    current: AnalogPad::divided(At(0, 1), 1, 40.0),
    // 10 kΩ over 1 kΩ before the pin, as docs/wiring.md has it.
    servo_battery: AnalogPad::divided(At(1, 0), 8, 11.0),
    receiver: 0,
    receiver_out: (At(0, 9), 7),
    console: 1,
    mavlink: 2,
    ground: 7,
    ground_in: (At(3, 2), 8),
    motors: TimerPins {
        pins: [At(2, 6), At(2, 7), At(2, 8), At(2, 9)],
        function: 3,
    },
    servos: [
        ServoPin::new(At(1, 6), 2, "TIM4", 1),
        ServoPin::new(At(1, 7), 2, "TIM4", 2),
        ServoPin::new(At(1, 14), 9, SMALL_TIMER, 1),
        ServoPin::new(At(1, 15), 9, SMALL_TIMER, 2),
    ],
    buses: &[
        (At(0, 5), 5),
        (At(0, 6), 5),
        (At(0, 7), 5),
        (At(1, 8), 4),
        (At(1, 9), 4),
        (At(1, 10), 4),
        (At(1, 11), 4),
        (At(0, 10), 7),
        (At(0, 2), 7),
        (At(0, 3), 7),
        (At(2, 10), 7),
        (At(2, 11), 7),
    ],
    resting_high: &[
        At(1, 8),
        At(1, 9),
        At(1, 10),
        At(1, 11),
        At(0, 10),
        At(0, 3),
        At(2, 11),
    ],
    signals: [At(1, 12), At(1, 13), At(0, 8)],
    foreign: &[0x5168_5BFC],
};

/// Instances that our firmware does not use or the F405 lacks. An access is listed as unimplemented and fails the run.
const UNUSED: [&str; 24] = [
    "TIM1", "TIM2", "TIM3", "SPI2", "SPI3", "SPI4", "SPI5", "SPI6", "I2C3", "USART6", "UART4", "UART7",
    "UART8", "ADC2", "ADC3", "SDIO", "RTC", "GPIOE", "GPIOF", "GPIOG", "GPIOH", "GPIOI", "GPIOJ", "GPIOK",
];

/// The requests that reach DMA2: the emulator's, and the motor timer's update (table 44).
fn requests() -> &'static [Wire] {
    static WIRES: LazyLock<Vec<Wire>> = LazyLock::new(|| {
        let known = CONTROLLERS[1].wiring.iter().map(|wire| Wire {
            instance: wire.instance,
            request: wire.request,
            channel: wire.channel,
            streams: wire.streams,
        });
        let motors = Wire {
            instance: MOTOR_TIMER,
            request: UPDATE_REQUEST,
            channel: 7,
            streams: &[1],
        };
        known.chain([motors]).collect()
    });
    &WIRES
}

fn controller() -> Dma {
    let known = &CONTROLLERS[1];
    Dma::new(requests(), known.last_data, known.reaches_memory)
}

fn motor_timer() -> Tim<Advanced> {
    Tim::with_clock(HSI_HZ, Counter::Narrow)
}

/// The part.
#[derive(Debug)]
pub struct F405 {
    inner: Stm32f427,
    motors: EdgeProbe<Advanced>,
    servos: IgnoreDma<TwoChannels>,
    dma: Dma,
    buses: [ClockStretch<DmaI2c>; 2],
    exti: Exti,
    syscfg: Syscfg,
    usb: UsbCore<Otg>,
    slots: Slots,
    pulses: u64,
    /// The next reset is by a supply that broke down.
    browned_out: bool,
    /// Bits of the clocks' control register that never rise.
    missing: u64,
    /// Content of the identity register.
    revision: u64,
    /// Each reset leaves the loader's clocks running.
    loader_clocks: bool,
}

#[derive(Debug)]
struct Slots {
    motors: usize,
    servos: usize,
    clocks: usize,
    debug: usize,
    flash: usize,
    dma: usize,
    buses: [usize; 2],
    exti: usize,
    syscfg: usize,
    usb: usize,
    unused: Vec<bool>,
}

impl F405 {
    /// The part, out of reset.
    ///
    /// # Errors
    /// The emulator cannot make it.
    pub fn new() -> Result<Self, String> {
        let failed = |e: rigless::soc::Error| format!("emulator: {e}");
        let inner = Stm32f427::new().map_err(failed)?;
        let slot = |name| inner.bus().slot(name).map_err(failed);
        let mut unused = vec![false; inner.bus().slots().len()];
        for name in UNUSED {
            unused[slot(name)?] = true;
        }
        let slots = Slots {
            motors: slot(MOTOR_TIMER)?,
            servos: slot(SMALL_TIMER)?,
            clocks: slot("RCC")?,
            debug: slot("DBG")?,
            flash: slot("FLASH")?,
            dma: slot(CONTROLLERS[1].instance)?,
            buses: [slot("I2C1")?, slot("I2C2")?],
            exti: slot("EXTI")?,
            syscfg: slot("SYSCFG")?,
            usb: slot("OTG_FS_GLOBAL")?,
            unused,
        };
        let buses = BUS_COUNTS.map(|count| {
            let count = generated::DMA1.base + u64::from(count.spec().offset);
            // `Mcu::split` fills this slot.
            ClockStretch::new(DmaI2c::new(count))
        });
        let mut part = Self {
            inner,
            motors: EdgeProbe::new(motor_timer),
            servos: IgnoreDma(tim12()),
            dma: controller(),
            buses,
            exti: Exti::default(),
            syscfg: Syscfg,
            usb: UsbCore::default(),
            slots,
            pulses: 0,
            browned_out: false,
            missing: 0,
            // The last one (RM0090 §38.6.1).
            revision: 0x101F,
            loader_clocks: false,
        };
        part.mark_revision();
        Ok(part)
    }

    /// Writes clock registers as a firmware would.
    fn write_clocks(&mut self, now: VirtualNanos, writes: &[(Clocks, u64)]) {
        for &(register, value) in writes {
            let address = generated::RCC.base + u64::from(register.spec().offset);
            // The emulator refuses a write only to a missing register.
            let _ = Operate::write(self, now, address, Width::W32, value);
        }
    }

    /// Writes an F405's identity to the identity register.
    fn mark_revision(&mut self) {
        let file = self.inner.bus_mut().slot_mut(self.slots.debug).registers_mut();
        file.set(Debug::DbgmcuIdcode, 0x413 | self.revision << 16);
    }

    /// The interface of a bus.
    fn i2c(&mut self, bus: usize) -> &mut I2c {
        &mut self.buses[bus].inner.inner
    }

    /// Gives the data-ready pulses that the sensor has sent to the pin that it is wired to, and to the interrupt line of
    /// that pin.
    fn carry_data_ready(&mut self, now: VirtualNanos) {
        let pulses = self.imu(PADS.imu).map_or(0, |imu| imu.pulses);
        if pulses == self.pulses {
            return;
        }
        self.pulses = pulses;
        let pin = PADS.imu_ready;
        let routed = routed_to(pin.1, self.inner.bus().slots()[self.slots.syscfg].registers());
        // 8 µs on the real part; the interrupt takes the edge.
        for level in [Level::High, Level::Low] {
            self.drive(now, pin, level);
            if routed == pin.0 {
                let (file, mut c) = self.inner.bus_mut().drive(now, self.slots.exti);
                self.exti.edge(pin.1, level, file, &mut c);
            }
        }
    }
}

impl Chip for F405 {
    same_on_this_part!(stm32f427);

    fn servo_pulse(&mut self, servo: ServoPin) -> Option<(u64, u64)> {
        let number = Channel::new(servo.channel)?;
        let pulse = if servo.timer == SMALL_TIMER {
            let slots = self.inner.bus().slots();
            let clocks = slots[self.slots.clocks].registers().get(Clocks::Apb1enr);
            let file = slots[self.slots.servos].registers();
            (clocks & small_timer::ENABLED != 0).then(|| self.servos.0.pulse(number, file))??
        } else {
            let nth = TIMERS.iter().position(|timer| timer.instance == servo.timer)?;
            let (timer, file) = self.inner.timer(nth);
            timer.pulse(number, file)?
        };
        Some((pulse.width.0, pulse.period.0))
    }

    fn hold_clock(&mut self, bus: usize, hold: u64) -> bool {
        self.buses[bus].hold = hold;
        true
    }

    fn serial_setup(&self, port: usize) -> Setup {
        let instance = SERIAL_PORTS[port].instance;
        let clock = if FAST_SERIAL.contains(&instance) {
            FAST_SERIAL_CLOCK
        } else {
            SERIAL_CLOCK
        };
        let file = self.inner.bus().registers(instance);
        let registers = [Serial::Brr, Serial::Cr1, Serial::Cr2, Serial::Cr3];
        Setup::in_registers(clock, registers.map(|r| file.map_or(0, |file| file.get(r))))
    }

    fn set_options(&mut self, options: Options) {
        let (flash, file) = self.inner.program();
        let (optcr, optcr1) = flash.committed_options();
        let level = match options {
            Options::Factory => 3 << 2,
            // Level 3: two bits that count downwards (RM0090 §3.9.10).
            Options::BrownOut => 0,
        };
        flash.keep_options(optcr & !(3 << 2) | level, optcr1, file);
    }

    fn age(&mut self) {
        // Revision A (RM0090 §38.6.1).
        self.revision = 0x1000;
        self.mark_revision();
    }

    fn changes_cached_flash(&self, address: u64, value: u64) -> bool {
        let control = generated::FLASH.base + u64::from(Flash::Cr.spec().offset);
        let file = self.inner.bus().slots()[self.slots.flash].registers();
        address == control && value & CHANGES != 0 && file.get(Flash::Acr) & DATA_CACHE != 0
    }

    // The emulator does not let this part erase.
    fn erased(&self, _: u64, _: u64) -> Option<u64> {
        None
    }

    fn core(&self, speed: f64) -> Result<CoreSpec, String> {
        let rate = NonZeroU64::new((CLOCK * speed) as u64).ok_or("the speed must be more than 0")?;
        let core = armv7m::Core {
            variant: armv7m::Variant::M4,
            clock_hz: NonZeroU64::new(CLOCK as u64).ok_or("no clock")?,
            interrupt_lines: NonZeroU32::new(u32::from(self.cpu().interrupt_lines)).ok_or("no interrupts")?,
            priority_bits: 4,
            refclk_divider: NonZeroU32::new(8).ok_or("no divider")?,
            instructions_per_second: rate,
            boot: "flash",
        };
        Ok(core.spec_with_parts(
            &windows(self.bus()),
            armv7m::Fpu::FpV4Sp,
            armv7m::MpuRegions::Eight,
        ))
    }
}

impl Mcu for F405 {
    fn bus(&self) -> &Bus {
        self.inner.bus()
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.inner.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        // The emulator rebuilds its models and keeps the attached devices; ours are rebuilt alike.
        for (own, stock) in self.buses.iter_mut().zip(&mut self.inner.i2c) {
            stock.inherit(&mut own.inner.inner);
        }
        // The emulator forgets the levels that the outside drives; restore them.
        let mut ports = std::mem::take(&mut self.inner.gpio);
        self.inner.reset(at, cause);
        for (fresh, old) in self.inner.gpio.iter_mut().zip(&mut ports) {
            *fresh = std::mem::take(old);
            Device::reset(fresh);
        }
        for (own, stock) in self.buses.iter_mut().zip(&mut self.inner.i2c) {
            own.inner.inner = I2c::with_clock(HSI_HZ);
            own.inner.inner.inherit(stock);
            Device::reset(own);
        }
        self.motors.restart(at);
        self.mark_revision();
        self.servos = IgnoreDma(tim12());
        if std::mem::take(&mut self.browned_out) {
            // The emulator knows no brown-out: its flag is set beside the pin's (RM0090 §7.3.21).
            let file = self.inner.bus_mut().slot_mut(self.slots.clocks).registers_mut();
            file.set(Clocks::Csr, file.get(Clocks::Csr) | 1 << 25);
        }
        self.dma = controller();
        self.exti = Exti::default();
        Device::reset(&mut self.usb);
        if self.loader_clocks {
            self.write_clocks(at, LOADER_CLOCKS);
        }
    }

    fn poll(&mut self, now: VirtualNanos) {
        self.inner.poll(now);
        self.carry_data_ready(now);
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        if self.missing != 0 && slot == self.slots.clocks {
            let file = self.inner.bus_mut().slot_mut(slot).registers_mut();
            file.set(Clocks::Cr, file.get(Clocks::Cr) & !self.missing);
        }
        let own: &mut dyn ErasedDevice = if slot == self.slots.motors {
            &mut self.motors
        } else if slot == self.slots.servos {
            &mut self.servos
        } else if slot == self.slots.dma {
            &mut self.dma
        } else if let Some(nth) = self.slots.buses.iter().position(|bus| *bus == slot) {
            &mut self.buses[nth]
        } else if slot == self.slots.exti {
            &mut self.exti
        } else if slot == self.slots.syscfg {
            &mut self.syscfg
        } else if slot == self.slots.usb {
            &mut self.usb
        } else if self.slots.unused.get(slot) == Some(&true) {
            return (self.inner.bus_mut(), None);
        } else {
            return self.inner.split(slot);
        };
        (self.inner.bus_mut(), Some(own))
    }
}

#[cfg(test)]
mod tests {
    use rigless::soc::stm32f427::generated::{EXTI, RCC, SYSCFG, exti, rcc, syscfg};

    use super::*;

    fn write<L: Layout>(part: &mut F405, base: u64, register: L, value: u64) {
        let address = base + u64::from(register.spec().offset);
        part.write(VirtualNanos(0), address, rigless::soc::Width::W32, value)
            .unwrap();
    }

    fn pending(part: &F405) -> u64 {
        part.bus().slots()[part.slots.exti]
            .registers()
            .get(exti::Register::Pr)
    }

    fn edge(part: &mut F405) {
        let (file, mut c) = part.inner.bus_mut().drive(VirtualNanos(0), part.slots.exti);
        part.exti.edge(4, Level::High, file, &mut c);
    }

    #[test]
    fn an_edge_pends_an_unmasked_line_until_a_one_is_written() {
        let mut part = F405::new().unwrap();
        write(&mut part, EXTI.base, exti::Register::Rtsr, 1 << 4);
        edge(&mut part);
        assert_eq!(pending(&part), 0);
        write(&mut part, EXTI.base, exti::Register::Imr, 1 << 4);
        edge(&mut part);
        assert_eq!(pending(&part), 1 << 4);
        write(&mut part, EXTI.base, exti::Register::Pr, 1 << 3);
        assert_eq!(pending(&part), 1 << 4);
        write(&mut part, EXTI.base, exti::Register::Pr, 1 << 4);
        assert_eq!(pending(&part), 0);
    }

    #[test]
    fn a_pin_reaches_the_line_that_the_firmware_routes_it_to() {
        let mut part = F405::new().unwrap();
        write(&mut part, RCC.base, rcc::Register::Apb2enr, 1 << 14);
        write(&mut part, SYSCFG.base, syscfg::Register::Exticr2, 0x2);
        let file = part.bus().slots()[part.slots.syscfg].registers();
        assert_eq!((routed_to(4, file), routed_to(5, file)), (2, 0));
    }
}
