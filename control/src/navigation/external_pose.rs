//! Whether poses can be trusted: they change, do not step, turn as the vehicle does and go the way that the inertial sensor
//! feels.
//!
//! The two ways are compared in a band of s³ω/(s+ω)⁴, m, to which the specific force comes as sω/(s+ω)⁴: slower, an error
//! of the attitude passes for a way; faster, the pose's noise. docs/design/navigation.md has limits and times.

use super::fix::Fix;
use super::fix_age::{TAINTED_AGE, UNKNOWN_AGE};
use super::history::StateSnapshot;
use super::inertial::Inertial;
use crate::maths::elapsed::seconds;
use crate::maths::frames::about_down;
use crate::maths::scalar::{self, GRAVITY};
use crate::maths::vector::Vec3;

/// Share of a new heading's difference that the turn follows: 1 s at 50 Hz.
pub(crate) const TURN_GAIN: f32 = 0.02;
/// Corner of the band, rad/s.
const CORNER: f32 = 3.0;
/// Time from where the poses begin, or begin anew, until the beginning has left the band, µs: five of its time constants.
const SETTLE: u64 = 1_700_000;
/// Time between two poses beyond which the way in between is not known, µs.
const GAP: u64 = 120_000;
/// Equal poses in a row of a source that stands still, a quarter of a second at 50 Hz: noise and flight leave none equal.
const FROZEN_FIXES: u32 = 12;
/// Difference below which positions are equal, m.
const EQUAL: f32 = 1e-6;
/// Departure from the way of the last two poses that is a step, m: in 20 ms no acceleration of a vehicle gives it.
const STEP: f32 = 0.15;
/// Beyond the noise of three poses, of which it is made: four deviations, squared, for each pose's variance.
const NOISE: f32 = 16.0 * 6.0;
/// Change of the heading less the vehicle's own that is a step, rad: five deviations of 3°, or a turn at 2 rad/s with a time
/// that is 0.12 s wrong.
pub const TURN_STEP: f32 = 0.25;
/// Weights of a refused and of a taken pose, and their sum that is a source that jumps: three refused in a row, or every other.
const REFUSED: u32 = 2;
const REFUSED_MAX: u32 = 6;
/// New origins that the sender may announce within [`RESETS_TIME`].
const RESETS_MAX: u32 = 5;
const RESETS_TIME: u64 = 5_000_000;
/// For how long poses must have been sound before they are taken again, µs.
const SOUND_TIME: u64 = 1_000_000;
/// Time over which the two ways are compared, s.
const WINDOW: f32 = 1.5;
/// What they may differ by: the share of the square of the way, 1, beside that of [`FLOOR`], m, and of the pose's noise in
/// the band. A factor of 0.55 or 1.45 and a turn by 26° are at the limit.
const BORNE: f32 = 0.2;
const FLOOR: f32 = 0.006;
/// Narrower share within which they are taken again, and the way that it takes to say so, m RMS over the window.
const REGAINED: f32 = 0.1;
const REGAINED_WAY: f32 = 0.006;

/// What is wrong with the poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseFault {
    /// They say the same whatever the vehicle does.
    Frozen,
    /// They jump without the sender's saying so, or say it all the time.
    Jumps,
    /// They do not go the way that the inertial sensor feels: mirrored, turned, or of another scale.
    Disagrees,
}

impl PoseFault {
    /// Every fault.
    pub const ALL: [Self; 3] = [Self::Frozen, Self::Jumps, Self::Disagrees];

    /// For the pilot's display: at most 40 ASCII characters.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Frozen => "pose frozen, left out",
            Self::Jumps => "pose jumps, left out",
            Self::Disagrees => "pose mirrored or scaled, left out",
        }
    }
}

/// A first-order low-pass at [`CORNER`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Low {
    input: Vec3,
    output: Vec3,
}

impl Low {
    fn step(&mut self, input: Vec3, dt: f32) -> Vec3 {
        let half = 0.5 * CORNER * dt;
        let mean = (self.input + input) * 0.5;
        self.output += (mean - self.output) * (2.0 * half / (1.0 + half));
        self.input = input;
        self.output
    }
}

/// How far two ways depart from each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Departure {
    /// Integrals of the squared difference and of the squared way, m² s.
    off: f32,
    way: f32,
    wrong: bool,
}

impl Departure {
    /// Wrong until the ways have agreed.
    fn doubted() -> Self {
        Self {
            wrong: true,
            ..Self::default()
        }
    }

    /// Takes the way that was `seen` with `variance`, m², and that was `felt`, m, `dt` s after the last.
    fn step(&mut self, seen: Vec3, felt: Vec3, variance: f32, dt: f32) {
        let keep = WINDOW / (WINDOW + dt);
        self.off = self.off * keep + (seen - felt).norm_squared() * dt;
        self.way = self.way * keep + felt.norm_squared() * dt;
        let floor = WINDOW * (FLOOR * FLOOR + variance);
        if !self.wrong {
            if self.off > BORNE * self.way + floor {
                *self = Self::doubted();
            }
        } else if self.off > BORNE * self.way + floor {
            // What follows is judged alone.
            (self.off, self.way) = (0.0, 0.0);
        } else if self.way > WINDOW * REGAINED_WAY * REGAINED_WAY {
            self.wrong = self.off > REGAINED * self.way;
            if self.wrong {
                (self.off, self.way) = (0.0, 0.0);
            }
        }
    }
}

/// A pose that came before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Before {
    at_us: u64,
    position: Vec3,
    heading: f32,
    /// Way from the one before it, m/s; `None` where that is not known.
    speed: Option<Vec3>,
}

/// What is known of the source.
#[derive(Clone, Debug, Default)]
pub struct ExternalPoseMonitor {
    /// The felt way's band, and when the inertial sensor was last looked at, µs.
    felt: [Low; 4],
    felt_us: u64,
    /// The poses' band, the origin that keeps it free of steps, and when it began, µs.
    seen: [Low; 4],
    origin: Vec3,
    began_us: u64,
    before: Option<Before>,
    level: Departure,
    down: Departure,
    /// Heading less the vehicle's own, rad; `None` before the first pose.
    yaw_offset: Option<f32>,
    /// Weight of the poses that are off it, and since when they are doubted, µs: until the heading is back, or the level way
    /// agrees with the new one.
    turns: u32,
    turned_us: Option<u64>,
    same: u32,
    /// The pose before was a step away from the one before it.
    stepped: bool,
    refused: u32,
    resets: u8,
    /// New origins announced since `resets_us`, µs.
    announced: u32,
    resets_us: u64,
    fault: Option<PoseFault>,
    /// When something was wrong last, µs.
    unsound_us: u64,
}

impl ExternalPoseMonitor {
    /// What is wrong at present.
    pub fn fault(&self) -> Option<PoseFault> {
        self.fault
    }

    /// Takes what the inertial sensor feels; gives the way in the band, m, in the axes of the vehicle's attitude.
    pub fn predict(&mut self, felt: &Inertial) -> Vec3 {
        let dt = seconds(self.felt_us, felt.at_us);
        if dt > super::inertial::STEP_MAX {
            self.felt = Default::default();
            self.began_us = self.began_us.max(felt.at_us);
        }
        self.felt_us = felt.at_us;
        let acceleration = felt.q.rotate(felt.accel) + Vec3::new(0.0, 0.0, GRAVITY);
        if dt > super::inertial::STEP_MAX || !acceleration.is_finite() {
            return Vec3::ZERO;
        }
        let [first, second, slow, last] = &mut self.felt;
        let once = first.step(acceleration * (1.0 / (CORNER * CORNER)), dt);
        let twice = second.step(once, dt);
        let high = twice - slow.step(twice, dt);
        last.step(high, dt)
    }

    /// Looks at `fix`, measured at the moment `then`, of a vehicle whose rotors carry it where it `flies`.
    pub fn update(&mut self, fix: &Fix, then: Option<&StateSnapshot>, flies: bool) {
        let at = fix.at_us;
        let mut sound = true;
        let dt = self.before.map_or(0, |before| at.saturating_sub(before.at_us));
        let announced = self.before.is_some() && fix.resets != self.resets;
        self.resets = fix.resets;
        if announced {
            sound = self.announce(at);
        }
        let before = self.before.filter(|_| dt > 0 && dt <= GAP && !announced);
        let mut speed = None;
        if let Some(before) = before {
            let dt = dt as f32 * 1e-6;
            let way = fix.position - before.position;
            let still = [way.x, way.y, way.z, fix.heading - before.heading];
            let same = still.iter().all(|change| change.abs() < EQUAL);
            let held = self.same >= FROZEN_FIXES;
            self.same = if same { self.same.saturating_add(1) } else { 0 };
            let off = before.speed.map_or(Vec3::ZERO, |speed| way - speed * dt);
            let v = fix.variance();
            let stepped = off.norm_squared() > (NOISE * (v.x + v.y + v.z)).max(STEP * STEP);
            if stepped {
                // The way between is not known: that before goes on.
                self.origin += off;
                sound = false;
            }
            let again = stepped && self.stepped;
            self.stepped = stepped && !again;
            speed = if self.stepped {
                before.speed
            } else {
                Some(way * (1.0 / dt)).filter(|_| !again)
            };
            if again || (held && !same) {
                self.begin(fix);
            }
            let seen = self.seen(fix.position, dt);
            if let Some(then) = then.filter(|_| at.saturating_sub(self.began_us) > SETTLE && self.same == 0) {
                self.compare(seen, fix, then, dt);
            }
        } else {
            self.begin(fix);
            (self.same, self.stepped) = (0, false);
            sound &= self.fault.is_none();
        }
        if let Some(then) = then.filter(|_| self.same == 0) {
            // Of a vehicle that is carried, after a silence and in new axes it may be any.
            let anew = !flies || announced || self.before.is_none_or(|b| seconds(b.at_us, at) > UNKNOWN_AGE);
            self.check_heading(scalar::wrap_pi(fix.heading - then.yaw()), at, anew);
        }
        self.before = Some(Before {
            at_us: at,
            position: fix.position,
            heading: fix.heading,
            speed,
        });
        let turned = self
            .turned_us
            .is_some_and(|since| at.saturating_sub(since) < TAINTED_AGE);
        let found = if self.same >= FROZEN_FIXES && flies {
            Some(PoseFault::Frozen)
        } else if self.down.wrong || (self.level.wrong && !turned) {
            Some(PoseFault::Disagrees)
        } else {
            // What was estimated before it turned is sound, and coasted on.
            turned.then_some(PoseFault::Jumps)
        };
        if found.is_some() {
            self.fault = found;
        }
        self.settle(at, sound && found.is_none());
    }

    /// Looks at the heading less the vehicle's own, `yaw_offset` rad, at `at` µs; `anew` where it may be any.
    fn check_heading(&mut self, yaw_offset: f32, at: u64, anew: bool) {
        let known = self.yaw_offset.unwrap_or(yaw_offset);
        let off = scalar::wrap_pi(yaw_offset - known);
        let same = off.abs() < TURN_STEP;
        if self.turned_us.is_some() {
            if same || !self.level.wrong {
                self.turned_us = None;
                self.level.wrong = false;
                self.yaw_offset = Some(yaw_offset);
            }
        } else if self.level.wrong || anew || same {
            let gain = if same { TURN_GAIN } else { 1.0 };
            self.yaw_offset = Some(scalar::wrap_pi(known + gain * off));
            self.turns = self.turns.saturating_sub(1);
        } else {
            self.turns += REFUSED;
            if self.turns >= REFUSED_MAX {
                self.turns = 0;
                self.turned_us = Some(at);
                self.level = Departure::doubted();
            }
        }
    }

    /// The fault ends where all was `sound` for long enough.
    fn settle(&mut self, at: u64, sound: bool) {
        if !sound {
            self.unsound_us = at;
        } else if at.saturating_sub(self.unsound_us) >= SOUND_TIME {
            self.fault = None;
        }
    }

    /// A pose at `at` µs is `off` where the vehicle was taken to be, or is not.
    pub fn note_gate(&mut self, at: u64, off: bool) {
        self.refused = if off {
            self.refused + REFUSED
        } else {
            self.refused.saturating_sub(1)
        };
        if self.refused >= REFUSED_MAX {
            self.jumps(at);
        }
    }

    fn jumps(&mut self, at: u64) {
        self.refused = 0;
        self.fault = Some(PoseFault::Jumps);
        self.unsound_us = at;
    }

    /// A new origin was announced; true if that is not done too often.
    fn announce(&mut self, at: u64) -> bool {
        if at.saturating_sub(self.resets_us) > RESETS_TIME {
            (self.resets_us, self.announced) = (at, 0);
        }
        self.announced += 1;
        let often = self.announced > RESETS_MAX;
        if often {
            self.jumps(at);
        }
        !often
    }

    /// The way in the poses' axes begins anew.
    fn begin(&mut self, fix: &Fix) {
        self.seen = Default::default();
        self.origin = fix.position;
        self.began_us = fix.at_us;
    }

    fn seen(&mut self, position: Vec3, dt: f32) -> Vec3 {
        let mut high = position - self.origin;
        let [first, second, third, last] = &mut self.seen;
        for low in [first, second, third] {
            high = high - low.step(high, dt);
        }
        last.step(high, dt)
    }

    fn compare(&mut self, seen: Vec3, fix: &Fix, then: &StateSnapshot, dt: f32) {
        let seen = about_down(seen, then.yaw() - fix.heading);
        let felt = then.swing;
        let level = |v: Vec3| Vec3::new(v.x, v.y, 0.0);
        let down = |v: Vec3| Vec3::new(0.0, 0.0, v.z);
        // What is left of white noise at 50 Hz.
        let noise = fix.variance() * (0.5 * CORNER * dt);
        self.level.step(level(seen), level(felt), noise.x + noise.y, dt);
        self.down.step(down(seen), down(felt), noise.z, dt);
    }
}
