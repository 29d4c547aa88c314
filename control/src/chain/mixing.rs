//! Fourth stage: the arms' tilt, allocation, motor commands.

use core::array::IntoIter;
use core::iter::Enumerate;

use crate::chain::{Demand, MixOutput, StepClock};
use crate::mixer::{Allocation, Conditions, Flexible};
use crate::params::Params;
use crate::thrust_curve::ThrustCurve;
use crate::wrench::{PerArm, Wrench};

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
    /// The last reading of the arms' sensors, unless it is too old.
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
    /// When the readings taken last were measured, µs, and those that have not corrected their arm yet.
    seen_us: u64,
    readings: Enumerate<IntoIter<Option<f32>, 4>>,
}

impl<A: Allocation> Mixing<A> {
    /// Mixing by `allocation`, rotors stopped.
    pub fn new(p: &Params, allocation: A) -> Self {
        Self {
            allocation,
            curve: ThrustCurve::from_params(p),
            clock: StepClock::default(),
            seen_us: 0,
            readings: [None; 4].into_iter().enumerate(),
        }
    }

    /// Commands for `demand`, whose sample was ready at `at_us` µs.
    #[inline(always)]
    pub fn step(&mut self, at_us: u64, demand: Demand, surroundings: &Surroundings) -> MixOutput {
        let dt = self.clock.step(at_us);
        let ratio = surroundings.battery_ratio.unwrap_or(1.0);
        // On the pipe the arms do not hang free.
        if !matches!(demand, Demand::Resting(_)) {
            self.take(surroundings.arms.as_ref());
        }
        self.correct_tilt();
        let mut wrench = |wrench: Wrench, yaw: bool| {
            let conditions = Conditions {
                yaw,
                battery_ratio: ratio,
                dt,
            };
            self.allocation.mix(wrench, conditions)
        };
        let mix = match demand {
            Demand::Wrench(w) => wrench(w, true),
            Demand::Resting(w) => wrench(w, false),
            Demand::Idle | Demand::Stop => self.allocation.idle(dt),
        };
        let running = demand != Demand::Stop;
        let (thrusts, commands) = if running {
            (mix.thrusts, self.curve.commands(&mix.thrusts, ratio))
        } else {
            ([0.0; 4], [0.0; 4])
        };
        let tilt = self.allocation.tilt();
        MixOutput {
            running,
            thrusts,
            commands,
            given: mix.given,
            yaw_gated: mix.yaw_gated,
            tilt: tilt.tilt(),
            tilt_bias: tilt.bias(),
            tilt_fault: tilt.fault(),
        }
    }

    /// Takes each reading once.
    #[inline(always)]
    fn take(&mut self, arms: Option<&ArmReading>) {
        if let Some(arms) = arms
            && arms.at_us > self.seen_us
        {
            self.seen_us = arms.at_us;
            self.readings = arms.tilt.into_iter().enumerate();
        }
    }

    /// One arm a step: all four in one would make it longer than the others.
    #[inline(always)]
    pub fn correct_tilt(&mut self) {
        if let Some((arm, Some(tilt))) = self.readings.next() {
            self.allocation.tilt_mut().correct(arm, tilt);
        }
    }
}
