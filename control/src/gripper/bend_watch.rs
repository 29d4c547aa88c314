//! Detects an arm without touch that does not bend as its load rises, and learns the response of a free arm.
//!
//! An obstacle that the sensor does not detect (a cable, the wrong side of a pipe) stops the arm, and the controller
//! would wind to the force limit. The parameters give an arm's softness only within a factor of two and a tendon's
//! stiffness within four, and on a pipe an arm bends by only 0.2 to 0.5 of a free one: no fixed threshold separates the
//! two. So each window of the closing is compared with the free windows before it.
//!
//! A free arm that bends less than its parameters say has a softer tendon, or one that rubs: less force arrives for the
//! same reel than the parameters' stiffness makes. That stiffness is taken as so much smaller, and every force of the
//! gripper is the one that bends the arm.
//!
//! The load is the tendon's force minus the share that balances the rotor's thrust.

use super::Config;
use crate::maths::filter::LowPass;
use crate::maths::scalar;

/// Bending over which an arm is judged, rad, by its tilt or by its load.
const WINDOW: f32 = 0.15;
/// Bending after which a tendon pulls, rad, and the tension that it also needs, N.
const SETTLED: (f32, f32) = (0.1, 8.0);
/// Tension at which a tendon pulls in any case, N: below it may be slack, knotted 1 mm too long (8 N) with the tilt off
/// by 0.03 rad (4 N).
const TENSION_MIN: f32 = 20.0;
/// Least share of the free arm's bending: 1 for a free arm, 0.2 to 0.5 on a pipe's skin.
const BEND_SHARE_MIN: f32 = 0.6;
/// Share of a window by which a change of thrust may bend the arm while the response is unknown.
const THRUST_SHARE: f32 = 0.2;
/// Plausible response of flying arms, relative to the parameters: at least with arms 1.5 times as stiff, a thread of a
/// third of the stiffness, and a channel that takes 0.4 of the force.
pub const RESPONSE: (f32, f32) = (0.13, 2.5);
/// Delay of the watch on an arm that starts under tension, s.
const START_TIME: f32 = 0.4;
/// The same once the stiffness has been learnt, s: tensions by the former are read for two frames.
const LEARNT_TIME: f32 = 0.05;
/// Cut-off of tilt, load and tension, rad/s.
const CUTOFF: f32 = 20.0;

/// Bending of this arm by the reel's way relative to the parameters, learnt while it is free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response(Option<f32>);

impl Response {
    /// The parameters' response, for an arm that may lie on the pipe already.
    pub const ASSUMED: Self = Self(Some(1.0));

    /// Response learnt by an earlier run, 0.4 to 2.5; outside this range, or missing, it is unknown.
    pub fn resumed(learnt: Option<f32>) -> Self {
        let (least, most) = RESPONSE;
        Self(learnt.filter(|r| (least..=most).contains(r)))
    }

    /// `None` until learnt.
    pub fn known(self) -> Option<f32> {
        self.0
    }

    /// The tendon's stiffness over that of the parameters that it shows, at most 1; 1 until learnt.
    pub fn tendon(self) -> f32 {
        tendon_stiffness(self.0)
    }

    /// Bending by a force relative to the parameters; 1 until learnt.
    pub fn arm(self) -> f32 {
        self.0.unwrap_or(1.0) / self.tendon()
    }

    /// Least bending by a force, relative to the parameters, until which no window ends.
    fn least(self) -> f32 {
        let (least, _) = RESPONSE;
        self.0.map_or(least, |_| self.arm())
    }

    pub fn is_known(self) -> bool {
        self.0.is_some()
    }

    /// Response below which an arm is not free.
    fn least_free(self) -> f32 {
        let (least, _) = RESPONSE;
        BEND_SHARE_MIN * self.0.unwrap_or(least)
    }

    /// Keeps the largest: an arm that bends down gets softer, contact makes it stiffer.
    fn learn(&mut self, measured: f32) {
        let (least, most) = RESPONSE;
        let measured = scalar::clamp(measured, least, most);
        if self.0.is_none_or(|known| measured > known) {
            self.0 = Some(measured);
        }
    }
}

/// The tendon's stiffness over that of the parameters that a learnt `response` shows, at most 1; 1 where it is unknown.
pub fn tendon_stiffness(response: Option<f32>) -> f32 {
    response.map_or(1.0, |response| response.min(1.0))
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendWatch {
    tilt: LowPass,
    load: LowPass,
    tension: LowPass,
    /// Tilt at the start, rad.
    start: f32,
    from: Option<BendSample>,
    /// The tendon is known to pull.
    pulls: bool,
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
            pulls: false,
            wait: 0.0,
        }
    }

    /// For an arm that starts under tension: its delayed tilt looks like a rise.
    pub fn of_a_start(sample: &BendSample) -> Self {
        Self {
            wait: START_TIME,
            ..Self::new(sample)
        }
    }

    /// For an arm whose tendon's stiffness was learnt.
    pub fn of_a_learnt_stiffness(sample: &BendSample) -> Self {
        Self {
            pulls: true,
            wait: LEARNT_TIME,
            ..Self::new(sample)
        }
    }

    /// One step of `dt` s; returns the force before the rise, N, if the load rose by a window but the tilt hardly fell.
    /// A window of free bending raises the arm's `response` if that is unknown or `free` allows it.
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
            *self = Self {
                start: self.start,
                pulls: self.pulls,
                wait: self.wait - dt,
                ..Self::new(&sample)
            };
            return None;
        }
        let Some(from) = self.from else {
            let (bent, tension) = SETTLED;
            self.pulls |= now.tension > TENSION_MIN || now.tension > tension && self.start - now.tilt > bent;
            self.from = self.pulls.then_some(now);
            return None;
        };
        let bent = from.tilt - now.tilt;
        let expected = cfg.bend_per_force * (now.load - from.load);
        if bent < WINDOW && expected * response.least() < WINDOW {
            return None;
        }
        self.from = Some(now);
        let (_, most) = RESPONSE;
        // Until the tendon's stiffness is known, thrust and tendon do not compare.
        let thrust = cfg.bend_per_force * (now.tension - now.load - from.tension + from.load).abs();
        let thrust_moves = !response.is_known() && thrust > THRUST_SHARE * WINDOW;
        if expected < WINDOW / most || thrust_moves {
            // Another force than the tendon's moved the arm.
            return None;
        }
        let measured = bent / expected * response.tendon();
        if measured < response.least_free() {
            return Some(from.force);
        }
        if free || !response.is_known() {
            response.learn(measured);
        }
        None
    }
}
