//! Sustained oscillation of roll or pitch, as loops make that do not suit the vehicle: half swings of alternating sign,
//! each fast enough and neither too short nor too long, one after the other.

use crate::maths::vector::Vec3;

/// Least rate of a half swing, rad/s: beyond it the ends of the belly's pads, 0.1 m off, move at 0.12 m/s, two fifths of the
/// last descent. Held against gusts of 20 % in 6 m/s the rates are 0.14 rad/s RMS (`sim/tests/hold/swings.rs` flies it), of
/// which this is eight times.
const RATE: f32 = 1.2;
/// Rate beyond which the sign has changed, rad/s: the filtered gyro's noise and the rotors' shaking stay below.
const CROSSED: f32 = 0.15;
/// Shortest and longest half swing, s: 8 Hz, above the arms' bending mode, to 0.5 Hz.
const HALF: (f32, f32) = (0.06, 1.0);
/// Longest half swing that counts as none of a hand, s: 1.7 Hz. A pilot's loop crosses at 0.5 Hz (McRuer and Krendel,
/// AGARDograph 188, 1974), and the prefilter of the sticks halves 2 Hz.
const QUICK: f32 = 0.3;
/// Half swings in a row: three periods.
const SWINGS: u8 = 6;

/// The present half swing about one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Axis {
    backwards: bool,
    /// Largest rate, rad/s, and time, s, of this half swing.
    peak: f32,
    time: f32,
    /// Number of half swings before it, each large and in time, and of those in a row that no hand made.
    count: u8,
    quick: u8,
}

impl Axis {
    fn step(&mut self, rate: f32, dt: f32) {
        let along = if self.backwards { -rate } else { rate };
        self.time += dt;
        if along < -CROSSED {
            let in_time = (HALF.0..=HALF.1).contains(&self.time);
            let counts = in_time && self.peak >= RATE;
            let next = |count: u8, counts: bool| if counts { count.saturating_add(1) } else { 0 };
            self.quick = next(self.quick, counts && self.time <= QUICK);
            self.count = next(self.count, counts);
            (self.backwards, self.peak, self.time) = (!self.backwards, -along, 0.0);
        } else if along > self.peak {
            self.peak = along;
        }
        if self.time > HALF.1 {
            (self.count, self.quick) = (0, 0);
        }
    }
}

/// Watches the body rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Oscillation {
    roll: Axis,
    pitch: Axis,
}

impl Oscillation {
    /// One step of `dt` s with the body rate, rad/s; `None` forgets.
    pub fn step(&mut self, rate: Option<Vec3>, dt: f32) {
        let Some(rate) = rate else {
            *self = Self::default();
            return;
        };
        self.roll.step(rate.x, dt);
        self.pitch.step(rate.y, dt);
    }

    /// Begins to count anew.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// The vehicle swings for three periods already.
    pub fn swings(&self) -> bool {
        self.roll.count.max(self.pitch.count) >= SWINGS
    }

    /// It does, faster than a pilot's stick could swing it.
    pub fn swings_by_itself(&self) -> bool {
        self.roll.quick.max(self.pitch.quick) >= SWINGS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_noise::TestNoise;

    const DT: f32 = 0.01;

    /// Whether `seconds` of `rate` at each time are noticed, and when.
    fn noticed(seconds: f32, rate: impl Fn(f32) -> f32) -> Option<f32> {
        let mut watch = Oscillation::default();
        (0..(seconds / DT) as u32).map(|i| DT * i as f32).find(|t| {
            watch.step(Some(Vec3::new(0.0, rate(*t), 0.0)), DT);
            watch.swings()
        })
    }

    fn swing(size: f32, hz: f32) -> impl Fn(f32) -> f32 {
        move |t| size * (core::f32::consts::TAU * hz * t).sin()
    }

    #[test]
    fn three_periods_of_a_swing_are_noticed() {
        // A hold that swings by 40 deg at 1.3 Hz; the arms' bending mode.
        for (size, hz) in [(2.7, 1.3), (1.4, 0.6), (1.6, 5.0)] {
            let at = noticed(20.0, swing(size, hz)).unwrap_or(f32::INFINITY);
            assert!((at * hz - 3.0).abs() < 0.7, "{size} {hz}: {at}");
        }
    }

    #[test]
    fn a_swing_that_a_hand_may_make_is_not_by_itself() {
        for (hz, by_itself) in [(1.3, false), (1.6, false), (1.8, true), (5.0, true)] {
            let mut watch = Oscillation::default();
            let rate = swing(2.0, hz);
            let noticed = (0..2000).any(|i| {
                watch.step(Some(Vec3::new(rate(DT * i as f32), 0.0, 0.0)), DT);
                watch.swings_by_itself()
            });
            assert_eq!(noticed, by_itself, "{hz} Hz");
        }
    }

    #[test]
    fn small_slow_and_single_swings_are_not() {
        for (size, hz) in [(1.1, 1.3), (2.0, 0.3), (2.0, 12.0)] {
            assert_eq!(noticed(60.0, swing(size, hz)), None, "{size} {hz}");
        }
        // A push that fades, and a flick of the stick.
        let fades = |t: f32| 3.0 * (-1.5 * t).exp() * swing(1.0, 1.0)(t);
        assert_eq!(noticed(20.0, fades), None);
    }

    #[test]
    fn noise_of_gusts_is_never_one() {
        // Twice those of a strong wind, coloured at 1 Hz: ten hours.
        let mut random = TestNoise(12345);
        let (mut watch, mut rate) = (Oscillation::default(), 0.0_f32);
        let keep = 1.0 - DT * core::f32::consts::TAU;
        for i in 0..3_600_000 {
            rate = keep * rate + (1.0 - keep * keep).sqrt() * 0.28 * random.normal();
            watch.step(Some(Vec3::new(rate, 0.0, 0.0)), DT);
            assert!(!watch.swings(), "{i}");
        }
    }
}
