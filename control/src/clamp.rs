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

mod ceiling;

use self::ceiling::CeilingWatch;
use crate::deflection::ArmModel;
use crate::filter::LowPass;
use crate::grip::{ArmGrip, ArmState, Demand, FreeProof, HoldProof};
use crate::math;
use crate::params::Params;
use crate::tendon::{ForceLimit, TILT_CUTOFF};
use crate::wrench::PerArm;

#[cfg(test)]
mod force_tests;

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
/// Fastest rise of the force of an arm that lost touch, N/s: slow enough for the watch on unfelt contact.
const REGAIN: f32 = 30.0;
/// Force (N) that the tendon lacks, for good, where the servo is at the end of its travel or strength.
const STUCK: f32 = 8.0;
/// Cut-off of the force that an arm falls back to when its touch was lost for good, rad/s.
const USUAL_CUTOFF: f32 = 3.0;
/// Time at the force limit after which the arm counts as limited, s.
const LIMITED_AFTER: f32 = 1.0;
/// Time for which pressure and tilt must be known after a restart, s: ten frames of the servos' drives.
const RESUME_TIME: f32 = 0.2;
/// Time without a tilt after which the arm counts as faulty, s; its servo is held from the first moment.
const TILT_MISSING: f32 = 0.5;
/// Shares of the grip pressure between which no arm can fall within one step of 10 ms (its modes are below 30 Hz):
/// the sensor's lead broke.
const VANISHED_FROM: f32 = 0.3;
const VANISHED_TO: f32 = 0.02;
/// Rise of the tension (N) over which an arm that does not touch is expected to bend.
const BEND_WINDOW: f32 = 8.0;
/// Tension (N) from which that is watched: below it the tendon may still be slack, when it was knotted 1 mm too
/// long (8 N) and the tilt is wrong by 0.03 rad (6 N).
const BEND_SETTLE: f32 = 20.0;
/// Share of the expected bending below which something unfelt holds the arm: a free arm bends by 1 within its
/// model, the stiffest on the skin of a pipe by 0.4, a soft one by 0.2.
const BEND_SHARE: f32 = 0.6;
/// Time after the start of an arm that is under tension already, s, from which on that is watched.
const START_TIME: f32 = 0.4;
/// Cut-off of the tilt in that comparison, rad/s.
const BEND_CUTOFF: f32 = 20.0;

/// Why an arm is faulty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// No fresh pressure; over as soon as there is one.
    Stale,
    /// The pressure sensor failed; stays until release.
    Sensor,
    /// The arm met something that its sensor does not feel; stays until release.
    Unfelt,
    /// The force rose and the pressure, below that of a grip, did not follow: the sensor cannot read it; stays until
    /// release.
    Ceiling,
    /// The arm's tilt is missing; over when it is back.
    Tilt,
    /// A number is not finite; over when it is.
    NotFinite,
}

impl Fault {
    /// It stays until the arm is released.
    pub const fn is_latched(self) -> bool {
        matches!(self, Self::Sensor | Self::Unfelt | Self::Ceiling)
    }

    /// Text for the pilot.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Stale => "pressure reading lost",
            Self::Sensor => "pressure sensor fault",
            Self::Unfelt => "arm stopped, no pressure felt",
            Self::Ceiling => "pressure sensor at its ceiling",
            Self::Tilt => "arm tilt lost",
            Self::NotFinite => "reading is no number",
        }
    }
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
    /// The pressure, when it is known and a number; limited, so that filters cannot overflow.
    fn known(self) -> Option<f32> {
        match self {
            Self::Known(p) if p.is_finite() => Some(math::clamp(p, 0.0, 1e6)),
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
        let limit = ForceLimit::from_params(p).asked;
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
    /// After a restart, with the time for which all is known again, s: the servo stays where it is.
    Resume(f32),
    /// Felt: the pressure is controlled.
    Grip(Pid),
    Release,
}

/// State of the pressure loop.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pid {
    /// What of the force asked for before the touch the tendon did not have, on its way out, N.
    carry: (LowPass, LowPass),
    /// Force of the last third of a second in touch, N.
    usual: LowPass,
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
    from: Option<BendStart>,
    /// Time for which nothing is judged yet, s.
    wait: f32,
}

/// Where a window of the watch began.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BendStart {
    tilt: f32,
    tension: f32,
    /// Force asked for, N.
    force: f32,
}

impl BendWatch {
    fn new(tilt: f32, tension: f32) -> Self {
        Self {
            tilt: LowPass::at(tilt),
            tension: LowPass::at(tension),
            from: None,
            wait: 0.0,
        }
    }

    /// A watch of an arm that starts to move under tension: at first its tilt is late and the tension seems to rise.
    fn of_a_start(tilt: f32, tension: f32) -> Self {
        Self {
            wait: START_TIME,
            ..Self::new(tilt, tension)
        }
    }

    /// Takes note of tilt (rad), tension (N) and the force asked for (N). When the tension rose by the window
    /// but the tilt hardly fell: the force that was asked before.
    fn step(&mut self, cfg: &Config, tilt: f32, tension: f32, force: f32, dt: f32) -> Option<f32> {
        let tilt = self.tilt.step(tilt, BEND_CUTOFF, dt);
        let tension = self.tension.step(tension, BEND_CUTOFF, dt);
        let now = BendStart { tilt, tension, force };
        if self.wait > 0.0 {
            self.wait -= dt;
            return None;
        }
        let Some(from) = self.from else {
            self.from = (tension > BEND_SETTLE).then_some(now);
            return None;
        };
        let rise = tension - from.tension;
        if rise < BEND_WINDOW {
            return None;
        }
        self.from = Some(now);
        (from.tilt - tilt < BEND_SHARE * cfg.bend_per_force * rise).then_some(from.force)
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
    ceiling: CeilingWatch,
    fault: Option<Fault>,
    tilt_missing: f32,
    at_limit: f32,
    /// Pressure of the step before, unfiltered, Pa.
    felt: Option<f32>,
    hold: HoldProof,
    free: FreeProof,
}

impl ArmClamp {
    /// A closed arm of which the run before asked `force` N, with the fault that stays until release.
    pub fn resume(force: f32, fault: Option<Fault>) -> Self {
        Self {
            phase: Phase::Resume(0.0),
            force: math::clamp(force, 0.0, 1e4),
            fault: fault.filter(|f| f.is_latched()),
            ..Self::default()
        }
    }

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
            self.thrust
                .get_or_insert(LowPass::at(thrust))
                .step(thrust, THRUST_CUTOFF, dt)
        });
        let tension = input
            .tension
            .filter(|t| t.is_finite())
            .map(|t| math::clamp(t, 0.0, 1e4));
        let tilt = input.tilt.filter(|t| t.abs() <= math::PI);

        if close {
            self.close(cfg, input.pressure, pressure, thrust, tension, tilt, dt);
        } else {
            self.let_go(cfg, dt);
        }
        self.force = math::clamp(self.force, 0.0, cfg.limit);
        let known = pressure.filter(|_| self.fault.is_none());
        let free = self.free.step(&cfg.demand, pressure, tension, dt);
        if self.phase == Phase::Release && free {
            *self = Self {
                pressure: self.pressure,
                thrust: self.thrust,
                free: self.free,
                ..Self::default()
            };
        }
        let holding = match self.phase {
            Phase::Grip(_) | Phase::Approach | Phase::Resume(_) => {
                self.hold.step(&cfg.demand, known, self.force, dt)
            }
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
            fault: self.fault,
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
            Phase::Approach | Phase::Resume(_) => ArmState::Closing,
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
        self.ceiling = CeilingWatch::default();
        self.at_limit = 0.0;
        self.tilt_missing = 0.0;
        self.force = math::slew(self.force, 0.0, cfg.release * dt);
    }

    /// After a restart: once the tension is known that the servo's angle means by the new attitude (which may show every
    /// tilt 0.02 rad off the old one), the loop takes it over. Asked for the old force, the servo would jump.
    fn go_on(&mut self, cfg: &Config, seen: f32, (pressure, thrust, tilt, has): (f32, f32, f32, f32)) {
        if seen < RESUME_TIME {
            self.phase = Phase::Resume(seen);
            return;
        }
        self.force = math::clamp(has, LEAST, cfg.limit);
        self.phase = if pressure > TOUCH {
            let forward = cfg.per_thrust * thrust;
            Phase::Grip(Pid::new(self.force - forward, forward, 0.0, pressure))
        } else {
            self.watch = Some(BendWatch::of_a_start(tilt, has));
            Phase::Approach
        };
    }

    #[allow(
        clippy::too_many_arguments,
        reason = "the step's own locals, taken apart once"
    )]
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
        self.tilt_missing = if tilt.is_some() {
            0.0
        } else {
            math::clamp(self.tilt_missing + dt, 0.0, 10.0)
        };
        let latched = self.fault.is_some_and(Fault::is_latched);
        let before = core::mem::replace(&mut self.felt, sensed.known());
        let vanished = matches!(self.phase, Phase::Grip(_))
            && before.is_some_and(|p| p > VANISHED_FROM * cfg.demand.pressure)
            && sensed
                .known()
                .is_some_and(|p| p < VANISHED_TO * cfg.demand.pressure);
        self.fault = match sensed {
            _ if latched => self.fault,
            Pressure::Faulty => Some(Fault::Sensor),
            // An unloaded sensor looks like an open one, but no arm lets go within one step.
            Pressure::Known(_) if vanished => Some(Fault::Sensor),
            Pressure::Stale => Some(Fault::Stale),
            Pressure::Known(_) if pressure.is_none() || thrust.is_none() => Some(Fault::NotFinite),
            Pressure::Known(_) if self.tilt_missing >= TILT_MISSING => Some(Fault::Tilt),
            Pressure::Known(_) => None,
        };
        let (Some(pressure), Some(thrust), Some(tilt), None) = (pressure, thrust, tilt, self.fault) else {
            // The force is held, and the loop restarts from it: no wind-up, no kick.
            match self.phase {
                Phase::Grip(_) => self.phase = Phase::Approach,
                Phase::Resume(_) => self.phase = Phase::Resume(0.0),
                _ => {}
            }
            self.watch = None;
            self.ceiling.pause();
            return;
        };
        let has = tension.unwrap_or(self.force);
        if let Phase::Resume(seen) = self.phase {
            self.go_on(cfg, seen + dt, (pressure, thrust, tilt, has));
            return;
        }
        match self.phase {
            Phase::Grip(mut pid) => {
                let rise = if pressure < TOUCH { REGAIN } else { SLEW };
                let wanted = pid.step(cfg, pressure, cfg.per_thrust * thrust, self.force - has, dt);
                self.force = math::clamp(wanted, self.force - SLEW * dt, self.force + rise * dt);
                self.force = math::clamp(self.force, LEAST, cfg.limit);
                if pressure > TOUCH {
                    pid.usual.step(self.force, USUAL_CUTOFF, dt);
                }
                self.phase = Phase::Grip(pid);
            }
            _ if pressure > TOUCH => {
                let surplus = math::clamp(self.force - has, 0.0, cfg.limit);
                let forward = cfg.per_thrust * thrust;
                let base = self.force - surplus - forward;
                self.phase = Phase::Grip(Pid::new(base, forward, surplus, pressure));
            }
            _ => self.force = math::clamp(self.force + cfg.approach * dt, LEAST, cfg.limit),
        }
        if pressure > TOUCH {
            self.watch = None;
            let forward = cfg.per_thrust * thrust;
            if self
                .ceiling
                .step(cfg, pressure, has - forward, self.force - forward, dt)
            {
                self.fault = Some(Fault::Ceiling);
            }
        } else {
            self.ceiling.pause();
            let watch = self.watch.get_or_insert(BendWatch::new(tilt, has));
            if let Some(before) = watch.step(cfg, tilt, has, self.force, dt) {
                self.fault = Some(Fault::Unfelt);
                self.force = match self.phase {
                    Phase::Grip(pid) => math::clamp(pid.usual.value(), LEAST, self.force),
                    _ => before,
                };
            }
        }
        // A servo at the end of its travel, or at its stall, is a limit as good as the force's.
        let stuck = matches!(self.phase, Phase::Grip(_)) && self.force - has > STUCK;
        let limited = self.force >= cfg.demand.force || stuck;
        self.at_limit = if limited {
            math::clamp(self.at_limit + dt, 0.0, 10.0)
        } else {
            0.0
        };
    }
}

impl Pid {
    /// A loop that at the pressure `pressure` (Pa) puts out `force`, `forward` and `surplus` (N) and aims at where
    /// it is.
    ///
    /// The surplus is what the tendon lacked because the arm still moved and its tilt is known late. The arm
    /// stands still now: as the tilt catches up, the same reel position means the smaller force.
    fn new(force: f32, forward: f32, surplus: f32, pressure: f32) -> Self {
        Self {
            carry: (LowPass::at(surplus), LowPass::at(surplus)),
            usual: LowPass::at(force + forward),
            reference: pressure,
            integral: force,
            last: pressure,
            slope: LowPass::at(0.0),
        }
    }

    /// One step with the force `forward` (N) fed forward, while the tendon lags by `lag` N; returns the force.
    fn step(&mut self, cfg: &Config, pressure: f32, forward: f32, lag: f32, dt: f32) -> f32 {
        let towards = dt / (REFERENCE_TAU + dt);
        self.reference += (cfg.demand.pressure - self.reference) * towards;
        let error = self.reference - pressure;
        let slope = self
            .slope
            .step((pressure - self.last) / dt, DERIVATIVE_CUTOFF, dt);
        self.last = pressure;
        let once = self.carry.0.step(0.0, TILT_CUTOFF, dt);
        let carried = self.carry.1.step(once, TILT_CUTOFF, dt);
        let quick = cfg.p * error - cfg.d * slope + forward + carried;
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
    /// Arms whose servos are to stay where they are: a restart left them there.
    pub stay: PerArm<bool>,
    /// What is known of each grip.
    pub arms: PerArm<ArmGrip>,
    /// Every chosen arm holds (there is at least one), and all were within the tolerance at once for the dwell time.
    pub proven: bool,
    /// Every arm is free.
    pub released: bool,
}

/// The clamp loops of the four arms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clamp {
    arms: PerArm<ArmClamp>,
    /// Time for which every chosen arm has been within the tolerance at once, s.
    together: f32,
    proven: bool,
}

impl Clamp {
    /// The loops of closed arms after a restart; see [`ArmClamp::resume`]. Arms without a force were not closed.
    pub fn resume(force: PerArm<f32>, fault: PerArm<Option<Fault>>) -> Self {
        let mut arms = [ArmClamp::default(); 4];
        for ((arm, force), fault) in arms.iter_mut().zip(force).zip(fault) {
            if force > 0.0 {
                *arm = ArmClamp::resume(force, fault);
            }
        }
        Self {
            arms,
            ..Self::default()
        }
    }

    /// One step of `dt` s: closes the arms in `close`, releases the others.
    pub fn step(
        &mut self,
        cfg: &Config,
        close: PerArm<bool>,
        input: &PerArm<ArmInput>,
        dt: f32,
    ) -> ClampOutput {
        let mut out = ClampOutput {
            released: true,
            ..ClampOutput::default()
        };
        let (mut holding, mut within) = (close.contains(&true), true);
        let slots = out.force.iter_mut().zip(&mut out.stay).zip(&mut out.arms);
        for (((arm, close), input), ((force, stay), grip)) in
            self.arms.iter_mut().zip(close).zip(input).zip(slots)
        {
            *grip = arm.step(cfg, close, input, dt);
            *force = grip.force;
            *stay = matches!(arm.phase, Phase::Resume(_));
            holding &= !close || grip.state == ArmState::Holding;
            within &= !close || (grip.pressure - cfg.demand.pressure).abs() <= cfg.demand.tolerance;
            out.released &= arm.is_free(input.pressure);
        }
        // Once proven a grip is only doubted arm by arm: a push moves the pressures without loosening it.
        self.together = if within {
            math::clamp(self.together + dt, 0.0, 10.0)
        } else {
            0.0
        };
        self.proven = holding && (self.proven || self.together >= cfg.demand.dwell);
        out.proven = self.proven;
        out
    }
}

impl ArmClamp {
    /// The arm is free: released for long enough, by all that is known of it.
    fn is_free(&self, sensed: Pressure) -> bool {
        self.phase == Phase::Free && self.free.proven(sensed.known().is_some())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const DT: f32 = 0.01;

    fn config() -> Config {
        Config::from_params(&Params::default())
    }

    fn close(a: f32, b: f32, tolerance: f32) -> bool {
        (a - b).abs() <= tolerance
    }

    /// An arm that bends as it should and a tendon that has what is asked.
    fn input(cfg: &Config, arm: &ArmClamp, pressure: f32) -> ArmInput {
        ArmInput {
            pressure: Pressure::Known(pressure),
            thrust: 0.0,
            tension: Some(arm.force),
            tilt: Some(math::clamp(-0.2 - cfg.bend_per_force * arm.force, -2.5, 0.0)),
        }
    }

    fn run(arm: &mut ArmClamp, cfg: &Config, pressure: f32, seconds: f32) -> ArmGrip {
        let mut grip = ArmGrip::default();
        for _ in 0..(seconds / DT + 0.5) as u32 {
            let i = input(cfg, arm, pressure);
            grip = arm.step(cfg, true, &i, DT);
        }
        grip
    }

    /// An arm that holds at 950 Pa.
    fn holding(cfg: &Config) -> ArmClamp {
        let mut arm = ArmClamp::default();
        run(&mut arm, cfg, 0.0, 1.5);
        assert!(run(&mut arm, cfg, 950.0, 1.5).state == ArmState::Holding);
        arm
    }

    #[test]
    fn the_approach_rises_with_the_arm_s_stiffness() {
        // Infill 6.9, K 7.75: 8.2210 °/N are 0.14348 rad/N; times 0.025/0.178: 0.020152 rad/N. 0.7 rad/s
        // over that: 34.74 N/s.
        let cfg = config();
        assert!(close(cfg.bend_per_force, 0.020_152, 1e-5) && close(cfg.approach, 34.74, 0.02));
        let mut arm = ArmClamp::default();
        let grip = run(&mut arm, &cfg, 0.0, 1.0);
        // The first step starts at the least force.
        assert!(
            grip.state == ArmState::Closing && close(grip.force, 34.74, 1.1),
            "{grip:?}"
        );
    }

    #[test]
    fn a_touch_takes_the_tendon_s_own_force_over_without_a_kick() {
        let cfg = config();
        let mut arm = ArmClamp::default();
        run(&mut arm, &cfg, 0.0, 1.5);
        let asked = arm.force;
        // The tendon has 12 N less than asked. The pressure jumps to 300 Pa and stays.
        let mut last = asked;
        for _ in 0..50 {
            let i = ArmInput {
                tension: Some(asked - 12.0),
                ..input(&cfg, &arm, 300.0)
            };
            let force = arm.step(&cfg, true, &i, DT).force;
            assert!((force - last).abs() < 2.0, "{last} {force}");
            last = force;
        }
        // The surplus has gone (two filters at 25 rad/s, 0.5 s), the integral has added at most
        // 0.05·650·0.5 = 16 N, of which 40 % in the reference's first two time constants, and P 0.0035·560.
        assert!((-9.0..4.0).contains(&(last - asked)), "{}", last - asked);
    }

    #[test]
    fn a_resumed_grip_goes_on_from_its_force_without_a_kick() {
        let cfg = config();
        let before = holding(&cfg).force;
        let mut arm = ArmClamp::resume(before, None);
        // While the sensors start nothing is known, then the tilt comes before the drive's tension, which by the new
        // attitude is 4 N more.
        let has = before + 4.0;
        for (pressure, tension, tilt, seconds, force, stays) in [
            (Pressure::Stale, None, None, 0.05, before, true),
            (Pressure::Known(960.0), Some(0.5), None, 0.1, before, true),
            (Pressure::Known(960.0), Some(0.5), Some(-1.2), 0.03, before, true),
            (Pressure::Known(960.0), Some(has), Some(-1.2), 0.15, before, true),
            (Pressure::Known(960.0), Some(has), Some(-1.2), 0.5, has, false),
        ] {
            for step in 0..(seconds / DT + 0.5) as u32 {
                let i = ArmInput {
                    pressure,
                    thrust: 0.0,
                    tension,
                    tilt,
                };
                let grip = arm.step(&cfg, true, &i, DT);
                if stays || step > 2 {
                    assert!((grip.force - force).abs() < 0.5, "{} {force}", grip.force);
                    assert!(matches!(arm.phase, Phase::Resume(_)) == stays);
                }
            }
        }
        assert!(run(&mut arm, &cfg, 950.0, 1.0).state == ArmState::Holding);
    }

    #[test]
    fn a_resumed_arm_that_does_not_touch_goes_on_closing() {
        let cfg = config();
        let mut arm = ArmClamp::resume(30.0, None);
        let grip = run(&mut arm, &cfg, 0.0, 0.5);
        assert!(close(grip.force, 30.0 + 0.3 * 34.74, 1.0) && grip.state == ArmState::Closing);
        // A person may open it as any other.
        for _ in 0..100 {
            arm.step(&cfg, false, &input(&cfg, &arm, 0.0), DT);
        }
        assert!(arm.force == 0.0);
    }

    #[test]
    fn a_fault_that_stays_until_release_outlives_a_restart() {
        let cfg = config();
        for fault in [Fault::Sensor, Fault::Unfelt, Fault::Ceiling] {
            let mut arm = ArmClamp::resume(50.0, Some(fault));
            let grip = run(&mut arm, &cfg, 0.0, 3.0);
            assert!(grip.force == 50.0 && grip.fault == Some(fault), "{grip:?}");
        }
        let mut arm = ArmClamp::resume(50.0, Some(Fault::Tilt));
        assert!(run(&mut arm, &cfg, 950.0, 0.1).fault.is_none());
    }

    #[test]
    fn restart_after_restart_leaves_the_force_where_it_is() {
        let cfg = config();
        let before = holding(&cfg).force;
        let mut force = before;
        for _ in 0..200 {
            let mut arm = ArmClamp::resume(force, None);
            // 70 ms each, the first two steps without pressure.
            arm.step(&cfg, true, &ArmInput::default(), DT);
            arm.step(&cfg, true, &ArmInput::default(), DT);
            force = run(&mut arm, &cfg, 950.0, 0.05).force;
        }
        assert!((force - before).abs() < 0.5, "{before} {force}");
    }

    #[test]
    fn a_stopped_rotor_is_fed_forward() {
        let cfg = config();
        // 0.178/0.025 = 7.12 N for each newton of thrust.
        assert!(close(cfg.per_thrust, 7.12, 1e-4));
        let mut arm = ArmClamp::default();
        let step = |arm: &mut ArmClamp, pressure: f32, thrust: f32| {
            let i = ArmInput {
                thrust,
                ..input(&cfg, arm, pressure)
            };
            arm.step(&cfg, true, &i, DT).force
        };
        for _ in 0..200 {
            step(&mut arm, 0.0, 2.5);
        }
        for _ in 0..300 {
            step(&mut arm, 950.0, 2.5);
        }
        let before = arm.force;
        for _ in 0..100 {
            step(&mut arm, 950.0, 0.0);
        }
        assert!(close(before - arm.force, 17.8, 0.5), "{}", before - arm.force);
    }

    #[test]
    fn the_integral_waits_at_the_limit() {
        let cfg = config();
        let mut arm = ArmClamp::default();
        run(&mut arm, &cfg, 0.0, 1.5);
        // 6.2 Pa/N, 830 Pa at the limit: that is reached and reported.
        let mut grip = ArmGrip::default();
        for _ in 0..3000 {
            let pressure = 150.0 + 6.2 * math::clamp(arm.force - 52.0, 0.0, 1e3);
            grip = run(&mut arm, &cfg, pressure, DT);
        }
        assert!(
            grip.state == ArmState::ForceLimited && close(grip.force, cfg.limit, 1e-2),
            "{grip:?}"
        );
        // And left at once when the pressure comes, not after unwinding 30 s.
        assert!(run(&mut arm, &cfg, 1200.0, 0.3).force < cfg.limit - 2.0);
    }

    /// What a sensor reads of `pressure` on a pad of which the converter sees a `part` of the voltage, Pa: with
    /// P = pressure / 692.5 Pa the pad has P / (1 + P) of the supply.
    fn behind(part: f32, pressure: f32) -> f32 {
        let x = part * pressure / (692.5 + pressure);
        692.5 * x / (1.0 - x)
    }

    /// Closes an arm on a skin of 70 Pa/N that it meets at 52 N, its sensor read through `sensor`.
    fn closing_on_a_skin(sensor: impl Fn(f32) -> f32) -> (ArmClamp, ArmGrip) {
        let cfg = config();
        let mut arm = ArmClamp::default();
        let mut grip = ArmGrip::default();
        for _ in 0..1500 {
            let pressure = 70.0 * math::clamp(arm.force - 52.0, 0.0, 1e3);
            grip = run(&mut arm, &cfg, sensor(pressure), DT);
        }
        (arm, grip)
    }

    #[test]
    fn a_sensor_that_cannot_read_the_grip_pressure_stops_the_winding() {
        let (_, grip) = closing_on_a_skin(|pressure| pressure);
        assert!(grip.state == ArmState::Holding, "{grip:?}");
        // Behind 1:2 the reading ends at 692 Pa. By 40 N of tension on the skin it rises by less than 6 Pa/N.
        let (mut arm, grip) = closing_on_a_skin(|pressure| behind(0.5, pressure));
        assert!(
            grip.fault == Some(Fault::Ceiling) && grip.force < 52.0 + 50.0,
            "{grip:?}"
        );
        assert!(grip.state == ArmState::Faulty && grip.pressure < 692.5);
        // It stays, and the force with it, until the arm is released.
        let cfg = config();
        let later = run(&mut arm, &cfg, 950.0, 3.0);
        assert!(later.fault == Some(Fault::Ceiling) && later.force == grip.force);
        arm.step(&cfg, false, &input(&cfg, &arm, 500.0), DT);
        assert!(arm.fault().is_none());
        // Whatever sits still, wherever.
        for ceiling in [150.0, 400.0, 800.0] {
            let (_, grip) = closing_on_a_skin(|pressure| math::clamp(pressure, 0.0, ceiling));
            assert!(grip.fault == Some(Fault::Ceiling), "{ceiling}: {grip:?}");
            assert!(grip.force < 52.0 + 35.0, "{ceiling}: {grip:?}");
        }
    }

    #[test]
    fn a_sensor_that_has_read_the_grip_pressure_has_the_range() {
        let cfg = config();
        let mut arm = holding(&cfg);
        let force = arm.force;
        // The load pulls the arm away from the pipe as fast as the tendon pulls it back.
        let grip = run(&mut arm, &cfg, 700.0, 3.0);
        assert!(grip.force > force + 20.0 && grip.fault.is_none(), "{grip:?}");
    }

    #[test]
    fn a_rotor_that_starts_is_no_ceiling() {
        let cfg = config();
        let mut arm = ArmClamp::default();
        let mut grip = ArmGrip::default();
        for step in 0..1500 {
            // 0.1 s after the touch the rotor asks for 5 N, 35.6 N of the tendon's: the skin feels none of them.
            let thrust = if step > 160 { 5.0 } else { 0.0 };
            let pressure = 70.0 * math::clamp(arm.force - cfg.per_thrust * thrust - 52.0, 0.0, 1e3);
            let i = ArmInput {
                thrust,
                ..input(&cfg, &arm, if step > 150 { pressure + 120.0 } else { pressure })
            };
            grip = arm.step(&cfg, true, &i, DT);
        }
        assert!(grip.state == ArmState::Holding, "{grip:?}");
    }

    #[test]
    fn a_servo_at_the_end_of_its_travel_is_reported_and_not_wound_up() {
        let cfg = config();
        let mut arm = holding(&cfg);
        let stuck = arm.force;
        let mut grip = ArmGrip::default();
        for _ in 0..1000 {
            let i = ArmInput {
                tension: Some(stuck),
                ..input(&cfg, &arm, 700.0)
            };
            grip = arm.step(&cfg, true, &i, DT);
        }
        assert!(
            grip.state == ArmState::ForceLimited && grip.force < stuck + LAG + 5.0,
            "{grip:?}"
        );
    }

    #[test]
    fn stale_pressure_holds_and_goes_on_without_a_jump() {
        let cfg = config();
        let mut arm = holding(&cfg);
        let force = arm.force;
        for _ in 0..100 {
            let i = ArmInput {
                pressure: Pressure::Stale,
                ..input(&cfg, &arm, 0.0)
            };
            let grip = arm.step(&cfg, true, &i, DT);
            assert!(grip.state == ArmState::Faulty && close(grip.force, force, 1e-6));
        }
        assert!(arm.fault() == Some(Fault::Stale));
        let grip = run(&mut arm, &cfg, 950.0, 0.1);
        assert!(
            grip.state == ArmState::Touching && close(grip.force, force, 1.0),
            "{grip:?}"
        );
        assert!(run(&mut arm, &cfg, 950.0, 1.5).state == ArmState::Holding);
    }

    #[test]
    fn a_failed_sensor_stays_failed_until_release() {
        let cfg = config();
        let mut arm = holding(&cfg);
        let force = arm.force;
        let i = ArmInput {
            pressure: Pressure::Faulty,
            ..input(&cfg, &arm, 0.0)
        };
        assert!(arm.step(&cfg, true, &i, DT).state == ArmState::Faulty);
        assert!(run(&mut arm, &cfg, 950.0, 5.0).state == ArmState::Faulty);
        assert!(arm.fault() == Some(Fault::Sensor) && close(arm.force, force, 1e-6));
        let i = input(&cfg, &arm, 950.0);
        assert!(arm.step(&cfg, false, &i, DT).state == ArmState::Releasing && arm.fault().is_none());
    }

    #[test]
    fn numbers_that_are_none_hold_the_force() {
        let cfg = config();
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut arm = holding(&cfg);
            let force = arm.force;
            let i = input(&cfg, &arm, 950.0);
            for i in [
                ArmInput {
                    pressure: Pressure::Known(bad),
                    ..i
                },
                ArmInput { thrust: bad, ..i },
            ] {
                let grip = arm.step(&cfg, true, &i, DT);
                assert!(grip.state == ArmState::Faulty && close(grip.force, force, 1e-6));
                assert!(arm.fault() == Some(Fault::NotFinite));
            }
        }
    }

    #[test]
    fn a_missing_tilt_holds_at_once_and_is_faulty_when_it_lasts() {
        let cfg = config();
        let mut arm = holding(&cfg);
        let force = arm.force;
        let mut blind = |seconds: f32| {
            let mut grip = ArmGrip::default();
            for _ in 0..(seconds / DT + 0.5) as u32 {
                let i = ArmInput {
                    tilt: None,
                    ..input(&cfg, &arm, 900.0)
                };
                grip = arm.step(&cfg, true, &i, DT);
            }
            (grip, arm.fault())
        };
        let (grip, fault) = blind(0.4);
        assert!(grip.state == ArmState::Holding && close(grip.force, force, 1e-6) && fault.is_none());
        let (grip, fault) = blind(0.2);
        assert!(grip.state == ArmState::Faulty && close(grip.force, force, 1e-6));
        assert!(fault == Some(Fault::Tilt));
    }

    #[test]
    fn an_arm_that_stands_still_under_a_rising_force_without_pressure_is_faulty() {
        let cfg = config();
        let mut arm = ArmClamp::default();
        run(&mut arm, &cfg, 0.0, 1.0);
        let (force, tilt) = (arm.force, -0.2 - cfg.bend_per_force * arm.force);
        let mut largest = 0.0;
        for _ in 0..500 {
            let i = ArmInput {
                tilt: Some(tilt),
                ..input(&cfg, &arm, 0.0)
            };
            let grip = arm.step(&cfg, true, &i, DT);
            largest = if grip.force > largest { grip.force } else { largest };
        }
        assert!(arm.fault() == Some(Fault::Unfelt) && largest < force + 20.0);
        // Taken back to before the rise that nothing came of.
        assert!(arm.force < force + 8.0);
    }

    #[test]
    fn release_falls_at_its_rate_and_ends_free() {
        let cfg = config();
        let mut arm = holding(&cfg);
        let from = arm.force;
        let mut time = 0.0;
        while arm.force > 0.0 {
            let i = input(&cfg, &arm, 500.0);
            assert!(arm.step(&cfg, false, &i, DT).state == ArmState::Releasing);
            time += DT;
            assert!(time < 5.0);
        }
        assert!(close(time, from / 80.0, 0.03));
        // Pressed still: not free. Light and wound back: free after the dwell.
        for (pressure, state) in [(500.0, ArmState::Releasing), (0.0, ArmState::Free)] {
            let mut grip = ArmGrip::default();
            for _ in 0..50 {
                grip = arm.step(&cfg, false, &input(&cfg, &arm, pressure), DT);
            }
            assert!(grip.state == state, "{grip:?}");
        }
    }

    #[test]
    fn every_chosen_arm_must_hold_and_every_arm_be_free() {
        let cfg = config();
        let mut clamp = Clamp::default();
        let front = [true, false, true, false];
        let mut out = ClampOutput::default();
        let drive = |clamp: &mut Clamp, close: PerArm<bool>, pressure: PerArm<f32>, seconds: f32| {
            let mut out = ClampOutput::default();
            for _ in 0..(seconds / DT) as u32 {
                let mut inputs = [ArmInput::default(); 4];
                for ((i, arm), p) in inputs.iter_mut().zip(&clamp.arms).zip(pressure) {
                    *i = input(&cfg, arm, p);
                }
                out = clamp.step(&cfg, close, &inputs, DT);
            }
            out
        };
        for (pressures, proven) in [
            ([0.0; 4], false),
            ([950.0, 0.0, 880.0, 0.0], false),
            ([950.0, 0.0, 950.0, 0.0], true),
        ] {
            out = drive(&mut clamp, front, pressures, 1.5);
            assert!(out.proven == proven && !out.released, "{out:?}");
        }
        assert!(
            out.arms.map(|a| a.state)
                == [
                    ArmState::Holding,
                    ArmState::Free,
                    ArmState::Holding,
                    ArmState::Free
                ]
        );
        out = drive(&mut clamp, [false; 4], [0.0, 0.0, 300.0, 0.0], 5.0);
        assert!(!out.released && !out.proven);
        // Not once one arm has left the tolerance again before the other came: only when both are in it.
        let mut clamp = Clamp::default();
        for (pressures, proven) in [
            ([0.0; 4], false),
            ([950.0, 0.0, 880.0, 0.0], false),
            ([1020.0, 0.0, 950.0, 0.0], false),
            ([960.0, 0.0, 950.0, 0.0], true),
            ([1020.0, 0.0, 950.0, 0.0], true),
        ] {
            out = drive(&mut clamp, front, pressures, 1.5);
            assert!(out.proven == proven, "{pressures:?} {out:?}");
        }
        out = drive(&mut clamp, [false; 4], [0.0, 0.0, 300.0, 0.0], 5.0);
        assert!(!out.released && !out.proven);
        out = drive(&mut clamp, [false; 4], [0.0; 4], 1.0);
        assert!(out.released && !out.proven);
    }

    fn any_pressure() -> impl Strategy<Value = Pressure> {
        prop_oneof![
            proptest::num::f32::ANY.prop_map(Pressure::Known),
            (0.0f32..2000.0).prop_map(Pressure::Known),
            Just(Pressure::Stale),
            Just(Pressure::Faulty),
        ]
    }

    proptest! {
        #[test]
        fn the_force_stays_within_its_bounds(
            steps in proptest::collection::vec(
                (
                    any::<bool>(), any_pressure(), proptest::num::f32::ANY,
                    proptest::option::of(proptest::num::f32::ANY),
                    proptest::option::of(prop_oneof![proptest::num::f32::ANY, -2.0f32..0.5]),
                    prop_oneof![proptest::num::f32::ANY, 0.005f32..0.02],
                ),
                1..200,
            ),
        ) {
            let cfg = config();
            let mut arm = ArmClamp::default();
            for (close, pressure, thrust, tension, tilt, dt) in steps {
                let grip = arm.step(&cfg, close, &ArmInput { pressure, thrust, tension, tilt }, dt);
                prop_assert!(grip.force >= 0.0 && grip.force <= cfg.limit(), "{grip:?}");
                prop_assert!(grip.pressure.is_finite());
                prop_assert!(grip.closure.is_none_or(f32::is_finite));
            }
        }
    }
}
