//! A motor controller: decodes edges into a command, stops without frames.

use sophie_control::params::MotorProtocol;
use sophie_drivers::dshot::{THROTTLE_MAX, THROTTLE_MIN};
use sophie_drivers::dshot_decoder::{Decoder, LineError};
use sophie_sim::plant::esc::{EscSpec, ONESHOT125};

/// Silence that stops the motor, ns (assumed; controllers differ between 0.1 and 0.5 s).
pub const SILENCE: u64 = 250_000_000;

/// Standard pulses that a controller takes for a signal, µs (AM32; SimonK up to 2200).
const SIGNAL: std::ops::RangeInclusive<f64> = 800.0..=2200.0;

/// More than a count of any timer, µs.
const COUNT: f64 = 0.5;

/// Protocol.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line {
    /// DShot, kbit/s.
    DShot(u32),
    /// Pulses for a controller with its own ends: a standard pulse is this many times as long.
    Pulse(f64, EscSpec),
}

impl Line {
    /// The line for `protocol` to a controller as built, whichever controller the board assumes.
    #[must_use]
    pub const fn of(protocol: MotorProtocol, esc: EscSpec) -> Self {
        match protocol {
            MotorProtocol::Oneshot125 => Self::Pulse(ONESHOT125, esc),
            MotorProtocol::Dshot150 => Self::DShot(150),
            MotorProtocol::Dshot300 => Self::DShot(300),
            MotorProtocol::Pwm => Self::Pulse(1.0, esc),
            MotorProtocol::Dshot600 => Self::DShot(600),
        }
    }
}

/// Input statistics.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EscStats {
    /// Valid frames or pulses.
    pub frames: u64,
    /// Invalid frames or pulses.
    pub bad: u64,
    /// Shortest and longest between frames, ns.
    pub interval: Option<[u64; 2]>,
    /// Shortest and longest valid pulse above the lower end, as a standard one, µs.
    pub pulse_us: Option<[f64; 2]>,
}

/// A controller.
#[derive(Clone, Debug)]
pub struct Esc {
    line: Line,
    decoder: Decoder,
    rose: Option<u64>,
    began: Option<u64>,
    command: f64,
    heard: Option<u64>,
    /// Input so far.
    pub stats: EscStats,
}

impl Esc {
    /// A controller on a silent line.
    #[must_use]
    pub fn new(line: Line) -> Self {
        let bit = match line {
            Line::DShot(kbit) => 1_000_000 / kbit,
            Line::Pulse(..) => 0,
        };
        Self {
            line,
            decoder: Decoder::new(bit),
            rose: None,
            began: None,
            command: 0.0,
            heard: None,
            stats: EscStats::default(),
        }
    }

    /// Takes a change to `high` at `at` ns; returns the start of a completed frame.
    pub fn edge(&mut self, at: u64, high: bool) -> Option<u64> {
        if high {
            self.rose = Some(at);
            return None;
        }
        let rose = self.rose.take()?;
        let width = at.saturating_sub(rose);
        let began = *self.began.get_or_insert(rose);
        let command = match self.line {
            Line::DShot(_) => {
                let width = u32::try_from(width).unwrap_or(u32::MAX);
                match self.decoder.pulse(rose, width)? {
                    Ok(frame) => throttle(frame.value()),
                    Err(error) => {
                        self.stats.bad += 1;
                        // A truncated frame: this pulse begins the next one.
                        self.began = matches!(error, LineError::Short(_)).then_some(rose);
                        return None;
                    }
                }
            }
            Line::Pulse(standard, esc) => {
                let us = 1e-3 * width as f64 * standard;
                if !SIGNAL.contains(&us) {
                    self.stats.bad += 1;
                    self.began = None;
                    return None;
                }
                if us > esc.pulse_min + COUNT {
                    let [shortest, longest] = self.stats.pulse_us.unwrap_or([us; 2]);
                    self.stats.pulse_us = Some([shortest.min(us), longest.max(us)]);
                }
                esc.drive(us)
            }
        };
        self.began = None;
        self.stats.frames += 1;
        if let Some(last) = self.heard.replace(began) {
            let gap = began.saturating_sub(last);
            let [shortest, longest] = self.stats.interval.unwrap_or([gap; 2]);
            self.stats.interval = Some([shortest.min(gap), longest.max(gap)]);
        }
        self.command = command;
        Some(began)
    }

    /// Command at `now` ns, 0..1.
    #[must_use]
    pub fn command(&self, now: u64) -> f64 {
        match self.heard {
            Some(heard) if now.saturating_sub(heard) < SILENCE => self.command,
            _ => 0.0,
        }
    }
}

/// Values below the throttle range stop the motor.
fn throttle(value: u16) -> f64 {
    f64::from(value.saturating_sub(THROTTLE_MIN)) / f64::from(THROTTLE_MAX - THROTTLE_MIN)
}

#[cfg(test)]
mod tests {
    use sophie_drivers::dshot::Frame;

    use super::*;

    /// 3333 ns a bit.
    fn send(esc: &mut Esc, at: u64, bits: u16, count: u32) -> Option<u64> {
        let mut done = None;
        for n in 0..count {
            let rise = at + 3333 * u64::from(n);
            let width = if bits >> (15 - n) & 1 == 1 { 2500 } else { 1250 };
            esc.edge(rise, true);
            done = esc.edge(rise + width, false).or(done);
        }
        done
    }

    #[test]
    fn a_frame_becomes_a_command_and_silence_stops_it() {
        let mut esc = Esc::new(Line::DShot(300));
        let bits = Frame::from_command(0.5).bits();
        assert_eq!(send(&mut esc, 1000, bits, 16), Some(1000));
        assert!((esc.command(60_000) - 0.5).abs() < 1e-3);
        assert!(esc.command(1000 + SILENCE) == 0.0);
    }

    #[test]
    fn a_cut_frame_is_counted_and_the_next_is_understood() {
        let mut esc = Esc::new(Line::DShot(300));
        let bits = Frame::from_command(1.0).bits();
        assert_eq!(send(&mut esc, 0, bits, 7), None);
        assert_eq!(send(&mut esc, 1_000_000, bits, 16), Some(1_000_000));
        assert_eq!((esc.stats.frames, esc.stats.bad), (1, 1));
        assert_eq!(send(&mut esc, 2_000_000, bits ^ 1, 16), None);
        assert_eq!((esc.stats.frames, esc.stats.bad), (1, 2));
    }

    #[test]
    fn pulses_are_read_by_their_length() {
        let mut esc = Esc::new(Line::of(MotorProtocol::Oneshot125, EscSpec::default()));
        esc.edge(0, true);
        assert_eq!(esc.edge(187_500, false), Some(0));
        assert!((esc.command(200_000) - 0.5).abs() < 1e-9);
        assert_eq!(esc.stats.pulse_us, Some([1500.0; 2]));
        esc.edge(1_000_000, true);
        assert_eq!(esc.edge(1_400_000, false), None);
        assert_eq!(esc.stats.bad, 1);
    }
}
