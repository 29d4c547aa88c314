//! Height by the pressure of the air: the source of last resort.
//!
//! A pressure has no ground. What it is off is learnt while range or pose give the height, so that the height goes on
//! without a step where they end. docs/design/navigation.md has figures.

use crate::maths::elapsed::seconds;
use crate::navigation::air_pressure::AirPressure;

/// Height in which the pressure falls by a factor e, m: R T / g of dry air at 15 °C. At 0 and 35 °C a way is 5 and 7 % off.
const SCALE_HEIGHT: f32 = 8_434.0;
/// Variance of a height, m². Its errors are no white noise: 0.15 m of prop wash and gusts that last a second (assumed)
/// weigh as much at 25 Hz, 2 · (0.15 m)² · 1 s · 25 Hz.
const VARIANCE: f32 = 1.1;
/// Time constant of learning what it is off, s, and for how long it must have been learnt.
const LEARN_TIME: f32 = 3.0;
const LEARNT: f32 = 2.0;
/// Age of the newest height by range or pose up to which these count, s.
const FRESH: f32 = 0.2;
/// Age beyond which a pressure says nothing, s, and from which a way between two is not known.
const STALE: f32 = 0.3;
/// Change between two pressures that no climb gives, m: 25 of the noise of a DPS310, 7 of an MS5611's.
const STEP: f32 = 1.0;
/// Weights of a refused and of a taken one, and their sum that is a barometer that jumps: three in a row, or every other.
const REFUSED: u32 = 2;
const REFUSED_MAX: u32 = 6;
/// Equal pressures in a row of a barometer that stands still.
const FROZEN: u32 = 25;
/// Departure from range or pose, over [`DEPARTURE_TIME`] s, that is a fault, m: a way out of ground effect is a half of it,
/// a drift of 0.5 m/s the whole.
const DEPARTURE: f32 = 1.5;
const DEPARTURE_TIME: f32 = 1.0;
/// The same from the inertial sensor's way while the height is by pressure, m: four deviations of prop wash and gusts, or a
/// drift of 0.5 m/s for two seconds.
const ASTRAY: f32 = 0.7;
/// For how long it must have been sound before it is taken again, µs.
const SOUND_TIME: u64 = 2_000_000;

/// What is wrong with the pressure of the air.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PressureFault {
    /// It says the same whatever the vehicle does.
    Frozen,
    /// It jumps as no air does.
    Jumps,
    /// Its height goes another way than that of range or pose.
    Disagrees,
}

impl PressureFault {
    /// Every fault.
    pub const ALL: [Self; 3] = [Self::Frozen, Self::Jumps, Self::Disagrees];

    /// For the pilot's display: at most 40 ASCII characters.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Frozen => "barometer frozen, left out",
            Self::Jumps => "barometer jumps, left out",
            Self::Disagrees => "barometer drifts, left out",
        }
    }
}

/// What is known of the barometer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BaroHeight {
    /// Pressure that heights are above, Pa.
    ground: Option<f32>,
    /// Newest pressure: when, µs, its value, Pa, and where that is, m down.
    at_us: u64,
    pascal: f32,
    down: f32,
    /// It was not looked at yet; the one that was before, µs.
    news: bool,
    looked_us: u64,
    /// Estimated less measured, m down, for how long that was learnt, s, and what is left of it in the mean, m.
    offset: f32,
    learnt: f32,
    departure: f32,
    same: u32,
    refused: u32,
    fault: Option<PressureFault>,
    unsound_us: u64,
    /// When a height was given last, µs; 0 for none.
    used_us: u64,
}

impl BaroHeight {
    /// What is wrong at present.
    pub fn fault(&self) -> Option<PressureFault> {
        self.fault
    }

    /// Takes the newest pressure, once.
    pub fn hear(&mut self, air: &AirPressure) {
        let Some(air) = air.checked().filter(|air| air.at_us > self.at_us) else {
            return;
        };
        let ground = *self.ground.get_or_insert(air.pascal);
        let gap = seconds(self.at_us, air.at_us) > STALE;
        let down = below(ground, air.pascal);
        let same = air.pascal.to_bits() == self.pascal.to_bits();
        self.same = if same { self.same.saturating_add(1) } else { 0 };
        self.pascal = air.pascal;
        self.at_us = air.at_us;
        self.news = false;
        if self.same >= FROZEN {
            self.fail(PressureFault::Frozen);
        }
        if !gap && (down - self.down).abs() > STEP {
            self.refused += REFUSED;
            if self.refused < REFUSED_MAX {
                return;
            }
            self.fail(PressureFault::Jumps);
            self.refused = 0;
        } else {
            self.refused = self.refused.saturating_sub(1);
        }
        self.down = down;
        self.news = true;
    }

    /// When the newest one was measured that was not looked at, up to `now`, µs.
    pub fn news(&mut self, now: u64) -> Option<u64> {
        let news = self.news && self.at_us <= now;
        self.news &= !news;
        news.then_some(self.at_us)
    }

    /// What a height of `down` m at the newest pressure is off, m, with its variance, m². `None` while range or pose, `known`
    /// s ago, give it, from which it learns, or where it is not sound.
    pub fn height(&mut self, down: f32, known: f32) -> Option<(f32, f32)> {
        let dt = seconds(self.looked_us, self.at_us);
        self.looked_us = self.at_us;
        let off = down - self.down - self.offset;
        let sound = self.same < FROZEN && self.refused == 0 && self.departure.abs() <= 0.5 * ASTRAY;
        if !sound {
            self.unsound_us = self.at_us;
        } else if self.at_us.saturating_sub(self.unsound_us) >= SOUND_TIME {
            self.fault = None;
        }
        if known <= FRESH {
            self.learn(off, dt.min(STALE));
            return None;
        }
        if self.learnt < LEARNT || self.fault.is_some() {
            return None;
        }
        self.depart(off, dt.min(STALE), ASTRAY);
        if self.fault.is_some() {
            return None;
        }
        self.used_us = self.at_us;
        Some((-off, VARIANCE))
    }

    fn learn(&mut self, off: f32, dt: f32) {
        if self.learnt <= 0.0 {
            (self.offset, self.departure) = (self.offset + off, 0.0);
        } else {
            self.offset += off * (dt / (dt + LEARN_TIME));
            self.depart(off, dt, DEPARTURE);
        }
        self.learnt = (self.learnt + dt).min(LEARNT);
    }

    fn depart(&mut self, off: f32, dt: f32, limit: f32) {
        self.departure += (off - self.departure) * (dt / (dt + DEPARTURE_TIME));
        if self.departure.abs() > limit {
            self.fail(PressureFault::Disagrees);
        }
    }

    /// The height that it gave cannot be.
    pub fn refuse(&mut self) {
        self.fail(PressureFault::Jumps);
    }

    /// What it is off is learnt anew: the height's origin is another.
    pub fn forget(&mut self) {
        self.learnt = 0.0;
    }

    /// The height is by pressure at `now`, µs.
    pub fn carries(&self, now: u64) -> bool {
        self.used_us > 0 && self.fault.is_none() && seconds(self.used_us, now) <= STALE
    }

    fn fail(&mut self, fault: PressureFault) {
        self.fault = Some(fault);
        self.unsound_us = self.at_us;
        if fault != PressureFault::Disagrees {
            self.forget();
        }
    }
}

/// How far `pascal` is below `ground`, m. The logarithm by its series about their mean: 1 mm off over 300 m.
fn below(ground: f32, pascal: f32) -> f32 {
    let x = (pascal - ground) / (pascal + ground);
    2.0 * SCALE_HEIGHT * x * (1.0 + x * x * (1.0 / 3.0))
}
