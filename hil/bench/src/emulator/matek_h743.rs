//! The Matek H743 with SOPHIE's parts on its pads, as `docs/boards.md` wires them.

use std::num::NonZeroU64;

use rigless::device::Level;
use rigless::machine::matekh743::MatekH743;
use rigless::machine::{Board, Target, armv7m};
use rigless::mcu::Mcu;
use rigless::snapshot::{Error, Reader, Store, Writer};
use rigless::soc::stm32h743::Stm32h743;
use rigless::soc::stm32h743::peripherals::adc::Channel as Input;
use rigless::soc::stm32h743::peripherals::gpio::Pin;
use rigless::soc::stm32h743::peripherals::spi::Select;
use rigless::soc::stm32h743::peripherals::tim::Channel;
use rigless::time::VirtualNanos;

use super::chips::bno055::Bno055;
use super::chips::icm42688p::Imu;
use super::chips::line::Line;
use super::part::{At, Part};

/// Core clock, Hz.
pub const CLOCK: f64 = 400e6;
/// Crystal, Hz.
const CRYSTAL: u64 = 8_000_000;
/// Supply and converter reference, mV.
const SUPPLY: u32 = 3300;
/// Converter channels of the analog inputs: PC4, PC5, PA4, PA7 (pressure 1 to 4), PC0 (voltage), PC1 (current).
const ANALOG: [u8; 6] = [4, 8, 18, 7, 10, 11];
/// Inertial sensor: interface, and PC15 as its select.
const IMU: usize = 0;
const IMU_SELECT: (&str, u8) = ("GPIOC", 15);
/// Interfaces and addresses of the arms' sensors 1 to 4.
const ARMS: [(usize, u8); 4] = [(0, 0x28), (0, 0x29), (1, 0x28), (1, 0x29)];
/// Serial port of the receiver: USART6.
const RECEIVER: usize = 5;
/// General-purpose timer of the servos: TIM5.
const SERVOS: usize = 3;
/// Pins of motors and servos with the alternate function that their timers are.
const MOTOR_PINS: [At; 4] = [At(3, 12), At(3, 13), At(3, 14), At(3, 15)];
const SERVO_PINS: [At; 4] = [At(0, 0), At(0, 1), At(0, 2), At(0, 3)];
const TIMER_FUNCTION: u8 = 2;
/// Pins of the buses with their alternate functions. The emulator's interfaces are not wired to pins: a firmware that
/// forgot one would still talk.
const BUS_PINS: [(At, u8); 9] = [
    (At(0, 5), 5),
    (At(0, 6), 5),
    (At(3, 7), 5),
    (At(1, 6), 4),
    (At(1, 7), 4),
    (At(1, 10), 4),
    (At(1, 11), 4),
    (At(2, 6), 7),
    (At(2, 7), 7),
];
/// Lines that rest high: the I2C buses by their pull-ups, the receiver's line by the receiver.
const RESTING_HIGH: [At; 5] = [At(1, 6), At(1, 7), At(1, 10), At(1, 11), At(2, 7)];
/// State light, fault light, buzzer.
const SIGNAL_PINS: [At; 3] = [At(4, 4), At(4, 3), At(0, 15)];

/// The board.
#[derive(Debug)]
pub struct MatekBoard {
    /// Its processor.
    pub part: Part,
    core: armv7m::Config,
}

impl MatekBoard {
    /// The board, running `speed` instructions for each cycle of its clock.
    ///
    /// # Errors
    /// The emulator cannot make the part.
    pub fn new(speed: f64) -> Result<Self, String> {
        let told = |e: rigless::soc::Error| format!("emulator: {e}");
        let mut chip = Stm32h743::new().map_err(told)?;
        chip.rcc.attach_crystals(CRYSTAL, 0);
        chip.set_supply(SUPPLY);
        chip.set_analog_supply(SUPPLY);
        for converter in &mut chip.adc {
            converter.set_reference(SUPPLY);
        }
        if let Some(pin) = Pin::new(IMU_SELECT.1) {
            chip.spi[IMU].attach_selected(
                Imu::default(),
                Select {
                    port: IMU_SELECT.0,
                    pin,
                    active: Level::Low,
                },
            );
        }
        for (bus, address) in ARMS {
            chip.i2c[bus].attach(Bno055::new(address));
        }
        chip.usart[RECEIVER].attach(Line::default());
        let mut core = MatekH743::new().map_err(told)?.config();
        let rate = NonZeroU64::new((CLOCK * speed) as u64).ok_or("the speed must be more than 0")?;
        core.core.instructions_per_second = rate;
        Ok(Self {
            part: Part::new(chip).map_err(told)?,
            core,
        })
    }

    /// Power comes up: lines take the level at which they rest.
    pub fn power_up(&mut self, now: VirtualNanos) {
        for pin in RESTING_HIGH {
            self.part.drive(now, pin, Level::High);
        }
    }

    /// The inertial sensor.
    pub fn imu(&mut self) -> Option<&mut Imu> {
        self.part.inner.spi[IMU].chip_mut(0)
    }

    /// Cuts the inertial sensor off, or connects it.
    pub fn silence_imu(&mut self, silent: bool) {
        // False only without a chip there.
        let _ = self.part.inner.spi[IMU].silence(0, silent);
    }

    /// Flips `mask` in the next word that the inertial sensor answers.
    pub fn flip_imu_word(&mut self, mask: u64) {
        if let Some(place) = self.part.inner.spi[IMU].place_mut(0) {
            place.flip(mask);
        }
    }

    /// The sensor of arm `arm`, 0 to 3.
    pub fn arm(&mut self, arm: usize) -> Option<&mut Bno055> {
        let (bus, nth) = (ARMS.get(arm)?.0, arm % 2);
        self.part.inner.i2c[bus].chip_mut(nth)
    }

    /// Cuts the sensor of arm `arm` off, or connects it.
    pub fn silence_arm(&mut self, arm: usize, silent: bool) {
        if let Some((bus, _)) = ARMS.get(arm) {
            let _ = self.part.inner.i2c[*bus].silence(arm % 2, silent);
        }
    }

    /// Puts volts on the analog inputs: pressure 1 to 4, battery voltage, battery current.
    pub fn set_analog(&mut self, volts: [f64; 6]) {
        for (channel, volts) in ANALOG.into_iter().zip(volts) {
            if let Some(channel) = Input::new(channel) {
                // The emulator takes whole millivolts: 1.2 counts of 12 bits.
                self.part.inner.adc[0].set_input(channel, (volts * 1e3).round().max(0.0) as u32);
            }
        }
    }

    /// The receiver's line.
    pub fn receiver(&mut self) -> Option<&mut Line> {
        self.part.inner.usart[RECEIVER].chip_mut()
    }

    /// The motors' pins are their timer's.
    pub fn motors_driven(&mut self, now: VirtualNanos) -> [bool; 4] {
        MOTOR_PINS.map(|pin| self.part.function(now, pin) == Some(TIMER_FUNCTION))
    }

    /// High time and period of each servo's pulse, ns; `None` without pulses.
    pub fn servo_pulses(&mut self, now: VirtualNanos) -> [Option<(u64, u64)>; 4] {
        let driven = SERVO_PINS.map(|pin| self.part.function(now, pin) == Some(TIMER_FUNCTION));
        let (timer, file) = self.part.inner.timer(SERVOS);
        std::array::from_fn(|nth| {
            let pulse = timer.pulse(Channel::new(nth as u8 + 1)?, file)?;
            (driven[nth] && pulse.width.0 > 0).then_some((pulse.width.0, pulse.period.0))
        })
    }

    /// Levels of state light, fault light and buzzer.
    pub fn signals(&mut self, now: VirtualNanos) -> [bool; 3] {
        SIGNAL_PINS.map(|pin| self.part.is_high(now, pin))
    }

    /// Pins that do not carry what is wired to them, one line each.
    pub fn miswired(&mut self, now: VirtualNanos) -> Vec<String> {
        let timers = MOTOR_PINS
            .into_iter()
            .chain(SERVO_PINS)
            .map(|pin| (pin, TIMER_FUNCTION));
        let mut lines = Vec::new();
        for (pin, wanted) in timers.chain(BUS_PINS) {
            let found = self.part.function(now, pin);
            if found != Some(wanted) {
                let found = found.map_or("none".to_owned(), |f| f.to_string());
                lines.push(format!(
                    "{pin} carries alternate function {found}, wired for {wanted}"
                ));
            }
        }
        lines
    }
}

impl Board for MatekBoard {
    fn name(&self) -> &'static str {
        "matek-h743"
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec!["stm32h743"]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.part)
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let core = self.core.clone().spec();
        vec![Target::new("stm32h743", &mut self.part, core)]
    }
}

// No snapshot is ever taken of a run.
impl Store for MatekBoard {
    fn store(&self, _: &mut Writer) -> Result<(), Error> {
        Err(Error::Failed)
    }

    fn load(&mut self, _: &mut Reader) -> Result<(), Error> {
        Err(Error::Failed)
    }
}
