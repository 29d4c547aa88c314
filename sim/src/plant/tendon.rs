//! Servo, reel and tendon of one arm.
//!
//! The servo winds a nylon thread along the arm's underside, which only pulls, and is slack until the reel has wound
//! the length that the tilt frees. Numbers are the vehicle's; the flight stack's are parameters.

use std::f64::consts::PI;

use sophie_control::gripper::tendon::REFERENCE_TILT;
use sophie_control::params::Params;

use super::beam::TENDON_LEVER;
use crate::plant::flexible::ArmBending;

/// Deadband of the servo, µs (digital servos state 2 to 5; MG996R datasheet 5).
const DEADBAND_US: f64 = 2.0;
/// Limits of an accepted pulse, µs.
const PULSE_LIMITS_US: (f64, f64) = (450.0, 2550.0);
/// Gear friction without pulses, share of the stall torque (assumed).
const GEAR_FRICTION: f64 = 0.35;

/// The tendon servo fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ServoProfile {
    /// 35 kgcm, the paper's claim.
    Paper,
    /// MG996R, datasheet at 4.8 V: 9.4 kgcm.
    Mg996r,
}

/// A servo as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoSpec {
    /// Stall torque, N·m.
    pub stall: f64,
    /// No-load speed, rad/s.
    pub slew: f64,
    /// Travel from `release_us` to `full_us`, rad.
    pub range: f64,
    /// Release position, µs.
    pub release_us: f64,
    /// Pulse after the travel `range`, µs; below `release_us` for a reversed servo.
    pub full_us: f64,
    /// Period of accepted pulses, s: 20 ms for an analog servo.
    pub frame: f64,
}

impl ServoSpec {
    /// This servo with the pulses of its release and full marks, µs, and pulses at `frame_rate` Hz.
    #[must_use]
    pub fn marked(self, release_us: f64, full_us: f64, frame_rate: f32) -> Self {
        Self {
            release_us,
            full_us,
            frame: 1.0 / f64::from(frame_rate),
            ..self
        }
    }
}

impl From<ServoProfile> for ServoSpec {
    fn from(profile: ServoProfile) -> Self {
        let usual = Self {
            stall: 0.0,
            slew: 6.16,
            range: 0.0,
            release_us: 550.0,
            full_us: 2450.0,
            frame: 0.02,
        };
        match profile {
            // 35 kgcm (paper); speed of the MG996R it names; 270° version.
            ServoProfile::Paper => Self {
                stall: 3.432,
                range: 4.71,
                ..usual
            },
            // 9.4 kgcm, 0.17 s for 60° at 4.8 V (datasheet); 180°.
            ServoProfile::Mg996r => Self {
                stall: 0.922,
                range: PI,
                ..usual
            },
        }
    }
}

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
    /// Fault to come, and the time until it begins, s.
    breaks: Option<(TendonBreak, f64)>,
}

impl Tendon {
    /// Servo at the release position.
    pub fn new(servo: ServoSpec, spec: TendonSpec) -> Self {
        Self {
            servo,
            spec,
            position: 0.0,
            target: None,
            to_next_frame: 0.0,
            last_tilt: None,
            tension: 0.0,
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

    /// Advances by `dt` s under pulses of `pulse_us` µs (0: none) at tilt `alpha` rad; returns the moment on the tilt,
    /// N·m (never positive). Without pulses gear friction holds 35 % of the stall torque and slips beyond.
    pub fn step(&mut self, dt: f64, pulse_us: f64, alpha: f64) -> f64 {
        self.to_next_frame -= dt;
        if self.to_next_frame <= 0.0 {
            self.to_next_frame += self.servo.frame;
            self.target = self.commanded(pulse_us);
        }
        let before = self.position;
        let broken = self.broken(dt);
        if broken != Some(TendonBreak::Stuck) {
            self.position += self.speed(dt) * dt;
        }
        let tilt_change = alpha - self.last_tilt.replace(alpha).unwrap_or(alpha);

        let TendonSpec {
            reel_radius: r,
            lever: h,
            stiffness,
            damping,
            reference_tilt,
            slack_error,
        } = self.spec;
        let stretch = r * self.position - slack_error - h * (reference_tilt - alpha);
        let stretch_rate = (r * (self.position - before) + h * tilt_change) / dt;
        self.tension = if stretch > 0.0 && broken != Some(TendonBreak::Torn) {
            (stiffness * stretch + damping * stretch_rate).max(0.0)
        } else {
            0.0
        };
        -h * self.tension
    }

    /// Pull of the tendon, N.
    pub fn tension(&self) -> f64 {
        self.tension
    }

    /// On the servo's shaft, N·m.
    pub fn servo_torque(&self) -> f64 {
        self.tension * self.spec.reel_radius
    }

    /// Servo angle from the release position, rad, winding positive.
    pub fn servo_angle(&self) -> f64 {
        self.position
    }

    /// Commanded angle, rad; unchanged within the deadband.
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
        let angle = (pulse_us - release_us) * per_us;
        match self.target {
            Some(held) if (angle - held).abs() < DEADBAND_US * per_us.abs() => Some(held),
            _ => Some(angle),
        }
    }

    /// Speed, rad/s: linear from no-load speed to zero at stall, backwards beyond (a DC motor); at most what reaches
    /// the target within `dt`.
    fn speed(&self, dt: f64) -> f64 {
        let ServoSpec { stall, slew, .. } = self.servo;
        let load = self.servo_torque() / stall;
        match self.target {
            None => -slew * ((load - GEAR_FRICTION) / (1.0 - GEAR_FRICTION)).clamp(0.0, 1.0),
            Some(target) => {
                let wanted = (target - self.position) / dt;
                let winding = slew * (1.0 - load);
                wanted.clamp(-slew, winding.max(-slew))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::STEP as DT;
    use super::*;

    fn run(t: &mut Tendon, pulse: f64, alpha: f64, seconds: f64) -> f64 {
        (0..(seconds / DT) as u64).fold(0.0, |_, _| t.step(DT, pulse, alpha))
    }

    #[test]
    fn a_torn_tendon_pulls_nothing_and_a_stuck_servo_stays() {
        let taut = |broken| {
            let mut t = paper().breaking(broken, 1.0);
            run(&mut t, 1500.0, 0.0, 0.9);
            let pulled = t.tension();
            run(&mut t, 1500.0, 0.0, 0.2);
            let held = (pulled, t.servo_angle());
            run(&mut t, 1000.0, 0.0, 0.9);
            (held, (t.tension(), t.servo_angle()))
        };
        let ((pulled, at), (after, then)) = taut(Some(TendonBreak::Torn));
        assert!(pulled > 1.0 && after == 0.0 && then < at);
        let ((pulled, at), (after, then)) = taut(Some(TendonBreak::Stuck));
        assert!(
            (after / pulled - 1.0).abs() < 0.05 && (then - at).abs() < 0.3,
            "{pulled} {after} {at} {then}"
        );
        let ((_, at), (_, then)) = taut(None);
        assert!(at - then > 0.5);
    }

    fn paper() -> Tendon {
        Tendon::new(ServoProfile::Paper.into(), TendonSpec::default())
    }

    #[test]
    fn a_released_tendon_is_slack_in_flight_and_at_rest() {
        let mut t = paper();
        for alpha in [-0.55, -0.2, 0.0, 0.35] {
            assert!(
                run(&mut t, 550.0, alpha, 0.2) == 0.0 && t.tension() == 0.0,
                "{alpha}"
            );
        }
    }

    #[test]
    fn the_tension_by_hand() {
        // 1150/1900 · 4.71 rad = 2.85079 rad on 15 mm are 42.762 mm; at -1 rad 25 mm · 1.4 = 35 mm are taken up: 7.762
        // mm of stretch, 62.09 N, 1.552 N·m on the arm, 0.931 N·m on the servo.
        let mut t = paper();
        let moment = run(&mut t, 1700.0, -1.0, 3.0);
        assert!(
            (t.tension() - 62.09).abs() < 0.02 && (moment + 1.5523).abs() < 1e-3,
            "{}",
            t.tension()
        );
        assert!((t.servo_torque() - 0.9314).abs() < 1e-3);
    }

    #[test]
    fn a_servo_obeys_pulses_between_its_marks() {
        let spec = ServoSpec::from(ServoProfile::Paper).marked(2330.0, 830.0, 333.0);
        assert!((spec.frame - 3.003e-3).abs() < 1e-6);
        let mut t = Tendon::new(spec, TendonSpec::default());
        // Half of 2330 to 830 µs is half the travel.
        for (pulse, angle) in [(2330.0, 0.0), (1580.0, 2.355), (1581.5, 2.355), (830.0, 4.71)] {
            run(&mut t, pulse, -2.5, 1.0);
            assert!(
                (t.servo_angle() - angle).abs() < 1e-3,
                "{pulse}: {}",
                t.servo_angle()
            );
        }
    }

    #[test]
    fn the_servo_takes_its_time() {
        let mut t = paper();
        // 4.71 rad at 6.16 rad/s, slack tendon: 0.765 s and a frame.
        run(&mut t, 2450.0, -2.5, 0.74);
        assert!(t.servo_angle() < 4.6);
        run(&mut t, 2450.0, -2.5, 0.1);
        assert!((t.servo_angle() - 4.71).abs() < 1e-6);
    }

    #[test]
    fn a_weak_servo_stalls_below_its_target() {
        let mut t = Tendon::new(ServoProfile::Mg996r.into(), TendonSpec::default());
        run(&mut t, 2450.0, 0.0, 5.0);
        assert!((t.servo_torque() - 0.922).abs() < 1e-3 && t.servo_angle() < 3.0);
    }

    #[test]
    fn without_pulses_the_gears_hold_and_slip_under_too_much() {
        let mut t = paper();
        run(&mut t, 1700.0, -1.0, 3.0);
        let angle = t.servo_angle();
        run(&mut t, 0.0, -1.0, 3.0);
        assert!((t.servo_angle() - angle).abs() < 1e-12);
        // The arm is forced up: gears slip beyond 0.35 · 3.432 N·m.
        run(&mut t, 0.0, -0.6, 3.0);
        assert!(t.servo_angle() < angle && (t.servo_torque() - 1.2012).abs() < 1e-2);
    }

    #[test]
    fn changes_within_the_deadband_are_ignored() {
        let mut t = paper();
        run(&mut t, 1500.0, -2.0, 2.0);
        let angle = t.servo_angle();
        run(&mut t, 1501.5, -2.0, 1.0);
        assert!((t.servo_angle() - angle).abs() < 1e-12);
        run(&mut t, 1503.0, -2.0, 1.0);
        assert!(t.servo_angle() > angle);
    }
}
