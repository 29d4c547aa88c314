//! A vehicle that moves up and down, felt with a constant error, and what its estimate says of it.

use super::*;
use crate::maths::scalar::sin;
use crate::maths::vector::Vec3;
use crate::navigation::range_hit::RangeHit;

const DT: f32 = 0.01;

struct World {
    vertical_fallback: VerticalFallback,
    estimate: Option<Estimate>,
    /// Down, m and m/s.
    at: f32,
    speed: f32,
    time: f32,
    /// Added to the estimate's speed, m/s, and what has come of it, m.
    bent: f32,
    off: f32,
    /// Error of the felt acceleration, m/s².
    bias: f32,
    range_hit: RangeHit,
    age: f32,
    /// Over a crown, near it.
    steady: bool,
    named: bool,
}

impl World {
    fn new() -> Self {
        Self {
            vertical_fallback: VerticalFallback::default(),
            estimate: None,
            at: -2.0,
            speed: 0.0,
            time: 0.0,
            bent: 0.0,
            off: 0.0,
            bias: 0.05,
            range_hit: RangeHit {
                surface_point: Some(Vec3::ZERO),
                age: 0.02,
                ..RangeHit::default()
            },
            age: 0.02,
            steady: false,
            named: false,
        }
    }

    /// After half a minute of a sound module.
    fn learnt() -> Self {
        let mut w = Self::new();
        w.run(30.0);
        w
    }

    fn run(&mut self, seconds: f32) {
        for _ in 0..(seconds / DT) as u32 {
            self.time += DT;
            let speed = 0.2 * sin(0.7 * self.time);
            let down = (speed - self.speed) / DT + self.bias;
            self.speed = speed;
            self.at += speed * DT;
            self.off += self.bent * DT;
            let estimate = Estimate {
                position: Vec3::new(0.0, 0.0, self.at + self.off),
                velocity: Vec3::new(0.0, 0.0, speed + self.bent),
                range_hit: self.range_hit,
                age: self.age,
                ..Estimate::default()
            };
            self.estimate = Some(estimate);
            self.vertical_fallback.steady = self.steady;
            self.vertical_fallback
                .step(true, down, self.estimate.as_ref(), DT);
            self.named |= self.vertical_fallback.misfit();
        }
    }

    /// Nothing is within reach.
    fn blinded(mut self) -> Self {
        (self.range_hit.surface_point, self.age) = (None, 0.2);
        self
    }

    fn out(&self) -> Estimate {
        self.vertical_fallback.apply(self.estimate.unwrap())
    }
}

#[test]
fn a_sound_estimate_is_left_unchanged() {
    let w = World::learnt();
    assert_eq!(Some(w.out()), w.estimate);
    let mut w = w.blinded();
    w.run(3.0);
    assert_eq!(Some(w.out()), w.estimate);
}

/// The range of a vehicle that went off the flank of a pipe with a wrong scale was out of reach: it sank at the wrong speed.
#[test]
fn where_nothing_gives_the_height_a_bent_speed_is_not_flown_by() {
    let mut w = World::learnt().blinded();
    w.bent = -0.2;
    w.run(2.0);
    let out = w.out();
    assert!((out.velocity.z - w.speed).abs() < 0.05, "{out:?} {}", w.speed);
    // A tenth of a second passes before it counts.
    assert!((out.position.z - w.at).abs() < 0.1, "{out:?} {}", w.at);
    assert!((out.position.z - w.estimate.unwrap().position.z) > 0.3);
    assert!(!w.named);
    // Longer than a height may be carried by what is felt the position is none.
    assert!(out.age < 0.3);
    w.run(2.2);
    assert!(w.out().age > HEIGHT_AGE, "{:?}", w.out());
}

/// Poses that had been scaled were left out, and what they had bent of the acceleration was flown by for seconds.
#[test]
fn where_poses_have_gone_their_bent_speed_is_not_flown_by() {
    let mut w = World::new();
    w.range_hit = RangeHit::default();
    w.run(30.0);
    (w.age, w.bent) = (0.2, -0.2);
    w.run(1.0);
    let out = w.out();
    assert!((out.velocity.z - w.speed).abs() < 0.05, "{out:?} {}", w.speed);
    assert!((out.position.z - w.at).abs() < 0.1, "{out:?} {}", w.at);
    assert!(!w.named);
}

/// After a gap of 0.4 s in a fast flight the inertial speed, off by its own drift, was flown by although the poses had
/// come back, and 4 s later there was no position.
#[test]
fn poses_that_come_back_give_the_height_again() {
    let mut w = World::new();
    w.range_hit = RangeHit::default();
    w.run(30.0);
    (w.age, w.bent) = (0.2, -0.2);
    w.run(0.4);
    assert!((w.out().velocity.z - w.speed).abs() < 0.05);
    w.age = 0.02;
    w.run(5.0);
    let (out, estimate) = (w.out(), w.estimate.unwrap());
    assert!(out.velocity == estimate.velocity && out.age < 0.1, "{out:?}");
    assert!((out.position.z - estimate.position.z).abs() < 1e-3);
}

#[test]
fn an_inconsistent_range_is_a_fault_once_the_bias_is_learnt() {
    for (seconds, bent, flown, named) in [
        (30.0, 0.2, false, false),
        (30.0, -0.35, true, true),
        (30.0, 0.35, true, true),
        (1.0, 0.35, false, false),
        (1.0, 0.6, true, false),
    ] {
        let mut w = World::new();
        w.bias = 0.0;
        w.run(seconds);
        w.bent = bent;
        w.run(0.3);
        let out = w.out();
        let by_felt = (out.velocity.z - w.speed).abs() < 0.08;
        assert_eq!((by_felt, w.named), (flown, named), "{seconds} {bent}: {out:?}");
    }
    // What a pose says of the speed is judged elsewhere.
    let mut w = World::learnt();
    (w.range_hit, w.bent) = (RangeHit::default(), 0.5);
    w.run(1.0);
    assert_eq!(Some(w.out()), w.estimate);
}

/// At the gate, 10 cm over the crown, a range that becomes 1.6 times too long bends it by no more than 0.12 m/s.
#[test]
fn close_above_a_crown_a_smaller_speed_error_is_a_fault() {
    for (steady, bent, named) in [
        (true, 0.08, false),
        (true, 0.12, true),
        (true, -0.12, true),
        (false, 0.12, false),
    ] {
        let mut w = World::learnt();
        w.bias = 0.0;
        w.run(30.0);
        (w.steady, w.bent) = (steady, bent);
        w.run(0.1);
        assert_eq!(w.named, named, "{steady} {bent}");
    }
}

#[test]
fn what_was_flown_by_it_is_given_back_or_is_another_origin() {
    for (seconds, reset_count) in [(0.3, 0), (1.0, 1)] {
        let mut w = World::learnt();
        w.bent = 0.4;
        w.run(seconds);
        let before = w.out().position.z;
        // The surface_point stays as far below the vehicle.
        let way = |e: &Estimate| e.range_hit.surface_point.unwrap().z - e.position.z;
        assert!((way(&w.out()) - way(&w.estimate.unwrap())).abs() < 1e-5);
        (w.bent, w.off) = (0.0, 0.4 * seconds);
        w.run(0.03);
        let out = w.out();
        assert_eq!(out.reset_count, reset_count, "{seconds}");
        assert_eq!(
            (out.position.z - before).abs() < 0.04,
            reset_count == 0,
            "{seconds}: {out:?}"
        );
        w.run(5.0);
        let given = (w.out().position.z - w.estimate.unwrap().position.z).abs();
        assert!(given < 1e-3, "{seconds}: {given}");
    }
}

#[test]
fn on_the_pipe_it_stands() {
    let mut w = World::learnt();
    w.bent = 0.4;
    w.run(0.5);
    assert!(w.out() != w.estimate.unwrap());
    w.vertical_fallback.step(false, 0.5, w.estimate.as_ref(), DT);
    assert!(w.out().velocity == w.estimate.unwrap().velocity);
}
