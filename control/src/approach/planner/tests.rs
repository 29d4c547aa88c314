//! A vehicle that follows the held point exactly, over a pipe.

use super::*;

const DT: f32 = 0.01;
/// Of the range, m.
const REACH: f32 = 2.5;

/// The pipe runs along `heading` through a point `right` of the origin, its crown `down` below the origin's height.
#[derive(Clone, Copy)]
struct World {
    heading: f32,
    right: f32,
    crown_z: f32,
    ground: Option<f32>,
    radius: f32,
    /// Of the ends from the origin, along the heading, m.
    ends: (f32, f32),
    /// Where along it the beam misses it for a moment, m.
    missed: (f32, f32),
    /// When a range becomes wrong, and is right again, s, and how many times as long as it should be.
    scaled: (f32, f32, f32),
    /// By how much the ground to the right of the pipe is lower, m, and how far off that begins.
    dip: (f32, f32),
}

const WORLD: World = World {
    heading: 0.4,
    right: 0.3,
    crown_z: 0.7,
    ground: Some(2.2),
    radius: 0.15,
    ends: (-1.0, 1.0),
    missed: (5.0, 5.0),
    scaled: (f32::MAX, f32::MAX, 1.0),
    dip: (0.0, 0.0),
};

impl World {
    /// Right of the crown and along the pipe, m.
    fn beside(&self, p: Vec3) -> (f32, f32) {
        let local = about_down(p, -self.heading);
        (local.y - self.right, local.x)
    }

    /// What the range sees straight below a lens at `lens` of a vehicle at `p`.
    fn below_lens(&self, p: Vec3, lens: Vec3) -> Option<Vec3> {
        self.below(p + about_down(lens, self.heading))
    }

    /// What the range sees straight below `p`.
    fn below(&self, p: Vec3) -> Option<Vec3> {
        let (y, x) = self.beside(p);
        let on = y.abs() < self.radius
            && (self.ends.0..self.ends.1).contains(&x)
            && !(self.missed.0..self.missed.1).contains(&x);
        let pipe = self.crown_z + self.radius - (self.radius * self.radius - y * y).max(0.0).sqrt();
        let dip = if y > self.dip.1 { self.dip.0 } else { 0.0 };
        let z = if on {
            Some(pipe)
        } else {
            self.ground.map(|ground| ground + dip)
        };
        z.filter(|z| (0.02..REACH).contains(&(z - p.z)))
            .map(|z| Vec3::new(p.x, p.y, z))
    }
}

/// How a try ends: the planner, where the vehicle is then, and after how long.
fn flown(world: World, planner: ApproachPlanner) -> (Result<(), ApproachAbort>, Vec3, ApproachPlanner, f32) {
    let (mut planner, mut held, mut speed) = (planner, planner.origin, Vec3::ZERO);
    let mut surface_point = RangeHit::default();
    for i in 0..12_000 {
        if i % 2 == 0 {
            surface_point = RangeHit {
                surface_point: world.below_lens(held, planner.lens).and_then(|point| {
                    let (from, until, scale) = world.scaled;
                    let wrong = (from..until).contains(&(i as f32 * DT));
                    let scale = if wrong { scale } else { 1.0 };
                    let range = scale * (point.z - held.z);
                    let seen = Vec3::new(point.x, point.y, held.z + range);
                    (range < REACH).then_some(seen)
                }),
                count: surface_point.count.wrapping_add(1),
                age: 0.02,
            };
        }
        let view = View {
            position: held,
            velocity: speed,
            heading: world.heading,
            held,
            age: 0.0,
            range_hit: surface_point,
            target: None,
        };
        match planner.step(&view, DT) {
            Ok(command) => {
                let commanded = about_down(command.velocity, world.heading);
                let slew = |a: f32, b: f32| scalar::slew(a, b, DT);
                speed = Vec3::new(
                    slew(speed.x, commanded.x),
                    slew(speed.y, commanded.y),
                    slew(speed.z, commanded.z),
                );
                held += speed * DT;
            }
            Err(doubt) => return (Err(doubt), held, planner, i as f32 * DT),
        }
        let (y, _) = world.beside(held);
        let touches = y.abs() < world.radius && held.z > world.crown_z - 0.05;
        if planner.has_left() || (touches && planner.committed()) {
            return (Ok(()), held, planner, i as f32 * DT);
        }
    }
    panic!("neither touch nor doubt in 120 s: {planner:?}");
}

fn begun(world: &World) -> ApproachPlanner {
    begun_by(world, &Params::default())
}

fn begun_by(world: &World, p: &Params) -> ApproachPlanner {
    let view = View {
        position: Vec3::ZERO,
        velocity: Vec3::ZERO,
        heading: world.heading,
        held: Vec3::ZERO,
        age: 0.0,
        range_hit: RangeHit::default(),
        target: None,
    };
    ApproachPlanner::begin(p, &view, world.heading, 0)
}

#[test]
fn it_touches_on_the_crown_from_wherever_the_search_begins() {
    for right in [-0.9, -0.3, -0.1, 0.0, 0.16, 0.5, 1.0] {
        for ground in [Some(2.2), Some(1.1), None] {
            let world = World {
                right,
                ground,
                ..WORLD
            };
            let (end, at, planner, seconds) = flown(world, begun(&world));
            let (y, x) = world.beside(at);
            assert_eq!(end, Ok(()), "{right} {ground:?} {planner:?}");
            assert!(y.abs() < 0.015 && x.abs() < 0.05, "{right} {ground:?}: {y} {x}");
            assert!(seconds < 60.0, "{right} {ground:?}: {seconds} s");
        }
    }
}

/// The vehicle comes down over the crown, the beam that finds it beside the vehicle; the ends are looked for with the beam.
#[test]
fn with_the_lens_beside_its_centre_it_touches_on_the_crown_as_far_from_the_ends() {
    for (x, y, z) in [(-0.08, 0.06, 0.05), (0.15, -0.07, -0.05), (0.0, 0.07, 0.1)] {
        let p = Params {
            flow_x: x,
            flow_y: y,
            flow_z: z,
            ..Params::default()
        };
        for (ends, wanted) in [((-1.0, 1.0), 0.0), ((-1.0, 0.2), -0.1), ((-0.1, 2.0), 0.2)] {
            let world = World { ends, ..WORLD };
            let (end, at, planner, _) = flown(world, begun_by(&world, &p));
            let (right, ahead) = world.beside(at);
            assert_eq!(end, Ok(()), "{x} {y} {z} {ends:?} {planner:?}");
            assert!(
                right.abs() < 0.015 && (ahead - wanted).abs() < 0.05,
                "{x} {y} {z} {ends:?}: {right} {ahead}"
            );
        }
        let short = World {
            ends: (-0.2, 0.25),
            ..WORLD
        };
        assert_eq!(
            flown(short, begun_by(&short, &p)).0,
            Err(ApproachAbort::TooShort),
            "{x} {y} {z}"
        );
    }
}

#[test]
fn it_sinks_no_faster_than_it_may_and_only_over_the_crown() {
    let world = WORLD;
    let (mut planner, mut held) = (begun(&world), Vec3::ZERO);
    for i in 0..6000u32 {
        let view = View {
            position: held,
            velocity: Vec3::ZERO,
            heading: world.heading,
            held,
            age: 0.0,
            range_hit: RangeHit {
                surface_point: world.below(held),
                count: (i % 256) as u8,
                age: 0.0,
            },
            target: None,
        };
        let command = planner.step(&view, DT).unwrap();
        let v = command.velocity;
        assert!(v.z <= DESCENT && v.x.hypot(v.y) < 0.5, "{v:?}");
        held += about_down(v, world.heading) * DT;
        let (y, _) = world.beside(held);
        let range = world.crown_z - held.z;
        assert!(range > LOW - 0.1 || y.abs() < 0.05, "{range} m over it at {y} m");
        if planner.phase == Phase::Commit {
            assert!(v.y.abs() <= CORRECT_SPEED, "{v:?}");
            return;
        }
    }
    panic!("never at the gate: {planner:?}");
}

#[test]
fn it_keeps_away_from_an_end_and_refuses_a_pipe_that_is_too_short() {
    for (ends, wanted) in [((-1.0, 0.2), -0.1), ((-0.1, 2.0), 0.2), ((-0.31, 0.31), 0.0)] {
        let world = World { ends, ..WORLD };
        let (end, at, planner, _) = flown(world, begun(&world));
        let (y, x) = world.beside(at);
        assert_eq!(end, Ok(()), "{ends:?} {planner:?}");
        assert!(y.abs() < 0.015 && (x - wanted).abs() < 0.03, "{ends:?}: {y} {x}");
    }
    let short = World {
        ends: (-0.2, 0.25),
        ..WORLD
    };
    assert_eq!(flown(short, begun(&short)).0, Err(ApproachAbort::TooShort));
}

#[test]
fn what_the_beam_comes_back_onto_has_not_ended() {
    for missed in [(0.1, 0.2), (-0.25, -0.15)] {
        let world = World { missed, ..WORLD };
        let (end, at, planner, _) = flown(world, begun(&world));
        let (y, x) = world.beside(at);
        assert_eq!(end, Ok(()), "{missed:?} {planner:?}");
        assert!(y.abs() < 0.015 && x.abs() < 0.03, "{missed:?}: {y} {x}");
    }
}

#[test]
fn what_is_no_pipe_or_too_wide_for_it_is_none() {
    let none = World { right: 5.0, ..WORLD };
    let (end, at, ..) = flown(none, begun(&none));
    assert_eq!(end, Err(ApproachAbort::NoPipe));
    // Where it gives up the height is that of the beginning.
    assert!(at.z.abs() < 1e-3, "{at:?}");
    let wall = World { radius: 0.4, ..WORLD };
    assert_eq!(flown(wall, begun(&wall)).0, Err(ApproachAbort::NoPipe));
}

/// One that had become too long was flown by: the vehicle hovered at the gate where flow sees nothing, or in another search lower
/// than it took itself to be, until a gust pressed an arm onto the pipe.
#[test]
fn a_range_that_shows_higher_steps_than_before_ends_it() {
    for from in 7..26u8 {
        // The ground goes out of reach, or does not.
        for ground in [2.2, 1.3] {
            let world = World {
                ground: Some(ground),
                scaled: (f32::from(from), f32::MAX, 1.6),
                ..WORLD
            };
            let (end, at, planner, seconds) = flown(world, begun(&world));
            let found = matches!(
                end,
                Err(ApproachAbort::RangeLong | ApproachAbort::RangeMisfit | ApproachAbort::PipeLost)
            );
            assert!(found, "{from} {ground}: {end:?} {planner:?}");
            let above = world.crown_z - at.z;
            assert!(
                above > 0.15 && seconds < f32::from(from) + 6.0,
                "{from} {ground}: {above} m, {seconds} s"
            );
        }
    }
}

/// Called too long at its first jump, one that jumps was never named.
#[test]
fn a_range_that_returns_soon_is_no_surface_step() {
    for from in 7..26u8 {
        for ground in [2.2, 1.3] {
            let from = f32::from(from);
            let world = World {
                ground: Some(ground),
                scaled: (from, from + 0.3, 1.6),
                ..WORLD
            };
            let (end, ..) = flown(world, begun(&world));
            let misfit = matches!(end, Err(ApproachAbort::RangeLong | ApproachAbort::RangeMisfit));
            assert!(!misfit, "{from} {ground}: {end:?}");
        }
    }
}

#[test]
fn uneven_ground_and_a_range_that_is_a_little_off_are_no_other_steps() {
    // A terrace along the pipe, a ditch beside it.
    for dip in [(0.2, 0.0), (0.9, 0.0), (-0.9, 0.0), (0.25, 0.22)] {
        let world = World {
            ground: Some(2.0),
            dip,
            ..WORLD
        };
        let (end, at, planner, _) = flown(world, begun(&world));
        assert_eq!(end, Ok(()), "{dip:?} {planner:?}");
        assert!(world.beside(at).0.abs() < 0.03, "{dip:?}: {at:?}");
    }
    for scale in [0.85, 1.15] {
        for from in 7..26u8 {
            let world = World {
                scaled: (f32::from(from), f32::MAX, scale),
                ..WORLD
            };
            let (end, ..) = flown(world, begun(&world));
            let misfit = matches!(end, Err(ApproachAbort::RangeLong | ApproachAbort::RangeMisfit));
            assert!(!misfit, "{from} {scale}: {end:?}");
        }
    }
}

/// What has been learnt of the steps goes along to the next try.
#[test]
fn another_try_knows_the_steps_of_the_first() {
    let mut planner = begun(&WORLD);
    (planner.steps, planner.farthest) = ([1.5, 1.4], 2.0);
    let view = descending(0.4, 0.0, 0.02).1;
    let next = planner.retried(&Params::default(), &view, WORLD.heading, 0);
    assert!(next.steps == planner.steps && next.farthest == planner.farthest);
}

#[test]
fn near_crown_holds_low_over_it_alone() {
    for (range, aside, near) in [(0.2, 0.0, true), (0.35, 0.0, false), (0.2, 0.08, false)] {
        let (mut planner, mut view) = descending(range, 0.0, 0.02);
        planner.take_range(&view);
        view.range_hit.count = 2;
        planner.take_range(&view);
        view.position = about_down(Vec3::new(0.0, aside, 0.0), WORLD.heading) + view.position;
        assert_eq!(planner.near_crown(&view), near, "{range} {aside}");
        planner.phase = Phase::Cross;
        assert!(!planner.near_crown(&view));
    }
}

#[test]
fn without_a_range_and_where_nothing_is_touched_it_gives_up() {
    let mut planner = begun(&WORLD);
    let mut view = View {
        position: Vec3::ZERO,
        velocity: Vec3::ZERO,
        heading: 0.4,
        held: Vec3::ZERO,
        age: 0.0,
        range_hit: RangeHit {
            age: RANGE_AGE - 0.01,
            ..RangeHit::default()
        },
        target: None,
    };
    assert!(planner.step(&view, DT).is_ok());
    view.range_hit.age = RANGE_AGE + 0.01;
    assert_eq!(planner.step(&view, DT), Err(ApproachAbort::RangeStale));
    planner.phase = Phase::Commit;
    let steps = (0..1000).take_while(|_| planner.step(&view, DT).is_ok()).count();
    assert!((steps as f32 * DT - TOUCH_WAIT).abs() < 0.05, "{steps}");
    view.position.y = 0.2;
    planner.since = 0.0;
    assert_eq!(planner.step(&view, DT), Err(ApproachAbort::NotCentred));
    // The wind keeps it from sweeping.
    let mut planner = begun(&WORLD);
    view.range_hit.age = 0.0;
    let steps = (0..10_000)
        .take_while(|_| planner.step(&view, DT).is_ok())
        .count();
    assert!((steps as f32 * DT - SEARCH_TIME).abs() < 0.1, "{steps}");
    assert_eq!(planner.step(&view, DT), Err(ApproachAbort::NoPipe));
}

#[test]
fn another_try_climbs_before_it_searches_and_leaving_only_climbs() {
    let world = WORLD;
    let view = View {
        position: Vec3::new(0.0, 0.0, 0.5),
        velocity: Vec3::ZERO,
        heading: world.heading,
        held: Vec3::new(0.0, 0.0, 0.5),
        age: 0.0,
        range_hit: RangeHit::default(),
        target: None,
    };
    let planner = ApproachPlanner::again(&Params::default(), &view, world.heading, 0, true);
    let (end, at, ..) = flown(world, planner);
    assert_eq!(end, Ok(()));
    assert!((at.z - 0.5 + HIGH).abs() < 0.1, "{at:?}");
    let planner = ApproachPlanner::again(&Params::default(), &view, world.heading, 0, false);
    let (end, at, ..) = flown(world, planner);
    assert_eq!(end, Ok(()));
    assert!(world.beside(at).0.abs() < 0.015, "{at:?}");
}

/// From 0.65 m over the crown another try climbed by 0.4 m more, from where the ground was out of the range's reach.
#[test]
fn another_try_from_a_search_climbs_no_higher_than_over_what_it_has_met() {
    for (crown_z, climbs) in [(0.3, HIGH - 0.3), (0.65, 0.0)] {
        let world = World {
            right: 0.0,
            crown_z,
            ..WORLD
        };
        let mut planner = begun(&world);
        let mut view = View {
            position: Vec3::ZERO,
            velocity: Vec3::ZERO,
            heading: world.heading,
            held: Vec3::ZERO,
            age: 0.0,
            range_hit: RangeHit {
                surface_point: world.below(Vec3::ZERO),
                count: 1,
                age: 0.0,
            },
            target: None,
        };
        planner.step(&view, DT).unwrap();
        // The ground is met at the side since.
        view.range_hit.surface_point = Some(Vec3::new(0.0, 0.0, 2.2));
        for count in 2..5 {
            view.range_hit.count = count;
            planner.step(&view, DT).unwrap();
        }
        assert_eq!(planner.phase, Phase::Search);
        let again = planner.retried(&Params::default(), &view, world.heading, 0);
        assert!((again.up + climbs).abs() < 1e-5, "{crown_z}: {}", again.up);
    }
}

/// Over the crown on the way down: at `range` m, sinking at `sinks` m/s, the newest flow `age` s old.
fn descending(range: f32, sinks: f32, age: f32) -> (ApproachPlanner, View) {
    let world = World { right: 0.0, ..WORLD };
    let place = Vec3::new(0.0, 0.0, world.crown_z - range);
    let view = View {
        position: place,
        velocity: Vec3::new(0.0, 0.0, sinks),
        heading: world.heading,
        held: place,
        age,
        range_hit: RangeHit {
            surface_point: world.below(place),
            count: 1,
            age: 0.0,
        },
        target: None,
    };
    let mut planner = begun(&world);
    (planner.phase, planner.crown_z) = (Phase::Descend, world.crown_z);
    (planner, view)
}

/// What the planner asks for after a tenth of a second there, m/s down, and in which part of the way it is then.
fn asks_at(range: f32, sinks: f32, age: f32) -> (f32, Phase) {
    let (mut planner, view) = descending(range, sinks, age);
    let command = (0..10).map(|_| planner.step(&view, DT)).last();
    (command.unwrap().unwrap().velocity.z, planner.phase)
}

/// From where a gust carries it aside, nearer than 8 cm flow would see nothing.
#[test]
fn it_stops_at_the_gate_where_it_is_not_known_to_touch_on_the_crown() {
    for gust in [0.30, 0.20, 0.17, 0.15, 0.13, 0.11] {
        let (mut planner, mut view) = descending(LOW, 0.0, 0.02);
        let (mut speed, mut nearest) = (0.0, f32::MAX);
        for i in 1..800u32 {
            let range = WORLD.crown_z - view.position.z;
            nearest = nearest.min(range);
            view.velocity.y = if range < gust { 2.0 * GATE_SPEED } else { 0.0 };
            view.range_hit.count = (i % 256) as u8;
            view.range_hit.surface_point = Some(Vec3::new(0.0, 0.0, WORLD.crown_z));
            let command = planner.step(&view, DT).unwrap();
            if planner.phase == Phase::Commit {
                break;
            }
            // The held point as the hold moves it, the vehicle a fifth of a second behind.
            speed = scalar::slew(speed, command.velocity.z, DT);
            view.held.z += speed * DT;
            view.velocity.z += (speed - view.velocity.z) * (DT / 0.2);
            view.position.z += view.velocity.z * DT;
        }
        assert!(nearest > 0.085, "{gust}: {nearest} m");
        let stands = (WORLD.crown_z - view.position.z - GATE).abs() < 0.01;
        assert!(stands || planner.phase == Phase::Commit, "{gust}: {view:?}");
    }
}

#[test]
fn what_flow_does_not_see_is_not_committed_to_but_waited_for_higher_up() {
    // Over the crown at the gate it goes on; sinking, before it could no longer stop.
    assert_eq!(asks_at(1.2 * GATE, 0.0, 0.02).1, Phase::Commit);
    assert_eq!(asks_at(1.5 * GATE, DESCENT, 0.02).1, Phase::Commit);
    assert_eq!(asks_at(1.5 * GATE, 0.0, 0.02).1, Phase::Descend);
    // Without flow it climbs to where flow sees again, faster than it comes down, and stays there.
    let (down, phase) = asks_at(0.06, 0.0, BLIND + 0.1);
    assert!(
        phase == Phase::Descend && down <= -BACK_SPEED + 1e-3,
        "{down} {phase:?}"
    );
    let (down, phase) = asks_at(SEEING, 0.0, BLIND + 0.1);
    assert!(phase == Phase::Descend && down.abs() < 0.01, "{down} {phase:?}");
}

/// A pose that is left out comes back elsewhere, or not at all: at the gate a gust would carry it onto the pipe.
#[test]
fn without_a_pose_it_climbs_from_the_pipe() {
    for (aside, age, climbs) in [
        (0.0, BLIND - 0.1, false),
        (0.0, BLIND + 0.1, true),
        (2.0 * NEAR_OFF, BLIND + 0.1, true),
    ] {
        let (mut planner, mut view) = descending(1.5 * GATE, 0.0, age);
        view.position.y += aside;
        let target = PipeTarget {
            crown_position: Vec3::new(0.0, 0.0, WORLD.crown_z),
            ..PipeTarget::default()
        };
        (planner, view.target) = (planner.to(&target), Some(target));
        planner.phase = Phase::Descend;
        let command = (0..10).map(|_| planner.step(&view, DT)).last().unwrap().unwrap();
        let up = -command.velocity.z;
        assert_eq!(up > 0.3, climbs, "{aside} {age}: {up}");
    }
}

#[test]
fn a_search_about_where_the_pipe_was_finds_it_from_where_an_escape_ends() {
    let world = World {
        right: -2.3,
        crown_z: 0.2,
        ground: Some(1.7),
        ..WORLD
    };
    let view = View {
        position: Vec3::ZERO,
        velocity: Vec3::ZERO,
        heading: world.heading,
        held: Vec3::ZERO,
        age: 0.0,
        range_hit: RangeHit::default(),
        target: None,
    };
    let p = Params::default();
    assert_eq!(
        flown(world, ApproachPlanner::again(&p, &view, world.heading, 0, false)).0,
        Err(ApproachAbort::NoPipe)
    );
    // The flow has drifted by as much as 0.6 m meanwhile.
    for drift in [-0.6, 0.0, 0.6] {
        let crown_position = about_down(Vec3::new(0.1, world.right + drift, world.crown_z), world.heading);
        let planner = ApproachPlanner::back_to(crown_position, &p, &view, world.heading, 0);
        let (end, at, planner, seconds) = flown(world, planner);
        assert_eq!(end, Ok(()), "{drift}: {planner:?}");
        let (y, x) = world.beside(at);
        assert!(y.abs() < 0.015 && (x - 0.1).abs() < 0.05, "{drift}: {y} {x}");
        assert!(seconds < 60.0, "{drift}: {seconds} s");
    }
}

#[test]
fn a_pipe_whose_edge_is_met_at_the_end_of_the_last_sweep_is_crossed() {
    let right = SWEEP_MAX - 0.03;
    let world = World { right, ..WORLD };
    let (end, at, planner, _) = flown(world, begun(&world));
    assert_eq!(end, Ok(()), "{planner:?}");
    assert!(world.beside(at).0.abs() < 0.015);
}
