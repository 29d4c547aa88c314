//! Controller of one arm: free, approach, grip, release, and its faults.

use super::bend_watch::{BendSample, BendWatch, Response};
use super::ceiling_watch::{CeilingSample, CeilingWatch};
use super::input::{Contact, InputFilters, Measured};
use super::pressure_loop::PressureLoop;
use super::{ArmInput, Config, FORCE_MIN, Pressure};
use crate::gripper::grip::{ArmGrip, ArmState, FreeProof, GripProof};
use crate::gripper::grip_fault::GripFault;
use crate::gripper::grip_geometry::BENT_MIN;
use crate::maths::scalar;

/// Largest force rate of a touching arm, N/s.
const FORCE_RATE_MAX: f32 = 300.0;
/// Largest force rise after a lost touch, N/s: slow enough for the bend watch.
const REGAIN_RATE_MAX: f32 = 30.0;
/// Lag of a servo at the end of its travel or strength, N.
const LAG_STUCK: f32 = 8.0;
/// Time at the force limit before the arm counts as limited, s.
const LIMITED_AFTER: f32 = 1.0;
/// Time of known pressure and tilt after a restart, s: ten servo frames of 20 ms.
const RESUME_TIME: f32 = 0.2;
/// Time without a tilt until a fault, s; the servo is held at once.
const TILT_MISSING_MAX: f32 = 0.5;
/// A fall between these shares of the grip pressure within one step of 10 ms means a broken sensor lead: an arm's modes
/// are below 30 Hz. Below its turn-on force a sensor reads 0: so that a bounce across it counts as no break, the first
/// share is counted from there, up to a share below a grip's least pressure.
const VANISHED_FROM_SHARE: f32 = 0.3;
const VANISHED_FROM_SHARE_MAX: f32 = 0.85;
const VANISHED_TO_SHARE: f32 = 0.02;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Phase {
    #[default]
    Free,
    /// Bending down without touch.
    Approach,
    /// After a restart, servo held, with the time of known inputs, s.
    Resume(f32),
    /// Touched: the pressure is controlled.
    Grip(PressureLoop),
    Release,
}

/// Controller of one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmGripper {
    pub(super) phase: Phase,
    /// Force asked of the tendon, N.
    pub(super) force: f32,
    filters: InputFilters,
    bend_watch: Option<BendWatch>,
    /// Learnt in this closing.
    pub(super) response: Response,
    ceiling_watch: CeilingWatch,
    fault: Option<GripFault>,
    /// Time without a tilt, s.
    tilt_missing: f32,
    /// Time at the force limit, s.
    at_limit: f32,
    /// Last unfiltered pressure, Pa.
    last_pressure: Option<f32>,
    proof: GripProof,
    free: FreeProof,
}

impl ArmGripper {
    /// Resumes a closed arm with the retained `force` (N), a latched `fault`, which lasts until release, and the learnt
    /// `response`.
    pub fn resume(force: f32, fault: Option<GripFault>, response: Option<f32>) -> Self {
        Self {
            phase: Phase::Resume(0.0),
            force: scalar::clamp(force, 0.0, 1e4),
            fault: fault.filter(|f| f.is_latched()),
            response: Response::resumed(response),
            ..Self::default()
        }
    }

    /// One step of `dt` s. The force stays within 0 and the limit for any input.
    pub fn step(&mut self, cfg: &Config, input: &ArmInput, dt: f32) -> ArmGrip {
        let dt = scalar::clamp(dt, 1e-4, 0.1);
        let measured = self.filters.step(input, dt);
        if input.close {
            self.close(cfg, &measured, dt);
        } else {
            self.release(cfg, dt);
        }
        self.force = scalar::clamp(self.force, 0.0, cfg.limit);
        let free = self
            .free
            .step(&cfg.demand, measured.pressure, measured.tension, dt);
        let pressure = measured.pressure.filter(|_| self.fault.is_none());
        if self.phase == Phase::Release && free {
            *self = Self {
                filters: self.filters,
                free: self.free,
                ..Self::default()
            };
        }
        let holding = match self.phase {
            Phase::Grip(_) | Phase::Approach | Phase::Resume(_) => {
                self.proof.step(&cfg.demand, pressure, self.force, dt)
            }
            Phase::Free | Phase::Release => {
                self.proof = GripProof::default();
                false
            }
        };
        ArmGrip {
            state: self.state(holding),
            pressure: self.filters.pressure(),
            force: self.force,
            closure: self.proof.closure(),
            fault: self.fault,
            response: self.response.known(),
        }
    }

    /// Present fault.
    pub fn fault(&self) -> Option<GripFault> {
        self.fault
    }

    /// The pressure is settled at the grip pressure.
    pub(super) fn is_settled(&self, cfg: &Config) -> bool {
        self.proof.settled(&cfg.demand)
    }

    pub(super) fn holds_position(&self) -> bool {
        matches!(self.phase, Phase::Resume(_))
    }

    pub(super) fn is_free(&self, sensed: Pressure) -> bool {
        self.phase == Phase::Free && self.free.proven(sensed.known().is_some())
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

    fn release(&mut self, cfg: &Config, dt: f32) {
        if self.phase != Phase::Free {
            self.phase = Phase::Release;
        }
        self.fault = None;
        self.bend_watch = None;
        self.ceiling_watch = CeilingWatch::default();
        self.at_limit = 0.0;
        self.tilt_missing = 0.0;
        self.force = scalar::slew(self.force, 0.0, cfg.release_rate * dt);
    }

    fn close(&mut self, cfg: &Config, measured: &Measured, dt: f32) {
        if matches!(self.phase, Phase::Free | Phase::Release) {
            self.phase = Phase::Approach;
            self.proof = GripProof::default();
            self.free = FreeProof::default();
        }
        self.tilt_missing = if measured.tilt.is_some() {
            0.0
        } else {
            scalar::clamp(self.tilt_missing + dt, 0.0, 10.0)
        };
        self.fault = self.input_fault(cfg, measured);
        self.last_pressure = measured.sensed.known();
        let Some(contact) = self.contact(cfg, measured) else {
            self.pause();
            return;
        };
        if let Phase::Resume(seen) = self.phase {
            self.take_over(cfg, &contact, seen + dt);
            return;
        }
        self.control(cfg, &contact, dt);
        if contact.touches() {
            self.watch_ceiling(cfg, &contact, dt);
        } else {
            self.watch_bending(cfg, &contact, dt);
        }
        // A servo at its end or stall counts as a force limit.
        let stuck = matches!(self.phase, Phase::Grip(_)) && self.force - contact.tension > LAG_STUCK;
        let limited = self.force >= cfg.provable() / cfg.limit * self.most(cfg, &contact) || stuck;
        self.at_limit = if limited {
            scalar::clamp(self.at_limit + dt, 0.0, 10.0)
        } else {
            0.0
        };
    }

    fn input_fault(&self, cfg: &Config, measured: &Measured) -> Option<GripFault> {
        let latched = self.fault.is_some_and(GripFault::is_latched);
        let pressure = measured.sensed.known();
        let from = measured.turn_on + VANISHED_FROM_SHARE * cfg.demand.pressure;
        let from = scalar::clamp(from, 0.0, VANISHED_FROM_SHARE_MAX * cfg.demand.pressure);
        let vanished = matches!(self.phase, Phase::Grip(_))
            && self.last_pressure.is_some_and(|p| p > from)
            && pressure.is_some_and(|p| p < VANISHED_TO_SHARE * cfg.demand.pressure);
        match measured.sensed {
            _ if latched => self.fault,
            Pressure::Faulty => Some(GripFault::Sensor),
            // An unloaded sensor reads as open, but no arm lets go in one step.
            Pressure::Known(_) if vanished => Some(GripFault::Sensor),
            Pressure::Stale => Some(GripFault::Stale),
            Pressure::Known(_) if measured.pressure.is_none() || measured.thrust.is_none() => {
                Some(GripFault::NotFinite)
            }
            Pressure::Known(_) if self.tilt_missing >= TILT_MISSING_MAX => Some(GripFault::Tilt),
            Pressure::Known(_) => None,
        }
    }

    /// Input of the loop; `None` if incomplete or the arm is faulty.
    fn contact(&self, cfg: &Config, measured: &Measured) -> Option<Contact> {
        if self.fault.is_some() {
            return None;
        }
        Some(Contact {
            pressure: measured.pressure?,
            feed_forward: cfg.per_thrust * measured.thrust?,
            lifted: measured.thrust? / cfg.thrust_per_force,
            tension: measured.tension.unwrap_or(self.force),
            tilt: measured.tilt?,
        })
    }

    /// Holds the force, from which the loop restarts bumplessly.
    fn pause(&mut self) {
        match self.phase {
            Phase::Grip(_) => self.phase = Phase::Approach,
            Phase::Resume(_) => self.phase = Phase::Resume(0.0),
            _ => {}
        }
        self.bend_watch = None;
        self.ceiling_watch.pause();
    }

    /// After a restart: once tension and tilt have been known for [`RESUME_TIME`], seeds the force from the tension by
    /// the new attitude, which may shift every tilt by 0.02 rad. The old force would make the servo jump.
    fn take_over(&mut self, cfg: &Config, contact: &Contact, seen: f32) {
        if seen < RESUME_TIME {
            self.phase = Phase::Resume(seen);
            return;
        }
        self.force = scalar::clamp(contact.tension, FORCE_MIN, cfg.limit);
        self.phase = if contact.touches() {
            Phase::Grip(PressureLoop::new(contact, self.force, 0.0))
        } else {
            self.bend_watch = Some(BendWatch::of_a_start(&self.bend_sample(contact)));
            Phase::Approach
        };
        // The arm may lie on the pipe although its sensor shows no touch.
        if !self.response.is_known() {
            self.response = Response::ASSUMED;
        }
    }

    /// Controls the pressure after touch, raises the force by the arm's stiffness before.
    fn control(&mut self, cfg: &Config, contact: &Contact, dt: f32) {
        let lag = self.force - contact.tension;
        match self.phase {
            Phase::Grip(mut pressure_loop) => {
                let rise = if contact.pressure < super::TOUCH_PRESSURE {
                    REGAIN_RATE_MAX
                } else {
                    FORCE_RATE_MAX
                };
                let wanted = pressure_loop.step(cfg, contact, lag, dt);
                self.force = scalar::clamp(wanted, self.force - FORCE_RATE_MAX * dt, self.force + rise * dt);
                self.force = scalar::clamp(self.force, FORCE_MIN, cfg.limit);
                if contact.touches() {
                    pressure_loop.note_force(self.force, dt);
                }
                self.phase = Phase::Grip(pressure_loop);
            }
            _ if contact.touches() => {
                let transient = scalar::clamp(lag, 0.0, cfg.limit);
                self.phase = Phase::Grip(PressureLoop::new(contact, self.force, transient));
            }
            _ => {
                let rise = cfg.approach_rate / self.response.arm() * dt;
                self.force = scalar::clamp(self.force + rise, FORCE_MIN, self.most(cfg, contact));
            }
        }
    }

    /// Largest force, N. An arm that an obstacle has held since it was open bends as one on a soft tendon: until it is
    /// bent as round the widest pipe that fits, the reel goes no further than the parameters' stiffness allows, but for
    /// the rotor's thrust.
    fn most(&self, cfg: &Config, contact: &Contact) -> f32 {
        let open = -contact.tilt < BENT_MIN * cfg.pipe_bend;
        let blocked = open && !matches!(self.phase, Phase::Grip(_));
        if blocked {
            let against_thrust = contact.lifted.min(cfg.limit);
            (cfg.limit * self.response.tendon() + against_thrust).min(cfg.limit)
        } else {
            cfg.limit
        }
    }

    fn watch_ceiling(&mut self, cfg: &Config, contact: &Contact, dt: f32) {
        self.bend_watch = None;
        let sample = CeilingSample {
            pressure: contact.pressure,
            tension: contact.tension - contact.feed_forward,
            force: self.force - contact.feed_forward,
        };
        if self.ceiling_watch.step(cfg, sample, dt) {
            self.fault = Some(GripFault::Ceiling);
        }
    }

    fn bend_sample(&self, contact: &Contact) -> BendSample {
        BendSample {
            tilt: contact.tilt,
            load: contact.tension - contact.lifted,
            tension: contact.tension,
            force: self.force,
        }
    }

    /// An arm without touch must bend as the force rises; otherwise the force returns to its previous value.
    fn watch_bending(&mut self, cfg: &Config, contact: &Contact, dt: f32) {
        self.ceiling_watch.pause();
        let sample = self.bend_sample(contact);
        let free = self.phase == Phase::Approach;
        let watch = self.bend_watch.get_or_insert(BendWatch::new(&sample));
        let known = self.response;
        if let Some(before) = watch.step(cfg, sample, &mut self.response, free, dt) {
            self.fault = Some(GripFault::Unfelt);
            self.force = match self.phase {
                Phase::Grip(pressure_loop) => {
                    scalar::clamp(pressure_loop.mean_force(), FORCE_MIN, self.force)
                }
                _ => before,
            };
        }
        if self.response != known {
            // The reel stays: the same way is another force.
            self.force *= self.response.tendon() / known.tendon();
            self.bend_watch = Some(BendWatch::of_a_learnt_stiffness(&sample));
        }
    }
}
