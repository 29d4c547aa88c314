//! The loop that closes the arms on the pipe: contact pressure in, tendon force out.
//!
//! Each arm goes through three phases. It is bent down at a steady speed, its force rising as its stiffness
//! demands, until the sensor feels something. Then the force is set to what the tendon really has, which is
//! less than what was asked while the arm still moved, and a PID leads the pressure along a reference that
//! approaches the target from below. On release the force falls to nothing at a limited rate.
//!
//! Two things are known beforehand and fed forward: the arm's stiffness sets the rise, and the thrust of the
//! arm's rotor bends it away from the pipe with arm_d T, which the tendon meets with arm_d/h T. So the
//! pressure hardly moves when the rotors stop.

use crate::deflection::ArmModel;
use crate::filter::LowPass;
use crate::grip::{ArmGrip, ArmState, Demand, FreeProof, HoldProof};
use crate::math;
use crate::params::Params;
use crate::tendon::ForceLimit;
use crate::wrench::PerArm;

/// Pressure that counts as touching, Pa: above the sensor's threshold of 0.1 N (69 Pa on 1444 mm²).
const TOUCH: f32 = 100.0;
/// Time constant with which the reference approaches the target, s.
const REFERENCE_TAU: f32 = 0.25;
/// Cut-off of the measured pressure, rad/s (13 Hz).
const PRESSURE_CUTOFF: f32 = 80.0;
/// Cut-off of the pressure's derivative, rad/s (6 Hz).
const DERIVATIVE_CUTOFF: f32 = 40.0;
/// Cut-off of the thrust that is fed forward, rad/s: the asked thrust acts after the motors' 50 ms, less the
/// time that the servo needs itself.
const THRUST_CUTOFF: f32 = 30.0;
/// Least force of a closed arm, N: at 0 the servo would pay out to its release position.
const LEAST: f32 = 1.0;
/// Fastest change of the force of an arm that touches, N/s.
const SLEW: f32 = 300.0;
/// Force (N) that the tendon may lag behind before the integral waits for it.
const LAG: f32 = 20.0;
/// Time at the force limit after which the arm counts as limited, s.
const LIMITED_AFTER: f32 = 1.0;
/// Time without a tilt after which the arm counts as faulty, s; its servo is held from the first moment.
const TILT_MISSING: f32 = 0.5;
/// Rise of the tension (N) over which an arm that does not touch is expected to bend.
const BEND_WINDOW: f32 = 8.0;
/// Share of the expected bending below which something unfelt holds the arm.
const BEND_SHARE: f32 = 0.45;
/// Cut-off of the tilt in that comparison, rad/s.
const BEND_CUTOFF: f32 = 12.0;

/// Why an arm is faulty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// No fresh pressure; over as soon as there is one.
    Stale,
    /// The pressure sensor failed; stays until release.
    Sensor,
    /// The arm met something that its sensor does not feel; stays until release.
    Unfelt,
    /// The arm's tilt is missing; over when it is back.
    Tilt,
    /// A number is not finite; over when it is.
    NotFinite,
}

/// The contact pressure of one arm, or why there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pressure {
    /// Pa.
    Known(f32),
    /// Nothing fresh.
    #[default]
    Stale,
    /// The sensor is open, shorted or out of range.
    Faulty,
}

impl Pressure {
    /// The pressure, when it is known and a number.
    fn known(self) -> Option<f32> {
        match self {
            Self::Known(p) if p.is_finite() => Some(p),
            _ => None,
        }
    }
}

/// What is known of one arm at a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmInput {
    /// Contact pressure.
    pub pressure: Pressure,
    /// Thrust asked of the arm's rotor, N; 0 when it is stopped.
    pub thrust: f32,
    /// Tension that the servo can be giving, N.
    pub tension: Option<f32>,
    /// Tilt by the arm's own sensor, rad.
    pub tilt: Option<f32>,
}

/// The loop's numbers, derived from the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    p: f32,
    i: f32,
    d: f32,
    /// Rise of the force that bends a free arm at the approach speed, N/s.
    approach: f32,
    release: f32,
    limit: f32,
    /// Tendon force that a rotor's thrust takes, N/N.
    per_thrust: f32,
    /// Tilt that a free arm loses for tendon force, rad/N.
    bend_per_force: f32,
    demand: Demand,
}

impl Config {
    /// The loop that the parameters describe.
    pub fn from_params(p: &Params) -> Self {
        // The tendon's moment h F bends like the thrust F h/d; below level thrust the arm is linear.
        let compliance = math::clamp(ArmModel::from_params(p).slope(0.0), 1e-3, 10.0);
        let bend_per_force = compliance * p.tendon_lever / p.arm_d;
        let limit = ForceLimit::from_params(p).force;
        Self {
            p: p.clamp_p,
            i: p.clamp_i,
            d: p.clamp_d,
            approach: math::clamp(p.clamp_approach / bend_per_force, 0.0, 1e3),
            release: p.clamp_release,
            limit,
            per_thrust: p.arm_d / p.tendon_lever,
            bend_per_force,
            demand: Demand::from_params(p, limit),
        }
    }

    /// Largest force, N.
    pub fn limit(&self) -> f32 {
        self.limit
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Phase {
    #[default]
    Free,
    /// Bending down, nothing felt yet.
    Approach,
    /// Felt: the pressure is controlled.
    Grip(Pid),
    Release,
}

/// State of the pressure loop.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pid {
    reference: f32,
    integral: f32,
    last: f32,
    slope: LowPass,
}

/// Watches that an arm bends as its tension rises.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BendWatch {
    tilt: LowPass,
    tension: LowPass,
    from: Option<(f32, f32)>,
}

impl BendWatch {
    /// True when the tension rose by the window but the tilt hardly fell.
    fn step(&mut self, cfg: &Config, tilt: f32, tension: f32, dt: f32) -> bool {
        let tilt = self.tilt.step(tilt, BEND_CUTOFF, dt);
        let tension = self.tension.step(tension, BEND_CUTOFF, dt);
        let Some((tilt_from, tension_from)) = self.from else {
            // The first newtons take up slack and settle the filters.
            self.from = (tension > BEND_WINDOW).then_some((tilt, tension));
            return false;
        };
        if tension < tension_from + BEND_WINDOW {
            return false;
        }
        self.from = Some((tilt, tension));
        tilt_from - tilt < BEND_SHARE * cfg.bend_per_force * (tension - tension_from)
    }
}

/// The clamp loop of one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmClamp {
    phase: Phase,
    force: f32,
    pressure: Option<LowPass>,
    thrust: Option<LowPass>,
    watch: Option<BendWatch>,
    fault: Option<Fault>,
    tilt_missing: f32,
    at_limit: f32,
    hold: HoldProof,
    free: FreeProof,
}

impl ArmClamp {
    /// One step of `dt` s: closes (`close`) or releases the arm; returns what is known of its grip.
    ///
    /// Whatever the input, the force stays within 0 and the limit.
    pub fn step(&mut self, cfg: &Config, close: bool, input: &ArmInput, dt: f32) -> ArmGrip {
        let dt = math::clamp(dt, 1e-4, 0.1);
        let raw = input.pressure.known();
        let pressure = raw.map(|p| {
            let filter = self.pressure.get_or_insert(LowPass::at(p));
            filter.step(p, PRESSURE_CUTOFF, dt)
        });
        let thrust = input.thrust.is_finite().then(|| {
            let thrust = math::clamp(input.thrust, 0.0, 1e3);
            self.thrust.get_or_insert(LowPass::at(thrust)).step(thrust, THRUST_CUTOFF, dt)
        });
        let tension = input.tension.filter(|t| t.is_finite());
        let tilt = input.tilt.filter(|t| t.is_finite());

        if close {
            self.close(cfg, input.pressure, pressure, thrust, tension, tilt, dt);
        } else {
            self.let_go(cfg, dt);
        }
        self.force = math::clamp(self.force, 0.0, cfg.limit);
        let known = pressure.filter(|_| self.fault.is_none());
        let free = self.free.step(&cfg.demand, pressure, tension, dt);
        if self.phase == Phase::Release && free {
            *self = Self { pressure: self.pressure, thrust: self.thrust, free: self.free, ..Self::default() };
        }
        let holding = match self.phase {
            Phase::Grip(_) | Phase::Approach => self.hold.step(&cfg.demand, known, self.force, dt),
            Phase::Free | Phase::Release => {
                self.hold = HoldProof::default();
                false
            }
        };
        ArmGrip {
            state: self.state(holding),
            pressure: pressure.unwrap_or_else(|| self.pressure.map_or(0.0, |f| f.value())),
            force: self.force,
            closure: self.hold.closure(),
        }
    }

    /// Why the arm is faulty, if it is.
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    fn state(&self, holding: bool) -> ArmState {
        match self.phase {
            Phase::Free => ArmState::Free,
            Phase::Release => ArmState::Releasing,
            _ if self.fault.is_some() => ArmState::Faulty,
            _ if holding => ArmState::Holding,
            _ if self.at_limit >= LIMITED_AFTER => ArmState::ForceLimited,
            Phase::Approach => ArmState::Closing,
            Phase::Grip(_) => ArmState::Touching,
        }
    }

    /// Lets the force fall; every fault ends with it.
    fn let_go(&mut self, cfg: &Config, dt: f32) {
        if self.phase != Phase::Free {
            self.phase = Phase::Release;
        }
        self.fault = None;
        self.watch = None;
        self.at_limit = 0.0;
        self.tilt_missing = 0.0;
        self.force = math::slew(self.force, 0.0, cfg.release * dt);
    }

    #[allow(clippy::too_many_arguments, reason = "the step's own locals, taken apart once")]
    fn close(
        &mut self,
        cfg: &Config,
        sensed: Pressure,
        pressure: Option<f32>,
        thrust: Option<f32>,
        tension: Option<f32>,
        tilt: Option<f32>,
        dt: f32,
    ) {
        if matches!(self.phase, Phase::Free | Phase::Release) {
            self.phase = Phase::Approach;
            self.hold = HoldProof::default();
            self.free = FreeProof::default();
        }
        self.tilt_missing = if tilt.is_some() { 0.0 } else { math::clamp(self.tilt_missing + dt, 0.0, 10.0) };
        let latched = matches!(self.fault, Some(Fault::Sensor | Fault::Unfelt));
        self.fault = match sensed {
            _ if latched => self.fault,
            Pressure::Faulty => Some(Fault::Sensor),
            Pressure::Stale => Some(Fault::Stale),
            Pressure::Known(_) if pressure.is_none() || thrust.is_none() => Some(Fault::NotFinite),
            Pressure::Known(_) if self.tilt_missing >= TILT_MISSING => Some(Fault::Tilt),
            Pressure::Known(_) => None,
        };
        let (Some(pressure), Some(thrust), Some(tilt), None) = (pressure, thrust, tilt, self.fault) else {
            // The force is held, and the loop starts afresh from it: no wind-up, no kick.
            if let Phase::Grip(_) = self.phase {
                self.phase = Phase::Approach;
            }
            self.watch = None;
            return;
        };
        let has = tension.unwrap_or(self.force);
        match self.phase {
            Phase::Grip(mut pid) => {
                let rise = if pressure < TOUCH { cfg.approach } else { SLEW };
                let wanted = pid.step(cfg, pressure, cfg.per_thrust * thrust, self.force - has, dt);
                self.force = math::clamp(wanted, self.force - SLEW * dt, self.force + rise * dt);
                self.force = math::clamp(self.force, LEAST, cfg.limit);
                self.phase = Phase::Grip(pid);
            }
            _ if pressure > TOUCH => {
                // What was asked beyond what the tendon has would arrive as a peak once the arm stands still.
                self.force = math::clamp(if has < self.force { has } else { self.force }, LEAST, cfg.limit);
                self.phase = Phase::Grip(Pid::new(self.force - cfg.per_thrust * thrust, pressure));
            }
            _ => {
                self.force = math::clamp(self.force + cfg.approach * dt, LEAST, cfg.limit);
                let watch = self.watch.get_or_insert(BendWatch {
                    tilt: LowPass::at(tilt),
                    tension: LowPass::at(has),
                    from: None,
                });
                if watch.step(cfg, tilt, has, dt) {
                    self.fault = Some(Fault::Unfelt);
                }
            }
        }
        let limited = self.force >= cfg.limit - 1e-3;
        self.at_limit = if limited { math::clamp(self.at_limit + dt, 0.0, 10.0) } else { 0.0 };
    }
}

impl Pid {
    /// A loop that at the pressure `pressure` (Pa) puts out `force` (N) and aims at where it is.
    fn new(force: f32, pressure: f32) -> Self {
        Self { reference: pressure, integral: force, last: pressure, slope: LowPass::at(0.0) }
    }

    /// One step with the force `forward` (N) fed forward, while the tendon lags by `lag` N; returns the force.
    fn step(&mut self, cfg: &Config, pressure: f32, forward: f32, lag: f32, dt: f32) -> f32 {
        let towards = dt / (REFERENCE_TAU + dt);
        self.reference += (cfg.demand.pressure - self.reference) * towards;
        let error = self.reference - pressure;
        let slope = self.slope.step((pressure - self.last) / dt, DERIVATIVE_CUTOFF, dt);
        self.last = pressure;
        let quick = cfg.p * error - cfg.d * slope + forward;
        let force = self.integral + quick;
        let up = force >= cfg.limit || lag > LAG;
        let down = force <= LEAST || lag < -LAG;
        if !(up && error > 0.0 || down && error < 0.0) {
            // `forward` may exceed the limit by itself; the integral then works against it.
            self.integral = math::clamp_abs(self.integral + cfg.i * error * dt, 2.0 * cfg.limit);
        }
        self.integral + quick
    }
}

/// What the clamp loop puts out for all arms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClampOutput {
    /// Force asked of each tendon, N.
    pub force: PerArm<f32>,
    /// What is known of each grip.
    pub arms: PerArm<ArmGrip>,
    /// Every chosen arm holds (there is at least one).
    pub proven: bool,
    /// Every arm is free.
    pub released: bool,
}

/// The clamp loops of the four arms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clamp {
    arms: PerArm<ArmClamp>,
}

impl Clamp {
    /// One step of `dt` s: closes the arms in `close`, releases the others.
    pub fn step(
        &mut self,
        cfg: &Config,
        close: PerArm<bool>,
        input: &PerArm<ArmInput>,
        dt: f32,
    ) -> ClampOutput {
        let mut out = ClampOutput { proven: close.contains(&true), released: true, ..ClampOutput::default() };
        let slots = out.force.iter_mut().zip(out.arms.iter_mut());
        for (((arm, close), input), (force, grip)) in self.arms.iter_mut().zip(close).zip(input).zip(slots) {
            *grip = arm.step(cfg, close, input, dt);
            *force = grip.force;
            out.proven &= !close || grip.state == ArmState::Holding;
            out.released &= arm.is_free(input.pressure);
        }
        out
    }

    /// Why each arm is faulty, if it is.
    pub fn faults(&self) -> PerArm<Option<Fault>> {
        self.arms.map(|a| a.fault())
    }
}

impl ArmClamp {
    /// The arm is free: released for long enough, by all that is known of it.
    fn is_free(&self, sensed: Pressure) -> bool {
        self.phase == Phase::Free && self.free.proven(sensed.known().is_some())
    }
}
