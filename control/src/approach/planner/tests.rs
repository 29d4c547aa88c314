//! A vehicle that follows the held point exactly, over a pipe.

use super::*;
use crate::navigation::fix_age::HEIGHT_AGE;

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

    /// What the range sees straight below `p`.
    fn below(&self, p: Vec3) -> Option<Vec3> {
        let (y, x) = self.beside(p);
        let on = y.abs() < self.radius
            && (self.ends.0..self.ends.1).contains(&x)
            && !(self.missed.0..self.missed.1).contains(&x);
        // What is wider than a pipe is flat between such sides.
        let rounded = self.radius.min(WORLD.radius);
        let side = (y.abs() - (self.radius - rounded)).max(0.0);
        let pipe = self.crown_z + rounded - (rounded * rounded - side * side).max(0.0).sqrt();
        let dip = if y > self.dip.1 { self.dip.0 } else { 0.0 };
        let z = if on {
            Some(pipe)
        } else {
            self.ground.map(|ground| ground + dip)
        };
        z.filter(|z| (0.02..REACH).contains(&(z - p.z)))
            .map(|z| Vec3::new(p.x, p.y, z))
    }

    /// The hit of a range straight below `lens`.
    fn hit(&self, lens: Vec3, count: u8) -> RangeHit {
        RangeHit {
            surface_point: self.below(lens),
            lens,
            count,
            age: 0.0,
            ..RangeHit::default()
        }
    }

    /// The same, `seconds` after the beginning.
    fn hit_at(&self, lens: Vec3, count: u8, seconds: f32) -> RangeHit {
        let (from, until, scale) = self.scaled;
        let scale = if (from..until).contains(&seconds) {
            scale
        } else {
            1.0
        };
        let hit = self.hit(lens, count);
        let seen = |point: Vec3| Vec3::new(point.x, point.y, lens.z + scale * (point.z - lens.z));
        RangeHit {
            surface_point: hit
                .surface_point
                .map(seen)
                .filter(|point| point.z - lens.z < REACH),
            age: 0.02,
            ..hit
        }
    }

    /// The levels as they are.
    fn levels(&self) -> SurfaceLevels {
        SurfaceLevels {
            ground: self.ground.unwrap_or(50.0),
            raised: Some(self.crown_z),
        }
    }

    /// A view from `at`, at rest, before any range.
    fn view(&self, at: Vec3) -> View {
        View {
            position: at,
            velocity: Vec3::ZERO,
            heading: self.heading,
            held: at,
            age: 0.0,
            range_hit: RangeHit::default(),
            levels: SurfaceLevels {
                raised: None,
                ..self.levels()
            },
            target: None,
        }
    }
}

/// How an estimator finds the levels: by three ranges that agree, if they are no deeper than the ground over some way, and what is
/// wider than a pipe, or fits nothing for long, is the ground.
struct Surfaces {
    levels: SurfaceLevels,
    /// First hit on another surface, level of the newest, and ranges in a row on it.
    other: (Vec3, f32, u8),
    /// Ranges in a row on no surface that is known.
    refused: u16,
    /// Where the beam came onto what is raised, right, m.
    entered: Option<f32>,
}

impl Surfaces {
    fn of(world: &World) -> Self {
        Self {
            levels: world.view(Vec3::ZERO).levels,
            other: (Vec3::ZERO, 0.0, 0),
            refused: 0,
            entered: None,
        }
    }

    /// Takes a hit from a lens at the height `from`, to the `right` by so much.
    fn take(&mut self, hit: Option<Vec3>, from: f32, right: f32) {
        let Some(point) = hit else {
            (self.other.2, self.refused) = (0, 0);
            return;
        };
        let level = point.z;
        let SurfaceLevels { ground, raised } = &mut self.levels;
        // The back of a pipe falls off.
        let on_raised = |top: &f32| (-MISFIT..0.19).contains(&(level - top));
        if let Some(top) = raised.filter(on_raised) {
            // From the flank up to the crown.
            *raised = Some(top + 0.2 * (level - top).min(0.0));
            let from = *self.entered.get_or_insert(right);
            if (right - from).abs() > 0.48 {
                self.levels = SurfaceLevels {
                    ground: top,
                    raised: None,
                };
            }
        } else if (level - *ground).abs() <= MISFIT {
            self.entered = None;
        } else {
            let (first, before, ranges) = self.other;
            self.other = if ranges > 0 && (level - before).abs() < 0.08 {
                (first, level, ranges.saturating_add(1))
            } else {
                (point, level, 1)
            };
            let (first, _, ranges) = self.other;
            let way = (point.x - first.x).hypot(point.y - first.y);
            let present = raised.filter(|_| self.entered.is_some()).unwrap_or(*ground);
            let near = level.min(present) - from;
            if ranges >= 3 && level < *ground && way > 0.21 * near {
                (*raised, self.entered) = (Some(level), Some(right));
            } else if ranges >= 3 && level > *ground {
                (*raised, *ground, self.entered) = (Some(*ground), level, None);
            }
            self.refused += 1;
            if self.refused as f32 * 2.0 * DT > HEIGHT_AGE {
                self.levels = SurfaceLevels {
                    ground: level,
                    raised: None,
                };
            }
            return;
        }
        (self.other.2, self.refused) = (0, 0);
    }
}

/// How a try ends: the planner, where the vehicle is then, and after how long.
fn flown(world: World, planner: ApproachPlanner) -> (Result<(), ApproachAbort>, Vec3, ApproachPlanner, f32) {
    let (mut planner, mut held, mut speed) = (planner, planner.origin, Vec3::ZERO);
    let (mut range_hit, mut surfaces) = (RangeHit::default(), Surfaces::of(&world));
    for i in 0..12_000 {
        if i % 2 == 0 {
            let lens = held + about_down(planner.lens, world.heading);
            range_hit = world.hit_at(lens, range_hit.count.wrapping_add(1), i as f32 * DT);
            surfaces.take(range_hit.surface_point, lens.z, world.beside(lens).0);
        }
        let view = View {
            velocity: speed,
            range_hit,
            levels: surfaces.levels,
            ..world.view(held)
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
    let view = world.view(Vec3::ZERO);
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
            range_hit: world.hit(held, (i % 256) as u8),
            levels: world.levels(),
            ..world.view(held)
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

/// Where the range is too long the pipe's level falls; from so near that it falls by less the levels lead onto the crown.
#[test]
fn a_range_that_becomes_too_long_ends_it() {
    for from in 5..26u8 {
        // The ground goes out of reach, or does not.
        for ground in [2.2, 1.3] {
            let world = World {
                ground: Some(ground),
                scaled: (f32::from(from), f32::MAX, 1.6),
                ..WORLD
            };
            let (end, at, planner, seconds) = flown(world, begun(&world));
            let above = world.crown_z - at.z;
            match end {
                Err(ApproachAbort::RangeMisfit | ApproachAbort::PipeLost) => assert!(
                    above > 0.15 && seconds < f32::from(from) + 6.0,
                    "{from} {ground}: {above} m, {seconds} s"
                ),
                Ok(()) => assert!(
                    world.beside(at).0.abs() < 0.015 && seconds < f32::from(from) + 3.0,
                    "{from} {ground}: {at:?}, {seconds} s"
                ),
                Err(_) => panic!("{from} {ground}: {end:?} {planner:?}"),
            }
        }
    }
}

#[test]
fn two_wrong_ranges_are_no_misfit() {
    for from in 5..26u8 {
        for (ground, scale) in [(2.2, 1.6), (1.3, 1.6), (2.2, 0.5)] {
            let from = f32::from(from);
            let world = World {
                ground: Some(ground),
                scaled: (from, from + 0.03, scale),
                ..WORLD
            };
            let (end, ..) = flown(world, begun(&world));
            assert_ne!(end, Err(ApproachAbort::RangeMisfit), "{from} {ground} {scale}");
        }
    }
}

#[test]
fn uneven_ground_and_a_range_that_is_a_little_off_are_no_misfit() {
    // A terrace along the pipe, a ditch beside it.
    for dip in [(0.19, 0.0), (-0.19, 0.0), (0.9, 0.0), (0.19, 0.22)] {
        let world = World {
            ground: Some(2.0),
            dip,
            ..WORLD
        };
        let (end, at, planner, _) = flown(world, begun(&world));
        assert_eq!(end, Ok(()), "{dip:?} {planner:?}");
        assert!(world.beside(at).0.abs() < 0.03, "{dip:?}: {at:?}");
    }
    // It moves the ground by less than the smallest pipe is high.
    for scale in [0.85, 1.15] {
        for from in 7..26u8 {
            let world = World {
                ground: Some(1.5),
                scaled: (f32::from(from), f32::MAX, scale),
                ..WORLD
            };
            let (end, ..) = flown(world, begun(&world));
            assert_ne!(end, Err(ApproachAbort::RangeMisfit), "{from} {scale}");
        }
    }
}

/// An estimator knows two surfaces: a third one, by more than the smallest pipe, takes the place of one of them.
#[test]
fn a_third_level_beside_the_pipe_ends_it_before_the_descent() {
    for dip in [(-0.9, 0.0), (0.25, 0.22)] {
        let world = World {
            ground: Some(2.0),
            dip,
            ..WORLD
        };
        let (end, at, ..) = flown(world, begun(&world));
        assert_eq!(end, Err(ApproachAbort::RangeMisfit), "{dip:?}");
        assert!(world.crown_z - at.z > LOW - 0.05, "{dip:?}: {at:?}");
    }
}

/// Before the first crossing nothing is known that they could differ from; a pipe that another computer reports needs no range.
#[test]
fn levels_that_change_after_the_first_crossing_end_it() {
    let levels = WORLD.levels();
    let misfit = Err(ApproachAbort::RangeMisfit);
    for (ground, raised, crossed) in [
        (0.0, Some(0.0), Ok(())),
        (0.0, Some(0.9 * MISFIT), Ok(())),
        (0.0, Some(-0.9 * MISFIT), Ok(())),
        (0.0, Some(1.1 * MISFIT), misfit),
        (0.0, Some(-1.1 * MISFIT), misfit),
        (0.0, None, misfit),
        (-0.9 * MISFIT, Some(0.0), Ok(())),
        (-1.1 * MISFIT, Some(0.0), misfit),
        // Ground that falls off leaves the pipe where it is.
        (5.0 * MISFIT, Some(0.0), Ok(())),
    ] {
        let other = SurfaceLevels {
            ground: levels.ground + ground,
            raised: raised.map(|off| WORLD.crown_z + off),
        };
        let (mut planner, mut view) = descending(LOW, 0.0, 0.02);
        let before = levels.raised.map(|pipe| [levels.ground, pipe]);
        (view.levels, planner.crossed_levels) = (other, before);
        assert_eq!(planner.step(&view, DT).map(|_| ()), crossed, "{other:?}");
        planner.crossed_levels = None;
        assert!(planner.step(&view, DT).is_ok(), "{other:?}");
        planner.crossed_levels = before;
        let target = PipeTarget {
            crown_position: Vec3::new(0.0, 0.0, WORLD.crown_z),
            ..PipeTarget::default()
        };
        (planner, view.target) = (planner.to(&target), Some(target));
        assert!(planner.step(&view, DT).is_ok(), "{other:?}");
    }
}

#[test]
fn the_levels_of_the_first_crossing_are_kept() {
    let (end, _, planner, _) = flown(WORLD, begun(&WORLD));
    assert_eq!(end, Ok(()));
    let [ground, pipe] = planner.crossed_levels.unwrap();
    assert!((pipe - WORLD.crown_z).abs() < 0.005 && ground == WORLD.ground.unwrap());
}

/// An edge at `y` over which the beam moves by `way`.
fn edge(y: f32, way: (f32, f32), onto: bool) -> Option<Edge> {
    let (x, across) = way;
    Some(Edge {
        at: Vec3::new(0.0, y, WORLD.crown_z),
        way: Vec3::new(x, across, 0.0),
        onto,
    })
}

#[test]
fn edges_move_a_crown_that_has_drifted_and_the_beams_way_says_of_which_side_they_are() {
    // From the left the beam comes onto the pipe at its left side and falls off at the right one, and the other way round.
    for (way, onto, side) in [
        (0.007, true, -1.0),
        (0.007, false, 1.0),
        (-0.007, true, 1.0),
        (-0.007, false, -1.0),
    ] {
        for drift in [-0.1, -0.04, 0.06, 0.1] {
            let (mut planner, _) = descending(LOW, 0.0, 0.02);
            // Five seconds of flow since the crossing.
            planner.crown_variance = 0.5 * EDGE * EDGE + 5.0 * DRIFT * DRIFT;
            let variance = planner.crown_variance;
            assert!(planner.follow_edge(edge(drift + side * planner.half, (0.002, way), onto)));
            let off = planner.crown_y - drift;
            assert!(off.abs() < 0.08 * drift.abs(), "{way} {onto} {drift}: {off}");
            assert!(planner.crown_variance < EDGE * EDGE && planner.crown_variance < variance);
            // The edge of its other side agrees, and moves it less.
            assert!(planner.follow_edge(edge(drift - side * planner.half, (0.002, way), !onto)));
            assert!((planner.crown_y - drift).abs() < off.abs());
        }
        // Where the crown cannot be it does not go.
        let (mut planner, _) = descending(LOW, 0.0, 0.02);
        planner.crown_variance = 0.5 * EDGE * EDGE;
        assert!(!planner.follow_edge(edge(0.2 + side * planner.half, (0.0, way), onto)));
        assert_eq!(planner.crown_y, 0.0);
    }
    // Lengthwise near the crown it is an end, which says nothing of the crown.
    let (mut planner, _) = descending(LOW, 0.0, 0.02);
    planner.crown_variance = 5.0 * DRIFT * DRIFT;
    assert!(planner.follow_edge(edge(0.05, (0.007, 0.002), false)) && planner.crown_y == 0.0);
}

/// A descent during which the place by flow is off by `drift` to the right, and a gust at `gust` s carries the vehicle `aside` for
/// `lasts` s: how it ends, the crown where it is known then, and the least range.
fn gusty_descent(drift: f32, (gust, lasts, aside): (f32, f32, f32)) -> (Option<ApproachAbort>, f32, f32) {
    let world = World {
        right: drift,
        ..WORLD
    };
    let (mut planner, mut view) = descending(LOW, 0.0, 0.02);
    planner.crown_variance = 0.5 * EDGE * EDGE + 5.0 * DRIFT * DRIFT;
    let (mut along, mut off, mut nearest) = (view.held, 0.0, f32::MAX);
    for i in 0..1200u32 {
        let seconds = i as f32 * DT;
        let blown = (gust..gust + lasts).contains(&seconds);
        off = scalar::slew(off, if blown { aside } else { 0.0 }, 0.3 * DT);
        view.held = along;
        view.position = along + about_down(Vec3::new(0.0, off, 0.0), world.heading);
        if i % 2 == 0 {
            view.range_hit = world.hit(view.position, view.range_hit.count.wrapping_add(1));
        }
        match planner.step(&view, DT) {
            Ok(command) => along += about_down(command.velocity, world.heading) * DT,
            Err(doubt) => return (Some(doubt), planner.crown_y, nearest),
        }
        nearest = nearest.min(world.crown_z - along.z);
        if planner.phase == Phase::Commit {
            break;
        }
    }
    (None, planner.crown_y, nearest)
}

#[test]
fn an_edge_in_the_descent_corrects_the_crown_and_a_pipe_that_stays_away_is_lost() {
    for drift in [-0.04, 0.0, 0.04] {
        for aside in [-0.25, 0.25] {
            let (end, crown, _) = gusty_descent(drift, (0.3, 0.9, aside));
            assert_eq!(end, None, "{drift} {aside}");
            assert!((crown - drift).abs() < 0.015, "{drift} {aside}: {crown}");
        }
    }
    // Meanwhile it does not come down.
    let (end, _, nearest) = gusty_descent(0.0, (0.3, 9.0, 0.3));
    assert_eq!(end, Some(ApproachAbort::PipeLost));
    assert!(nearest > NEAR - 0.05, "{nearest}");
}

#[test]
fn without_a_range_and_where_nothing_is_touched_it_gives_up() {
    let mut planner = begun(&WORLD);
    let mut view = View {
        range_hit: RangeHit {
            age: RANGE_AGE - 0.01,
            ..RangeHit::default()
        },
        ..WORLD.view(Vec3::ZERO)
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
    let view = world.view(Vec3::new(0.0, 0.0, 0.5));
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
            range_hit: world.hit(Vec3::ZERO, 1),
            levels: world.levels(),
            ..world.view(Vec3::ZERO)
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
        velocity: Vec3::new(0.0, 0.0, sinks),
        age,
        range_hit: world.hit(place, 1),
        levels: world.levels(),
        ..world.view(place)
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
    let view = world.view(Vec3::ZERO);
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

/// The wind has carried it away from where the crown is known to be.
#[test]
fn another_try_after_the_crown_was_known_searches_about_where_the_pipe_was() {
    let (end, _, descended, _) = flown(WORLD, begun(&WORLD));
    assert_eq!(end, Ok(()));
    let p = Params::default();
    for phase in [
        Phase::Over,
        Phase::Fore,
        Phase::Cross,
        Phase::Centre,
        Phase::Descend,
        Phase::Commit,
    ] {
        let planner = ApproachPlanner { phase, ..descended };
        for right in [-1.8, 2.4] {
            let away = about_down(Vec3::new(0.2, right, WORLD.crown_z - LOW), WORLD.heading);
            let next = planner.retried(&p, &WORLD.view(away), WORLD.heading, 0);
            assert!(next.climbs() && next.crossed_levels.is_none());
            let (end, at, planner, seconds) = flown(WORLD, next);
            assert_eq!(end, Ok(()), "{phase:?} {right}: {planner:?}");
            assert!(
                WORLD.beside(at).0.abs() < 0.015 && seconds < 60.0,
                "{phase:?} {right}: {at:?}"
            );
        }
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
