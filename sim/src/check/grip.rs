//! Check rows of the grip: the gripper that flies closes each arm on the pipe.

use sophie_control::gripper::Config;
use sophie_control::gripper::grip::ArmState;

use super::row::{Limit, Row};
use crate::pilot::throttle_on_pipe;
use crate::plant::beam::rest::{DAMPING, SlowArm, pipe_under};
use crate::plant::beam::{BeamSpec, Masses, TENDON_LEVER};
use crate::plant::flexible::ArmBending;
use crate::plant::tendon::TendonSpec;
use crate::scenario::{Scenario, Step};
use crate::test_stands::arm_stand::{StandArm, Tried, try_grip};

/// Closing throttle of a mission that names none: a scenario file's default.
const THROTTLE: f64 = 0.3;
/// Reserve of the provable force: arms are tried centred with a true sensor, and flights have taken up to 4.4 % more
/// (docs/design-check.md).
const RESERVE: f64 = 0.05;

/// An arm that was tried.
#[derive(Clone, Copy, Debug)]
pub struct TriedArm {
    /// Index, 0 to 3.
    pub arm: usize,
    /// Its result.
    pub tried: Tried,
}

/// Tries every arm that the scenario closes; equal arms once.
#[must_use]
pub fn tries(scenario: &Scenario) -> Vec<TriedArm> {
    let mut done: Vec<(StandArm, TriedArm)> = Vec::new();
    for arm in (0..4).filter(|arm| scenario.arms.mask()[*arm]) {
        let stand = stand(scenario, arm);
        let alike = done
            .iter()
            .find(|(other, _)| other.is_like(&stand))
            .map(|(_, tried)| *tried);
        let tried = alike.map_or_else(
            || try_grip(&stand, f64::from(scenario.params.clamp_timeout)),
            |t| t.tried,
        );
        done.push((stand, TriedArm { arm, tried }));
    }
    done.into_iter().map(|(_, tried)| tried).collect()
}

fn stand(scenario: &Scenario, arm: usize) -> StandArm {
    let (v, w, p) = (&scenario.vehicle, &scenario.world, scenario.params);
    let wanted = scenario.steps.iter().find_map(|step| match step {
        Step::Perch { throttle } | Step::Clamp { throttle } => Some(*throttle),
        _ => None,
    });
    StandArm {
        arm,
        spec: scenario.arm_spec(arm),
        beam: (v.arm_bending == ArmBending::Beam).then(|| scenario.beam_spec(arm)),
        servo: scenario.servo_on(arm),
        tendon: TendonSpec {
            slack_error: 0.0,
            ..scenario.tendon_on(arm)
        },
        fsr: scenario.fsr_on(arm),
        rotor_tau: v.rotor.spin.up,
        params: p,
        diameter: w.pipe_diameter,
        friction: w.pipe_friction,
        thrust: throttle_on_pipe(&p, wanted.unwrap_or(THROTTLE)) * f64::from(p.thrust_max),
        broken: None,
    }
}

/// Force of each arm's grip against the gripper's limit.
///
/// Value: the largest force asked of the tendon while holding the grip pressure and stopping the rotor, N; for an arm
/// given up, the static balance with the rotor turning if that is more. Limit: the largest force of a proven grip, less
/// 5 %. Passes only if the gripper holds the arm.
pub fn rows(scenario: &Scenario, tries: &[TriedArm]) -> Vec<Row> {
    let limit = (1.0 - RESERVE) * f64::from(Config::from_params(&scenario.params).provable());
    let row = |tried: &TriedArm| {
        let TriedArm { arm, tried } = *tried;
        let holds = tried.grip.state == ArmState::Holding;
        let target = f64::from(scenario.params.grip_pressure);
        let value = if holds {
            tried.asked
        } else {
            needed(scenario, arm, stand(scenario, arm).thrust, target)
                .map_or(f64::INFINITY, |n| n.max(tried.asked))
        };
        let mut row = Row::new(
            format!("grip force arm {}", arm + 1),
            value,
            "N",
            Limit::AtMost(limit),
        );
        row.pass &= holds;
        row.advise(advice(&tried))
    };
    tries.iter().map(row).collect()
}

fn advice(tried: &Tried) -> String {
    let why = match (tried.grip.fault, tried.grip.state) {
        (Some(fault), _) => format!("the gripper gives it up ({})", fault.text()),
        (None, ArmState::ForceLimited) => "the gripper's limit comes first".to_owned(),
        (None, _) => "the gripper does not prove it in time".to_owned(),
    };
    format!("{why}: fit softer arms or a stronger servo, or choose a larger pipe")
}

/// Tendon force (N) that holds `arm` at the pressure `target` (Pa), body level on the crown, rotor at `thrust` (N): the
/// plant's arm at rest.
pub fn needed(scenario: &Scenario, arm: usize, thrust: f64, target: f64) -> Option<f64> {
    let (v, w) = (&scenario.vehicle, &scenario.world);
    let print = scenario.arm_spec(arm);
    let beam = BeamSpec::tapered(&print, Masses::of(&v.body), DAMPING, v.arm_taper);
    let pipe = pipe_under(0.5 * w.pipe_diameter, w.pipe_friction);
    SlowArm::new(arm, beam, TENDON_LEVER, thrust, Some(pipe)).pull_to(target)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::tendon::ServoProfile;
    use crate::test_stands::arm_stand::{Closing, close};

    #[test]
    fn the_needed_force_equals_that_of_a_closing_arm() {
        for (infill, diameter) in [(6.0, 0.3), (8.0, 0.3), (6.0, 0.2)] {
            let mut scenario = Scenario::default_mission();
            scenario.vehicle.infill = infill;
            scenario.world.pipe_diameter = diameter;
            let closed = close(&Closing {
                infill,
                diameter,
                servo: ServoProfile::Paper.into(),
                thrust: 2.5,
                seconds: 12.0,
                seed: 1,
            });
            let takes = closed.steady / TendonSpec::default().reel_radius;
            let needed = needed(&scenario, 0, 0.0, 950.0).unwrap();
            assert!((needed / takes - 1.0).abs() < 0.1, "{needed} {takes}");
        }
    }

    #[test]
    fn a_stiff_arm_on_a_thin_pipe_is_beyond_the_gripper_and_the_default_one_is_not() {
        let mut s = Scenario::default_mission();
        let sound = rows(&s, &tries(&s));
        assert!(sound.len() == 4 && sound.iter().all(|row| row.pass), "{sound:?}");
        (s.vehicle.infill, s.vehicle.gain_k, s.world.pipe_diameter) = (8.0, 3.5, 0.2);
        (s.params.infill, s.params.gain_k) = (8.0, 3.5);
        let stiff = rows(&s, &tries(&s));
        assert!(stiff.iter().all(|row| !row.pass), "{stiff:?}");
    }

    #[test]
    fn an_arm_that_holds_with_the_last_of_its_force_has_no_reserve() {
        let s = Scenario::default_mission();
        let provable = f64::from(Config::from_params(&s.params).provable());
        for (share, passes) in [(0.94, true), (0.96, false)] {
            let mut tried = tries(&s);
            for arm in &mut tried {
                arm.tried.asked = share * provable;
            }
            assert!(rows(&s, &tried).iter().all(|row| row.pass == passes), "{share}");
        }
    }
}
