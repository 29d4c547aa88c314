//! Fourth stage, 1 kHz: tilt of the arms, allocation, motor commands.

#[cfg(test)]
mod tests;

use super::messages::{Demand, MixOutput};
use super::step_clock::StepClock;
use crate::allocation::arm_tilt::TiltModel;
use crate::allocation::mixer::{Allocation, Conditions, Flexible};
use crate::allocation::thrust_curve::ThrustCurve;
use crate::allocation::wrench::PerArm;
use crate::maths::scalar;
use crate::params::Params;

/// Measurement of the arms' sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmReading {
    /// Time of measurement, µs.
    pub at_us: u64,
    /// Tilt of each arm, rad, tip up positive; `None` without reading.
    pub tilt: PerArm<Option<f32>>,
}

/// Inputs besides the demand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// [`voltage_ratio`](crate::allocation::thrust_curve::voltage_ratio) of the last battery voltage, of any age; `None`
    /// means nominal.
    pub battery_ratio: Option<f32>,
    /// Root of the thrust that the rotors give over that of the parameters; `None` means 1.
    pub thrust_root: Option<f32>,
    /// Last reading of the arms' sensors, `None` where too old; taken readings may be omitted.
    pub arms: Option<ArmReading>,
}

/// An allocation with the whole step of the stage.
///
/// Generic code is built with its caller, on a board for size. The flying allocation repeats the method without inlining,
/// to be built with this crate for speed.
pub trait MixingStep: Allocation + Sized {
    /// One step of the `mixing` that owns this allocation.
    #[inline(always)]
    fn step_mixing(
        mixing: &mut Mixing<Self>,
        at_us: u64,
        demand: &Demand,
        surroundings: &Surroundings,
        out: &mut MixOutput,
    ) {
        mixing.compose(at_us, demand, surroundings, out);
    }
}

impl MixingStep for Flexible {
    #[inline(never)]
    fn step_mixing(
        mixing: &mut Mixing<Self>,
        at_us: u64,
        demand: &Demand,
        surroundings: &Surroundings,
        out: &mut MixOutput,
    ) {
        mixing.compose(at_us, demand, surroundings, out);
    }
}

/// Allocation, arm readings and motor curve.
#[derive(Clone, Debug)]
pub struct Mixing<A = Flexible> {
    /// From wrench to thrusts.
    pub allocation: A,
    /// From thrusts to commands.
    pub curve: ThrustCurve,
    clock: StepClock,
    readings: Readings,
}

impl<A: MixingStep> Mixing<A> {
    /// Mixing by `allocation`, rotors stopped.
    pub fn new(p: &Params, allocation: A) -> Self {
        Self {
            allocation,
            curve: ThrustCurve::from_params(p),
            clock: StepClock::default(),
            readings: Readings::default(),
        }
    }

    /// True for readings at `at_us` µs that are newer than those taken.
    #[inline(always)]
    pub fn awaits(&self, at_us: u64) -> bool {
        at_us > self.readings.seen_us
    }

    /// Writes the commands for `demand`, whose sample was ready at `at_us` µs, into `out`, as so long a message is
    /// costly to copy.
    #[inline(always)]
    pub fn step(&mut self, at_us: u64, demand: &Demand, surroundings: &Surroundings, out: &mut MixOutput) {
        A::step_mixing(self, at_us, demand, surroundings, out);
    }

    /// Default body of [`MixingStep::step_mixing`].
    #[inline(always)]
    fn compose(&mut self, at_us: u64, demand: &Demand, surroundings: &Surroundings, out: &mut MixOutput) {
        let dt = self.clock.step(at_us);
        let root = surroundings.thrust_root.unwrap_or(1.0);
        let battery_ratio = surroundings.battery_ratio.unwrap_or(1.0);
        let ratio = battery_ratio * root;
        // On the pipe the arms do not hang free.
        if !matches!(demand, Demand::Resting(_)) {
            self.readings.take(surroundings.arms.as_ref());
        }
        self.readings.correct_one(self.allocation.tilt_mut());
        let (wrench, yaw) = match demand {
            Demand::Wrench(wrench) => (Some(wrench), true),
            Demand::Resting(wrench) => (Some(wrench), false),
            Demand::Idle | Demand::Stop | Demand::Spin(_) | Demand::StaticThrust(_) => (None, false),
        };
        let conditions = Conditions {
            yaw,
            // The surplus of a fresh battery stays in reserve, that of strong rotors does not.
            thrust_ratio: scalar::clamp(battery_ratio, 0.0, 1.0) * root,
            dt,
        };
        let mix = match wrench {
            Some(wrench) => self.allocation.mix(wrench, conditions),
            None => self.allocation.idle(dt),
        };
        let running = *demand != Demand::Stop;
        let (thrusts, commands) = if running {
            (mix.thrusts, self.curve.commands(&mix.thrusts, ratio))
        } else {
            ([0.0; 4], [0.0; 4])
        };
        let tilt = self.allocation.tilt();
        *out = MixOutput {
            running,
            thrusts,
            commands,
            given: mix.given,
            yaw_gated: mix.yaw_gated,
            tilt: tilt.tilt(),
            tilt_bias: tilt.bias(),
            tilt_fault: tilt.fault(),
        };
        let least = self.curve.least_command();
        match demand {
            Demand::Spin(spin) => on_bench(out, spin.commands(least)),
            Demand::StaticThrust(thrust) => on_bench(out, thrust.commands(least)),
            _ => (),
        }
    }
}

/// The commands of a motor test instead of four idling rotors, out of the flight path.
#[cold]
#[inline(never)]
fn on_bench(out: &mut MixOutput, commands: PerArm<f32>) {
    out.thrusts = [0.0; 4];
    out.commands = commands;
}

#[derive(Clone, Copy, Debug, Default)]
struct Readings {
    /// Time of the last readings taken, µs.
    seen_us: u64,
    tilt: PerArm<Option<f32>>,
    /// Next arm to correct; 4 when all are done.
    arm: usize,
}

impl Readings {
    #[inline(always)]
    fn take(&mut self, arms: Option<&ArmReading>) {
        if let Some(arms) = arms
            && arms.at_us > self.seen_us
        {
            *self = Self {
                seen_us: arms.at_us,
                tilt: arms.tilt,
                arm: 0,
            };
        }
    }

    /// Corrects one arm a step, to keep steps equal.
    #[inline(always)]
    fn correct_one(&mut self, model: &mut TiltModel) {
        let Some(reading) = self.tilt.get(self.arm) else {
            return;
        };
        if let Some(tilt) = reading {
            model.correct(self.arm, *tilt);
        }
        self.arm += 1;
    }
}
