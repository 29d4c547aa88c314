//! Check rows of yaw, which bending arms change.

use sophie_control::allocation::least_thrust::least_thrust;
use sophie_control::allocation::mixer::{Allocation, Conditions, YAW_FLOOR};
use sophie_control::allocation::wrench::{PerArm, Wrench, YAW};
use sophie_mixers::Mixer;

use super::hover::Built;
use super::row::{Limit, Row};
use super::thrust::GUST_FACTOR;
use crate::scenario::Scenario;

/// Evaluated thrusts in shares of hover thrust.
const NEAR_HOVER: [f64; 3] = [0.8, 1.0, 1.2];
/// Between the yaw gate and the largest thrust.
const POINTS: u32 = 12;
/// Share of the largest thrust up to which yaw has room.
const TOP: f64 = 0.95;
/// Tried moment, N·m: a tenth of a newton a rotor on a stiff frame.
const TRIED: f32 = 0.006;
/// Step of the mixer's model, s, far beyond its slowest filter, and number of steps.
const SETTLE: f32 = 1e3;
const SETTLE_STEPS: u32 = 4;
/// Time to reach the fastest turn, s.
const TURN_TIME: f64 = 1.0;

/// All rows of yaw.
pub fn rows(scenario: &Scenario, built: &Built) -> Vec<Row> {
    vec![
        share(scenario, built),
        derivative(scenario, built),
        authority(scenario, built),
    ]
}

/// Rotor thrusts that use yaw, N: from the stack's gate to [`TOP`].
fn range(scenario: &Scenario) -> impl Iterator<Item = f64> {
    let low = f64::from(
        scenario
            .params
            .yaw_gate_thrust
            .max(least_thrust(&scenario.params)),
    );
    let high = (TOP * scenario.vehicle.rotor.thrust_max).max(low);
    (0..=POINTS).map(move |i| low + (high - low) * f64::from(i) / f64::from(POINTS))
}

/// Moment (N·m) for a demand of 1 N·m at `thrust` N a rotor: the mixer's output through the plant's settled arms. 1
/// where the mixer knows the arms; negative where they reverse the demand.
fn given(scenario: &Scenario, built: &Built, thrust: f64) -> f64 {
    let change = yaw_thrusts(scenario, thrust);
    let effect = built.yaw_effect(thrust);
    let chi = f64::from(scenario.vehicle.configuration.chi());
    let moment = change
        .iter()
        .zip(effect)
        .zip(YAW)
        .map(|((t, y), sign)| t * chi * y * f64::from(sign));
    moment.sum()
}

/// Thrust (N) added to each rotor for 1 N·m of yaw at a collective of `thrust` N a rotor.
fn yaw_thrusts(scenario: &Scenario, thrust: f64) -> PerArm<f64> {
    let mut mixer = Mixer::new(scenario.mixer, scenario.vehicle.configuration, &scenario.params);
    let conditions = Conditions {
        yaw: true,
        thrust_ratio: 1.0,
        dt: SETTLE,
    };
    let collective = [thrust as f32; 4];
    for _ in 0..SETTLE_STEPS {
        mixer.follow(&collective, SETTLE);
    }
    let lift: f32 = mixer
        .tilt()
        .tilt()
        .iter()
        .map(|tilt| thrust as f32 * libm::cosf(*tilt))
        .sum();
    let mut at = |yaw: f32| {
        let wrench = Wrench {
            thrust: lift,
            yaw,
            ..Wrench::default()
        };
        mixer.allocate(&wrench, conditions).thrusts
    };
    // Opens the gate.
    at(0.0);
    let (more, less) = (at(TRIED), at(-TRIED));
    std::array::from_fn(|i| f64::from(more[i] - less[i]) / f64::from(2.0 * TRIED))
}

/// Smallest moment over yaw demand from 0.8 to 1.2 of hover thrust; 1 where the mixer knows the arms. Limit: share of
/// the stiff frame's authority at which the mixer fades yaw.
fn share(scenario: &Scenario, built: &Built) -> Row {
    let most = TOP * scenario.vehicle.rotor.thrust_max;
    let shares = NEAR_HOVER.map(|share| given(scenario, built, (share * built.hover).min(most)));
    let least = shares.into_iter().fold(f64::INFINITY, f64::min);
    Row::new("yaw given", least, "", Limit::AtLeast(f64::from(YAW_FLOOR)))
        .advise("fit configuration B, stiffer arms or the flexible mixer, or state the arms as they are")
}

/// Largest C = 1 - y/k_q over the thrusts at which the mixer uses yaw, y the yaw moment per newton of pattern with settled
/// arms. 0 for stiff arms; above 1 a command is reversed. A mixer that knows its arms gives yaw up there; where it gives it
/// up at every thrust, all count.
fn derivative(scenario: &Scenario, built: &Built) -> Row {
    let uses_yaw = |t: &f64| yaw_thrusts(scenario, *t).iter().any(|change| change.abs() > 0.0);
    let used = range(scenario).any(|t| uses_yaw(&t));
    let worst = range(scenario)
        .filter(|t| !used || uses_yaw(t))
        .map(|t| built.yaw_derivative(t))
        .fold(f64::NEG_INFINITY, f64::max);
    Row::new("yaw derivative", worst, "", Limit::AtMost(1.0))
        .advise("fit configuration B or stiffer arms, or raise yaw_gate_thrust: bending arms turn yaw round")
}

/// Yaw moment in hover, N·m: the mixer's pattern up to `yaw_thrust_max` or the rotors' room, against gusts and the
/// fastest turn within a second. 0 where the mixer gives up yaw.
fn authority(scenario: &Scenario, built: &Built) -> Row {
    let (p, v) = (&scenario.params, &scenario.vehicle);
    let pattern = yaw_thrusts(scenario, built.hover);
    let largest = pattern.iter().fold(0.0, |most: f64, t| most.max(t.abs()));
    let room = (v.rotor.thrust_max - built.hover).min(built.hover - f64::from(least_thrust(p)));
    let most = room.min(f64::from(p.yaw_thrust_max)).max(0.0);
    let moment = if largest > 0.0 {
        given(scenario, built, built.hover) * most / largest
    } else {
        0.0
    };
    let [.., inertia] = v.body.inertia;
    let needed = GUST_FACTOR * scenario.world.gust_moment + inertia * f64::from(p.yaw_slew) / TURN_TIME;
    Row::new("yaw moment", moment, "N m", Limit::AtLeast(needed))
        .advise("raise yaw_thrust_max, fit rotors of more drag torque, or make it lighter")
}

#[cfg(test)]
mod tests {
    use super::*;
    use sophie_control::allocation::wrench::Configuration;
    use sophie_mixers::Variant;

    fn given_by(variant: Variant, configuration: Configuration, gain_k: f64) -> f64 {
        let mut s = Scenario::default_mission();
        s.mixer = variant;
        s.vehicle.configuration = configuration;
        s.vehicle.gain_k = gain_k;
        s.params.gain_k = gain_k as f32;
        let built = Built::of(&s);
        given(&s, &built, built.hover)
    }

    #[test]
    fn the_flexible_mixer_gives_the_whole_yaw_moment_and_the_rigid_one_1_less_c() {
        let (a, b) = (Configuration::A, Configuration::B);
        assert!((given_by(Variant::Flexible, b, 7.75) - 1.0).abs() < 0.02);
        let mut s = Scenario::default_mission();
        let c = Built::of(&s).yaw_derivative(Built::of(&s).hover);
        assert!(
            (given_by(Variant::Rigid, b, 7.75) - (1.0 - c)).abs() < 0.05,
            "{c}"
        );
        assert!(given_by(Variant::Rigid, a, 7.75) < -1.0);
        let literal = given_by(Variant::Rigid, a, 1.0);
        assert!((0.3..0.7).contains(&literal), "{literal}");
        s.vehicle.configuration = a;
        let built = Built::of(&s);
        assert!(!authority(&s, &built).pass && !share(&s, &built).pass && !derivative(&s, &built).pass);
        assert!(given(&s, &built, built.hover).abs() < 1e-3);
    }

    #[test]
    fn a_mixer_that_gives_yaw_up_where_arms_reverse_it_passes_and_another_does_not() {
        let of = |mixer| {
            let mut s = Scenario::default_mission();
            s.mixer = mixer;
            s.params.yaw_gate_thrust = 1.0;
            s.params.torque_ratio *= 0.7;
            s.vehicle.rotor.torque_ratio *= 0.7;
            derivative(&s, &Built::of(&s))
        };
        let (flexible, rigid) = (of(Variant::Flexible), of(Variant::Rigid));
        assert!(flexible.pass && !rigid.pass, "{flexible:?} {rigid:?}");
    }

    #[test]
    fn by_default_yaw_is_sound() {
        let s = Scenario::default_mission();
        let rows = rows(&s, &Built::of(&s));
        assert!(rows.iter().all(|row| row.pass), "{rows:?}");
    }
}
