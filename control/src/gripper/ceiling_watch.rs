//! Detects a pressure that does not rise with the tension, until a sensor has read the grip pressure.
//!
//! Behind an undeclared divider a reading ends far below the grip pressure, and the loop would wind to the force limit.
//! Only a rise too slow to reach the grip pressure within the limit counts: an arm that could have held is not stopped.

use super::Config;
use crate::maths::filter::LowPass;

/// Tension rise over which the pressure must rise, N: from touch to grip on a skin of 70 Pa/N, and more than the
/// disturbance of a swinging arm.
const WINDOW: f32 = 12.0;
/// Share of the grip pressure that shows the sensor's range.
const SHOWN_SHARE: f32 = 0.95;
/// Cut-off of the tension, rad/s: a tilt wrong by 0.1 rad is 20 N for a frame.
const CUTOFF: f32 = 20.0;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CeilingWatch {
    tension: Option<LowPass>,
    from: Option<CeilingSample>,
    shown: bool,
}

/// One step of a touching arm; forces without the share against the rotor's thrust.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CeilingSample {
    /// Tension, N.
    pub tension: f32,
    /// Demanded force, N.
    pub force: f32,
    /// Contact pressure, Pa.
    pub pressure: f32,
}

impl CeilingWatch {
    pub fn pause(&mut self) {
        (self.tension, self.from) = (None, None);
    }

    /// One step of `dt` s; true if tension and force rose without the pressure.
    pub fn step(&mut self, cfg: &Config, sample: CeilingSample, dt: f32) -> bool {
        self.shown |= sample.pressure >= SHOWN_SHARE * cfg.demand.pressure;
        if self.shown {
            return false;
        }
        let tension =
            self.tension
                .get_or_insert(LowPass::at(sample.tension))
                .step(sample.tension, CUTOFF, dt);
        let now = CeilingSample { tension, ..sample };
        let from = self.from.get_or_insert(now);
        let pulled = now.tension - from.tension;
        let asked = now.force - from.force;
        if pulled < 0.0 || asked < 0.0 {
            *from = now;
        }
        // A push raises only the tension, a servo at its end only the force.
        let rise = if pulled < asked { pulled } else { asked };
        if rise < WINDOW {
            return false;
        }
        let risen = now.pressure - from.pressure;
        *from = now;
        risen < rise * cfg.demand.pressure / cfg.limit
    }
}
