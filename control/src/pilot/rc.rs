//! Decoding of the transmitter's sticks and switches.
//!
//! Channels are CRSF counts, 11 bit: 172 and 1811 at the ends of a stick's travel, 992 at its centre.
//!
//! | channel | what | low .. high |
//! |---|---|---|
//! | 1 | roll | left .. right |
//! | 2 | pitch | pulled (nose up) .. pushed (nose down), as EdgeTX sends it |
//! | 3 | throttle | 0 .. 1 |
//! | 4 | yaw | left .. right |
//! | 5 | arm switch | off, on |
//! | 6 | stick mode | angle, rate, direct |
//! | 7 | perch switch | off, on |
//! | 8 | arms that close | all, front, rear |
//! | 9 | hold switch | off, off, on |
//!
//! Channel 9 is optional: a transmitter that omits or centres it flies without hold.
//!
//! Counts above the stick's end are valid (EdgeTX's extended limits send up to 1984, full resolution up to 2047) and
//! read as the stick's end, also over SBUS, which has no checksum: refusing them would reject one of four random
//! frames, while header, flags and end of three frames in a row reject all but 5e-14. Counts below the least are sent
//! by receivers without a transmitter.

use crate::maths::scalar::clamp;

/// Channels in a frame.
pub const CHANNELS: usize = 16;
/// Counts at the low end of a stick's travel.
pub const RAW_LOW: u16 = 172;
/// Counts at the centre.
pub const RAW_CENTRE: u16 = 992;
/// Counts at the high end.
pub const RAW_HIGH: u16 = 1811;
/// Least count of a transmitter, 885 µs. A receiver without one sends less.
const RAW_LEAST: u16 = 8;
/// Half the travel of a centred stick, counts.
const RAW_HALF: f32 = 819.5;
const RAW_SPAN: f32 = 1639.0;
/// Dead zone about the centre (or the throttle's zero), share of the travel, for a gimbal's slack.
pub const DEADBAND: f32 = 0.01;
/// Thresholds of a switch, counts.
const SWITCH_LOW: u16 = 582;
const SWITCH_HIGH: u16 = 1402;

/// Reading of the sticks in flight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StickMode {
    /// Roll and pitch angle, yaw rate.
    #[default]
    Angle,
    /// The three body rates.
    Rate,
    /// Thrust and the three torques, as in the paper.
    Direct,
}

/// Arms that the tendons close.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArmChoice {
    /// All four.
    #[default]
    All,
    /// The front pair, 1 and 3.
    Front,
    /// The rear pair, 2 and 4.
    Rear,
}

impl ArmChoice {
    /// True for each chosen arm.
    pub const fn mask(self) -> crate::allocation::wrench::PerArm<bool> {
        match self {
            Self::All => [true; 4],
            Self::Front => [true, false, true, false],
            Self::Rear => [false, true, false, true],
        }
    }
}

/// Pilot's input, scaled and finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sticks {
    /// Right positive, -1..1.
    pub roll: f32,
    /// Nose up positive, -1..1: stick pulled.
    pub pitch: f32,
    /// Clockwise from above positive, -1..1.
    pub yaw: f32,
    /// Share of the largest collective thrust, 0..1.
    pub throttle: f32,
    /// On permits running motors, off stops them at once.
    pub arm_switch: bool,
    /// On closes the arms, off releases them.
    pub perch_switch: bool,
    /// On holds the position, off flies by the sticks.
    pub hold_switch: bool,
    /// Reading of the sticks.
    pub stick_mode: StickMode,
    /// Arms to close.
    pub arms: ArmChoice,
}

/// A needed channel with a count that no transmitter sends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelError {
    /// Channel, from 1.
    pub channel: u8,
    /// Its count.
    pub raw: u16,
}

impl Sticks {
    /// Decodes a frame.
    ///
    /// # Errors
    /// A stick, the arm switch or the perch switch below the least count: the frame must be dropped, as its low end would
    /// lean the vehicle, stop its motors or let go of the pipe. Any other channel then reads as its low position.
    pub fn from_channels(channels: &[u16; CHANNELS]) -> Result<Self, ChannelError> {
        let &[roll, pitch, throttle, yaw, arm, mode, perch, arms, hold, ..] = channels;
        let needed = [
            (1, roll),
            (2, pitch),
            (3, throttle),
            (4, yaw),
            (5, arm),
            (7, perch),
        ];
        for (channel, raw) in needed {
            if raw < RAW_LEAST {
                return Err(ChannelError { channel, raw });
            }
        }
        Ok(Self {
            roll: centred(roll),
            pitch: -centred(pitch),
            yaw: centred(yaw),
            throttle: from_zero(throttle),
            arm_switch: position(arm) == Position::High,
            perch_switch: position(perch) == Position::High,
            hold_switch: position(hold) == Position::High,
            stick_mode: match position(mode) {
                Position::Low => StickMode::Angle,
                Position::Middle => StickMode::Rate,
                Position::High => StickMode::Direct,
            },
            arms: match position(arms) {
                Position::Low => ArmChoice::All,
                Position::Middle => ArmChoice::Front,
                Position::High => ArmChoice::Rear,
            },
        })
    }

    /// The frame for these sticks, exact to the count; channels 10 to 16 are centred, and 9 where the hold switch is off.
    pub fn to_channels(&self) -> [u16; CHANNELS] {
        let c = RAW_CENTRE;
        let two = |on| if on { RAW_HIGH } else { RAW_LOW };
        let mode = match self.stick_mode {
            StickMode::Angle => RAW_LOW,
            StickMode::Rate => c,
            StickMode::Direct => RAW_HIGH,
        };
        let arms = match self.arms {
            ArmChoice::All => RAW_LOW,
            ArmChoice::Front => c,
            ArmChoice::Rear => RAW_HIGH,
        };
        let roll = to_centred(self.roll);
        let pitch = to_centred(-self.pitch);
        let yaw = to_centred(self.yaw);
        let throttle = to_from_zero(self.throttle);
        let (arm, perch) = (two(self.arm_switch), two(self.perch_switch));
        let hold = if self.hold_switch { RAW_HIGH } else { c };
        [
            roll, pitch, throttle, yaw, arm, mode, perch, arms, hold, c, c, c, c, c, c, c,
        ]
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Position {
    Low,
    Middle,
    High,
}

fn position(raw: u16) -> Position {
    match raw {
        SWITCH_HIGH.. => Position::High,
        SWITCH_LOW.. => Position::Middle,
        _ => Position::Low,
    }
}

/// A centred stick, -1..1, continuous at the edge of the deadband.
fn centred(raw: u16) -> f32 {
    let x = clamp((f32::from(raw) - f32::from(RAW_CENTRE)) / RAW_HALF, -1.0, 1.0);
    let beyond = clamp(x.abs() - DEADBAND, 0.0, 1.0) / (1.0 - DEADBAND);
    if x < 0.0 { -beyond } else { beyond }
}

/// A stick with zero at its low end, 0..1.
fn from_zero(raw: u16) -> f32 {
    let x = (f32::from(raw) - f32::from(RAW_LOW)) / RAW_SPAN;
    clamp((x - DEADBAND) / (1.0 - DEADBAND), 0.0, 1.0)
}

fn to_centred(value: f32) -> u16 {
    let size = clamp(value.abs(), 0.0, 1.0);
    // Less than half a count: the released stick centres.
    if size < 0.5 / RAW_HALF {
        return RAW_CENTRE;
    }
    let x = DEADBAND + (1.0 - DEADBAND) * size;
    let counts = f32::from(RAW_CENTRE) + RAW_HALF * if value < 0.0 { -x } else { x };
    (clamp(counts, f32::from(RAW_LOW), f32::from(RAW_HIGH)) + 0.5) as u16
}

fn to_from_zero(value: f32) -> u16 {
    let value = clamp(value, 0.0, 1.0);
    let x = if value > 0.0 {
        DEADBAND + (1.0 - DEADBAND) * value
    } else {
        0.0
    };
    (f32::from(RAW_LOW) + RAW_SPAN * x + 0.5) as u16
}

#[cfg(test)]
mod tests;
