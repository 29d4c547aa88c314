//! The STM32H743: the emulator's part with additions, and without the peripherals that the board does not use.

mod bus_times;
mod i2c;
mod pll_ranges;
mod watchdog;

use std::num::NonZeroU64;

use rigless::device::{Device, ErasedDevice, Level, RegisterFile, ResetCause};
use rigless::emulator::CoreSpec;
use rigless::machine::matekh743::MatekH743;
use rigless::mcu::{Mcu, Operate};
use rigless::soc::stm32h743::Stm32h743;
use rigless::soc::stm32h743::generated::RCC;
use rigless::soc::stm32h743::generated::dbgmcu::Register as Debug;
use rigless::soc::stm32h743::generated::i2c1::Register as BusRegister;
use rigless::soc::stm32h743::generated::rcc::Register as Clocks;
use rigless::soc::stm32h743::generated::usart1::Register as Serial;
use rigless::soc::stm32h743::peripherals::flash::OptionBytes;
use rigless::soc::stm32h743::peripherals::i2c::I2c;
use rigless::soc::stm32h743::peripherals::otg::Otg;
use rigless::soc::stm32h743::peripherals::rcc::HSI_HZ;
use rigless::soc::stm32h743::peripherals::tim::{Channel, General, TIMERS, Tim};
use rigless::soc::{Bus, Layout, Width};
use rigless::time::VirtualNanos;

use sophie_control::params::ArmBusSpeed;

use self::i2c::EagerI2c;
use self::watchdog::Watchdog;
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
const CLOCK: f64 = 400e6;
/// Clock of the serial ports, Hz.
const SERIAL_CLOCK: f64 = 100e6;
/// Clock of the arms' buses, Hz.
const BUS_CLOCK: f64 = 100e6;
/// Control registers of the flash's banks, and in them the bits that erase a sector.
const BANK_CONTROLS: [u64; 2] = [0x5200_200C, 0x5200_210C];
const ERASE: u64 = 1 << 2 | 1 << 7;
/// First address of the flash; bytes of a bank and of a sector.
const FLASH: u64 = 0x0800_0000;
const BANK: u64 = 0x10_0000;
const SECTOR: u64 = 0x2_0000;
/// General-purpose timers of the clock and the motors: TIM2, TIM4.
const TIME_TIMER: usize = 0;
const MOTOR_TIMER: usize = 2;

/// The Matek's pads that lead to the converter, with what ArduPilot (`MatekH743`) and PX4 (`matek/h743-slim`) say of
/// their dividers.
const S1: AnalogPad = AnalogPad::bare(At(1, 0), 9);
/// Bare, like pad S1.
const S2: AnalogPad = AnalogPad::bare(At(1, 1), 5);
/// For a receiver's signal strength, 0 to 3.3 V.
const RSSI: AnalogPad = AnalogPad::bare(At(2, 5), 8);
/// For the current of a second battery, 0 to 3.3 V.
const CU2: AnalogPad = AnalogPad::bare(At(0, 7), 7);
/// For the voltage of a second battery.
const VB2: AnalogPad = AnalogPad::divided(At(0, 4), 18, 11.0);

/// The control path: data-ready on PB2, the sensor's words by DMA2 stream 2, the motors on TIM4.
pub const MARKS: Marks = Marks {
    ready: "EXTI2",
    received: "DMA2_STREAM2",
    motors: 0x4000_0800,
};

/// The pads of the Matek H743, as `docs/wiring.md` wires them.
pub static MATEK: Pads = Pads {
    name: "matek-h743",
    part: "stm32h743",
    crystal: 8_000_000,
    imu: 0,
    imu_select: ("GPIOC", 15),
    imu_ready: At(1, 2),
    // On the underside, turned by half a turn about the vertical (ArduPilot's `hwdef.dat`: ROTATION_YAW_180).
    imu_axes: |[x, y, z]| [-x, -y, z],
    arms: [(0, 0x28), (0, 0x29), (1, 0x28), (1, 0x29)],
    barometer: Some((1, 2)),
    pressure: [S1, S2, RSSI, CU2],
    // 1:11 and 40 A/V.
    battery: AnalogPad::divided(At(2, 0), 10, 11.0),
    current: AnalogPad::divided(At(2, 1), 11, 40.0),
    servo_battery: VB2,
    receiver: 5,
    receiver_out: (At(2, 6), 7),
    console: 6,
    mavlink: 0,
    ground: 2,
    ground_in: (At(3, 9), 7),
    motors: TimerPins {
        pins: [At(3, 12), At(3, 13), At(3, 14), At(3, 15)],
        function: 2,
    },
    servos: [
        ServoPin::new(At(0, 0), 2, "TIM5", 1),
        ServoPin::new(At(0, 1), 2, "TIM5", 2),
        ServoPin::new(At(0, 2), 2, "TIM5", 3),
        ServoPin::new(At(0, 3), 2, "TIM5", 4),
    ],
    buses: &[
        (At(0, 5), 5),
        (At(0, 6), 5),
        (At(3, 7), 5),
        (At(1, 6), 4),
        (At(1, 7), 4),
        (At(1, 10), 4),
        (At(1, 11), 4),
        (At(2, 7), 7),
        (At(4, 7), 7),
        (At(4, 8), 7),
        (At(0, 9), 7),
        (At(0, 10), 7),
    ],
    resting_high: &[
        At(1, 6),
        At(1, 7),
        At(1, 10),
        At(1, 11),
        At(2, 7),
        At(4, 7),
        At(0, 10),
    ],
    signals: [At(4, 4), At(4, 3), At(0, 15)],
    foreign: &[0x210D_99F1, 0x5168_5B62],
};

/// Instances that our firmware does not use; their models would halve the speed. An access is listed as unimplemented
/// and fails the run.
const UNUSED: [&str; 29] = [
    "TIM1", "TIM3", "TIM15", "TIM6", "TIM7", "TIM8", "TIM12", "TIM13", "TIM14", "TIM16", "TIM17", "SPI2",
    "SPI3", "SPI4", "SPI5", "SPI6", "I2C3", "I2C4", "UART4", "UART5", "UART8", "BDMA", "DMAMUX2", "ADC2",
    "ADC3", "SDMMC2", "GPIOI", "GPIOJ", "GPIOK",
];
/// Serial ports in the order of [`Stm32h743::usart`].
const SERIAL: [&str; 8] = [
    "USART1", "USART2", "USART3", "UART4", "UART5", "USART6", "UART7", "UART8",
];

/// Registers of running clocks (RM0433 §8.7): PLL1 makes 200 MHz of 64 by 4 and 25.
const LOADER_CLOCKS: &[(Clocks, u64)] = &[
    (Clocks::Pllckselr, 4 << 4),
    (Clocks::Pllcfgr, 1 << 16 | 3 << 2),
    (Clocks::Pll1divr, 1 << 24 | 1 << 16 | 1 << 9 | 24),
    (Clocks::Cr, 1 << 24 | 1),
];
/// Removes the reset flags.
const NO_FLAGS: &[(Clocks, u64)] = &[(Clocks::Rsr, 1 << 16)];

fn motor_timer() -> Tim<General> {
    Tim::new(TIMERS[MOTOR_TIMER])
}

/// The part.
#[derive(Debug)]
pub struct H743 {
    inner: Stm32h743,
    time: IgnoreDma<General>,
    motors: EdgeProbe<General>,
    watchdog: Watchdog,
    buses: [ClockStretch<EagerI2c>; 2],
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
    watchdog: usize,
    time: usize,
    motors: usize,
    clocks: usize,
    debug: usize,
    buses: [usize; 2],
    serial: Vec<usize>,
    usb: usize,
    unused: Vec<bool>,
}

impl H743 {
    /// The part, out of reset.
    ///
    /// # Errors
    /// The emulator cannot make it.
    pub fn new() -> Result<Self, String> {
        let failed = |e: rigless::soc::Error| format!("emulator: {e}");
        let mut inner = Stm32h743::new().map_err(failed)?;
        inner.set_analog_supply(SUPPLY);
        let slot = |name| inner.bus().slot(name).map_err(failed);
        let mut unused = vec![false; inner.bus().slots().len()];
        for name in UNUSED {
            unused[slot(name)?] = true;
        }
        let slots = Slots {
            watchdog: slot("IWDG")?,
            time: slot("TIM2")?,
            motors: slot("TIM4")?,
            clocks: slot("RCC")?,
            debug: slot("DBGMCU")?,
            buses: [slot("I2C1")?, slot("I2C2")?],
            usb: slot("OTG2_HS_GLOBAL")?,
            serial: SERIAL.into_iter().map(slot).collect::<Result<_, _>>()?,
            unused,
        };
        Ok(Self {
            inner,
            time: IgnoreDma(Tim::new(TIMERS[TIME_TIMER])),
            motors: EdgeProbe::new(motor_timer),
            watchdog: Watchdog::default(),
            // `Mcu::split` fills these slots.
            buses: [(); 2].map(|()| ClockStretch::new(EagerI2c::new(I2c::with_kernel_clock(HSI_HZ)))),
            usb: UsbCore::default(),
            slots,
            pulses: 0,
            browned_out: false,
            missing: 0,
            // Revision V, as the emulator's part is.
            revision: 0x2003,
            loader_clocks: false,
        })
    }

    /// Writes clock registers as a firmware would.
    fn write_clocks(&mut self, now: VirtualNanos, writes: &[(Clocks, u64)]) {
        for &(register, value) in writes {
            let address = RCC.base + u64::from(register.spec().offset);
            // The emulator refuses a write only to a missing register.
            let _ = Operate::write(self, now, address, Width::W32, value);
        }
    }

    /// Replaces the crystal, Hz.
    pub fn fit_crystal(&mut self, hz: u64) {
        self.inner.rcc.attach_crystals(hz, 0);
    }

    /// Resets the watchdog to its stopped state.
    pub fn still_watchdog(&mut self) {
        self.watchdog = Watchdog::default();
    }

    /// Level of motor 1's output.
    pub fn first_motor_is_high(&self) -> bool {
        self.motors.is_high(0)
    }

    /// Level of servo 1's output.
    pub fn first_servo_is_high(&mut self) -> bool {
        let [servo, ..] = MATEK.servos;
        let Some((number, (timer, file))) = Channel::new(servo.channel).zip(self.servo_timer(servo)) else {
            return false;
        };
        timer.output(number, file) == Some(Level::High)
    }

    /// The timer that makes a servo's pulses, and its registers.
    fn servo_timer(&mut self, servo: ServoPin) -> Option<(&mut Tim<General>, &mut RegisterFile)> {
        let nth = TIMERS.iter().position(|timer| timer.instance == servo.timer)?;
        Some(self.inner.timer(nth))
    }

    /// Puts the revision into the identity register.
    fn mark_revision(&mut self) {
        let file = self.inner.bus_mut().slot_mut(self.slots.debug).registers_mut();
        file.set(Debug::Idc, 0x450 | self.revision << 16);
    }

    /// The interface of a bus.
    fn i2c(&mut self, bus: usize) -> &mut I2c {
        &mut self.buses[bus].inner.inner
    }

    /// Gives the data-ready pulses that the sensor has sent to the pin that it is wired to.
    fn carry_data_ready(&mut self, now: VirtualNanos) {
        let pulses = self.imu(MATEK.imu).map_or(0, |imu| imu.pulses);
        if pulses == self.pulses {
            return;
        }
        self.pulses = pulses;
        // 8 µs on the real part; the interrupt takes the edge.
        self.drive(now, MATEK.imu_ready, Level::High);
        self.drive(now, MATEK.imu_ready, Level::Low);
    }
}

impl Chip for H743 {
    same_on_this_part!(stm32h743);

    fn servo_pulse(&mut self, servo: ServoPin) -> Option<(u64, u64)> {
        let (timer, file) = self.servo_timer(servo)?;
        let pulse = timer.pulse(Channel::new(servo.channel)?, file)?;
        Some((pulse.width.0, pulse.period.0))
    }

    fn pll_ranges(&self) -> Option<String> {
        let file = self.inner.bus().slots()[self.slots.clocks].registers();
        let settings = pll_ranges::Settings {
            control: file.get(Clocks::Cr),
            dividers: file.get(Clocks::Pllckselr),
            ranges: file.get(Clocks::Pllcfgr),
            multipliers: [Clocks::Pll1divr, Clocks::Pll2divr, Clocks::Pll3divr]
                .map(|register| file.get(register)),
        };
        pll_ranges::wrong(&settings, MATEK.crystal as f64)
    }

    fn bus_times(&self, bus: usize, speed: ArmBusSpeed) -> Option<String> {
        let file = self.inner.bus().slots()[self.slots.buses[bus]].registers();
        bus_times::wrong(file.get(BusRegister::Timingr), BUS_CLOCK, speed)
    }

    fn err_on_bus(&mut self, bus: usize, every: u32) -> bool {
        self.buses[bus].inner.errors = every;
        true
    }

    fn hold_clock(&mut self, bus: usize, hold: u64) -> bool {
        self.buses[bus].hold = hold;
        true
    }

    fn serial_setup(&self, port: usize) -> Setup {
        let file = self.inner.bus().slots()[self.slots.serial[port]].registers();
        let registers = [Serial::Brr, Serial::Cr1, Serial::Cr2, Serial::Cr3].map(|r| file.get(r));
        Setup::in_registers(SERIAL_CLOCK, registers)
    }

    fn set_options(&mut self, options: Options) {
        let (flash, file) = self.inner.program();
        let level = match options {
            Options::Factory => 0,
            // Level 3: two bits that count upwards (RM0433 §4.9.8).
            Options::BrownOut => 3 << 2,
        };
        let factory = OptionBytes::FACTORY;
        let optsr = factory.optsr & !(3 << 2) | level;
        flash.keep_options(OptionBytes { optsr, ..factory }, file);
    }

    fn age(&mut self) {
        // Revision Y (RM0433 §60.5.8).
        self.revision = 0x1003;
        self.mark_revision();
    }

    fn changes_cached_flash(&self, _: u64, _: u64) -> bool {
        // Bank 2 is never cached: the core's data cache is off.
        false
    }

    fn erased(&self, address: u64, value: u64) -> Option<u64> {
        let bank = BANK_CONTROLS.iter().position(|control| *control == address)?;
        // A sector's erase, and its start (RM0433 §4.9.4).
        (value & ERASE == ERASE).then(|| FLASH + BANK * bank as u64 + SECTOR * (value >> 8 & 7))
    }

    fn core(&self, speed: f64) -> Result<CoreSpec, String> {
        let machine = MatekH743::new().map_err(|e| format!("emulator: {e}"))?;
        let mut core = machine.config();
        core.core.instructions_per_second =
            NonZeroU64::new((CLOCK * speed) as u64).ok_or("the speed must be more than 0")?;
        Ok(core.spec())
    }
}

impl Mcu for H743 {
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
        self.inner.reset(at, cause);
        for (own, stock) in self.buses.iter_mut().zip(&mut self.inner.i2c) {
            own.inner.inner = I2c::with_kernel_clock(HSI_HZ);
            own.inner.inner.inherit(stock);
            Device::reset(own);
        }
        self.watchdog = Watchdog::default();
        Device::reset(&mut self.usb);
        self.time = IgnoreDma(Tim::new(TIMERS[TIME_TIMER]));
        self.motors.restart(at);
        self.mark_revision();
        if std::mem::take(&mut self.browned_out) {
            // The emulator knows no brown-out: its flag is set beside the pin's (RM0433 §8.7.37).
            let file = self.inner.bus_mut().slot_mut(self.slots.clocks).registers_mut();
            file.set(Clocks::Rsr, file.get(Clocks::Rsr) | 1 << 21);
        }
        if self.loader_clocks {
            self.write_clocks(at, LOADER_CLOCKS);
        }
    }

    fn poll(&mut self, now: VirtualNanos) {
        // Only serial ports with something at the far end look outside; the stock part asks every model at every stop.
        for (nth, slot) in self.slots.serial.iter().enumerate() {
            if self.inner.usart[nth].attached() {
                let mut port = std::mem::take(&mut self.inner.usart[nth]);
                let (file, mut c) = self.inner.bus_mut().drive(now, *slot);
                Device::poll(&mut port, file, &mut c);
                self.inner.usart[nth] = port;
            }
        }
        self.carry_data_ready(now);
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        if self.missing != 0 && slot == self.slots.clocks {
            let file = self.inner.bus_mut().slot_mut(slot).registers_mut();
            file.set(Clocks::Cr, file.get(Clocks::Cr) & !self.missing);
        }
        if slot == self.slots.watchdog {
            return (self.inner.bus_mut(), Some(&mut self.watchdog));
        }
        if slot == self.slots.time {
            return (self.inner.bus_mut(), Some(&mut self.time));
        }
        if slot == self.slots.usb {
            return (self.inner.bus_mut(), Some(&mut self.usb));
        }
        if slot == self.slots.motors {
            return (self.inner.bus_mut(), Some(&mut self.motors));
        }
        if let Some(nth) = self.slots.buses.iter().position(|bus| *bus == slot) {
            return (self.inner.bus_mut(), Some(&mut self.buses[nth]));
        }
        if self.slots.unused.get(slot) == Some(&true) {
            return (self.inner.bus_mut(), None);
        }
        self.inner.split(slot)
    }
}

#[cfg(test)]
mod tests {
    use sophie_control::gripper::contact_pressure::FsrScale;
    use sophie_control::params::Params;

    use super::*;

    /// For an airspeed sensor of 5 V.
    const AIRS: AnalogPad = AnalogPad::divided(At(2, 4), 4, 2.0);

    /// Pressure (Pa) that the flight stack reads through `pads` at a true `pressure` (Pa).
    fn read(pads: [AnalogPad; 4], params: &Params, pressure: f64) -> [f64; 4] {
        // R_d / (R_d + R) of 3.3 V, with 10 kΩ and 100 µS/N over 1444 mm².
        let load = pressure * 0.001_444 * 1e-4 * 10e3;
        let volts = 3.3 * load / (1.0 + load);
        let mut seen = [0.0; 4];
        let wired = Pads {
            pressure: pads,
            ..MATEK
        };
        let inputs = wired.analog([volts, volts, volts, volts, 1.5, 0.1, 0.7]);
        for ((seen, scale), (_, millivolts)) in seen.iter_mut().zip(FsrScale::all(params)).zip(inputs) {
            *seen = f64::from(scale.pressure((f64::from(millivolts) / 3300.0 * 4095.0).round() as u16));
        }
        seen
    }

    #[test]
    fn the_pads_of_the_pressure_sensors_read_the_grip_pressure() {
        for pressure in [100.0, 950.0, 1140.0, 3000.0] {
            for seen in read(MATEK.pressure, &Params::default(), pressure) {
                assert!((seen - pressure).abs() < 0.01 * pressure, "{pressure}: {seen}");
            }
        }
        let channels: Vec<u8> = MATEK.analog([0.0; 7]).map(|(channel, _)| channel).collect();
        assert_eq!(channels, [9, 5, 8, 7, 10, 11, 18]);
    }

    #[test]
    fn pads_with_dividers_would_end_below_the_grip_pressure() {
        // Behind 1:2 and 1:11 even a million newtons per square metre read as 692 and 69.
        let [airs, rssi, vb2, cu2] = read([AIRS, RSSI, VB2, CU2], &Params::default(), 950.0);
        assert!(
            (airs - 281.8).abs() < 2.0 && (vb2 - 38.4).abs() < 1.0,
            "{airs} {vb2}"
        );
        assert!(
            (rssi - 950.0).abs() < 5.0 && (cu2 - 950.0).abs() < 5.0,
            "{rssi} {cu2}"
        );
        let [airs, _, vb2, _] = read([AIRS, RSSI, VB2, CU2], &Params::default(), 1e6);
        assert!(
            (690.0..693.0).contains(&airs) && (68.5..70.0).contains(&vb2),
            "{airs} {vb2}"
        );
        // With their dividers declared, they read as the others do.
        let set = Params {
            fsr_scale_1: 2.0,
            fsr_scale_3: 11.0,
            ..Params::default()
        };
        let [airs, _, vb2, _] = read([AIRS, RSSI, VB2, CU2], &set, 950.0);
        assert!(
            (airs - 950.0).abs() < 5.0 && (vb2 - 950.0).abs() < 10.0,
            "{airs} {vb2}"
        );
    }
}
