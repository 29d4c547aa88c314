//! Flow and range against motions that are known.

extern crate std;
use crate::maths::vector::Quat;
use crate::navigation::consistency::Agreement;
use crate::navigation::flow_range::{FLOW_HEIGHT, FlowRangeLimit};
use crate::navigation::flow_range_sample::Range;
use crate::navigation::position_estimator::*;

const STEP_US: u64 = 5_000;
/// Time between two flows, and between two ranges, µs; how late both are.
const FLOW_US: u64 = 20_000;
const LATE_US: u64 = 25_000;

/// A vehicle that swings and tilts above ground.
pub(crate) struct Rig {
    estimator: PositionEstimator,
    now: u64,
    /// What the module makes of its flow along each axis.
    spoil: fn([f32; 2]) -> [f32; 2],
    range: fn(f32) -> f32,
    /// Height of what is below over the ground, m.
    floor: f32,
    /// Where its lens is in truth, m, body.
    lens: Vec3,
    /// What its inertial sensor is off, m/s², world.
    bias: Vec3,
    silent: bool,
    pub(crate) out: Option<Estimate>,
}

impl Rig {
    pub(crate) fn new() -> Self {
        Self::with_lens(Vec3::ZERO, Vec3::ZERO)
    }

    /// Its lens is at `lens`, and is measured to be at `known`, m, body.
    fn with_lens(lens: Vec3, known: Vec3) -> Self {
        let p = Params {
            flow_x: known.x,
            flow_y: known.y,
            flow_z: known.z,
            ..Params::default()
        };
        Self {
            estimator: PositionEstimator::new(&p),
            lens,
            now: 1_000_000,
            spoil: |angle| angle,
            range: |distance| distance,
            floor: 0.0,
            bias: Vec3::ZERO,
            silent: false,
            out: None,
        }
    }

    /// Position, velocity, acceleration: 0.3 m at 2 rad/s, 1 m high.
    fn truth(us: u64) -> [Vec3; 3] {
        let (t, w) = (us as f64 * 1e-6, 2.0);
        let (sin, cos) = ((w * t).sin() as f32, (w * t).cos() as f32);
        let swing = |x: f32, y: f32, z: f32| Vec3::new(0.3 * x, 0.3 * y, 0.1 * x + z);
        [
            swing(sin, cos, -1.0),
            swing(2.0 * cos, -2.0 * sin, 0.0),
            swing(-4.0 * sin, -4.0 * cos, 0.0),
        ]
    }

    /// It leans by ±6° and turns slowly.
    fn q(us: u64) -> Quat {
        let t = us as f64 * 1e-6;
        let lean = |w: f64| (0.1 * (w * t).sin()) as f32;
        Quat::from_euler(lean(7.0), lean(9.0), (0.2 * t) as f32)
    }

    pub(crate) fn view(&self) -> Option<GroundView> {
        let until = (self.now - LATE_US) / FLOW_US * FLOW_US;
        let from = until - FLOW_US;
        let (q0, q1) = (Self::q(from), Self::q(until));
        let place = |us: u64, q: Quat| {
            let [position, ..] = Self::truth(us);
            position + q.rotate(self.lens)
        };
        let (a, b) = (place(from, q0), place(until, q1));
        let depth = |p: Vec3, q: Quat| (-p.z - self.floor) / q.down_in_body().z;
        let turned = q0.conjugate() * q1;
        let way = q1.rotate_inverse(b - a);
        let d = depth(b, q1);
        // Calibrated by turning, of a view of 42°.
        let ground = 1.049 * d;
        let angle = [2.0 * turned.x - way.y / ground, 2.0 * turned.y + way.x / ground];
        (!self.silent).then(|| GroundView {
            flow: Some(Flow {
                until_us: until,
                seconds: FLOW_US as f32 * 1e-6,
                angle: (self.spoil)(angle),
                quality: 100,
            }),
            range: Some(Range {
                at_us: until,
                distance: Some((self.range)(d)),
                reach: (0.02, 8.0),
            }),
        })
    }

    pub(crate) fn run(&mut self, seconds: f32) {
        for _ in 0..(seconds * 1e6) as u64 / STEP_US {
            self.now += STEP_US;
            let view = self.view();
            self.look(view.as_ref());
        }
    }

    /// One step later with `view`.
    pub(crate) fn step(&mut self, view: Option<&GroundView>) {
        self.now += STEP_US;
        self.look(view);
    }

    fn look(&mut self, view: Option<&GroundView>) {
        let [_, _, acceleration] = Self::truth(self.now);
        let q = Self::q(self.now);
        let felt = Inertial {
            at_us: self.now,
            q,
            accel: q.rotate_inverse(acceleration + self.bias - Vec3::new(0.0, 0.0, GRAVITY)),
        };
        self.out = self.estimator.step(&felt, 17.7, None, view);
    }

    /// Errors of velocity and height, m/s and m.
    pub(crate) fn errors(&self) -> [f32; 2] {
        let [position, velocity, _] = Self::truth(self.now);
        let e = self.out.expect("an estimate");
        [(e.velocity - velocity).norm(), (e.position.z - position.z).abs()]
    }

    pub(crate) fn fault(&self) -> Option<FlowRangeFault> {
        match self.estimator.fault() {
            Some(Fault::FlowRange(fault)) => Some(fault),
            _ => None,
        }
    }
}

/// It stands 1 m over the ground, leaning by 3°, and flow and range begin at 10 s: a hundred a second, 25 ms late.
fn begun_in_the_air(phase_us: u64) -> PositionEstimator {
    let mut estimator = PositionEstimator::new(&Params::default());
    let q = Quat::from_euler(3f32.to_radians(), 0.0, 0.0);
    for step in 1..5_000u64 {
        let at_us = step * STEP_US;
        let until_us = (at_us.saturating_sub(LATE_US + phase_us)) / 10_000 * 10_000 + phase_us;
        let flow = Flow {
            until_us,
            seconds: 0.01,
            angle: [0.0; 2],
            quality: 100,
        };
        let range = Range {
            at_us: until_us,
            // It is noisy: it is not the range that is judged here.
            distance: Some(1.0 / q.down_in_body().z + 0.001 * (until_us / 10_000 % 7) as f32),
            reach: (0.02, 8.0),
        };
        let view = GroundView {
            flow: Some(flow),
            range: Some(range),
        };
        let felt = Inertial {
            at_us,
            q,
            accel: q.rotate_inverse(Vec3::new(0.0, 0.0, -GRAVITY)),
        };
        let seen = (until_us >= 10_000_000).then_some(&view);
        let _ = estimator.step(&felt, 17.7, None, seen);
        if estimator.fault().is_some() {
            break;
        }
    }
    estimator
}

/// The first flow's interval may begin in the track's first step: the place there is the track's own. With that of nothing
/// the way between was the height itself, and a sound flow was `mirrored or scaled` for good.
#[test]
fn a_sound_flow_that_begins_in_the_air_is_not_named_whatever_its_phase() {
    for phase_us in (0..10_000).step_by(500) {
        let estimator = begun_in_the_air(phase_us);
        assert_eq!(estimator.fault(), None, "{phase_us} us");
        assert!(estimator.track.is_some());
    }
}

/// An estimate that begins at rest, half a metre over the ground, and has no range for five seconds, in which this is felt
/// downwards, m/s², with this thrust, N.
fn without_range(down: f32, lift: f32) -> Option<Estimate> {
    let mut estimator = PositionEstimator::new(&Params::default());
    let mut out = None;
    for step in 1..1_400u64 {
        let at_us = 1_000_000 + step * STEP_US;
        let until_us = (at_us - LATE_US) / FLOW_US * FLOW_US;
        let view = GroundView {
            flow: Some(Flow {
                until_us,
                seconds: FLOW_US as f32 * 1e-6,
                angle: [0.0; 2],
                quality: 100,
            }),
            range: Some(Range {
                at_us: until_us,
                distance: Some(0.5 + 0.001 * (until_us / FLOW_US % 7) as f32),
                reach: (0.02, 8.0),
            }),
        };
        let seen = (step < 400).then_some(&view);
        let (down, lift) = if step < 400 { (0.0, 0.0) } else { (down, lift) };
        let felt = Inertial {
            at_us,
            q: Quat::IDENTITY,
            accel: Vec3::new(0.0, 0.0, down - GRAVITY),
        };
        out = estimator.step(&felt, lift, None, seen);
    }
    out
}

#[test]
fn what_stands_keeps_its_height_and_what_flies_or_falls_does_not() {
    let stands = without_range(0.0, 0.0).expect("an estimate");
    assert!(
        stands.height_age < 0.01 && stands.velocity.z.abs() < 0.01,
        "{stands:?}"
    );
    assert!(
        (stands.position.z + 0.5).abs() < 0.02 && (stands.age - 5.0).abs() < 0.1,
        "{stands:?}"
    );
    // Carried by its rotors, and with a throttle that is closed in the air.
    for (down, lift) in [(0.0, 17.7), (6.0, 0.0)] {
        let flies = without_range(down, lift).expect("an estimate");
        assert!((flies.height_age - 5.0).abs() < 0.1, "{flies:?}");
    }
}

#[test]
fn late_flow_of_a_vehicle_that_turns_gives_its_velocity_and_range_its_height() {
    let mut r = Rig::new();
    r.run(10.0);
    let [v, z] = r.errors();
    assert!(v < 0.04 && z < 0.01, "{v} {z}");
    // Dead reckoned from where it began: the way stays that of the truth.
    let off = |r: &Rig| r.out.unwrap().position - Rig::truth(r.now)[0];
    let before = off(&r);
    r.run(20.0);
    assert!((off(&r) - before).norm() < 0.1, "{before:?} {:?}", off(&r));
    assert_eq!(r.fault(), None);
}

/// Horizontal velocity and height that an estimator with the lens `known` has of one whose lens is at `lens`: what they are off,
/// m/s RMS and m at most.
fn off_by_lever(lens: Vec3, known: Vec3) -> [f32; 2] {
    let mut r = Rig::with_lens(lens, known);
    r.run(5.0);
    let (mut sum, mut most) = (0.0, 0.0f32);
    for _ in 0..1000 {
        r.run(0.02);
        let [_, velocity, _] = Rig::truth(r.now);
        let off = r.out.expect("an estimate").velocity - velocity;
        sum += off.x * off.x + off.y * off.y;
        most = most.max(r.errors()[1]);
    }
    assert_eq!(r.fault(), None);
    [scalar::sqrt(sum / 1000.0), most]
}

/// It rolls and pitches by 0.5 and 0.6 rad/s RMS. A lever that is known costs nothing, a mirrored one twice as much as one that
/// is not.
#[test]
fn the_lever_of_the_lens_is_taken_out_by_its_sign() {
    let axes = [
        Vec3::new(-0.1, 0.0, 0.0),
        Vec3::new(0.0, 0.1, 0.0),
        Vec3::new(0.0, 0.0, 0.1),
        Vec3::new(-0.08, 0.06, 0.05),
    ];
    let [without, high] = off_by_lever(Vec3::ZERO, Vec3::ZERO);
    assert!(without < 0.003 && high < 0.001, "{without} {high}");
    for lens in axes {
        let [known, known_high] = off_by_lever(lens, lens);
        let [unknown, unknown_high] = off_by_lever(lens, Vec3::ZERO);
        let [mirrored, mirrored_high] = off_by_lever(lens, -lens);
        assert!(
            known < 1.1 * without && known_high < high + 1e-4,
            "{lens:?}: {known} {known_high}"
        );
        assert!(
            unknown > 10.0 * known && unknown_high > 0.05 * lens.norm(),
            "{lens:?}: {unknown} {unknown_high}"
        );
        let twice = [mirrored / unknown, mirrored_high / unknown_high];
        assert!(
            twice.iter().all(|share| (1.9..2.1).contains(share)),
            "{lens:?}: {twice:?}"
        );
    }
}

#[test]
fn a_step_of_the_surface_below_changes_neither_height_nor_velocity() {
    let mut r = Rig::new();
    r.run(5.0);
    // Here all of the view steps at once, where a pipe fills a part of it, which costs some velocity.
    for floor in [0.6, 0.0, 0.6, 0.0] {
        r.floor = floor;
        r.run(1.5);
        let [_, z] = r.errors();
        assert!(z < 0.04, "{floor} {z}");
    }
    let [v, _] = r.errors();
    assert!(v < 0.2, "{v}");
    assert_eq!(r.fault(), None);
}

/// Of a leaning vehicle whose lens is 20 cm ahead, 10 cm to the right and 5 cm below: where the beam falls, and the height that
/// an estimate begins with.
#[test]
fn a_beam_falls_where_it_does_below_the_lens() {
    let lens = Vec3::new(0.2, 0.1, 0.05);
    let q = Quat::from_euler(0.1, -0.2, 0.7);
    let mut flow_range = FlowRangeFusion::new(0.3, lens);
    let moment = StateSnapshot {
        position: Vec3::new(1.0, 2.0, -1.5),
        q,
        ..StateSnapshot::default()
    };
    let above = 1.5 - q.rotate(lens).z;
    let distance = above / q.down_in_body().z;
    let point = moment.of(lens, 0.4).position + beam(q, distance, 0.4);
    // On the ground, and seen from above the vehicle's axes are turned by 0.4 rad.
    let wanted = about_down(q.rotate(lens + Vec3::new(0.0, 0.0, distance)), 0.4) + moment.position;
    assert!(
        point.z.abs() < 1e-5 && (point - wanted).norm() < 1e-5,
        "{point:?}"
    );
    let view = GroundView {
        flow: None,
        range: Some(Range {
            at_us: 20_000,
            distance: Some(distance),
            reach: (0.02, 8.0),
        }),
    };
    assert_eq!(
        flow_range.new_range(&view, 30_000, true),
        Some((20_000, distance))
    );
    let flow = Flow {
        until_us: 20_000,
        seconds: 0.02,
        angle: [0.0; 2],
        quality: 100,
    };
    let height = flow_range.begin(&flow, q).unwrap();
    assert!((height - 1.5).abs() < 1e-5, "{height}");
}

/// Where the range has just stepped, or is near, a flow that does not fit is not the flow's fault.
#[test]
fn no_flow_is_judged_while_its_prediction_is_uncertain() {
    let mut agreement = Agreement::default();
    let turns = |i: u32| (0.4 * i as f32).sin();
    for i in 0..500 {
        assert!(!agreement.step(0.1 * turns(i), turns(i), 0.12, false, 0.02));
    }
    let named = (0..500).any(|i| agreement.step(0.1 * turns(i), turns(i), 0.12, true, 0.02));
    assert!(named);
}

#[test]
fn a_faulty_flow_is_named_within_three_seconds_and_left_out() {
    type Spoil = fn([f32; 2]) -> [f32; 2];
    let spoilt: [(Spoil, FlowRangeFault); 6] = [
        (|[x, y]| [-x, -y], FlowRangeFault::FlowDisagrees),
        (|[x, y]| [-x, y], FlowRangeFault::FlowDisagrees),
        (|[x, y]| [y, x], FlowRangeFault::FlowDisagrees),
        (|[x, y]| [2.2 * x, 2.2 * y], FlowRangeFault::FlowDisagrees),
        (|_| [0.0, 0.0], FlowRangeFault::FlowDisagrees),
        (|_| [0.004, 0.001], FlowRangeFault::FlowFrozen),
    ];
    for (case, (spoil, fault)) in spoilt.into_iter().enumerate() {
        let mut r = Rig::new();
        r.run(5.0);
        r.spoil = spoil;
        r.run(3.0);
        assert_eq!(r.fault(), Some(fault), "{case}");
        let age = r.out.unwrap().age;
        r.run(1.0);
        assert!(r.out.unwrap().age > age + 0.9, "{case}");
        r.spoil = |angle| angle;
        r.run(8.0);
        assert!(
            r.fault().is_none() && r.errors()[0] < 0.1,
            "{case} {:?}",
            r.errors()
        );
    }
}

/// What was estimated by a flow that disagrees is no velocity to coast on: its age is that of a hold's end at once.
#[test]
fn nothing_coasts_on_a_flow_that_disagrees_and_a_sound_one_is_taken_again() {
    let mut r = Rig::new();
    r.run(10.0);
    r.spoil = |[x, y]| [-x, -y];
    for _ in 0..60 {
        let age = r.out.map_or(0.0, |e| e.age);
        r.run(0.05);
        if r.fault() == Some(FlowRangeFault::FlowDisagrees) {
            assert!(age < 0.2, "{age}");
            break;
        }
    }
    let age = r.out.map_or(0.0, |e| e.age);
    assert!(age > 1.3 && age < 1.5, "{age}");
    r.spoil = |angle| angle;
    r.run(10.0);
    let [v, _] = r.errors();
    assert!(r.out.is_some_and(|e| e.age < 0.1) && v < 0.05, "{v}");
}

#[test]
fn a_range_that_stands_still_or_jumps_is_named_and_left_out() {
    let mut r = Rig::new();
    r.run(5.0);
    r.range = |_| 1.0;
    r.run(1.0);
    assert_eq!(r.fault(), Some(FlowRangeFault::RangeFrozen));
    r.range = |d| d;
    r.run(3.0);
    assert!(r.fault().is_none() && r.errors()[1] < 0.15, "{:?}", r.errors());

    let mut r = Rig::new();
    r.run(5.0);
    let mut named = 0u8;
    for i in 0..20u8 {
        r.range = if i.is_multiple_of(2) { |d| d + 0.5 } else { |d| d };
        r.run(0.2);
        named += u8::from(r.fault() == Some(FlowRangeFault::RangeJumps));
    }
    // It is left out for a second at a time.
    assert!(named >= 5, "{named}");
    r.range = |d| d;
    r.run(3.0);
    assert!(r.fault().is_none() && r.errors()[1] < 0.15, "{:?}", r.errors());
}

/// Where the beam of a vehicle that hovered beside a pipe in gusts crossed its edge, s after the first time.
#[test]
fn an_edge_that_is_crossed_in_gusts_is_no_fault_and_a_range_that_jumps_as_often_is_one() {
    let crossed = [0.0, 0.40, 0.50, 0.90, 1.30, 1.50, 2.07, 3.00, 3.40, 4.20, 4.30];
    let jumps: std::vec::Vec<f32> = (0..14u8).map(|i| 0.3 * f32::from(i)).collect();
    for (times, fault) in [(&crossed[..], None), (&jumps, Some(FlowRangeFault::RangeJumps))] {
        let mut r = Rig::new();
        r.run(5.0);
        let (mut over, mut now) = (false, 0.0);
        for at in times {
            r.run(at - now);
            (over, now) = (!over, *at);
            r.floor = if over { 0.5 } else { 0.0 };
        }
        r.run(0.1);
        assert_eq!(r.fault(), fault);
    }
}

#[test]
fn near_the_ground_too_high_and_without_a_range_flow_is_not_used() {
    let ranges: [fn(f32) -> f32; 4] = [|_| 0.05, |d| d + 2.0, |_| f32::NAN, |_| 20.0];
    for range in ranges {
        let mut r = Rig::new();
        r.range = range;
        r.run(3.0);
        assert_eq!(r.out, None);
    }
}

#[test]
fn silence_is_coasted_through_and_aged() {
    let mut r = Rig::new();
    r.run(10.0);
    r.silent = true;
    r.run(1.0);
    let age = r.out.unwrap().age;
    assert!(r.errors()[0] < 0.1 && (0.95..1.1).contains(&age), "{age}");
    r.run(LOST_AGE);
    assert_eq!(r.out, None);
}

/// A vehicle that has learnt its sensor's bias, and then sees nothing for so long that the estimate ends, as on a pipe.
fn perched(bias: Vec3) -> Rig {
    let mut r = Rig::new();
    r.bias = bias;
    r.run(20.0);
    assert!(r.errors()[0] < 0.05);
    r.silent = true;
    r.run(LOST_AGE + 1.0);
    assert_eq!(r.out, None);
    r.silent = false;
    r
}

/// Else a range that slides off a flank, or a mirrored flow, passes for a bias of the sensor just off the pipe.
#[test]
fn the_bias_of_the_sensor_outlives_the_estimate() {
    let mut r = perched(Vec3::new(0.15, -0.15, 0.2));
    r.run(0.6);
    r.silent = true;
    r.run(1.0);
    let [v, z] = r.errors();
    assert!(v < 0.08 && z < 0.05, "{v} {z}");
}

/// A bias beyond any sensor's comes from what led the estimate astray, not from the sensor.
#[test]
fn an_implausible_accelerometer_bias_is_not_kept() {
    let mut r = perched(Vec3::new(0.6, 0.0, 0.0));
    assert!(r.estimator.learnt.is_none());
    r.bias = Vec3::ZERO;
    r.run(3.0);
    assert!(r.errors()[0] < 0.15, "{}", r.errors()[0]);
}

/// How well the flow has followed before a perch says nothing of it now.
#[test]
fn a_flow_that_is_mirrored_from_the_beginning_is_named_as_soon_after_a_perch() {
    let named = |mut r: Rig| {
        r.spoil = |[x, y]| [-x, -y];
        let after = (1..).find(|_| {
            r.run(0.05);
            r.fault() == Some(FlowRangeFault::FlowDisagrees)
        });
        0.05 * after.map_or(f32::MAX, |n| n as f32)
    };
    let (first, again) = (named(Rig::new()), named(perched(Vec3::ZERO)));
    assert!(again <= first + 0.1, "{first} {again}");
}

#[test]
fn flow_carries_on_where_poses_end_and_a_pose_sets_the_axes() {
    let mut r = Rig::new();
    r.run(3.0);
    // Poses 5 m north of where it is, heading as the vehicle's own.
    let step = |r: &mut Rig| {
        r.now += STEP_US;
        let at_us = (r.now - 30_000) / FLOW_US * FLOW_US;
        let [_, _, acceleration] = Rig::truth(r.now);
        let q = Rig::q(r.now);
        let felt = Inertial {
            at_us: r.now,
            q,
            accel: q.rotate_inverse(acceleration - Vec3::new(0.0, 0.0, GRAVITY)),
        };
        let pose = Fix {
            at_us,
            position: Rig::truth(at_us)[0] + Vec3::new(5.0, 0.0, 0.0),
            heading: Rig::q(at_us).to_euler().2,
            ..Fix::default()
        };
        let view = r.view();
        r.out = r.estimator.step(&felt, 17.7, Some(&pose), view.as_ref());
    };
    for _ in 0..400 {
        step(&mut r);
    }
    let e = r.out.unwrap();
    let at = Rig::truth(r.now)[0] + Vec3::new(5.0, 0.0, 0.0);
    assert!(
        e.reset_count == 1 && (e.position - at).norm() < 0.02,
        "{e:?} {at:?}"
    );
    r.run(3.0);
    let e = r.out.unwrap();
    let at = Rig::truth(r.now)[0] + Vec3::new(5.0, 0.0, 0.0);
    assert!(
        e.reset_count == 1 && e.age < 0.1 && (e.position - at).norm() < 0.15,
        "{e:?}"
    );
}

mod any {
    use proptest::prelude::*;

    use super::*;

    fn number() -> impl Strategy<Value = f32> {
        prop_oneof![4 => -0.3f32..0.3, 2 => -20.0f32..20.0, 1 => any::<f32>()]
    }

    fn view() -> impl Strategy<Value = (GroundView, u64)> {
        let flow = (0u64..60_000, number(), number(), number(), any::<u8>());
        let range = (0u64..60_000, prop::option::of(number()), number(), number());
        let both = (prop::option::of(flow), prop::option::of(range), 1u64..10);
        both.prop_map(|(flow, range, steps)| {
            let flow = flow.map(|(until_us, seconds, x, y, quality)| Flow {
                until_us,
                seconds,
                angle: [x, y],
                quality,
            });
            let range = range.map(|(at_us, distance, near, far)| Range {
                at_us,
                distance,
                reach: (near, far),
            });
            (GroundView { flow, range }, steps)
        })
    }

    proptest! {
        // Whatever a module says, before and after a time in which it was sound.
        #[test]
        fn any_flow_and_range_leave_the_estimate_finite(views in prop::collection::vec(view(), 0..60)) {
            let mut r = Rig::new();
            r.run(1.0);
            for (view, steps) in views {
                for _ in 0..steps {
                    r.now += STEP_US;
                    let felt = Inertial { at_us: r.now, q: Rig::q(r.now), accel: Vec3::new(0.0, 0.0, -GRAVITY) };
                    // Times are ages here.
                    let flow = view.flow.map(|f| Flow { until_us: r.now - f.until_us, ..f });
                    let range = view.range.map(|x| Range { at_us: r.now - x.at_us, ..x });
                    let out = r.estimator.step(&felt, 17.7, None, Some(&GroundView { flow, range }));
                    prop_assert!(out.is_none_or(|e| e.is_finite()));
                }
            }
            r.run(5.0);
            prop_assert!(r.out.is_none_or(|e| e.is_finite()));
        }
    }
}

#[test]
fn where_flow_cannot_be_used_is_named() {
    let view = |distance: Option<f32>, quality: u8| GroundView {
        flow: Some(Flow {
            until_us: 1,
            seconds: 0.02,
            angle: [0.0; 2],
            quality,
        }),
        range: Some(Range {
            at_us: 1,
            distance,
            reach: (0.02, 8.0),
        }),
    };
    let cases = [
        (view(Some(1.0), 100), None),
        (view(Some(0.07), 100), Some(FlowRangeLimit::TooLow)),
        (view(Some(2.6), 100), Some(FlowRangeLimit::TooHigh)),
        (view(Some(f32::NAN), 100), Some(FlowRangeLimit::NoRange)),
        (view(None, 100), Some(FlowRangeLimit::NoRange)),
        (view(Some(1.0), 10), Some(FlowRangeLimit::TooDark)),
        (GroundView::default(), Some(FlowRangeLimit::NoRange)),
    ];
    for (view, limit) in cases {
        assert_eq!(FlowRangeLimit::of(&view), limit, "{view:?}");
    }
    let high = FLOW_HEIGHT.1;
    assert!(FlowRangeLimit::TooHigh.text().contains(&std::format!("{high} m")));
    assert!(FlowRangeLimit::ALL.iter().all(|limit| limit.text().len() <= 40));
}

use proptest::prelude::*;

/// Numbers that a line can carry: small, huge and none.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![3 => -0.3f32..0.3, 2 => 0.0f32..3.0, 1 => prop::num::f32::ANY]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever a module says: an estimate is of finite numbers, and near what the inertial sensor and the last sound
    /// measurement allow.
    #[test]
    fn views_of_any_kind_give_only_estimates_of_finite_numbers(
        views in prop::collection::vec(
            (number(), number(), number(), number(), any::<u8>(), 0u64..40_000, (number(), number())), 1..80),
    ) {
        let mut rig = Rig::new();
        rig.run(1.0);
        for (x, y, seconds, distance, quality, late, reach) in views {
            rig.now += STEP_US;
            let at_us = rig.now - late;
            let view = GroundView {
                flow: Some(Flow { until_us: at_us, seconds, angle: [x, y], quality }),
                range: Some(Range { at_us, distance: Some(distance), reach }),
            };
            let felt = Inertial {
                at_us: rig.now,
                q: Quat::IDENTITY,
                accel: Vec3::new(0.0, 0.0, -GRAVITY),
            };
            if let Some(e) = rig.estimator.step(&felt, 0.0, None, Some(&view)) {
                prop_assert!(e.is_finite(), "{e:?}");
                prop_assert!(e.position.norm() < 20.0 && e.velocity.norm() < 20.0, "{e:?}");
            }
        }
    }
}

/// It rises and sinks by 3 cm. What was estimated by it counts no longer, and a sound one is taken again.
#[test]
fn a_scaled_range_is_named_left_out_and_taken_again() {
    for range in [(|d| 1.6 * d) as fn(f32) -> f32, |d| 0.6 * d] {
        let mut r = Rig::new();
        r.run(10.0);
        r.range = range;
        let named = (0..80).find(|_| {
            r.run(0.5);
            r.fault() == Some(FlowRangeFault::RangeScaled)
        });
        assert!(named.is_some(), "{:?}", r.fault());
        assert!(r.out.is_none_or(|e| e.age > 1.3), "{:?}", r.out);
        r.run(20.0);
        assert_eq!(r.fault(), Some(FlowRangeFault::RangeScaled));
        r.range = |d| d;
        r.run(20.0);
        assert_eq!(r.fault(), None);
        let [v, _] = r.errors();
        assert!(v < 0.05, "{v}");
    }
}

/// Else the true ground seems raised over one that it has put 0.6 m deeper, and the flow reads too fast.
#[test]
fn what_a_scaled_range_has_met_is_forgotten_with_it() {
    let mut r = Rig::new();
    r.run(10.0);
    r.range = |d| 1.6 * d;
    r.run(1.0);
    while r.fault().is_none() {
        assert!(r.now < 60_000_000);
        r.run(0.5);
    }
    r.range = |d| d;
    while r.fault().is_some() {
        assert!(r.now < 80_000_000 && r.estimator.track.is_some());
        r.run(0.1);
    }
    r.run(3.0);
    assert_eq!(r.fault(), None);
    assert!(!r.estimator.flow_range.raised());
    let [v, _] = r.errors();
    assert!(v < 0.05, "{v}");
}
