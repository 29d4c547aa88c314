//! Fourth stage: the arms' tilt, allocation, motor commands.

#[cfg(test)]
mod tests;

use crate::bench::Spin;
use crate::chain::{Demand, MixOutput, StepClock};
use crate::mixer::{Allocation, Conditions, Flexible};
use crate::params::Params;
use crate::thrust_curve::ThrustCurve;
use crate::tilt::TiltModel;
use crate::wrench::PerArm;

/// What the arms' own sensors measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmReading {
    /// When, µs.
    pub at_us: u64,
    /// Tilt of each arm, rad, tip up positive; `None` when its sensor gave nothing.
    pub tilt: PerArm<Option<f32>>,
}

/// What is known of the vehicle besides the demand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Battery voltage over nominal, the last that was measured, however old: still the best guess. Without any, nominal.
    pub battery_ratio: Option<f32>,
    /// The last reading of the arms' sensors, `None` for each that is too old; those that were taken may be left out.
    pub arms: Option<ArmReading>,
}

/// Allocation with the arms' readings and the motors' curve.
#[derive(Clone, Debug)]
pub struct Mixing<A = Flexible> {
    /// From wrench to thrusts.
    pub allocation: A,
    /// From thrusts to commands.
    pub curve: ThrustCurve,
    clock: StepClock,
    readings: Readings,
}

impl<A: Allocation> Mixing<A> {
    /// Mixing by `allocation`, rotors stopped.
    pub fn new(p: &Params, allocation: A) -> Self {
        Self {
            allocation,
            curve: ThrustCurve::from_params(p),
            clock: StepClock::default(),
            readings: Readings::default(),
        }
    }

    /// True for readings that are newer than those taken last, measured at `at_us` µs.
    #[inline(always)]
    pub fn awaits(&self, at_us: u64) -> bool {
        at_us > self.readings.seen_us
    }

    /// Commands for `demand`, whose sample was ready at `at_us` µs, in the place that keeps them: a message this long is
    /// dear to copy.
    #[inline(always)]
    pub fn step(&mut self, at_us: u64, demand: &Demand, surroundings: &Surroundings, out: &mut MixOutput) {
        A::step_mixing(self, at_us, demand, surroundings, out);
    }

    /// What [`Allocation::step_mixing`] does.
    #[inline(always)]
    pub(crate) fn compose(
        &mut self,
        at_us: u64,
        demand: &Demand,
        surroundings: &Surroundings,
        out: &mut MixOutput,
    ) {
        let dt = self.clock.step(at_us);
        let ratio = surroundings.battery_ratio.unwrap_or(1.0);
        // On the pipe the arms do not hang free.
        if !matches!(demand, Demand::Resting(_)) {
            self.readings.take(surroundings.arms.as_ref());
        }
        self.readings.correct_one(self.allocation.tilt_mut());
        let (wrench, yaw) = match demand {
            Demand::Wrench(wrench) => (Some(wrench), true),
            Demand::Resting(wrench) => (Some(wrench), false),
            Demand::Idle | Demand::Stop | Demand::Spin(_) => (None, false),
        };
        let conditions = Conditions {
            yaw,
            battery_ratio: ratio,
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
        if let Demand::Spin(spin) = demand {
            on_bench(out, spin);
        }
    }
}

/// One motor in place of the idling four. Apart from the flying, which must not pay for it.
#[cold]
#[inline(never)]
fn on_bench(out: &mut MixOutput, spin: &Spin) {
    out.thrusts = [0.0; 4];
    out.commands = spin.commands();
}

/// The readings of the arms' sensors that have not corrected their arm yet.
#[derive(Clone, Copy, Debug, Default)]
struct Readings {
    /// When those taken last were measured, µs.
    seen_us: u64,
    tilt: PerArm<Option<f32>>,
    /// Arm whose turn it is; 4 when all have had theirs.
    arm: usize,
}

impl Readings {
    /// Takes each reading once.
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

    /// One arm a step: all four in one would make it longer than the others.
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
