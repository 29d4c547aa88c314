//! Arms half to twice as soft as the stack assumes close on the bench and in flight: the watch on unfelt contact trips on
//! every open pressure sensor and on no sound one.

use sophie_control::gripper::grip::ArmState;
use sophie_control::gripper::grip_fault::GripFault;
use sophie_control::pilot::rc::ArmChoice;
use sophie_sim::flight::fly;
use sophie_sim::parallel;
use sophie_sim::plant::tendon::ServoProfile;
use sophie_sim::record::Silent;
use sophie_sim::scenario::{Scenario, Step};
use sophie_sim::sensors::fsr::FsrBreak;
use sophie_sim::test_stands::arm_stand::{Closing, StandArm, try_grip};

/// True response over the assumed one.
const RESPONSES: [f32; 5] = [0.5, 0.71, 1.0, 1.41, 2.0];
/// Largest pressure of an arm with a sound sensor, Pa.
const PEAK: f64 = 1300.0;
/// Largest pressure of an arm with an open sensor, Pa: as an open arm that bumps the pipe.
const BLIND_PEAK: f64 = 3000.0;

#[derive(Clone, Copy, Debug)]
struct Case {
    response: f32,
    infill: f64,
    diameter: f64,
    thrust: f64,
}

fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for response in RESPONSES {
        for infill in [6.0, 6.9, 8.0, 10.0] {
            for diameter in [0.25, 0.3, 0.4] {
                for thrust in [1.2, 2.5] {
                    cases.push(Case {
                        response,
                        infill,
                        diameter,
                        thrust,
                    });
                }
            }
        }
    }
    cases
}

fn bench(case: &Case, broken: Option<FsrBreak>) -> StandArm {
    let mut arm = StandArm::from(&Closing {
        infill: case.infill,
        diameter: case.diameter,
        servo: ServoProfile::Paper.into(),
        thrust: case.thrust,
        seconds: 10.0,
        seed: 1,
    });
    arm.params.tendon_bend /= case.response;
    arm.broken = broken;
    arm
}

#[test]
fn on_the_bench_only_an_open_sensor_trips_the_watch() {
    let cases = cases();
    let tried = parallel::each(&cases, |case| {
        let sound = try_grip(&bench(case, None), 10.0);
        let open = try_grip(&bench(case, Some(FsrBreak::Open)), 10.0);
        (sound, open)
    });
    let mut worst = (0.0_f64, 0.0_f64);
    for (case, (sound, open)) in cases.iter().zip(tried) {
        assert!(sound.grip.state == ArmState::Holding, "{case:?}: {sound:?}");
        assert!(sound.peak < PEAK, "{case:?}: {sound:?}");
        assert!(open.grip.fault == Some(GripFault::Unfelt), "{case:?}: {open:?}");
        assert!(open.peak < BLIND_PEAK, "{case:?}: {open:?}");
        worst = (worst.0.max(sound.peak), worst.1.max(open.peak));
    }
    println!("largest pressure, felt and blind: {worst:.0?} Pa");
}

#[test]
fn in_flight_four_and_two_arms_grip_at_once_whatever_their_response() {
    let steps = vec![
        Step::Arm,
        Step::TakeOff { height: 2.5 },
        Step::FlyToPipe,
        Step::Touch,
        Step::Perch { throttle: 0.3 },
        Step::Hold {
            seconds: 3.0,
            push: 0.0,
            lapse: 0.0,
        },
    ];
    let mut flights = vec![];
    for response in RESPONSES {
        for arms in [ArmChoice::All, ArmChoice::Front] {
            let mut scenario = Scenario {
                seed: 3,
                steps: steps.clone(),
                arms,
                ..Scenario::default_mission()
            };
            scenario.params.tendon_bend /= response;
            flights.push((response, scenario));
        }
    }
    let flown = parallel::each(&flights, |(_, scenario)| fly(scenario, &mut Silent).outcome);
    for ((response, scenario), outcome) in flights.iter().zip(flown) {
        assert!(
            outcome.accomplished,
            "{response} {:?}: {}",
            scenario.arms, outcome.reason
        );
    }
}
