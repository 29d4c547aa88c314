//! Barometric height: the source of last resort.
//!
//! A pressure gives no height above ground. Its offset to the estimate is learnt while range or pose give the height,
//! so that the height continues without a step when they stop. docs/design/navigation.md has figures.

use crate::maths::elapsed::seconds;
use crate::navigation::air_pressure::AirPressure;

/// Scale height, in which the pressure falls by a factor e, m: R T / g of dry air at 15 °C. At 0 and 35 °C a change of
/// height is 5 and 7 % off.
const SCALE_HEIGHT: f32 = 8_434.0;
/// Variance of a height, m². Its errors are correlated: 0.15 m of prop wash and gusts that last a second (assumed)
/// weigh as much at 25 Hz, 2 · (0.15 m)² · 1 s · 25 Hz.
const VARIANCE: f32 = 1.1;
/// Time constant of learning the offset, s, and the time for which it must be learnt before it is used, s.
const LEARN_TIME: f32 = 3.0;
const LEARNT: f32 = 2.0;
/// Age of the newest height by range or pose up to which that height has precedence, s.
const FRESH: f32 = 0.2;
/// Age beyond which a pressure is stale, and interval beyond which two pressures are not compared, s.
const STALE: f32 = 0.3;
/// Change between two pressures that no climb gives, m: 25 of the noise of a DPS310, 7 of an MS5611's.
const STEP: f32 = 1.0;
/// Weight of a refused pressure (an accepted one takes 1 off), and the sum at which the barometer counts as jumping:
/// three refused in a row, or every other.
const REFUSED: u32 = 2;
const REFUSED_MAX: u32 = 6;
/// Equal pressures in a row at which the barometer counts as frozen.
const FROZEN: u32 = 25;
/// Departure from range or pose, low-passed over [`DEPARTURE_TIME`] s, that is a fault, m: leaving ground effect gives
/// half of it, a drift of 0.5 m/s all of it.
const DEPARTURE: f32 = 1.5;
const DEPARTURE_TIME: f32 = 1.0;
/// Departure from the inertial height that is a fault while the height is barometric, m: four deviations of prop wash
/// and gusts, or a drift of 0.5 m/s for two seconds.
const ASTRAY: f32 = 0.7;
/// Time without a fault before the barometer is used again, µs.
const SOUND_TIME: u64 = 2_000_000;

/// Fault of the barometer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PressureFault {
    /// It repeats one value bit for bit.
    Frozen,
    /// It jumps by more than a climb explains.
    Jumps,
    /// Its height departs from that of range, pose or inertial sensor.
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

/// State of the barometric height.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BaroHeight {
    /// Reference pressure of the heights, Pa: the first one received.
    ground: Option<f32>,
    /// Newest pressure: time, µs, value, Pa, and height against the reference, m down.
    at_us: u64,
    pascal: f32,
    down: f32,
    /// The newest pressure is not processed yet; time of the one processed last, µs.
    news: bool,
    looked_us: u64,
    /// Estimated less barometric height, m down; time over which this offset was learnt, s; low-passed residual, m.
    offset: f32,
    learnt: f32,
    departure: f32,
    same: u32,
    refused: u32,
    fault: Option<PressureFault>,
    unsound_us: u64,
    /// Time of the last height given, µs; 0 for none.
    used_us: u64,
}

impl BaroHeight {
    /// The present fault.
    pub fn fault(&self) -> Option<PressureFault> {
        self.fault
    }

    /// Takes the newest pressure; an old or implausible one is ignored.
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

    /// Measurement time of the newest pressure, µs, if that is not after `now` and not processed yet.
    pub fn news(&mut self, now: u64) -> Option<u64> {
        let news = self.news && self.at_us <= now;
        self.news &= !news;
        news.then_some(self.at_us)
    }

    /// Innovation of a height of `down` m at the newest pressure, m, with its variance, m². `None` while range or pose
    /// gave a height less than `FRESH` ago (`known`, s), from which the offset is learnt, or while the barometer is
    /// not sound.
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

    /// Marks the barometer as faulty: its height fails the innovation gate.
    pub fn refuse(&mut self) {
        self.fail(PressureFault::Jumps);
    }

    /// Discards the learnt offset, because the origin of the height has changed.
    pub fn forget(&mut self) {
        self.learnt = 0.0;
    }

    /// The height is barometric at `now`, µs.
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

/// Height of `pascal` below `ground`, m. The logarithm is its series about their mean: 1 mm off over 300 m.
fn below(ground: f32, pascal: f32) -> f32 {
    let x = (pascal - ground) / (pascal + ground);
    2.0 * SCALE_HEIGHT * x * (1.0 + x * x * (1.0 / 3.0))
}
