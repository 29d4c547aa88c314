//! A vehicle that follows the held point exactly, over a pipe.

use super::*;

const DT: f32 = 0.01;

/// The pipe runs along `heading` through a point `right` of the origin, its crown `down` below the origin's height.
#[derive(Clone, Copy)]
struct World {
    heading: f32,
    right: f32,
    crown: f32,
    ground: Option<f32>,
    radius: f32,
    /// Of the ends from the origin, along the heading, m.
    ends: (f32, f32),
    /// Where along it the beam misses it for a moment, m.
    missed: (f32, f32),
}

const WORLD: World = World {
    heading: 0.4,
    right: 0.3,
    crown: 0.7,
    ground: Some(2.2),
    radius: 0.15,
    ends: (-1.0, 1.0),
    missed: (5.0, 5.0),
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
        let pipe = self.crown + self.radius - (self.radius * self.radius - y * y).max(0.0).sqrt();
        let z = if on { Some(pipe) } else { self.ground };
        z.filter(|z| (0.02..2.5).contains(&(z - p.z)))
            .map(|z| Vec3::new(p.x, p.y, z))
    }
}

/// How a try ends: the law, where the vehicle is then, and after how long.
fn flown(world: World, law: Approach) -> (Result<(), Doubt>, Vec3, Approach, f32) {
    let (mut law, mut held, mut speed) = (law, law.origin, Vec3::ZERO);
    let mut foot = Foot::default();
    for i in 0..12_000 {
        if i % 2 == 0 {
            foot = Foot {
                point: world.below_lens(held, law.lens),
                count: foot.count.wrapping_add(1),
                age: 0.02,
            };
        }
        let view = View {
            position: held,
            velocity: speed,
            heading: world.heading,
            held,
            foot,
            target: None,
        };
        match law.step(&view, DT) {
            Ok(wish) => {
                let wished = about_down(wish.velocity, world.heading);
                let slew = |a: f32, b: f32| math::slew(a, b, DT);
                speed = Vec3::new(
                    slew(speed.x, wished.x),
                    slew(speed.y, wished.y),
                    slew(speed.z, wished.z),
                );
                held += speed * DT;
            }
            Err(doubt) => return (Err(doubt), held, law, i as f32 * DT),
        }
        let (y, _) = world.beside(held);
        let touches = y.abs() < world.radius && held.z > world.crown - 0.05;
        if law.has_left() || (touches && law.committed()) {
            return (Ok(()), held, law, i as f32 * DT);
        }
    }
    panic!("neither touch nor doubt in 120 s: {law:?}");
}

fn begun(world: &World) -> Approach {
    begun_by(world, &Params::default())
}

fn begun_by(world: &World, p: &Params) -> Approach {
    let view = View {
        position: Vec3::ZERO,
        velocity: Vec3::ZERO,
        heading: world.heading,
        held: Vec3::ZERO,
        foot: Foot::default(),
        target: None,
    };
    Approach::begin(p, &view, world.heading, 0)
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
            let (end, at, law, seconds) = flown(world, begun(&world));
            let (y, x) = world.beside(at);
            assert_eq!(end, Ok(()), "{right} {ground:?} {law:?}");
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
            let (end, at, law, _) = flown(world, begun_by(&world, &p));
            let (right, ahead) = world.beside(at);
            assert_eq!(end, Ok(()), "{x} {y} {z} {ends:?} {law:?}");
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
            Err(Doubt::TooShort),
            "{x} {y} {z}"
        );
    }
}

#[test]
fn it_sinks_no_faster_than_it_may_and_only_over_the_crown() {
    let world = WORLD;
    let (mut law, mut held) = (begun(&world), Vec3::ZERO);
    for i in 0..6000u32 {
        let view = View {
            position: held,
            velocity: Vec3::ZERO,
            heading: world.heading,
            held,
            foot: Foot {
                point: world.below(held),
                count: (i % 256) as u8,
                age: 0.0,
            },
            target: None,
        };
        let wish = law.step(&view, DT).unwrap();
        let v = wish.velocity;
        assert!(v.z <= DESCENT && v.x.hypot(v.y) < 0.5, "{v:?}");
        held += about_down(v, world.heading) * DT;
        let (y, _) = world.beside(held);
        let range = world.crown - held.z;
        assert!(range > LOW - 0.1 || y.abs() < 0.05, "{range} m over it at {y} m");
        if law.phase == Phase::Commit {
            assert!(v.y.abs() <= CORRECT_SPEED, "{v:?}");
            return;
        }
    }
    panic!("never at the gate: {law:?}");
}

#[test]
fn it_keeps_away_from_an_end_and_refuses_a_pipe_that_is_too_short() {
    for (ends, wanted) in [((-1.0, 0.2), -0.1), ((-0.1, 2.0), 0.2), ((-0.31, 0.31), 0.0)] {
        let world = World { ends, ..WORLD };
        let (end, at, law, _) = flown(world, begun(&world));
        let (y, x) = world.beside(at);
        assert_eq!(end, Ok(()), "{ends:?} {law:?}");
        assert!(y.abs() < 0.015 && (x - wanted).abs() < 0.03, "{ends:?}: {y} {x}");
    }
    let short = World {
        ends: (-0.2, 0.25),
        ..WORLD
    };
    assert_eq!(flown(short, begun(&short)).0, Err(Doubt::TooShort));
}

#[test]
fn what_the_beam_comes_back_onto_has_not_ended() {
    for missed in [(0.1, 0.2), (-0.25, -0.15)] {
        let world = World { missed, ..WORLD };
        let (end, at, law, _) = flown(world, begun(&world));
        let (y, x) = world.beside(at);
        assert_eq!(end, Ok(()), "{missed:?} {law:?}");
        assert!(y.abs() < 0.015 && x.abs() < 0.03, "{missed:?}: {y} {x}");
    }
}

#[test]
fn what_is_no_pipe_or_too_wide_for_it_is_none() {
    let none = World { right: 5.0, ..WORLD };
    let (end, at, ..) = flown(none, begun(&none));
    assert_eq!(end, Err(Doubt::NoPipe));
    // Where it gives up the height is that of the beginning.
    assert!(at.z.abs() < 1e-3, "{at:?}");
    let wall = World { radius: 0.4, ..WORLD };
    assert_eq!(flown(wall, begun(&wall)).0, Err(Doubt::NoPipe));
}

#[test]
fn without_a_range_and_where_nothing_is_touched_it_gives_up() {
    let mut law = begun(&WORLD);
    let mut view = View {
        position: Vec3::ZERO,
        velocity: Vec3::ZERO,
        heading: 0.4,
        held: Vec3::ZERO,
        foot: Foot {
            age: RANGE_AGE - 0.01,
            ..Foot::default()
        },
        target: None,
    };
    assert!(law.step(&view, DT).is_ok());
    view.foot.age = RANGE_AGE + 0.01;
    assert_eq!(law.step(&view, DT), Err(Doubt::RangeStale));
    law.phase = Phase::Commit;
    let steps = (0..1000).take_while(|_| law.step(&view, DT).is_ok()).count();
    assert!((steps as f32 * DT - TOUCH_WAIT).abs() < 0.05, "{steps}");
    view.position.y = 0.2;
    law.since = 0.0;
    assert_eq!(law.step(&view, DT), Err(Doubt::NotCentred));
    // The wind keeps it from sweeping.
    let mut law = begun(&WORLD);
    view.foot.age = 0.0;
    let steps = (0..10_000).take_while(|_| law.step(&view, DT).is_ok()).count();
    assert!((steps as f32 * DT - SEARCH_TIME).abs() < 0.1, "{steps}");
    assert_eq!(law.step(&view, DT), Err(Doubt::NoPipe));
}

#[test]
fn another_try_climbs_before_it_searches_and_leaving_only_climbs() {
    let world = WORLD;
    let view = View {
        position: Vec3::new(0.0, 0.0, 0.5),
        velocity: Vec3::ZERO,
        heading: world.heading,
        held: Vec3::new(0.0, 0.0, 0.5),
        foot: Foot::default(),
        target: None,
    };
    let law = Approach::again(&Params::default(), &view, world.heading, 0, true);
    let (end, at, ..) = flown(world, law);
    assert_eq!(end, Ok(()));
    assert!((at.z - 0.5 + HIGH).abs() < 0.1, "{at:?}");
    let law = Approach::again(&Params::default(), &view, world.heading, 0, false);
    let (end, at, ..) = flown(world, law);
    assert_eq!(end, Ok(()));
    assert!(world.beside(at).0.abs() < 0.015, "{at:?}");
}
