//! Allocation of a wrench to four rotors whose arms bend, recomputed at every step.
//!
//! What flies is [`Variant::Flexible`]: the wrench is inverted through the quasi-static Jacobian about the
//! low-passed thrusts. Inverting the effectiveness at the frozen arm angle is wrong even with the true
//! angle: a thrust changed for yaw bends its arm a moment later and yaws |C| times more, and an inverse
//! that follows the angle turns this into a limit cycle.

use crate::deflection::Algorithm1;
use crate::desaturation::{Given, Patterns, desaturate};
use crate::effectiveness::{Effectiveness, Geometry, Inverse, Load};
use crate::filter::LowPass;
use crate::math;
use crate::params::Params;
use crate::tilt::TiltModel;
use crate::wrench::{Configuration, FORE, PerArm, SIDE, Wrench, YAW};

/// The allocation law in use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variant {
    /// The arms are taken as stiff.
    Rigid,
    /// Algorithm 1 in the printed matrix, its singular yaw row mended: tilt enters the thrust row only.
    Paper,
    /// The whole effectiveness inverted at the frozen arm angle: for study, it limit-cycles.
    Frozen,
    /// The quasi-static Jacobian about the low-passed thrust: what flies.
    #[default]
    Flexible,
}

/// Share of the stiff frame's yaw authority k_q below which yaw fades and entries are floored.
const YAW_FLOOR: f32 = 0.35;

/// Thrust above the yaw gate at which it opens again, N: a mean that hovers about the gate must not switch yaw.
const GATE_HYSTERESIS: f32 = 0.2;

/// What one step gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mix {
    /// Thrust of each rotor, N, from the idle thrust to the largest that the battery allows.
    pub thrusts: PerArm<f32>,
    /// What was given up.
    pub given: Given,
    /// Yaw has no authority to be trusted: it was given up, its integrator is to be reset.
    pub yaw_gated: bool,
}

/// What the mixer must know besides the wrench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Yaw may be used.
    pub yaw: bool,
    /// Battery voltage over nominal, 0.5..1 (limited); less lowers the largest thrust by its square.
    pub battery_ratio: f32,
    /// Step time, s, > 0.
    pub dt: f32,
}

/// Damping ratio of the arm mode in [`DynamicTilt`] (assumed).
const ARM_DAMPING: f32 = 0.15;

/// Motor lag and the arm's bending mode, for the frozen inverse: where the arm is at this very moment.
#[derive(Clone, Copy, Debug, PartialEq)]
struct DynamicTilt {
    motor: LowPass,
    /// Thrust whose static tilt the arm has now, N.
    load: f32,
    speed: f32,
    omega: f32,
}

impl DynamicTilt {
    fn at(thrust: f32, mode_hz: f32) -> Self {
        Self {
            motor: LowPass::at(thrust),
            load: thrust,
            speed: 0.0,
            omega: core::f32::consts::TAU * mode_hz,
        }
    }

    fn step(&mut self, thrust: f32, motor_rate: f32, dt: f32) {
        let thrust = self.motor.step(thrust, motor_rate, dt);
        let pull = self.omega * (thrust - self.load) - 2.0 * ARM_DAMPING * self.speed;
        self.speed += self.omega * pull * dt;
        self.load += self.speed * dt;
    }
}

/// Allocation with its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixer {
    variant: Variant,
    geometry: Geometry,
    /// The same as configuration B would have it, and the sign that makes one of the other.
    as_b: Geometry,
    chi: f32,
    tilt: TiltModel,
    algorithm_1: Algorithm1,
    dynamic: PerArm<DynamicTilt>,
    last: PerArm<f32>,
    idle: f32,
    max: f32,
    yaw_limit: f32,
    /// Least entry of the yaw row, m.
    yaw_floor: f32,
    /// Rise of yaw's share with the authority, 1/m: nothing at half the floor, all of it at the floor.
    fade_slope: f32,
    gate: f32,
    yaw_open: bool,
    motor_rate: f32,
}

impl Mixer {
    /// A mixer with idle rotors.
    pub fn new(variant: Variant, configuration: Configuration, p: &Params) -> Self {
        let tilt = TiltModel::new(p);
        let geometry = Geometry::from_params(p, configuration);
        Self {
            variant,
            geometry,
            as_b: geometry.as_b(),
            chi: configuration.chi(),
            algorithm_1: Algorithm1::new(*tilt.model(), p.power_exponent),
            tilt,
            dynamic: [DynamicTilt::at(p.thrust_idle, p.notch_hz); 4],
            last: [p.thrust_idle; 4],
            idle: p.thrust_idle,
            max: p.thrust_max,
            yaw_limit: p.yaw_thrust_max,
            yaw_floor: YAW_FLOOR * p.torque_ratio,
            fade_slope: 2.0 / (YAW_FLOOR * p.torque_ratio),
            gate: p.yaw_gate_thrust,
            yaw_open: false,
            motor_rate: 1.0 / p.motor_tau,
        }
    }

    /// The arms' tilt as the mixer believes it.
    pub const fn tilt(&self) -> &TiltModel {
        &self.tilt
    }

    /// Takes the tilt (rad) that the sensor of `arm` (0 to 3) measured, each arm's at 100 Hz, while they hang free.
    #[inline(always)]
    pub fn correct_tilt(&mut self, arm: usize, measured: f32) {
        self.tilt.correct(arm, measured);
    }

    /// Rotors at idle for one step of `dt` s.
    pub fn idle(&mut self, dt: f32) -> Mix {
        let mix = self.at_idle();
        self.follow(&mix.thrusts, dt);
        mix
    }

    const fn at_idle(&self) -> Mix {
        Mix {
            thrusts: [self.idle; 4],
            given: Given::ALL,
            yaw_gated: true,
        }
    }

    /// Thrusts (N) for the wrench `w` (N, N·m). A wrench that is not finite counts as none: idle.
    #[inline(always)]
    pub fn mix(&mut self, w: Wrench, c: Conditions) -> Mix {
        let mix = self.allocate(w, c);
        self.follow(&mix.thrusts, c.dt);
        mix
    }

    /// First half of [`Self::mix`]: the thrusts, at the estimated tilt of the arms.
    // On its own: inlined into a caller that is built for size, its loops would not be unrolled and cost twice as much.
    #[inline(never)]
    pub fn allocate(&mut self, w: Wrench, c: Conditions) -> Mix {
        if !w.is_finite() {
            return self.at_idle();
        }
        let ratio = math::clamp(c.battery_ratio, 0.5, 1.0);
        let high = self.max * ratio * ratio;
        let [t1, t2, t3, t4] = self.tilt.thrusts();
        let mean = 0.25 * ((t1 + t2) + (t3 + t4));
        let shut = if self.yaw_open { 0.0 } else { GATE_HYSTERESIS };
        self.yaw_open = mean >= self.gate + shut;
        let usable = c.yaw && self.yaw_open;
        let (mut patterns, fade) = if self.variant == Variant::Flexible {
            self.quasi_static(w, usable)
        } else {
            self.for_study(w, ratio)
        };
        let share = self.yaw_share(&patterns.yaw, if usable { fade } else { 0.0 });
        patterns.yaw = patterns.yaw.map(|y| y * share);
        let (thrusts, mut given) = desaturate(&patterns, self.idle, high);
        given.yaw *= share;
        Mix {
            thrusts,
            given,
            yaw_gated: share <= 0.0,
        }
    }

    /// Second half: steps the models of arms and motors by `dt` s with the thrusts (N) sent.
    // On its own as the first half.
    #[inline(never)]
    pub fn follow(&mut self, thrusts: &PerArm<f32>, dt: f32) {
        self.last = *thrusts;
        self.tilt.step(thrusts, dt);
        if self.variant == Variant::Frozen {
            for (arm, t) in self.dynamic.iter_mut().zip(thrusts) {
                arm.step(*t, self.motor_rate, dt);
            }
        }
    }

    /// What does not fly, at the battery's voltage ratio `ratio`.
    #[cold]
    fn for_study(&self, w: Wrench, ratio: f32) -> (Patterns, f32) {
        match self.variant {
            Variant::Frozen => self.frozen(w),
            Variant::Paper => {
                let tilt = self.last.map(|t| self.algorithm_1.angle(t, ratio * ratio));
                self.stiff(w, tilt)
            }
            Variant::Rigid | Variant::Flexible => self.stiff(w, [0.0; 4]),
        }
    }

    /// The law that flies: T = Tt + J⁻¹ (w - w(Tt)), J the static Jacobian at the low-passed thrusts Tt.
    #[inline(always)]
    fn quasi_static(&self, w: Wrench, yaw_usable: bool) -> (Patterns, f32) {
        let (thrusts, tilt) = (self.tilt.thrusts(), self.tilt.tilt());
        // In A yaw works the other way round: it is allocated as in B, with the moment reversed.
        let geometry = self.as_b;
        let w = Wrench {
            yaw: self.chi * w.yaw,
            ..w
        };
        let mut e = Effectiveness::quasi_static(&geometry, &tilt, &self.tilt.follow());
        // The authority fades with its own quasi-static gain, and no entry may pass zero: the inverse of a
        // vanishing entry would be a kick, and a reversed authority is not to be trusted.
        let [y1, y2, y3, y4] = e.yaw;
        let authority = 0.25 * (y1 + y2 + y3 + y4);
        let least = self.yaw_floor;
        let fade = math::clamp(authority * self.fade_slope - 1.0, 0.0, 1.0);
        let fade = if yaw_usable { fade } else { 0.0 };
        e.yaw = e.yaw.map(|y| if y > least { y } else { least });
        let Some(inverse) = Inverse::new(&e) else {
            return self.without_yaw(w);
        };
        let now = Load::given(&geometry, &thrusts, &tilt);
        let half = 0.5 * w.thrust;
        let [c1, c2, c3, c4] = inverse.solve(Load {
            front: half - now.front,
            rear: half - now.rear,
            roll: -now.roll,
            yaw: -now.yaw * fade,
        });
        let [t1, t2, t3, t4] = thrusts;
        let (c1, c2, c3, c4) = (t1 + c1, t2 + c2, t3 + c3, t4 + c4);
        // The collective continues from the last thrusts. Where yaw is given up nothing corrects what they have
        // of the yaw pattern, so it is taken out here; it has no part in thrust, roll and pitch.
        let left = (0.25 - 0.25 * fade) * (c1 - c2 - c3 + c4);
        let patterns = Patterns {
            collective: [c1 - left, c2 + left, c3 + left, c4 - left],
            ..Self::patterns(&geometry, &inverse, w)
        };
        (patterns, fade)
    }

    /// For study: T = M(α)⁻¹ w with the tilt that a model of motor lag and arm mode gives.
    fn frozen(&self, w: Wrench) -> (Patterns, f32) {
        let tilt = self.dynamic.map(|arm| self.tilt.model().angle(arm.load));
        let e = Effectiveness::frozen(&self.geometry, &tilt);
        let Some(inverse) = Inverse::new(&e) else {
            return self.without_yaw(w);
        };
        let half = 0.5 * w.thrust;
        let patterns = Patterns {
            collective: inverse.solve(Load {
                front: half,
                rear: half,
                ..Load::default()
            }),
            ..Self::patterns(&self.geometry, &inverse, w)
        };
        (patterns, 1.0)
    }

    /// No authority in yaw at all: the stiff frame's patterns still give thrust, roll and pitch.
    #[cold]
    fn without_yaw(&self, w: Wrench) -> (Patterns, f32) {
        (self.stiff(Wrench { yaw: 0.0, ..w }, [0.0; 4]).0, 0.0)
    }

    /// The moments of `w` split into patterns, and what a newton of thrust takes; without the collective.
    #[inline(always)]
    fn patterns(geometry: &Geometry, inverse: &Inverse, w: Wrench) -> Patterns {
        let moments = Load::of(
            geometry,
            Wrench {
                thrust: 0.0,
                yaw: 0.0,
                ..w
            },
        );
        Patterns {
            collective: [0.0; 4],
            shift: inverse.solve(Load {
                front: 0.5,
                rear: 0.5,
                ..Load::default()
            }),
            roll_pitch: inverse.solve(moments),
            yaw: inverse.solve_yaw(w.yaw),
        }
    }

    /// The printed matrix: stiff levers for roll, pitch and yaw, cos α in the thrust row alone.
    fn stiff(&self, w: Wrench, tilt: PerArm<f32>) -> (Patterns, f32) {
        let roll = 0.25 * w.roll / self.geometry.d;
        let pitch = 0.25 * w.pitch / self.geometry.b;
        let yaw = 0.25 * w.yaw / self.geometry.drag;
        let lift = tilt.map(math::cos);
        let mut p = Patterns::default();
        let mut moments_lift = 0.0;
        for ((rp, y), (s, (f, (n, l)))) in p
            .roll_pitch
            .iter_mut()
            .zip(&mut p.yaw)
            .zip(SIDE.iter().zip(FORE.iter().zip(YAW.iter().zip(&lift))))
        {
            *rp = s * roll + f * pitch;
            *y = n * yaw;
            moments_lift += l * (*rp + *y);
        }
        let inv_lift = 1.0 / lift.iter().sum::<f32>();
        p.collective = [(w.thrust - moments_lift) * inv_lift; 4];
        p.shift = [inv_lift; 4];
        (p, 1.0)
    }

    /// Share of a yaw pattern that keeps within what one rotor may get, at most `fade`.
    #[inline(always)]
    fn yaw_share(&self, yaw: &PerArm<f32>, fade: f32) -> f32 {
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let [a, b, c, d] = yaw.map(f32::abs);
        let worst = larger(larger(a, b), larger(c, d));
        let limited = self.yaw_limit / worst;
        if worst * fade > self.yaw_limit {
            limited
        } else {
            fade
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const HOVER: Wrench = Wrench {
        thrust: 17.7,
        roll: 0.0,
        pitch: 0.0,
        yaw: 0.0,
    };

    fn conditions() -> Conditions {
        Conditions {
            yaw: true,
            battery_ratio: 1.0,
            dt: 1e-3,
        }
    }

    fn settled(variant: Variant, w: Wrench) -> (Mixer, Mix) {
        let mut m = Mixer::new(variant, Configuration::B, &Params::default());
        let mut mix = m.mix(w, conditions());
        for _ in 0..3000 {
            mix = m.mix(w, conditions());
        }
        (m, mix)
    }

    #[test]
    fn hover_shares_the_weight_and_lifts_it() {
        for variant in [Variant::Rigid, Variant::Paper, Variant::Frozen, Variant::Flexible] {
            let (_, mix) = settled(variant, HOVER);
            assert!(
                mix.thrusts.iter().all(|t| (t - 4.425).abs() < 0.02),
                "{variant:?} {:?}",
                mix.thrusts
            );
        }
    }

    #[test]
    fn the_flexible_mixer_gives_the_wrench_once_the_arms_have_followed() {
        let w = Wrench {
            thrust: 18.0,
            roll: 0.3,
            pitch: -0.2,
            yaw: 0.04,
        };
        let (m, mix) = settled(Variant::Flexible, w);
        let p = Params::default();
        let g = Geometry::from_params(&p, Configuration::B);
        let model = *m.tilt().model();
        let got = g.wrench(&mix.thrusts, &mix.thrusts.map(|t| model.angle(t)));
        assert!((got.thrust - w.thrust).abs() < 0.02, "{got:?}");
        assert!((got.roll - w.roll).abs() < 2e-3 && (got.pitch - w.pitch).abs() < 5e-3);
        assert!((got.yaw - w.yaw).abs() < 2e-3, "{got:?}");
    }

    #[test]
    fn the_flexible_mixer_gives_the_wrench_in_a_as_well() {
        // Stiff enough for A's authority not to have been turned round.
        let p = Params {
            gain_k: 1.0,
            ..Params::default()
        };
        let w = Wrench {
            thrust: 18.0,
            roll: 0.3,
            pitch: -0.2,
            yaw: 0.02,
        };
        let mut m = Mixer::new(Variant::Flexible, Configuration::A, &p);
        let mut mix = m.mix(w, conditions());
        for _ in 0..3000 {
            mix = m.mix(w, conditions());
        }
        let model = *m.tilt().model();
        let got = Geometry::from_params(&p, Configuration::A)
            .wrench(&mix.thrusts, &mix.thrusts.map(|t| model.angle(t)));
        assert!((got.thrust - w.thrust).abs() < 0.02, "{got:?}");
        assert!((got.roll - w.roll).abs() < 2e-3 && (got.pitch - w.pitch).abs() < 5e-3);
        assert!((got.yaw - w.yaw).abs() < 2e-3, "{got:?}");
    }

    #[test]
    fn the_rigid_mixer_yaws_too_much_by_one_plus_c() {
        // |C| about 4.1·... at K 7.75, ρ 6.9: the arms answer a yaw command in the same sense.
        let w = Wrench { yaw: 0.01, ..HOVER };
        let (_, mix) = settled(Variant::Rigid, w);
        let p = Params::default();
        let model = crate::deflection::ArmModel::from_params(&p);
        let g = Geometry::from_params(&p, Configuration::B);
        let got = g.wrench(&mix.thrusts, &mix.thrusts.map(|t| model.angle(t)));
        // C = 1 - (dM/dδ) / (dM₀/dδ), along the yaw pattern about hover, with the arms following and without.
        let yaw = |step: f32, tilt: &dyn Fn(f32) -> f32| {
            let thrusts = YAW.map(|sign| 4.425 + step * sign);
            g.wrench(&thrusts, &thrusts.map(tilt)).yaw
        };
        let slope = |tilt: &dyn Fn(f32) -> f32| yaw(0.5, tilt) - yaw(-0.5, tilt);
        let c = 1.0 - slope(&|t| model.angle(t)) / slope(&|_| 0.0);
        assert!(
            (got.yaw / w.yaw - (1.0 - c)).abs() < 0.15,
            "{} {c}",
            got.yaw / w.yaw
        );
    }

    #[test]
    fn the_frozen_inverse_limit_cycles_where_c_is_large() {
        // A loop of motor lag and static arm around the allocation alone, with a constant small yaw demand.
        let swing = |variant, gain_k| {
            let p = Params {
                gain_k,
                yaw_thrust_max: 5.0,
                ..Params::default()
            };
            let mut m = Mixer::new(variant, Configuration::B, &p);
            let w = Wrench { yaw: 0.03, ..HOVER };
            let (mut low, mut high) = (f32::MAX, f32::MIN);
            for i in 0..8000 {
                let mix = m.mix(w, conditions());
                if i > 4000 {
                    low = low.min(mix.thrusts[0]);
                    high = high.max(mix.thrusts[0]);
                }
            }
            high - low
        };
        assert!(
            swing(Variant::Frozen, 7.75) > 1.0,
            "{}",
            swing(Variant::Frozen, 7.75)
        );
        assert!(
            swing(Variant::Frozen, 1.0) < 0.05,
            "{}",
            swing(Variant::Frozen, 1.0)
        );
        assert!(
            swing(Variant::Flexible, 7.75) < 0.05,
            "{}",
            swing(Variant::Flexible, 7.75)
        );
    }

    #[test]
    fn yaw_is_gated_during_spool_up_and_never_kicks() {
        let mut m = Mixer::new(Variant::Flexible, Configuration::B, &Params::default());
        let mut last = [0.25f32; 4];
        for i in 0..4000 {
            let thrust = 1.0 + 18.0 * i as f32 / 4000.0;
            let mix = m.mix(
                Wrench {
                    thrust,
                    yaw: 0.05,
                    ..Wrench::default()
                },
                conditions(),
            );
            let mean = 0.25 * m.tilt().thrusts().iter().sum::<f32>();
            assert!(mix.yaw_gated == (mean < 2.15) || (mean - 2.15).abs() < 0.02);
            for (a, b) in mix.thrusts.iter().zip(&last) {
                assert!(i == 0 || (a - b).abs() < 1.6, "{i}: {b} -> {a}");
            }
            last = mix.thrusts;
        }
    }

    #[test]
    fn yaw_beyond_its_limit_is_reported_as_not_given() {
        for variant in [Variant::Flexible, Variant::Rigid, Variant::Paper] {
            let (_, mix) = settled(variant, Wrench { yaw: 1.0, ..HOVER });
            assert!(
                mix.given.yaw < 0.5 && mix.given.saturated(),
                "{variant:?} {:?}",
                mix.given
            );
            let spread = 0.5 * (mix.thrusts[0] - mix.thrusts[1]);
            assert!(
                spread < 1.55 || variant == Variant::Flexible,
                "{variant:?} {:?}",
                mix.thrusts
            );
        }
        let (_, mix) = settled(Variant::Flexible, HOVER);
        assert!(mix.given == Given::ALL);
    }

    #[test]
    fn yaw_moves_no_rotor_by_more_than_its_limit() {
        // The rotors have room for 2.56 N (flexible) and 3.1 N (stiff) of yaw each: only the limit holds it back.
        let limit = Params::default().yaw_thrust_max;
        for (variant, yaw) in [
            (Variant::Flexible, 0.8),
            (Variant::Rigid, 0.2),
            (Variant::Paper, 0.2),
        ] {
            let (m, _) = settled(variant, HOVER);
            for yaw in [yaw, -yaw] {
                let (mut a, mut b) = (m, m);
                let still = a.mix(HOVER, conditions());
                let turning = b.mix(Wrench { yaw, ..HOVER }, conditions());
                let most = turning
                    .thrusts
                    .iter()
                    .zip(&still.thrusts)
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f32::max);
                assert!((most - limit).abs() < 0.02, "{variant:?} {most}");
                assert!((0.3..0.7).contains(&turning.given.yaw), "{:?}", turning.given);
            }
        }
    }

    #[test]
    fn the_rotor_that_yaw_moves_most_sets_its_share_whichever_it_is() {
        let m = Mixer::new(Variant::Flexible, Configuration::B, &Params::default());
        // 3 N asked of one rotor, 1.5 N allowed: a half. 1.2 N of 3 are within it: only the fade counts.
        for worst in 0..4 {
            for sign in [1.0, -1.0] {
                let mut yaw = [0.5, -1.0, 0.25, -2.0];
                yaw[worst] = 3.0 * sign;
                assert!(
                    m.yaw_share(&yaw, 1.0) == 0.5 && m.yaw_share(&yaw, 0.51) == 0.5,
                    "{yaw:?}"
                );
                assert!(m.yaw_share(&yaw, 0.4) == 0.4, "{yaw:?}");
            }
        }
        assert!(m.yaw_share(&[0.0; 4], 1.0) == 1.0 && m.yaw_share(&[0.0; 4], 0.3) == 0.3);
    }

    #[test]
    fn yaw_keeps_within_its_limit_on_every_rotor_of_a_rolling_vehicle() {
        // Arms that bend by different thrusts take different shares of a yaw command: the one that takes most is on
        // the left or on the right.
        let limit = Params::default().yaw_thrust_max;
        for roll in [0.6, -0.6] {
            let w = Wrench { roll, ..HOVER };
            let (m, _) = settled(Variant::Flexible, w);
            for yaw in [0.8, -0.8] {
                let (mut a, mut b) = (m, m);
                let still = a.mix(w, conditions());
                let turning = b.mix(Wrench { yaw, ..w }, conditions());
                let by = |i: usize| (turning.thrusts[i] - still.thrusts[i]).abs();
                let most = (0..4).map(by).fold(0.0, f32::max);
                assert!((most - limit).abs() < 0.02, "{roll} {yaw}: {most}");
            }
        }
    }

    #[test]
    fn a_sagging_battery_lowers_the_limit() {
        let mut m = Mixer::new(Variant::Flexible, Configuration::B, &Params::default());
        let sagged = Conditions {
            battery_ratio: 0.8,
            ..conditions()
        };
        for _ in 0..3000 {
            let mix = m.mix(
                Wrench {
                    thrust: 40.0,
                    ..Wrench::default()
                },
                sagged,
            );
            // 8.3 N · 0.8².
            assert!(mix.thrusts.iter().all(|t| *t <= 5.3121), "{:?}", mix.thrusts);
        }
    }

    #[test]
    fn giving_yaw_up_leaves_no_yaw_pattern_behind() {
        let (mut m, before) = settled(Variant::Flexible, Wrench { yaw: 0.06, ..HOVER });
        assert!(before.thrusts[0] - before.thrusts[1] > 0.3);
        let mut mix = before;
        for i in 0..3000 {
            let thrust = 17.7 * (1.0 - i as f32 / 3000.0);
            let c = Conditions {
                yaw: false,
                ..conditions()
            };
            mix = m.mix(
                Wrench {
                    thrust,
                    ..Wrench::default()
                },
                c,
            );
        }
        let [a, b, c, d] = mix.thrusts;
        assert!(
            (a - b).abs() < 0.01 && (a - c).abs() < 0.01 && (a - d).abs() < 0.01,
            "{:?}",
            mix.thrusts
        );
    }

    proptest! {
        #[test]
        fn any_input_gives_thrusts_within_the_limits(bits in prop::collection::vec(any::<[u32; 4]>(), 1..40)) {
            for variant in [Variant::Rigid, Variant::Paper, Variant::Frozen, Variant::Flexible] {
                let mut m = Mixer::new(variant, Configuration::B, &Params::default());
                for [t, l, p, n] in &bits {
                    let f = f32::from_bits;
                    let w = Wrench { thrust: f(*t), roll: f(*l), pitch: f(*p), yaw: f(*n) };
                    let mix = m.mix(w, Conditions { yaw: true, battery_ratio: f(*n), dt: 1e-3 });
                    prop_assert!(mix.thrusts.iter().all(|t| (0.25..=8.3).contains(t)), "{:?}", mix);
                    for (arm, measured) in [*t, *l, *p, *n, *t].into_iter().enumerate() {
                        m.correct_tilt(arm, f(measured));
                    }
                    prop_assert!(m.tilt().tilt().iter().all(|a| a.is_finite()));
                }
            }
        }
    }
}
