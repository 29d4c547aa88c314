//! Detects an arm without touch that does not bend as its load rises, and learns from a free one how far it does.
//!
//! An obstacle that the sensor does not feel (a cable, the wrong side of a pipe) stops the arm, and the controller
//! would wind to the force limit. How soft an arm is, the parameters know within a factor of two; how much less one
//! bends on a pipe, 0.2 to 0.5, is no more than that. So each window of the closing is compared with the free ones
//! before it.
//!
//! Load is the tendon's force less what the rotor's thrust takes from it.

use super::Config;
use crate::maths::filter::LowPass;
use crate::maths::scalar;

/// Bending over which an arm is judged, rad, by its tilt or by its load.
const WINDOW: f32 = 0.15;
/// Bending after which a tendon pulls, rad, and the tension that it needs beside, N.
const SETTLED: (f32, f32) = (0.1, 8.0);
/// Tension at which a tendon pulls in any case, N: below it may be slack, knotted 1 mm too long (8 N) with the tilt off
/// by 0.03 rad (4 N).
const TENSION_MIN: f32 = 20.0;
/// Least share of the free arm's bending: 1 for a free arm, 0.2 to 0.5 on a pipe's skin.
const BEND_SHARE_MIN: f32 = 0.6;
/// Response of arms that fly at all, over the parameters'.
pub const RESPONSE: (f32, f32) = (0.4, 2.5);
/// Response of the stiffest arm, below whose [`BEND_SHARE_MIN`] none bends that is free.
const STIFFEST: f32 = 0.5;
/// Delay of the watch on an arm that starts under tension, s.
const START_TIME: f32 = 0.4;
/// Cut-off of tilt, load and tension, rad/s.
const CUTOFF: f32 = 20.0;

/// Bending of this arm over that of the parameters, learnt while it is free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response(Option<f32>);

impl Response {
    /// As the parameters have it: of an arm that may lie on the pipe already.
    pub const ASSUMED: Self = Self(Some(1.0));

    /// As an earlier run learnt it, 0.4 to 2.5; out of that range, or none, it is unknown.
    pub fn resumed(learnt: Option<f32>) -> Self {
        let (least, most) = RESPONSE;
        Self(learnt.filter(|r| (least..=most).contains(r)))
    }

    /// `None` until learnt.
    pub fn known(self) -> Option<f32> {
        self.0
    }

    /// 1 until learnt.
    pub fn value(self) -> f32 {
        self.0.unwrap_or(1.0)
    }

    pub fn is_known(self) -> bool {
        self.0.is_some()
    }

    /// Response below which an arm is not free.
    fn least_free(self) -> f32 {
        BEND_SHARE_MIN * self.0.unwrap_or(STIFFEST)
    }

    /// Takes the largest: an arm that bends down gets softer, contact makes it stiffer.
    fn learn(&mut self, measured: f32) {
        let (least, most) = RESPONSE;
        let measured = scalar::clamp(measured, least, most);
        if self.0.is_none_or(|known| measured > known) {
            self.0 = Some(measured);
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendWatch {
    tilt: LowPass,
    load: LowPass,
    tension: LowPass,
    /// Tilt at the start, rad.
    start: f32,
    from: Option<BendSample>,
    /// Time until the watch begins, s.
    wait: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendSample {
    /// Tilt, rad.
    pub tilt: f32,
    /// Tension less the thrust's share, N.
    pub load: f32,
    /// Tension, N.
    pub tension: f32,
    /// Demanded force, N.
    pub force: f32,
}

impl BendWatch {
    pub fn new(sample: &BendSample) -> Self {
        Self {
            tilt: LowPass::at(sample.tilt),
            load: LowPass::at(sample.load),
            tension: LowPass::at(sample.tension),
            start: sample.tilt,
            from: None,
            wait: 0.0,
        }
    }

    /// For an arm that starts under tension: its late tilt looks like a rise.
    pub fn of_a_start(sample: &BendSample) -> Self {
        Self {
            wait: START_TIME,
            ..Self::new(sample)
        }
    }

    /// One step of `dt` s; returns the force before the rise, N, if the load rose by a window but the tilt hardly fell.
    /// A window that an arm bends freely raises its `response` where it is unknown or `free` says that it may.
    pub fn step(
        &mut self,
        cfg: &Config,
        sample: BendSample,
        response: &mut Response,
        free: bool,
        dt: f32,
    ) -> Option<f32> {
        let now = BendSample {
            tilt: self.tilt.step(sample.tilt, CUTOFF, dt),
            load: self.load.step(sample.load, CUTOFF, dt),
            tension: self.tension.step(sample.tension, CUTOFF, dt),
            ..sample
        };
        if self.wait > 0.0 {
            self.wait -= dt;
            return None;
        }
        let Some(from) = self.from else {
            let (bent, tension) = SETTLED;
            let pulls = now.tension > TENSION_MIN || now.tension > tension && self.start - now.tilt > bent;
            self.from = pulls.then_some(now);
            return None;
        };
        let bent = from.tilt - now.tilt;
        let expected = cfg.bend_per_force * (now.load - from.load);
        if bent < WINDOW && expected * response.value() < WINDOW {
            return None;
        }
        self.from = Some(now);
        let (_, most) = RESPONSE;
        if expected < WINDOW / most {
            // Something else than the tendon moved it.
            return None;
        }
        let measured = bent / expected;
        if measured < response.least_free() {
            return Some(from.force);
        }
        if free || !response.is_known() {
            response.learn(measured);
        }
        None
    }
}
