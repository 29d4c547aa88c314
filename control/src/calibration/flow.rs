//! Calibrates scale and mounting of an optical-flow module by turning it over a floor.
//!
//! At `d` m from the floor, a turn about a point that lies `l` m above the lens appears as `1 + l / d` times the turn.
//! Two distances separate the scale from that factor, so the vehicle need not be turned about the lens.

#[cfg(test)]
mod tests;

use crate::calibration::{Unfit, within};
use crate::maths::scalar;
use crate::maths::vector::Quat;
use crate::navigation::flow_range_sample::GroundView;
use crate::navigation::history::between;
use crate::params::FlowMounting;

/// Attitudes kept, 0.16 s at 100 Hz: one flow interval plus the module's delay.
const KEPT: usize = 16;
/// Flows that a round requires, 2.5 s at 50 Hz.
const FLOWS_MIN: f32 = 125.0;
/// Range of the flows' mean quality, of 255.
const QUALITY: [f32; 2] = [20.0, 255.0];
/// Rate about each axis, rad/s RMS: below it the module's noise dominates, above it the image blurs.
const TURNING: [f32; 2] = [0.3, 3.0];
/// Rate about the down axis, share of the rate about the other axes.
const YAW: [f32; 2] = [0.0, 0.7];
/// Ranges of the near and the far round, m.
const DISTANCE: [[f32; 2]; 2] = [[0.3, 0.8], [1.2, 2.4]];
/// Share of the flow that the turning explains.
const EXPLAINED: [f32; 2] = [0.8, 1.0];
/// Angle to the nearest quarter turn, deg.
const ASKEW: [f32; 2] = [-15.0, 15.0];
/// Allowed difference of the two rounds, as height of the turning point above the lens, m.
const PIVOT: [f32; 2] = [-0.25, 0.25];
/// Counts per degree, the range of the parameter.
const SCALE: [f32; 2] = [0.5, 200.0];

/// Result of one round of turning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// Flow over turn, along the axes of the turn, row by row.
    factor: [[f32; 2]; 2],
    /// Mean of the inverse distance, 1/m.
    nearness: f32,
}

/// Sums over a round.
#[derive(Clone, Debug)]
pub struct FlowTurns {
    attitudes: [Option<(u64, Quat)>; KEPT],
    next: usize,
    until_us: u64,
    flows: f32,
    seconds: f32,
    quality: f32,
    nearness: (f32, f32),
    /// Sums of flow times turn, turn times turn (xx, xy, yy), flow times flow, yaw times yaw.
    crossed: [[f32; 2]; 2],
    turned: [f32; 3],
    seen: f32,
    yawed: f32,
}

impl Default for FlowTurns {
    fn default() -> Self {
        Self {
            attitudes: [None; KEPT],
            next: 0,
            until_us: 0,
            flows: 0.0,
            seconds: 0.0,
            quality: 0.0,
            nearness: (0.0, 0.0),
            crossed: [[0.0; 2]; 2],
            turned: [0.0; 3],
            seen: 0.0,
            yawed: 0.0,
        }
    }
}

impl FlowTurns {
    /// Takes the attitude `q` of `at_us` µs and the module's latest view.
    pub fn add(&mut self, at_us: u64, q: Quat, view: &GroundView) {
        if !q.is_finite() {
            return;
        }
        if let Some(slot) = self.attitudes.get_mut(self.next) {
            *slot = Some((at_us, q));
        }
        self.next = (self.next + 1) % KEPT;
        if let Some(distance) = view.range.and_then(|range| range.checked()?.distance) {
            self.nearness.0 += 1.0 / distance.max(0.02);
            self.nearness.1 += 1.0;
        }
        let Some(flow) = view
            .flow
            .and_then(crate::navigation::flow_range_sample::Flow::checked)
        else {
            return;
        };
        if flow.until_us <= self.until_us {
            return;
        }
        let from_us = flow.until_us.saturating_sub((flow.seconds * 1e6) as u64);
        let (Some(from), Some(to)) = (self.at(from_us), self.at(flow.until_us)) else {
            return;
        };
        self.until_us = flow.until_us;
        self.flows += 1.0;
        self.seconds += flow.seconds;
        self.quality += f32::from(flow.quality);
        let turned = from.conjugate() * to;
        let half = if turned.w < 0.0 { -2.0 } else { 2.0 };
        let [x, y, z] = [turned.x, turned.y, turned.z].map(|part| half * part);
        let [a, b] = flow.angle;
        let [[ax, ay], [bx, by]] = &mut self.crossed;
        (*ax, *ay, *bx, *by) = (*ax + a * x, *ay + a * y, *bx + b * x, *by + b * y);
        let [xx, xy, yy] = &mut self.turned;
        (*xx, *xy, *yy) = (*xx + x * x, *xy + x * y, *yy + y * y);
        self.seen += a * a + b * b;
        self.yawed += z * z;
    }

    /// The attitude at `at_us` µs, interpolated.
    fn at(&self, at_us: u64) -> Option<Quat> {
        let known = || self.attitudes.iter().flatten();
        let (before, a) = known().filter(|(at, _)| *at <= at_us).max_by_key(|(at, _)| *at)?;
        let (after, b) = known().filter(|(at, _)| *at >= at_us).min_by_key(|(at, _)| *at)?;
        let whole = after.saturating_sub(*before).max(1) as f32;
        Some(between(*a, *b, at_us.saturating_sub(*before) as f32 / whole))
    }

    /// Result of the round; `far` for the second one.
    ///
    /// # Errors
    /// Too few flows, a dark image, a wrong distance, or too little turning about an axis.
    pub fn round(&self, far: bool) -> Result<Round, Unfit> {
        within("flows", self.flows, [FLOWS_MIN, f32::MAX], "")?;
        within("quality of the picture", self.quality / self.flows, QUALITY, "")?;
        let nearness = self.nearness.0 / self.nearness.1.max(1.0);
        let [near, farther] = DISTANCE;
        let distance = if nearness > 0.0 { 1.0 / nearness } else { 0.0 };
        within("range", distance, if far { farther } else { near }, "m")?;
        let [xx, xy, yy] = self.turned;
        // Sums per flow are squared angles; divided by the mean interval squared they are squared rates.
        let per = self.flows / (self.seconds * self.seconds);
        for (what, square) in [("rolling", xx), ("pitching", yy)] {
            within(what, scalar::sqrt(square * per), TURNING, "rad/s")?;
        }
        within("turning flat", scalar::sqrt(self.yawed / (xx + yy)), YAW, "")?;
        let det = xx * yy - xy * xy;
        within("rolling apart from pitching", det / (xx * yy), [0.1, 1.0], "")?;
        let solved = |[x, y]: [f32; 2]| [(x * yy - y * xy) / det, (y * xx - x * xy) / det];
        let factor = self.crossed.map(solved);
        let explained = factor
            .iter()
            .zip(self.crossed)
            .map(|(f, c)| f.iter().zip(c).map(|(f, c)| f * c).sum::<f32>())
            .sum::<f32>();
        within(
            "share that the turning explains",
            explained / self.seen,
            EXPLAINED,
            "",
        )?;
        Ok(Round { factor, nearness })
    }
}

/// Correction of an optical-flow module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowFit {
    /// Counts per degree.
    pub scale: f32,
    /// Direction of its x axis.
    pub mounting: FlowMounting,
}

/// Scale and rotation of one factor, 1 and rad.
fn turn_of(factor: &[[f32; 2]; 2]) -> Result<(f32, f32), Unfit> {
    let [[a, b], [c, d]] = *factor;
    let proper = scalar::sqrt((a + d) * (a + d) + (c - b) * (c - b));
    let mirrored = scalar::sqrt((a - d) * (a - d) + (c + b) * (c + b));
    within(
        "mirrored part of the flow",
        mirrored / (proper + mirrored),
        [0.0, 0.2],
        "",
    )?;
    Ok((0.5 * proper, scalar::atan2(c - b, a + d)))
}

/// Correction of a module that was turned `near` the floor and `far` from it, read with the correction `now`, and the
/// height of the turning point above its lens, m.
///
/// # Errors
/// A mirrored flow, a module between two quarter turns, or rounds that disagree.
pub fn flow_fit(near: &Round, far: &Round, now: FlowFit) -> Result<(FlowFit, f32), Unfit> {
    let (near_scale, near_turn) = turn_of(&near.factor)?;
    let (far_scale, far_turn) = turn_of(&far.factor)?;
    let differ = scalar::to_deg(scalar::wrap_pi(near_turn - far_turn));
    within("turn between the rounds", differ, ASKEW, "deg")?;
    // scale (1 + pivot * nearness) of both.
    let per_metre = (near_scale - far_scale) / (near.nearness - far.nearness);
    let scale = far_scale - per_metre * far.nearness;
    let pivot = per_metre / scale;
    within("height of the point of turning", pivot, PIVOT, "m")?;
    let quarters = scalar::to_deg(far_turn) / 90.0;
    let nearest = if quarters < 0.0 {
        (quarters - 0.5) as i32
    } else {
        (quarters + 0.5) as i32
    };
    within(
        "turn beside a quarter",
        scalar::to_deg(far_turn) - 90.0 * nearest as f32,
        ASKEW,
        "deg",
    )?;
    let scale = now.scale * scale;
    within("scale", scale, SCALE, "1/deg")?;
    // A mounting parameter that is too large turns the flow by the same angle.
    let ways = FlowMounting::ALL;
    let is = ways.iter().position(|way| *way == now.mounting).unwrap_or(0) as i32;
    let mounting = ways
        .get((is - nearest).rem_euclid(4) as usize)
        .copied()
        .unwrap_or(now.mounting);
    Ok((FlowFit { scale, mounting }, pivot))
}
