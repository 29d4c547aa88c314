//! `calibrate tendon` of drawn vehicles: what the steps of a servo with and without a weight find, beside the truth.

use glam::{DQuat, DVec3};
use sophie_control::allocation::wrench::{PerArm, SIDE};
use sophie_control::gripper::tendon::{REFERENCE_TILT, Reel, TendonDrive};
use sophie_control::params::Params;
use sophie_fit::servo_steps::bench::{Given, Rest};
use sophie_fit::servo_steps::plan::{self, Next};
use sophie_fit::servo_steps::{Found, fit};
use sophie_sim::plant::{Actuators, GRAVITY, Plant, STEP};
use sophie_sim::scenario::{Overrides, Scenario, draw};
use sophie_sim::sensors::arm_imu::{ArmImu, RATE_HZ};
use sophie_sim::streams::Streams;

/// Frame of the servos, s.
const FRAME: f64 = 0.02;
/// Time to rest after a step, and of the mean tilt, s.
const SETTLES: f64 = 1.5;
const MEAN: f64 = 1.0;
/// Hands hang a weight on within this time, s.
const HANDS: f64 = 1.0;
/// Weight on the tip, N: a bottle of 0.3 litres.
const WEIGHT: f64 = 3.0;
/// Scale of a kitchen, share.
const SCALE: f64 = 0.01;

/// A vehicle on its stand, all four arms at once.
struct Bench {
    plant: Plant,
    reels: PerArm<Reel>,
    drives: PerArm<TendonDrive>,
    sensors: PerArm<ArmImu>,
    to: PerArm<f64>,
    pulses: PerArm<f64>,
    hung: f64,
    /// Time to the next frame and the next fusion, s.
    clocks: [f64; 2],
    tilt: PerArm<f64>,
}

impl Bench {
    fn new(scenario: &Scenario) -> Self {
        let mut plant = scenario.plant();
        plant.stand(true);
        let sensor = |arm| ArmImu::new(arm, scenario.streams()).with_errors(scenario.sensors.tilt);
        Self {
            plant,
            reels: Reel::all(&scenario.params),
            drives: [TendonDrive::new(); 4],
            sensors: std::array::from_fn(sensor),
            to: [0.0; 4],
            pulses: [0.0; 4],
            hung: 0.0,
            clocks: [0.0; 2],
            tilt: [0.0; 4],
        }
    }

    /// Runs for `seconds`; the mean tilt that the sensors measure.
    fn run(&mut self, seconds: f64) -> PerArm<f64> {
        let (mut sum, mut count) = ([0.0; 4], 0.0);
        for _ in 0..(seconds / STEP) as u32 {
            self.clocks.iter_mut().for_each(|clock| *clock -= STEP);
            if self.clocks[0] <= 0.0 {
                self.clocks[0] += FRAME;
                for arm in 0..4 {
                    let (reel, drive) = (&self.reels[arm], &mut self.drives[arm]);
                    let pulse = reel.pulse_beyond(self.to[arm] as f32);
                    self.pulses[arm] = drive.place(reel, pulse, None, FRAME as f32).pulse_us.into();
                }
            }
            self.plant.step(&Actuators {
                motors: [0.0; 4],
                servos: self.pulses,
            });
            if self.clocks[1] <= 0.0 {
                self.clocks[1] += 1.0 / RATE_HZ;
                let tilt = self.plant.tilt();
                for (arm, sum) in sum.iter_mut().enumerate() {
                    let force = DVec3::new(0.0, 0.0, -GRAVITY);
                    let g = self.sensors[arm].sample(DQuat::IDENTITY, tilt[arm], force, 0.0);
                    self.tilt[arm] = libm::atan2(f64::from(SIDE[arm] * g.y), f64::from(g.z));
                    *sum += self.tilt[arm];
                }
                count += 1.0;
            }
        }
        sum.map(|sum| sum / count)
    }

    /// Hangs `weight` N on all arms, slowly.
    fn hang(&mut self, weight: f64) {
        const PARTS: u32 = 20;
        let from = self.hung;
        for part in 1..=PARTS {
            self.hung = from + (weight - from) * f64::from(part) / f64::from(PARTS);
            (0..4).for_each(|arm| self.plant.hang(arm, self.hung));
            self.run(HANDS / f64::from(PARTS));
        }
    }

    /// One rest of each arm, as its plan has it.
    fn rest(&mut self, next: &PerArm<Next>, weighed: f64, rests: &mut PerArm<Vec<Rest>>) -> PerArm<f64> {
        let weight = if next[0].hung { WEIGHT } else { 0.0 };
        if weight != self.hung {
            self.hang(weight);
        }
        self.to = next.map(|next| next.reel);
        self.run(SETTLES);
        let tilt = self.run(MEAN);
        for arm in 0..4 {
            rests[arm].push(Rest {
                reel: next[arm].reel,
                weight: if next[arm].hung { weighed } else { 0.0 },
                tilt: tilt[arm],
            });
        }
        tilt
    }
}

/// What the builder's parameters say.
fn given(p: &Params) -> Given {
    Given {
        reel_radius: p.reel_radius.into(),
        lever: p.tendon_lever.into(),
        length: p.arm_d.into(),
        bend: p.tendon_bend.into(),
        reference: REFERENCE_TILT.into(),
        speed: p.servo_slew_1.into(),
    }
}

/// The calibration of all arms of one vehicle.
struct Calibrated {
    found: PerArm<Found>,
    /// Top of the winding: angle ordered, tilt, and tension.
    top: PerArm<(f64, f64, f64)>,
}

fn calibrate(scenario: &Scenario) -> Calibrated {
    let given = given(&scenario.params);
    let mut bench = Bench::new(scenario);
    let mut rests: PerArm<Vec<Rest>> = Default::default();
    let weighed = WEIGHT * scenario.streams().within("bench scale", 1.0 - SCALE, 1.0 + SCALE);
    bench.run(2.0);
    let [free, hung, _] = plan::FREE.map(|next| bench.rest(&[next; 4], weighed, &mut rests));
    let torque = f64::from(
        scenario
            .params
            .servo_torque_max
            .min(0.85 * scenario.params.servo_stall),
    );
    let low: PerArm<f64> =
        std::array::from_fn(|arm| plan::top_tilt(free[arm], hung[arm], weighed, torque, &given));
    let (mut slack, mut top) = ([0.0; 4], [0.0; 4]);
    for _ in 0..32 {
        let tilt = bench.tilt;
        for arm in 0..4 {
            if tilt[arm] > low[arm] {
                if !plan::is_taut(free[arm], tilt[arm]) {
                    slack[arm] = top[arm];
                }
                top[arm] = f64::min(top[arm] + plan::SEARCH, scenario.params.servo_range.into());
            }
        }
        bench.to = top;
        bench.run(1.0);
    }
    bench.to = [0.0; 4];
    bench.run(3.0);
    let plans: PerArm<Vec<Next>> = std::array::from_fn(|arm| plan::rests(slack[arm], top[arm]));
    let mut tops = [(0.0, 0.0, 0.0); 4];
    for step in 0..plans[0].len() {
        bench.rest(&plans.each_ref().map(|plan| plan[step]), weighed, &mut rests);
        for (arm, kept) in tops.iter_mut().enumerate() {
            let tension = bench.plant.tension()[arm];
            if tension > kept.2 {
                *kept = (bench.to[arm], bench.plant.tilt()[arm], tension);
            }
        }
    }
    Calibrated {
        found: rests.map(|rests| fit(&rests, &given).unwrap_or_else(|why| panic!("{why}: {rests:?}"))),
        top: tops,
    }
}

/// A builder's vehicle as the table draws it, its parameters at their defaults but for the servos' marks.
fn drawn(seed: u64) -> Scenario {
    let mut text = format!("seed = {seed}\nvehicle.known = \"as-built\"\n");
    for drawn in draw::draw(Streams::new(seed)) {
        text += &format!("{}\n", drawn.line());
    }
    Scenario::parse(&text, "drawn", &Overrides::default()).unwrap()
}

/// Mean, and the ends between which 95 % lie.
fn spread(mut errors: Vec<f64>) -> [f64; 3] {
    errors.sort_by(f64::total_cmp);
    let at = |share: f64| errors[(share * (errors.len() - 1) as f64).round() as usize];
    [
        errors.iter().sum::<f64>() / errors.len() as f64,
        at(0.025),
        at(0.975),
    ]
}

#[test]
fn steps_with_and_without_a_weight_find_stiffness_slack_and_friction() {
    let count = std::env::var("VEHICLES")
        .ok()
        .and_then(|count| count.parse().ok())
        .unwrap_or(6);
    let (mut stiffness, mut mean, mut slack, mut friction) = (vec![], vec![], vec![], vec![]);
    let (mut before, mut after, mut lever, mut half) = (vec![], vec![], vec![], vec![]);
    let mut within = [0.0; 3];
    for seed in 1..=count {
        let scenario = drawn(seed);
        let Calibrated { found, top } = calibrate(&scenario);
        let (tendons, p) = (&scenario.vehicle.tendons, &scenario.params);
        let common = found.iter().map(|found| found.stiffness.value).sum::<f64>() / 4.0;
        mean.push(4.0 * common / tendons.stiffness.iter().sum::<f64>() - 1.0);
        for (arm, found) in found.iter().enumerate() {
            let truth = (
                tendons.stiffness[arm],
                scenario.faults.tendon_slack[arm],
                tendons.friction[arm],
            );
            stiffness.push(found.stiffness.value / truth.0 - 1.0);
            slack.push(1e3 * (found.slack.value - truth.1));
            friction.push(found.friction.value - truth.2);
            lever.push(found.lever_share.value / (tendons.lever[arm] / tendons.reel_radius[arm]) - 1.0);
            half.push(found.lever_share.most - found.lever_share.value);
            let holds = [
                found.stiffness.holds(truth.0),
                found.slack.holds(truth.1),
                found.friction.holds(truth.2),
            ];
            for (within, holds) in within.iter_mut().zip(holds) {
                *within += f64::from(u8::from(holds)) / (4 * count) as f64;
            }
            // The force that the law takes the top for.
            let (reel, tilt, tension) = top[arm];
            let law = |stiffness: f64, slack: f64| {
                let (r, h) = (f64::from(p.reel_radius), f64::from(p.tendon_lever));
                stiffness * (r * reel - slack - h * (f64::from(REFERENCE_TILT) - tilt)) / tension - 1.0
            };
            before.push(law(p.tendon_stiffness.into(), 0.0));
            after.push(law(common, found.slack.value));
        }
    }
    for (what, errors) in [
        ("stiffness of each", &stiffness),
        ("stiffness, mean of four", &mean),
        ("slack, mm", &slack),
        ("friction", &friction),
        ("lever over radius", &lever),
        ("its half interval", &half),
        ("force by the defaults", &before),
        ("force by what was found", &after),
    ] {
        println!("{what}: {:.3?}", spread(errors.clone()));
    }
    println!("within the interval: {within:.3?}");
    // A tenth of the numbers of a few vehicles may miss a 95 % interval.
    assert!(within.iter().all(|within| *within >= 0.85), "{within:?}");
    let [before, after] = [before, after].map(spread);
    assert!(after[0].abs() < 0.2 && before[0] > 0.5, "{before:?} {after:?}");
    let [average, least, most] = spread(mean);
    assert!(
        average.abs() < 0.12 && least > -0.1 && most < 0.3,
        "{average} {least} {most}"
    );
}
