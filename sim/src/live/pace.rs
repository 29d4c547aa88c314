//! Holds virtual time to wall time.

use std::thread::sleep;
use std::time::{Duration, Instant};

/// Largest delay that a flight catches up, in wall time: a host's usual delays. A longer one shifts the schedule, so
/// that no burst follows.
const SLACK: Duration = Duration::from_millis(20);
/// Wall time over which the reached speed is measured.
const WINDOW: Duration = Duration::from_secs(2);
/// Share of the asked speed below which the host is too slow.
const ENOUGH: f64 = 0.9;

/// Paces a flight: virtual time is never ahead of wall time, times a factor.
#[derive(Debug)]
pub struct Pace {
    /// Virtual seconds in a second of wall time.
    speed: f64,
    /// When the first call was made.
    began: Option<Instant>,
    /// Wall time since then at which the virtual time was, or would have been, 0.
    origin: f64,
    /// Wall and virtual time at the last measurement, s.
    measured: (f64, f64),
    /// A host that is too slow is reported once.
    reported: bool,
}

impl Pace {
    /// `speed` virtual seconds in a second of wall time, from the first wait on.
    #[must_use]
    pub fn new(speed: f64) -> Self {
        Self {
            speed,
            began: None,
            origin: 0.0,
            measured: (0.0, 0.0),
            reported: false,
        }
    }

    /// Waits until `us` of virtual time is due. Returns a message once, in one line, if the host is too slow.
    pub fn wait(&mut self, us: u64) -> Option<String> {
        let began = *self.began.get_or_insert_with(Instant::now);
        let virtual_time = us as f64 * 1e-6;
        let (early, slow) = self.assess(virtual_time, began.elapsed().as_secs_f64());
        if early > 0.0 {
            sleep(Duration::from_secs_f64(early));
        }
        slow.map(|reached| {
            format!(
                "this host is too slow for --speed {}: {reached:.2} times real time reached",
                self.speed
            )
        })
    }

    /// Wall time until `virtual_time` is due, negative when it is late, and the speed reached by a host that is found
    /// too slow at `wall`; all in s.
    fn assess(&mut self, virtual_time: f64, wall: f64) -> (f64, Option<f64>) {
        let mut early = self.origin + virtual_time / self.speed - wall;
        if early < -SLACK.as_secs_f64() {
            self.origin -= early;
            early = 0.0;
        }
        (early, self.measure(virtual_time, wall))
    }

    fn measure(&mut self, virtual_time: f64, wall: f64) -> Option<f64> {
        let (wall_before, virtual_before) = self.measured;
        let over = wall - wall_before;
        if over < WINDOW.as_secs_f64() {
            return None;
        }
        self.measured = (wall, virtual_time);
        let reached = (virtual_time - virtual_before) / over;
        let slow = reached < ENOUGH * self.speed && !self.reported;
        self.reported |= slow;
        slow.then_some(reached)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs `seconds` of virtual time at `speed` on a host that takes `cost(t)` s for each millisecond: wall time at
    /// the end, the speeds reported, and the largest virtual time run within any second of wall time.
    fn run(speed: f64, seconds: f64, cost: impl Fn(f64) -> f64) -> (f64, Vec<f64>, f64) {
        let (mut pace, mut wall, mut reported, mut times) = (Pace::new(speed), 0.0, vec![], vec![]);
        for ms in 1..=(seconds * 1e3) as u64 {
            let t = ms as f64 * 1e-3;
            let (early, slow) = pace.assess(t, wall);
            wall += early.max(0.0);
            assert!(t <= wall * speed + 1e-9, "{t} s is ahead of {wall} s");
            reported.extend(slow);
            times.push(wall);
            wall += cost(t);
        }
        let burst = times.iter().enumerate().map(|(first, from)| {
            times[first..].iter().take_while(|to| **to < from + 1.0).count() as f64 * 1e-3
        });
        (wall, reported, burst.fold(0.0, f64::max))
    }

    #[test]
    fn virtual_time_follows_wall_time_at_any_speed() {
        for speed in [0.5, 1.0, 10.0] {
            let (wall, reported, burst) = run(speed, 8.0, |_| 0.2e-3 / speed);
            assert!((wall - 8.0 / speed).abs() < 1e-3, "{speed}: {wall} s");
            assert!(
                reported.is_empty() && burst < 1.01 * speed,
                "{speed}: {reported:?} {burst}"
            );
        }
    }

    #[test]
    fn a_stall_moves_the_pace_and_is_not_caught_up() {
        let (wall, reported, burst) = run(1.0, 8.0, |t| if (t - 4.0).abs() < 1e-6 { 0.15 } else { 0.0 });
        assert!((wall - 8.15).abs() < 2e-3, "{wall} s");
        assert!(
            reported.is_empty() && burst < 1.0 + 2.0 * SLACK.as_secs_f64(),
            "{reported:?} {burst}"
        );
    }

    #[test]
    fn short_delays_are_caught_up() {
        let (wall, reported, _) = run(1.0, 8.0, |t| {
            if (t * 1e3).round() % 100.0 == 0.0 {
                5e-3
            } else {
                0.0
            }
        });
        assert!(
            (wall - 8.0).abs() < 6e-3 && reported.is_empty(),
            "{wall} s {reported:?}"
        );
    }

    #[test]
    fn a_host_that_is_too_slow_is_reported_once_with_its_speed() {
        let (wall, reported, _) = run(4.0, 40.0, |_| 0.5e-3);
        assert!((19.9..20.2).contains(&wall), "{wall} s");
        assert_eq!(reported.len(), 1);
        assert!((1.95..2.05).contains(&reported[0]), "{reported:?}");
        let mut pace = Pace::new(1e6);
        let began = Instant::now();
        let line = (1..).find_map(|ms| {
            sleep(Duration::from_millis(50));
            pace.wait(ms * 1000)
        });
        assert!(began.elapsed() >= WINDOW);
        assert_eq!(
            line.as_deref(),
            Some("this host is too slow for --speed 1000000: 0.02 times real time reached")
        );
    }
}
