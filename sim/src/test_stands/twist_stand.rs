//! Test stand of an arm's torsion: the body is held so that the arm's tip is level, a lever with weights lies across the
//! tip, and a phone on it shows the twist.

use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use super::scale::Scale;
use crate::normal::StandardNormal;
use crate::plant::GRAVITY;
use crate::plant::beam::BeamSpec;
use crate::plant::beam::twist::STIFFNESS_RATIO;
use crate::scenario::Scenario;
use crate::streams::Streams;

/// Largest error of a lever of 0.1 m by a ruler, m (assumed).
const RULER: f64 = 0.002;
/// Largest zero of phone, lever and arm, rad (assumed: 2°).
const ZERO: f64 = 0.035;
/// RMS of a phone that lies a little otherwise after each change of weights, rad (0.2°, assumed).
const LAID: f64 = 0.0035;
/// Resolution of the phone's display, rad: 0.1°.
const RESOLUTION: f64 = 0.001_745;

/// An arm on the stand.
#[derive(Clone, Debug)]
pub struct TwistStand {
    beam: BeamSpec,
    /// Angle between root and tip, rad.
    slope: f64,
    /// Error of the lever, m.
    lever: f64,
    zero: f64,
    scale: Scale,
    rng: Pcg64Mcg,
}

impl TwistStand {
    /// Arm `arm` (0 to 3) of `scenario`'s vehicle, with the errors of `streams`.
    #[must_use]
    pub fn new(scenario: &Scenario, arm: usize, streams: Streams) -> Self {
        Self {
            beam: scenario.beam_spec(arm),
            slope: scenario.arm_spec(arm).static_tilt(0.0),
            lever: streams.within("lever", -RULER, RULER),
            zero: streams.within("inclinometer", -ZERO, ZERO),
            scale: Scale::new(streams),
            rng: streams.of("twist stand"),
        }
    }

    /// Angle between root and tip, rad.
    #[must_use]
    pub const fn slope(&self) -> f64 {
        self.slope
    }

    /// A weight of about `mass` kg at about `lever` m: its mass by the scale, kg, and the twist by the phone, rad. A
    /// negative mass lies on the lever's other side.
    pub fn read(&mut self, mass: f64, lever: f64) -> (f64, f64) {
        let weighed = 1e-3 * self.scale.read(mass.abs() * GRAVITY, 0.0) * mass.signum();
        let compliance = share(self.slope) / self.beam.torsional_stiffness();
        let arm = mass * GRAVITY * (lever + self.lever * mass.signum()) * compliance;
        // The weight comes nearer to the axis as the lever turns; the zero turns it before.
        let mut twist = 0.0;
        for _ in 0..50 {
            twist = arm * libm::cos(twist);
        }
        let laid: f64 = StandardNormal.sample(&mut self.rng);
        let shown = (twist + self.zero + LAID * laid) / RESOLUTION;
        (weighed, shown.round() * RESOLUTION)
    }
}

/// Turn of the tip by a moment about its axis, over that of a straight arm, at the angle `slope` (rad) between root and
/// tip: a section that leans by β = slope · (1 - ξ) is twisted by the moment's share cos β and bent sideways by sin β, and
/// turns the tip by the same shares.
fn share(slope: f64) -> f64 {
    let parts = 200;
    let sum: f64 = (0..parts)
        .map(|i| {
            let beta = slope * (f64::from(i) + 0.5) / f64::from(parts);
            let (sin, cos) = (libm::sin(beta), libm::cos(beta));
            cos * cos + STIFFNESS_RATIO * sin * sin
        })
        .sum();
    sum / f64::from(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_twist_is_that_of_the_moment_over_the_stiffness() {
        let scenario = Scenario::default_mission();
        let mut stand = TwistStand::new(&scenario, 0, Streams::new(1));
        let stiffness = stand.beam.torsional_stiffness();
        assert!((stiffness - 0.35).abs() < 0.01, "{stiffness}");
        let (_, zero) = stand.read(0.0, 0.1);
        let (mass, twist) = stand.read(0.05, 0.1);
        assert!((mass - 0.05).abs() < 0.001);
        let expected = 0.05 * GRAVITY * 0.1 / stiffness;
        assert!(
            ((twist - zero) / expected - 1.0).abs() < 0.1,
            "{twist} {zero} {expected}"
        );
        let (other, back) = stand.read(-0.05, 0.1);
        assert!((other + mass).abs() < 0.001 && (back + twist - 2.0 * zero).abs() < 0.02);
        assert!((share(0.0) - 1.0).abs() < 1e-12 && (share(0.454) - 0.97).abs() < 0.002);
    }
}
