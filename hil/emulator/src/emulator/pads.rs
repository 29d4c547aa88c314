//! Pads of a board: which pin of the processor is wired to what.

use std::fmt::{self, Display, Formatter};

/// A pin of the processor: port (0 is A) and number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct At(pub usize, pub u8);

impl Display for At {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "P{}{}", char::from(b'A' + self.0 as u8), self.1)
    }
}

/// Four pins and the alternate function that makes them their timer's.
#[derive(Clone, Copy, Debug)]
pub struct TimerPins {
    /// Pins of the channels 1 to 4.
    pub pins: [At; 4],
    /// Number of the alternate function.
    pub function: u8,
}

/// A servo's pin, and the timer whose pulses it gets.
#[derive(Clone, Copy, Debug)]
pub struct ServoPin {
    /// The processor's pin.
    pub pin: At,
    /// Number of the alternate function that makes it the timer's.
    pub function: u8,
    /// The timer's name.
    pub timer: &'static str,
    /// Its channel, 1 to 4.
    pub channel: u8,
}

impl ServoPin {
    /// The pin of `channel` of `timer`.
    pub const fn new(pin: At, function: u8, timer: &'static str, channel: u8) -> Self {
        Self {
            pin,
            function,
            timer,
            channel,
        }
    }
}

/// A pad that leads to the converter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnalogPad {
    /// The processor's pin.
    pub pin: At,
    /// Channel of the converter.
    pub channel: u8,
    /// Voltage at the pad over that at the pin: 1 without a divider on the board.
    pub divider: f64,
}

impl AnalogPad {
    /// A pad that is the pin itself.
    pub const fn bare(pin: At, channel: u8) -> Self {
        Self::divided(pin, channel, 1.0)
    }

    /// A pad with a divider of 1:`divider` before the pin.
    pub const fn divided(pin: At, channel: u8, divider: f64) -> Self {
        Self {
            pin,
            channel,
            divider,
        }
    }

    /// Whole millivolts at the pin, which is what the emulator takes, where the pad has `volts`: 1.2 counts of 12 bits.
    pub fn millivolts(&self, volts: f64) -> u32 {
        (volts / self.divider * 1e3).round().max(0.0) as u32
    }
}

/// What hangs on a board's pads, as `docs/wiring.md` wires them. Interfaces are counted as the emulator counts them.
#[derive(Debug)]
pub struct Pads {
    /// Name of the board.
    pub name: &'static str,
    /// The first words that ArduPilot leaves in the sectors of the parameters (AP_FlashStorage: state and signature).
    pub foreign: &'static [u64],
    /// Name of the emulator's part.
    pub part: &'static str,
    /// Crystal, Hz.
    pub crystal: u64,
    /// Inertial sensor: serial interface, port and pin of its select, data-ready.
    pub imu: usize,
    /// Port, as the emulator names it, and pin of its select.
    pub imu_select: (&'static str, u8),
    /// Data-ready.
    pub imu_ready: At,
    /// Body axes (forward, right, down) on the axes of the inertial sensor.
    pub imu_axes: fn([f64; 3]) -> [f64; 3],
    /// Bus and address of the arms' sensors 1 to 4.
    pub arms: [(usize, u8); 4],
    /// The pads of pressure 1 to 4, as the board is made.
    pub pressure: [AnalogPad; 4],
    /// The pad of the battery's voltage.
    pub battery: AnalogPad,
    /// The pin of the battery's current sensor: a volt is so many amperes.
    pub current: AnalogPad,
    /// Serial port of the receiver.
    pub receiver: usize,
    /// Where the port sends to the receiver, with its alternate function; SBUS leaves it alone.
    pub receiver_out: (At, u8),
    /// Serial port of the console.
    pub console: usize,
    /// Serial port of MAVLink.
    pub mavlink: usize,
    /// The motors.
    pub motors: TimerPins,
    /// Servos 1 to 4.
    pub servos: [ServoPin; 4],
    /// Pins of the buses with their alternate functions. The emulator's interfaces are not wired to pins: a firmware
    /// that forgot one would still talk.
    pub buses: &'static [(At, u8)],
    /// Lines that rest high: the I2C buses by their pull-ups, the receiver's line by the receiver.
    pub resting_high: &'static [At],
    /// State light, fault light, buzzer.
    pub signals: [At; 3],
}

impl Pads {
    /// Channels of the converter and the millivolts at their pins, for volts at the pads of pressure 1 to 4, the battery's
    /// voltage (V) and its current (A).
    pub fn analog(&self, values: [f64; 6]) -> impl Iterator<Item = (u8, u32)> {
        let inputs = self.pressure.into_iter().chain([self.battery, self.current]);
        inputs
            .zip(values)
            .map(|(pad, volts)| (pad.channel, pad.millivolts(volts)))
    }

    /// Every pin that must carry an alternate function, with its number; `answers` the receiver both ways.
    pub fn functions(&self, answers: bool) -> impl Iterator<Item = (At, u8)> {
        let motors = self.motors.pins.map(|pin| (pin, self.motors.function));
        let servos = self.servos.map(|servo| (servo.pin, servo.function));
        motors
            .into_iter()
            .chain(servos)
            .chain(self.buses.iter().copied())
            .chain(answers.then_some(self.receiver_out))
    }
}
