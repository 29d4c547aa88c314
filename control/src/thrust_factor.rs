//! Ratio of the rotors' thrust to what the parameters expect of the same command, learnt in free flight, 100 Hz.
//!
//! In free air, mass times specific force along the thrust axis is the thrust. A Kalman filter of one state compares it
//! with the thrust that the commands stand for by the parameters,
//!
//!   -m f_z = κ N + w,   κ' = q,
//!
//! with w the force of gusts and q the walk of heat, wear and charge. The mixer divides its demands by κ, so that a newton
//! demanded is a newton given; the sticks keep their feel, as a throttle stands for a command. An error of the mass is part
//! of κ: forces are those of a vehicle of the parameter's mass.

use crate::contact::contact_force::LEAVING_FORCE;
use crate::maths::scalar::{GRAVITY, clamp, sqrt};
use crate::params::Params;

/// Bounds of the factor: beyond them propellers, battery or parameters are others, and the mixer no longer follows.
pub const BOUNDS: (f32, f32) = (0.6, 1.5);
/// Standard deviation of the factor before a flight: rotors of 0.9 to 1.12 times the nominal thrust in air of 1.02 to
/// 1.34 kg/m³ give 0.75 to 1.22 times (docs/uncertainty.md).
const PRIOR: f32 = 0.2;
/// Density of the force that is no thrust, N²·s: 1 N along the thrust axis, gusts and climb at 0.7 m/s, for a second each.
const GUSTS: f32 = 2.0;
/// Density of the walk, 1/s: hot motors lose up to 5 % (docs/uncertainty.md), in a minute (assumed).
const WALK: f32 = 0.05 * 0.05 / 60.0;
/// Climb rate that proves free air after the rotors have stood, m/s, by the inertial sensor: from the ground there is no
/// other way up.
const CLIMB: f32 = 0.3;
/// Beyond any sensor's range, m/s², and any vehicle's thrust, N.
const SANE: (f32, f32) = (400.0, 400.0);
/// Thrust below which the ground may carry the vehicle, share of its weight.
const CARRIES: f32 = 0.5;

/// The factor for those that use it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustFactor {
    /// Thrust over that of the parameters, within [`BOUNDS`].
    pub value: f32,
    /// Its root, by which a voltage ratio is multiplied
    /// ([`thrust_curve`](crate::allocation::thrust_curve::ThrustCurve::commands)).
    pub root: f32,
    /// Its standard deviation.
    pub deviation: f32,
}

impl Default for ThrustFactor {
    /// A vehicle that has not flown.
    fn default() -> Self {
        Self {
            value: 1.0,
            root: 1.0,
            deviation: PRIOR,
        }
    }
}

/// One step's measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustSample {
    /// Specific force along body z, m/s²; -9.81 at rest.
    pub specific_force_z: f32,
    /// Thrust demanded of the rotors along -z, N, with the present factor, >= 0.
    pub lift: f32,
    /// Sink rate by the inertial sensor, m/s.
    pub sink: f32,
    /// Something carries the vehicle, as far as the present factor shows it.
    pub resting: bool,
}

/// What the vehicle does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Air {
    /// The rotors are locked: whoever changes a battery or a propeller does it now.
    Locked,
    /// On the ground or on a pipe, or so near to either that it may touch.
    Near,
    /// In flight, or still on the ground before it.
    Free,
}

/// The filter.
#[derive(Clone, Copy, Debug)]
pub struct ThrustLearning {
    mass: f32,
    motor_tau: f32,
    factor: f32,
    variance: f32,
    /// Thrust by the parameters, N, after the motors' lag.
    thrust: f32,
    climbed: bool,
}

impl ThrustLearning {
    /// Starts from what an earlier run has `learnt`, if any.
    pub fn new(p: &Params, learnt: Option<f32>) -> Self {
        let learnt = learnt.filter(|factor| factor.is_finite());
        Self {
            mass: p.mass,
            motor_tau: p.motor_tau,
            factor: learnt.map_or(1.0, |factor| clamp(factor, BOUNDS.0, BOUNDS.1)),
            variance: PRIOR * PRIOR,
            thrust: 0.0,
            climbed: false,
        }
    }

    /// One step of `dt` s; `None` without a fresh inertial sample.
    pub fn step(&mut self, air: Air, sample: Option<ThrustSample>, dt: f32) {
        self.variance = match air {
            Air::Locked => PRIOR * PRIOR,
            Air::Near | Air::Free => clamp(self.variance + WALK * dt, 0.0, PRIOR * PRIOR),
        };
        let sample = sample.filter(|s| {
            s.specific_force_z.abs() < SANE.0 && (0.0..SANE.1).contains(&s.lift) && s.sink.is_finite()
        });
        let Some(sample) = sample else {
            return;
        };
        self.thrust += (sample.lift / self.factor - self.thrust) * dt / (dt + self.motor_tau);
        let carries = self.thrust * self.factor > CARRIES * self.mass * GRAVITY;
        self.climbed = carries && air != Air::Locked && (self.climbed || sample.sink < -CLIMB);
        // Before the factor is known, a strong vehicle looks as if it rested on something.
        let rests = sample.resting && self.is_known();
        if air == Air::Free && self.climbed && !rests && dt > 0.0 {
            self.correct(-self.mass * sample.specific_force_z, GUSTS / dt);
        }
    }

    /// Takes a `force` along the thrust axis, N, of this variance.
    fn correct(&mut self, force: f32, noise: f32) {
        let share = self.variance * self.thrust;
        let gain = share / (share * self.thrust + noise);
        let moved = self.factor + gain * (force - self.factor * self.thrust);
        self.factor = clamp(moved, BOUNDS.0, BOUNDS.1);
        self.variance -= gain * share;
    }

    #[cfg(test)]
    pub(crate) fn forget(&mut self) {
        self.variance = PRIOR * PRIOR;
    }

    /// Contact shows: two deviations of the thrust in hover are less than [`LEAVING_FORCE`].
    pub fn is_known(&self) -> bool {
        let hover = self.mass * GRAVITY;
        4.0 * self.variance * hover * hover < LEAVING_FORCE * LEAVING_FORCE
    }

    /// For mixer and displays.
    pub fn now(&self) -> ThrustFactor {
        ThrustFactor {
            value: self.factor,
            root: sqrt(self.factor),
            deviation: sqrt(self.variance),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;
    use crate::test_noise::TestNoise;

    const DT: f32 = 0.01;

    /// A vehicle of default mass that hovers by feedback, whatever its thrust.
    struct Hovering {
        learning: ThrustLearning,
        /// Thrust over the parameters'.
        truth: f32,
        /// Force of gusts, N, coloured at 1 s.
        gust: f32,
        size: f32,
        noise: TestNoise,
    }

    impl Hovering {
        fn new(truth: f32, size: f32) -> Self {
            Self {
                learning: ThrustLearning::new(&Params::DEFAULT, None),
                truth,
                gust: 0.0,
                size,
                noise: TestNoise(7),
            }
        }

        fn step(&mut self, air: Air, sink: f32) {
            let weight = Params::DEFAULT.mass * GRAVITY;
            let normal = self.noise.normal();
            self.gust += -self.gust * DT + self.size * (2.0 * DT).sqrt() * normal;
            // The demand is met with the present factor; the thrust is the weight.
            let lift = weight * self.learning.now().value / self.truth;
            let sample = ThrustSample {
                specific_force_z: -(weight + self.gust) / Params::DEFAULT.mass,
                lift,
                sink,
                resting: weight - lift > 3.0,
            };
            self.learning.step(air, Some(sample), DT);
        }

        fn fly(&mut self, seconds: f32) -> ThrustFactor {
            for _ in 0..50 {
                self.step(Air::Free, -1.0);
            }
            for _ in 0..(seconds / DT) as u32 {
                self.step(Air::Free, 0.0);
            }
            self.learning.now()
        }
    }

    #[test]
    fn a_few_seconds_of_flight_show_any_builders_thrust() {
        for truth in [0.8, 0.85, 1.0, 1.14, 1.23] {
            let mut hovering = Hovering::new(truth, 0.0);
            hovering.fly(1.0);
            assert!(
                !hovering.learning.is_known(),
                "{truth}: gusts are not averaged yet"
            );
            let factor = hovering.fly(4.0);
            assert!(hovering.learning.is_known(), "{truth}: {factor:?}");
            assert!((factor.value / truth - 1.0).abs() < 0.02, "{truth}: {factor:?}");
            assert!((factor.root * factor.root - factor.value).abs() < 1e-5);
        }
    }

    #[test]
    fn the_deviation_is_that_of_gusts_for_which_it_is_made() {
        // One second's gusts of 1 N: of 200 flights the mean square error over the variance is near 1.
        let mut sum = 0.0;
        for seed in 0..200 {
            let mut hovering = Hovering::new(1.1, 1.0);
            hovering.noise = TestNoise(1 + 7919 * seed);
            // The gust blows before the flight already.
            for _ in 0..500 {
                hovering.step(Air::Locked, 0.0);
            }
            let factor = hovering.fly(10.0);
            let error = (factor.value - 1.1) / factor.deviation;
            sum += error * error;
        }
        let ratio = sum / 200.0;
        assert!((0.6..1.4).contains(&ratio), "{ratio}");
    }

    #[test]
    fn only_free_air_teaches() {
        let mut hovering = Hovering::new(1.3, 0.0);
        for _ in 0..1000 {
            hovering.step(Air::Near, -1.0);
        }
        assert_eq!(hovering.learning.now().value, 1.0, "near a pipe");
        let mut hovering = Hovering::new(1.3, 0.0);
        for _ in 0..1000 {
            hovering.step(Air::Free, 0.0);
        }
        assert_eq!(hovering.learning.now().value, 1.0, "it never climbed");
        // On the ground with half of the weight on the legs, after a bounce.
        let mut learning = ThrustLearning::new(&Params::DEFAULT, None);
        let ground = |sink| ThrustSample {
            specific_force_z: -GRAVITY,
            lift: 0.45 * Params::DEFAULT.mass * GRAVITY,
            sink,
            resting: true,
        };
        for i in 0..1000 {
            learning.step(Air::Free, Some(ground(if i < 100 { -1.0 } else { 0.0 })), DT);
        }
        assert_eq!(learning.now().value, 1.0);
    }

    #[test]
    fn what_rests_on_something_is_no_thrust_once_the_factor_is_known() {
        let mut hovering = Hovering::new(1.1, 0.0);
        let before = hovering.fly(20.0).value;
        let mut learning = hovering.learning;
        for _ in 0..1000 {
            let sample = ThrustSample {
                specific_force_z: -GRAVITY,
                lift: 0.6 * Params::DEFAULT.mass * GRAVITY,
                sink: 0.0,
                resting: true,
            };
            learning.step(Air::Free, Some(sample), DT);
        }
        assert_eq!(learning.now().value, before);
    }

    #[test]
    fn heat_is_followed_and_a_stop_on_the_ground_keeps_the_value_alone() {
        let mut hovering = Hovering::new(1.2, 0.0);
        hovering.fly(10.0);
        for _ in 0..6000 {
            hovering.truth -= 0.06 / 6000.0;
            hovering.step(Air::Free, 0.0);
        }
        let factor = hovering.learning.now();
        assert!((factor.value - hovering.truth).abs() < 0.02, "{factor:?}");
        hovering.step(Air::Locked, 0.0);
        let stopped = hovering.learning.now();
        assert!(
            stopped.value == factor.value && (stopped.deviation - PRIOR).abs() < 1e-6,
            "{stopped:?}"
        );
        assert!(!hovering.learning.is_known());
        let next = ThrustLearning::new(&Params::DEFAULT, Some(factor.value));
        assert_eq!(next.now().value, stopped.value);
    }

    proptest! {
        #[test]
        fn no_input_leaves_the_bounds(
            samples in proptest::collection::vec(
                (proptest::num::f32::ANY, proptest::num::f32::ANY, proptest::num::f32::ANY, any::<bool>()), 1..60),
            learnt in proptest::option::of(proptest::num::f32::ANY),
        ) {
            let mut learning = ThrustLearning::new(&Params::DEFAULT, learnt);
            for (specific_force_z, lift, sink, resting) in samples {
                let sample = ThrustSample { specific_force_z, lift, sink, resting };
                learning.step(Air::Free, Some(sample), DT);
                let ThrustFactor { value, root, deviation } = learning.now();
                prop_assert!((BOUNDS.0..=BOUNDS.1).contains(&value), "{value}");
                prop_assert!(root.is_finite() && (0.0..=PRIOR).contains(&deviation), "{deviation}");
            }
        }
    }
}
