//! Decides whether a data-ready line is reliable, or samples are polled instead.
//!
//! A silent line is used again once its pulses and the part's status have agreed for a time that doubles with each
//! silence: a loose contact must not toggle the driver. A single short silence is not reported.

use embassy_time::{Duration, Instant};

/// Polling time until the line is reported as silent: one short silence, within the first `BACK_AFTER`, does not
/// justify a landing.
pub const REPORTED_AFTER: Duration = Duration::from_millis(200);
/// First and longest agreement before the line is used again.
const BACK_AFTER: [Duration; 2] = [Duration::from_millis(50), Duration::from_millis(3200)];
/// Time on the line that clears earlier silences.
const FORGOTTEN_AFTER: Duration = Duration::from_secs(10);
/// Poll period times rate, µs·Hz: 1.5 % shorter than the part's, whose clock, locked to the gyroscope, is off by about
/// 1 %. Hardly any sample is missed, and the filters' rate holds within 2 %.
const PERIOD_BY_RATE: f32 = 0.985e6;
/// Fraction of the period before a missing sample is requested again.
const AGAIN: u32 = 4;

/// Line state.
#[derive(Clone, Copy, Debug)]
pub struct LineWatch {
    clock: Option<Clock>,
    back_after: Duration,
    back_at: Option<Instant>,
}

#[derive(Clone, Copy, Debug)]
struct Clock {
    since: Instant,
    due: Instant,
    period: Duration,
    /// Samples with a pulse less those without, >= 0, and the count that clears the line.
    agreeing: u32,
    sound: u32,
    reported: bool,
}

impl Clock {
    /// Schedules the next poll `time` after the due one, so that processing does not lengthen the period; after a stall
    /// from `now`, against a burst.
    fn go_on(&mut self, now: Instant, time: Duration) {
        let late = now.saturating_duration_since(self.due) > time;
        self.due = if late { now } else { self.due } + time;
    }
}

impl Default for LineWatch {
    fn default() -> Self {
        Self::new()
    }
}

impl LineWatch {
    /// A line without faults.
    pub const fn new() -> Self {
        let [back_after, _] = BACK_AFTER;
        Self {
            clock: None,
            back_after,
            back_at: None,
        }
    }

    /// Time of the next poll; `None` while the line is used.
    pub fn due(&self) -> Option<Instant> {
        self.clock.map(|clock| clock.due)
    }

    /// The silence lasts or repeats.
    pub fn reported(&self) -> bool {
        self.clock.is_some_and(|clock| clock.reported)
    }

    /// The line is silent at `now` although the part works; samples come at `rate_hz`.
    pub fn silent(&mut self, now: Instant, rate_hz: f32) {
        let [first, longest] = BACK_AFTER;
        self.back_after = match self.back_at {
            Some(at) if now.saturating_duration_since(at) < FORGOTTEN_AFTER => {
                (self.back_after * 2).min(longest)
            }
            _ => first,
        };
        // No part samples below 100 Hz.
        let period = Duration::from_micros((PERIOD_BY_RATE / rate_hz.max(100.0)) as u64);
        self.clock = Some(Clock {
            since: now,
            due: now + period / AGAIN,
            period,
            agreeing: 0,
            sound: (self.back_after.as_ticks() / period.as_ticks().max(1)) as u32,
            reported: false,
        });
    }

    /// The poll at `now` found no sample.
    pub fn not_yet(&mut self, now: Instant) {
        if let Some(clock) = &mut self.clock {
            clock.go_on(now, clock.period / AGAIN);
        }
    }

    /// The poll at `now` found a sample, `announced` by the line or not.
    pub fn sample(&mut self, now: Instant, announced: bool) {
        let Some(clock) = &mut self.clock else { return };
        clock.go_on(now, clock.period);
        clock.reported |= now.saturating_duration_since(clock.since) >= REPORTED_AFTER;
        clock.agreeing = if announced {
            clock.agreeing.saturating_add(1)
        } else {
            clock.agreeing.saturating_sub(1)
        };
        if clock.agreeing > clock.sound {
            self.clock = None;
            self.back_at = Some(now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1000;

    fn at(us: u64) -> Instant {
        Instant::from_micros(us)
    }

    /// Feeds samples at 4 kHz until the line is used again, at most to `to`; returns that time.
    fn run(line: &mut LineWatch, from: u64, to: u64, announced: impl Fn(u64) -> bool) -> u64 {
        let mut now = from;
        while now < to && line.due().is_some() {
            now += 250;
            line.sample(at(now), announced(now));
        }
        now
    }

    #[test]
    fn a_dead_line_is_reported_once_and_stays_so() {
        let mut line = LineWatch::new();
        assert!(line.due().is_none() && !line.reported());
        line.silent(at(0), 4000.0);
        run(&mut line, 0, 199 * MS, |_| false);
        assert!(!line.reported());
        run(&mut line, 199 * MS, 201 * MS, |_| false);
        assert!(line.reported());
        assert_eq!(run(&mut line, 201 * MS, 5000 * MS, |_| false), 5000 * MS);
        assert!(line.reported());
    }

    #[test]
    fn a_line_that_comes_back_is_used_again_when_it_has_agreed_for_long_enough() {
        let mut line = LineWatch::new();
        line.silent(at(0), 4000.0);
        let back = run(&mut line, 0, 1000 * MS, |_| true);
        assert!((50 * MS..53 * MS).contains(&back), "{back}");
        assert!(!line.reported(), "one short silence is nothing");
        // A third of the pulses falls outside the polls.
        line.silent(at(20_000 * MS), 4000.0);
        let back = run(&mut line, 20_000 * MS, 21_000 * MS, |us| us % 750 != 0) - 20_000 * MS;
        assert!((140 * MS..160 * MS).contains(&back), "{back}");
        line.silent(at(40_000 * MS), 4000.0);
        let back = run(&mut line, 40_000 * MS, 45_000 * MS, |us| us % 500 == 0);
        assert_eq!(back, 45_000 * MS);
        assert!(line.reported());
    }

    #[test]
    fn a_loose_contact_is_reported_and_used_less_and_less_until_it_is_forgotten() {
        let mut line = LineWatch::new();
        let mut now = 0;
        let mut waits = [0; 9];
        let mut reported = 0;
        for wait in &mut waits {
            line.silent(at(now), 4000.0);
            let from = now;
            let mut this_time = false;
            while line.due().is_some() {
                now += 250;
                line.sample(at(now), true);
                this_time |= line.reported();
            }
            *wait = (now - from) / MS;
            reported += u32::from(this_time);
            now += 5000 * MS;
        }
        for (wait, patience) in waits
            .into_iter()
            .zip([50, 100, 200, 400, 800, 1600, 3200, 3200, 3200])
        {
            assert!(
                (patience..=patience + patience / 50 + 1).contains(&wait),
                "{waits:?}"
            );
        }
        assert_eq!(reported, 7);
        now += 10_000 * MS;
        line.silent(at(now), 4000.0);
        assert!(run(&mut line, now, now + 1000 * MS, |_| true) - now < 55 * MS);
    }

    #[test]
    fn the_part_is_asked_a_little_faster_than_it_samples_and_a_quarter_later_again() {
        for (rate, period) in [(1000.0, 985), (4000.0, 246), (8000.0, 123)] {
            let mut line = LineWatch::new();
            line.silent(at(1000), rate);
            assert_eq!(line.due(), Some(at(1000 + period / 4)));
            line.sample(at(1000 + period / 4 + 30), false);
            assert_eq!(
                line.due(),
                Some(at(1000 + period / 4 + period)),
                "from when it was due"
            );
            line.not_yet(at(1000 + period / 4 + period + 30));
            assert_eq!(line.due(), Some(at(1000 + 2 * (period / 4) + period)));
            line.sample(at(50_000), false);
            assert_eq!(line.due(), Some(at(50_000 + period)));
            line.not_yet(at(90_000));
            assert_eq!(line.due(), Some(at(90_000 + period / 4)));
        }
        let mut line = LineWatch::new();
        line.silent(at(0), f32::NAN);
        assert_eq!(line.due(), Some(at(9850 / 4)));
    }
}
