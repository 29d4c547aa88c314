//! Wiring of a board: the processor pin and interface of each device.

use std::fmt::{self, Display, Formatter};

/// Port (0 is A) and number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct At(pub usize, pub u8);

impl Display for At {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "P{}{}", char::from(b'A' + self.0 as u8), self.1)
    }
}

/// Four pins of one timer.
#[derive(Clone, Copy, Debug)]
pub struct TimerPins {
    /// Channels 1 to 4.
    pub pins: [At; 4],
    /// Number of the alternate function.
    pub function: u8,
}

/// A servo's pin and timer channel.
#[derive(Clone, Copy, Debug)]
pub struct ServoPin {
    /// Processor pin.
    pub pin: At,
    /// Number of the alternate function.
    pub function: u8,
    /// Name of the timer.
    pub timer: &'static str,
    /// 1 to 4.
    pub channel: u8,
}

impl ServoPin {
    /// `channel` of `timer` on `pin`.
    pub const fn new(pin: At, function: u8, timer: &'static str, channel: u8) -> Self {
        Self {
            pin,
            function,
            timer,
            channel,
        }
    }
}

/// A pad of the ADC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnalogPad {
    /// Processor pin.
    pub pin: At,
    /// ADC channel.
    pub channel: u8,
    /// Voltage at the pad over the pin's: 1 without divider.
    pub divider: f64,
}

impl AnalogPad {
    /// A pad without divider.
    pub const fn bare(pin: At, channel: u8) -> Self {
        Self::divided(pin, channel, 1.0)
    }

    /// With a divider of 1:`divider` before the pin.
    pub const fn divided(pin: At, channel: u8, divider: f64) -> Self {
        Self {
            pin,
            channel,
            divider,
        }
    }

    /// Millivolts at the pin (the emulator's unit, 1.2 counts of 12 bits) for `volts` at the pad.
    pub fn millivolts(&self, volts: f64) -> u32 {
        (volts / self.divider * 1e3).round().max(0.0) as u32
    }
}

/// Pads as in `docs/wiring.md`, interfaces numbered as in the emulator.
#[derive(Debug)]
pub struct Pads {
    /// Name of the board.
    pub name: &'static str,
    /// First words of the parameter sectors after ArduPilot (AP_FlashStorage: state and signature).
    pub foreign: &'static [u64],
    /// Name of the emulator's chip.
    pub part: &'static str,
    /// Crystal, Hz.
    pub crystal: u64,
    /// SPI interface of the inertial sensor.
    pub imu: usize,
    /// Emulator's port name and pin of its chip select.
    pub imu_select: (&'static str, u8),
    /// Data-ready pin of the sensor.
    pub imu_ready: At,
    /// Conversion from body axes (forward, right, down) to the sensor's.
    pub imu_axes: fn([f64; 3]) -> [f64; 3],
    /// Bus and address, arms 1 to 4.
    pub arms: [(usize, u8); 4],
    /// Bus of the barometer, and its index on it after the arms' sensors.
    pub barometer: Option<(usize, usize)>,
    /// 1 to 4.
    pub pressure: [AnalogPad; 4],
    /// Pad of the battery voltage.
    pub battery: AnalogPad,
    /// Current sensor, scaled in amperes per volt.
    pub current: AnalogPad,
    /// Pad of the servo battery's voltage, with what divides it.
    pub servo_battery: AnalogPad,
    /// Serial port of the receiver.
    pub receiver: usize,
    /// With its alternate function; unused with SBUS.
    pub receiver_out: (At, u8),
    /// Serial port of the console.
    pub console: usize,
    /// Serial port of MAVLink.
    pub mavlink: usize,
    /// Serial port of the flow and range module.
    pub ground: usize,
    /// Its input, with its alternate function; unused without a module.
    pub ground_in: (At, u8),
    /// The motors.
    pub motors: TimerPins,
    /// 1 to 4.
    pub servos: [ServoPin; 4],
    /// With alternate functions. The emulator's interfaces work without pins: a flight would not show a missing one.
    pub buses: &'static [(At, u8)],
    /// Idle high: I2C by pull-ups, the receiver's line by the receiver.
    pub resting_high: &'static [At],
    /// State light, fault light, buzzer.
    pub signals: [At; 3],
}

impl Pads {
    /// ADC channels and millivolts for volts at the pads of pressure 1 to 4, battery voltage (V) and current (A), servo
    /// battery (V).
    pub fn analog(&self, values: [f64; 7]) -> impl Iterator<Item = (u8, u32)> {
        let others = [self.battery, self.current, self.servo_battery];
        let inputs = self.pressure.into_iter().chain(others);
        inputs
            .zip(values)
            .map(|(pad, volts)| (pad.channel, pad.millivolts(volts)))
    }

    /// Pins with their alternate functions; `answers`: the receiver's output is used; `flow_module`: its line is used.
    pub fn functions(&self, answers: bool, flow_module: bool) -> impl Iterator<Item = (At, u8)> {
        let motors = self.motors.pins.map(|pin| (pin, self.motors.function));
        let servos = self.servos.map(|servo| (servo.pin, servo.function));
        motors
            .into_iter()
            .chain(servos)
            .chain(self.buses.iter().copied())
            .chain(answers.then_some(self.receiver_out))
            .chain(flow_module.then_some(self.ground_in))
    }
}
