//! Allocations that are studied and never flown by the firmware: they take the mixer task's place.

use embassy_time::Instant;
use sophie_control::deflection::Algorithm1;
use sophie_control::desaturation::{Given, Patterns, desaturate};
use sophie_control::effectiveness::{Effectiveness, Geometry, Inverse, Load};
use sophie_control::params::Params;
use sophie_control::thrust_curve::ThrustCurve;
use sophie_control::tilt::TiltModel;
use sophie_control::wrench::{Configuration, PerArm, Wrench, YAW};
use sophie_tasks::links::{Battery, Demand, Links, MixOutput, Setpoint, Stamped};

/// An allocation to be studied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Studied {
    /// Algorithm 1 with the sideways thrust in its yaw row: α from the thrust of the step before, the whole
    /// effectiveness at that α inverted.
    Verbatim,
    /// The quasi-static Jacobian with whatever sign the model gives its yaw row, yaw given up only where that
    /// authority is small: what configuration A would need.
    SignAware,
}

/// Yaw authority over k_q below which [`Studied::SignAware`] gives yaw up, and over which it has all of it: in A it
/// falls through zero while the rotors spool up.
const FADE: (f32, f32) = (0.5, 1.2);

struct Allocator {
    kind: Studied,
    geometry: Geometry,
    algorithm_1: Algorithm1,
    tilt: TiltModel,
    last: PerArm<f32>,
    idle: f32,
    max: f32,
    yaw_limit: f32,
}

impl Allocator {
    fn new(kind: Studied, configuration: Configuration, p: &Params) -> Self {
        let tilt = TiltModel::new(p);
        Self {
            kind,
            geometry: Geometry::from_params(p, configuration),
            algorithm_1: Algorithm1::new(*tilt.model(), p.power_exponent),
            tilt,
            last: [p.thrust_idle; 4],
            idle: p.thrust_idle,
            max: p.thrust_max,
            yaw_limit: p.yaw_thrust_max,
        }
    }

    /// Thrusts (N), what was given up, and whether yaw was given up altogether.
    fn step(&mut self, w: Wrench, yaw: bool, dt: f32) -> (PerArm<f32>, Given, bool) {
        let (e, base, rest, fade) = match self.kind {
            Studied::Verbatim => {
                let tilt = self.last.map(|t| self.algorithm_1.angle(t, 1.0));
                let rest = Wrench {
                    thrust: w.thrust,
                    ..Wrench::default()
                };
                (
                    Effectiveness::frozen(&self.geometry, &tilt),
                    [0.0; 4],
                    rest,
                    f32::from(yaw),
                )
            }
            Studied::SignAware => {
                let (thrusts, tilt) = (self.tilt.thrusts(), self.tilt.tilt());
                let mut e = Effectiveness::quasi_static(&self.geometry, &tilt, &self.tilt.follow());
                let k_q = self.geometry.drag.abs();
                let mean = 0.25 * e.yaw.iter().sum::<f32>();
                let fade = ((mean.abs() / k_q - FADE.0) / (FADE.1 - FADE.0)).clamp(0.0, 1.0);
                let sign = mean.signum();
                for y in &mut e.yaw {
                    *y = sign * (sign * *y).max(FADE.0 * k_q);
                }
                let now = self.geometry.wrench(&thrusts, &tilt);
                let rest = Wrench {
                    thrust: w.thrust - now.thrust,
                    roll: -now.roll,
                    pitch: -now.pitch,
                    yaw: -now.yaw * fade,
                };
                (e, thrusts, rest, if yaw { fade } else { 0.0 })
            }
        };
        let patterns = Inverse::new(&e).map(|inverse| {
            let of = |w: Wrench| inverse.solve(Load::of(&self.geometry, w));
            let mut collective = of(rest);
            for (c, b) in collective.iter_mut().zip(&base) {
                *c += b;
            }
            // Where yaw is given up nothing else corrects what the last thrusts have of its pattern.
            if self.kind == Studied::SignAware {
                let left = 0.25 * collective.iter().zip(&YAW).map(|(t, y)| t * y).sum::<f32>();
                for (c, y) in collective.iter_mut().zip(&YAW) {
                    *c -= (1.0 - fade) * left * y;
                }
            }
            let yaw = of(Wrench {
                yaw: w.yaw,
                ..Wrench::default()
            });
            let worst = yaw.iter().fold(0.0_f32, |m, y| m.max(y.abs())) * fade;
            let room = if worst > self.yaw_limit {
                self.yaw_limit / worst
            } else {
                1.0
            };
            Patterns {
                collective,
                shift: of(Wrench {
                    thrust: 1.0,
                    ..Wrench::default()
                }),
                roll_pitch: of(Wrench {
                    thrust: 0.0,
                    yaw: 0.0,
                    ..w
                }),
                yaw: yaw.map(|y| y * fade * room),
            }
        });
        let patterns = patterns.unwrap_or(Patterns {
            collective: [0.25 * w.thrust; 4],
            shift: [0.25; 4],
            ..Patterns::default()
        });
        let (thrusts, given) = desaturate(&patterns, self.idle, self.max);
        self.follow(thrusts, dt);
        (thrusts, given, fade <= 0.0)
    }

    fn follow(&mut self, thrusts: PerArm<f32>, dt: f32) {
        self.last = thrusts;
        self.tilt.step(&thrusts, dt);
    }
}

/// Allocates in the mixer task's place; returns only if the link has no receiver left.
pub async fn run(links: &Links, kind: Studied, configuration: Configuration) {
    /// Step time without an estimate, s.
    const DT: f32 = 1e-3;
    let Some(mut demand) = links.demand.receiver() else {
        return;
    };
    let mut allocator = Allocator::new(kind, configuration, &links.params);
    let curve = ThrustCurve::from_params(&links.params);
    let mut arms_seen = Instant::MIN;
    loop {
        let message = demand.changed().await;
        let ratio = links
            .battery
            .latest()
            .map_or(1.0, |b: Stamped<Battery>| b.value.ratio);
        let resting = links
            .setpoint
            .latest()
            .is_some_and(|s| matches!(s.value, Setpoint::Resting { .. }));
        if let Some(arms) = links.arms.latest()
            && arms.at > arms_seen
            && !resting
        {
            arms_seen = arms.at;
            for (arm, tilt) in arms.value.values().into_iter().enumerate() {
                allocator.tilt.correct(arm, tilt.unwrap_or(f32::NAN));
            }
        }
        let idle = [links.params.thrust_idle; 4];
        let (thrusts, given, yaw_gated, running) = match message.value {
            Demand::Stop => {
                allocator.follow(idle, DT);
                ([0.0; 4], Given::ALL, true, false)
            }
            Demand::Idle => {
                allocator.follow(idle, DT);
                (idle, Given::ALL, true, true)
            }
            Demand::Wrench { wrench, yaw } => {
                let (thrusts, given, gated) = allocator.step(wrench, yaw, DT);
                (thrusts, given, gated, true)
            }
        };
        links.mix.send(
            message.at,
            MixOutput {
                running,
                thrusts,
                commands: if running {
                    thrusts.map(|t| curve.command(t, ratio))
                } else {
                    [0.0; 4]
                },
                given,
                yaw_gated,
                tilt: allocator.tilt.tilt(),
                tilt_bias: allocator.tilt.bias(),
                tilt_fault: allocator.tilt.fault(),
            },
        );
    }
}
