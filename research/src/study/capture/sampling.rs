//! Which touches are tried.

use sophie_sim::streams::Streams;

use super::super::touch::{STAY, Touch};

/// A pipe on which half-widths are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauge {
    /// Diameter of the pipe, m.
    pub diameter: f64,
    /// Its coefficient of friction.
    pub friction: f64,
    /// Half-width that is wanted held, m.
    pub wanted: f64,
}

const fn gauge(diameter: f64, friction: f64, wanted: f64) -> Gauge {
    Gauge {
        diameter,
        friction,
        wanted,
    }
}

/// The first is the paper's pipe.
pub const GAUGES: [Gauge; 4] = [
    gauge(0.3, 0.6, 0.045),
    gauge(0.3, 0.3, 0.025),
    gauge(0.2, 0.6, 0.025),
    gauge(0.4, 0.6, 0.040),
];

/// Of ten touches: the gauge that each belongs to; none: from anywhere.
const TURNS: [Option<usize>; 10] = [
    None,
    Some(0),
    None,
    Some(1),
    None,
    Some(0),
    None,
    Some(2),
    None,
    Some(3),
];

/// Largest offset that is tried, m.
const OFFSET_MAX: f64 = 0.15;
/// Largest offset on a gauge pipe, m: no grip succeeds farther out.
pub(super) const GAUGE_OFFSET_MAX: f64 = 0.08;
/// No touch begins further beside the crown than this share of the diameter.
const ON_THE_PIPE: f64 = 0.48;
/// Throttle at which the missions' pilot closes the arms.
const THROTTLE: f64 = 0.30;
/// RMS of the gusts, N.
const GUST: f64 = 0.1;

/// A touch and why it is tried.
#[derive(Clone, Copy, Debug)]
pub struct Planned {
    /// The touch.
    pub touch: Touch,
    /// Its place in [`GAUGES`]; none: from anywhere.
    pub gauge: Option<usize>,
}

/// Touch `index` of a map, sampled from `seed`, headed up to `heading` (rad) off the pipe.
#[must_use]
pub fn plan(index: u64, seed: u64, heading: f64) -> Planned {
    let gauge = TURNS[(index % TURNS.len() as u64) as usize];
    let touch = gauge.map_or_else(|| anywhere(seed, heading), |i| careful(&GAUGES[i], seed, heading));
    Planned { touch, gauge }
}

/// Within ±150 mm and ±25° of lean, sinking at up to 0.6 m/s and drifting at up to 0.25 m/s, on pipes of 0.2 to 0.4 m with
/// friction of 0.3 to 0.8; half called off within 8 s.
fn anywhere(seed: u64, heading: f64) -> Touch {
    let streams = Streams::new(seed);
    let within = |what: &str, from: f64, to: f64| streams.within(&format!("touch.{what}"), from, to);
    let diameter = within("diameter", 0.2, 0.4);
    let most = (ON_THE_PIPE * diameter).min(OFFSET_MAX);
    Touch {
        offset: within("offset", -OFFSET_MAX, OFFSET_MAX).clamp(-most, most),
        lean: within("lean", -25.0, 25.0).to_radians(),
        sink: within("sink", 0.05, 0.6),
        sideways: within("sideways", -0.25, 0.25),
        yaw: within("yaw", -heading, heading),
        diameter,
        friction: within("friction", 0.3, 0.8),
        gust: within("gust", 0.0, GUST),
        throttle: within("throttle", 0.15, 0.38),
        cancel: match within("cancel", -8.0, 8.0) {
            t if t < 0.0 => f64::INFINITY,
            t => t,
        },
        stay: STAY,
        seed,
    }
}

/// What a careful pilot does: within ±3° of lean, sinking at up to 0.2 m/s and drifting at up to 0.05 m/s, in gusts of
/// 0.1 N RMS, nothing called off.
fn careful(gauge: &Gauge, seed: u64, heading: f64) -> Touch {
    let streams = Streams::new(seed);
    let within = |what: &str, from: f64, to: f64| streams.within(&format!("touch.{what}"), from, to);
    Touch {
        offset: within("offset", -GAUGE_OFFSET_MAX, GAUGE_OFFSET_MAX),
        lean: within("lean", -3.0, 3.0).to_radians(),
        sink: within("sink", 0.05, 0.2),
        sideways: within("sideways", -0.05, 0.05),
        yaw: within("yaw", -heading, heading),
        diameter: gauge.diameter,
        friction: gauge.friction,
        gust: GUST,
        throttle: THROTTLE,
        cancel: f64::INFINITY,
        stay: STAY,
        seed,
    }
}

#[cfg(test)]
mod tests {
    use crate::study::capture::sampling::*;

    #[test]
    fn half_come_from_anywhere_and_every_gauge_has_its_share() {
        let planned: Vec<_> = (0..1000).map(|i| plan(i, i, 0.1)).collect();
        let of = |gauge| planned.iter().filter(|p| p.gauge == gauge).count();
        assert_eq!(of(None), 500);
        assert_eq!(
            [of(Some(0)), of(Some(1)), of(Some(2)), of(Some(3))],
            [200, 100, 100, 100]
        );
        for p in planned.iter().filter(|p| p.gauge.is_none()) {
            assert!(p.touch.offset.abs() <= 0.5 * p.touch.diameter, "{p:?}");
        }
    }
}
