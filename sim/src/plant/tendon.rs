//! Servo, reel and tendon of one arm.
//!
//! The servo winds a nylon thread along the arm's underside, which only pulls, and is slack until the reel has wound
//! the length that the tilt frees. Numbers are the vehicle's; the flight stack's are parameters. Errors of
//! real threads and servos are off by default: friction, [`creep`](super::creep), stop, give and heat, a file each.

mod friction;
mod give;
mod heat;
mod servo;
mod stop;
#[cfg(test)]
mod tests;

use sophie_control::gripper::tendon::REFERENCE_TILT;
use sophie_control::params::Params;

use self::friction::Friction;
use self::give::Give;
use self::heat::Heat;
pub use self::servo::{ServoErrors, ServoProfile, ServoSpec};
use self::stop::Stop;
use super::beam::TENDON_LEVER;
use super::creep::Creep;
use crate::plant::flexible::ArmBending;

/// Deadband of the servo, µs (digital servos state 2 to 5; MG996R datasheet 5).
const DEADBAND_US: f64 = 2.0;
/// Limits of an accepted pulse, µs.
const PULSE_LIMITS_US: (f64, f64) = (450.0, 2550.0);
/// Gear friction without pulses, share of the stall torque (assumed).
const GEAR_FRICTION: f64 = 0.35;
/// Time from which the thread's creep counts, s.
const CREEP_BEGIN: f64 = 1.0;

/// Reel and tendon as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonSpec {
    /// Reel radius, m (assumed).
    pub reel_radius: f64,
    /// Distance from the arm's neutral line, m (assumed).
    pub lever: f64,
    /// Stiffness along the tendon, N/m: 1 mm nylon, 0.25 m, E 2.5 GPa (derived, 30 %).
    pub stiffness: f64,
    /// Damping along the tendon, N·s/m: loss factor 0.1 at 8 Hz (assumed).
    pub damping: f64,
    /// Tilt at which the tendon is just taut at release, rad.
    pub reference_tilt: f64,
    /// Excess length, m; negative: too short.
    pub slack_error: f64,
    /// Coefficient of friction in the channel.
    pub friction: f64,
    /// Creep of the thread, share of its stretch per decade of time.
    pub creep: f64,
}

impl TendonSpec {
    /// The tendon along arms of the model `bending`.
    #[must_use]
    pub fn of(bending: ArmBending) -> Self {
        match bending {
            ArmBending::Hinge => Self::default(),
            ArmBending::Beam => Self {
                lever: TENDON_LEVER,
                ..Self::default()
            },
        }
    }
}

/// Parameters of the stack for arms of the model `bending`: the tendon's lever, and the effect of tendon and thrust on
/// a free arm and on one on a pipe.
pub fn assume_bending(params: &mut Params, bending: ArmBending) {
    params.tendon_lever = TendonSpec::of(bending).lever as f32;
    (params.tendon_bend, params.tendon_relief) = match bending {
        ArmBending::Hinge => (1.0, 1.0),
        ArmBending::Beam => (Params::DEFAULT.tendon_bend, Params::DEFAULT.tendon_relief),
    };
}

impl Default for TendonSpec {
    fn default() -> Self {
        Self {
            reel_radius: 0.015,
            lever: 0.025,
            stiffness: 8000.0,
            damping: 16.0,
            reference_tilt: f64::from(REFERENCE_TILT),
            slack_error: 0.0,
            friction: 0.0,
            creep: 0.0,
        }
    }
}

/// A fault of a tendon or its servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TendonBreak {
    /// The thread is torn.
    Torn,
    /// The servo is stuck at its angle.
    Stuck,
}

/// Servo, reel and tendon of one arm.
#[derive(Clone, Debug)]
pub struct Tendon {
    servo: ServoSpec,
    spec: TendonSpec,
    position: f64,
    target: Option<f64>,
    to_next_frame: f64,
    last_tilt: Option<f64>,
    tension: f64,
    stop: Stop,
    give: Give,
    /// Angle by which the shaft gives way, rad.
    given: f64,
    heat: Heat,
    /// Present stall torque over the cold one's.
    strength: f64,
    friction: Friction,
    creep: Creep,
    /// Length that the thread has crept, m.
    crept: f64,
    /// Fault to come, and the time until it begins, s.
    breaks: Option<(TendonBreak, f64)>,
}

impl Tendon {
    /// Servo at the release position.
    pub fn new(servo: ServoSpec, spec: TendonSpec) -> Self {
        let errors = servo.errors;
        Self {
            servo,
            spec,
            position: 0.0,
            target: None,
            to_next_frame: 0.0,
            last_tilt: None,
            tension: 0.0,
            stop: Stop::new(errors.stop),
            give: Give::new(errors.sag, errors.backlash),
            given: 0.0,
            heat: Heat::new(errors.heat, errors.air),
            strength: 1.0,
            friction: Friction::new(spec.friction),
            creep: Creep::new(spec.creep, CREEP_BEGIN),
            crept: 0.0,
            breaks: None,
        }
    }

    /// The same, breaking after `seconds`.
    #[must_use]
    pub fn breaking(self, broken: Option<TendonBreak>, seconds: f64) -> Self {
        let breaks = broken.map(|broken| (broken, seconds));
        Self { breaks, ..self }
    }

    /// Present fault, `dt` s after the last call.
    fn broken(&mut self, dt: f64) -> Option<TendonBreak> {
        let (broken, seconds) = self.breaks.as_mut()?;
        *seconds -= dt;
        (*seconds <= 0.0).then_some(*broken)
    }

    /// Advances by `dt` s, creep and heat by `lapse` times as much, under pulses of `pulse_us` µs (0: none) at tilt `alpha` rad; returns the moment on the tilt,
    /// N·m (never positive). Without pulses gear friction holds 35 % of the stall torque and slips beyond.
    pub fn step(&mut self, dt: f64, lapse: f64, pulse_us: f64, alpha: f64) -> f64 {
        self.to_next_frame -= dt;
        if self.to_next_frame <= 0.0 {
            self.to_next_frame += self.servo.frame;
            self.target = self.commanded(pulse_us);
        }
        self.warm(lapse * dt);
        let before = self.servo_angle();
        let broken = self.broken(dt);
        if broken != Some(TendonBreak::Stuck) {
            self.position += self.speed(dt) * dt;
        }
        self.given = self.give.step(dt, self.servo_torque());
        let turned = self.servo_angle() - before;
        let tilt_change = alpha - self.last_tilt.replace(alpha).unwrap_or(alpha);

        let TendonSpec {
            reel_radius: r,
            lever: h,
            stiffness,
            damping,
            reference_tilt,
            slack_error,
            ..
        } = self.spec;
        let stretch = r * self.servo_angle() - slack_error - self.crept - h * (reference_tilt - alpha);
        let stretch_rate = (r * turned + h * tilt_change) / dt;
        self.tension = if stretch > 0.0 && broken != Some(TendonBreak::Torn) {
            (stiffness * stretch + damping * stretch_rate).max(0.0)
        } else {
            0.0
        };
        self.crept = self.creep.step(lapse * dt, self.tension / stiffness);
        let stretched = stiffness * h * tilt_change;
        -h * self.friction.step(self.tension, stretched, alpha)
    }

    /// Pull of the tendon at the reel, N.
    pub fn tension(&self) -> f64 {
        self.tension
    }

    /// On the servo's shaft, N·m.
    pub fn servo_torque(&self) -> f64 {
        self.tension * self.spec.reel_radius
    }

    /// Angle of the servo's shaft from the release position, rad, winding positive.
    pub fn servo_angle(&self) -> f64 {
        self.position - self.given
    }

    /// Warms the servo by its load since the last step; a burnt one has no target.
    fn warm(&mut self, dt: f64) {
        let load = match self.target {
            Some(_) => self.servo_torque() / self.servo.stall,
            None => 0.0,
        };
        match self.heat.step(dt, load) {
            Some(strength) => self.strength = strength,
            None => self.target = None,
        }
    }

    /// Commanded angle, rad; unchanged within the deadband of pulses, which a servo with one of positions does not have.
    fn commanded(&self, pulse_us: f64) -> Option<f64> {
        if !(pulse_us >= PULSE_LIMITS_US.0 && pulse_us <= PULSE_LIMITS_US.1) {
            return None;
        }
        let ServoSpec {
            range,
            release_us,
            full_us,
            ..
        } = self.servo;
        let per_us = range / (full_us - release_us);
        let angle = (pulse_us - release_us) * per_us + self.servo.errors.zero;
        match self.target {
            Some(held) if !self.stop.has_band() && (angle - held).abs() < DEADBAND_US * per_us.abs() => {
                Some(held)
            }
            _ => Some(angle),
        }
    }

    /// Speed, rad/s: linear from no-load speed to zero at stall, backwards beyond (a DC motor); at most what reaches
    /// the target within `dt`.
    fn speed(&mut self, dt: f64) -> f64 {
        let ServoSpec { stall, slew, .. } = self.servo;
        let load = self.servo_torque() / stall;
        match self.target {
            None => -slew * ((load - GEAR_FRICTION) / (1.0 - GEAR_FRICTION)).clamp(0.0, 1.0),
            Some(target) => {
                let wanted = self.stop.driven(target - self.position) / dt;
                let winding = slew * (1.0 - load / self.strength);
                wanted.clamp(-slew, winding.max(-slew))
            }
        }
    }
}
