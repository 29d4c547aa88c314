//! Shape of a real pipe: slope, sag, softness.

use super::super::{BELLY, ContactPoint, PointMotion, Surface};
use super::*;
use crate::plant::STEP;

const PIPE: Pipe = Pipe {
    north: 3.0,
    half_length: 2.0,
    east: 0.5,
    down: -1.35,
    radius: 0.15,
    friction: 0.6,
    shape: PipeShape::STRAIGHT,
};

fn with(shape: PipeShape) -> Pipe {
    Pipe { shape, ..PIPE }
}

fn sloping(degrees: f64) -> Pipe {
    with(PipeShape {
        slope: degrees.to_radians(),
        ..PipeShape::STRAIGHT
    })
}

/// Down from 3 m over the ground at `north`, m.
fn crown(pipe: &Pipe, north: f64) -> f64 {
    let way = pipe.or_ground_along(DVec3::new(north, 0.5, -3.0), DVec3::Z);
    way.unwrap() - 3.0
}

#[test]
fn a_slope_rises_to_the_north_and_turns_its_normal_back() {
    let pipe = sloping(5.0);
    // Straight down on a cylinder that slopes: its crown lies radius / cos over the axis.
    let level = -1.35 - 0.15 / libm::cos(5f64.to_radians());
    assert!((crown(&pipe, 3.0) - level).abs() < 1e-9);
    let rise = crown(&pipe, 3.0) - crown(&pipe, 4.0);
    assert!((rise - libm::tan(5f64.to_radians())).abs() < 1e-9, "{rise}");
    let (depth, n) = pipe.probe(DVec3::new(3.0, 0.5, level + 1e-3)).unwrap();
    assert!(
        (depth - 1e-3 * libm::cos(5f64.to_radians())).abs() < 1e-6,
        "{depth}"
    );
    let leant = DVec3::new(-libm::sin(5f64.to_radians()), 0.0, -libm::cos(5f64.to_radians()));
    assert!((n - leant).length() < 1e-6, "{n}");
    assert!((pipe.normal(DVec3::new(3.0, 0.5, level)) - leant).length() < 1e-6);
    // Beyond its end, along the slope.
    assert!(pipe.probe(DVec3::new(5.01, 0.5, -1.52)).is_none());
}

#[test]
fn without_a_shape_it_is_the_cylinder() {
    let (depth, n) = PIPE.probe(DVec3::new(4.0, 0.5, -1.499)).unwrap();
    assert!((depth - 1e-3).abs() < 1e-12 && n == DVec3::NEG_Z);
    for (a, b) in [
        (sloping(1e-9), PIPE),
        (
            with(PipeShape {
                sag: 1e-12,
                ..PipeShape::STRAIGHT
            }),
            PIPE,
        ),
    ] {
        assert!((crown(&a, 4.5) - crown(&b, 4.5)).abs() < 1e-6);
    }
}

#[test]
fn a_sagging_pipe_is_low_in_the_middle_and_leans_towards_it() {
    let pipe = with(PipeShape {
        sag: 0.08,
        ..PipeShape::STRAIGHT
    });
    assert!((crown(&pipe, 3.0) + 1.5).abs() < 1e-9);
    assert!((crown(&pipe, 4.999) + 1.58).abs() < 1e-3);
    // At half its half length: a quarter of the sag, a slope of 2 · 0.08 · 1 / 4.
    assert!((crown(&pipe, 4.0) + 1.52).abs() < 1e-4, "{}", crown(&pipe, 4.0));
    let (_, n) = pipe.probe(DVec3::new(4.0, 0.5, -1.519)).unwrap();
    assert!((n.x + 0.04).abs() < 1e-3 && n.z < -0.99, "{n}");
}

#[test]
fn cladding_is_a_spring_in_series_and_a_vibration_moves_the_surface() {
    let press = |pipe: &Pipe, z: f64| {
        let motion = PointMotion {
            position: DVec3::new(3.0, 0.5, z),
            velocity: DVec3::ZERO,
        };
        ContactPoint::default().force(STEP, &BELLY, motion, &Surface::Pipe(*pipe))
    };
    let soft = with(PipeShape {
        softness: 1.0 / BELLY.stiffness,
        ..PipeShape::STRAIGHT
    });
    let (hard, soft) = (press(&PIPE, -1.498).normal, press(&soft, -1.498).normal);
    assert!(
        (hard - 8.0).abs() < 1e-9 && (soft - 4.0).abs() < 1e-9,
        "{hard} {soft}"
    );
    // Rising at 10 mm/s it presses with its damping more.
    let rising = with(PipeShape {
        heave: -1e-3,
        heave_speed: -0.01,
        ..PipeShape::STRAIGHT
    });
    let pushed = press(&rising, -1.499).normal;
    assert!((pushed - (8.0 + 0.01 * BELLY.damping)).abs() < 1e-9, "{pushed}");
}

#[test]
fn a_flange_is_met_from_above() {
    let pipe = with(PipeShape {
        flange: Flange {
            spacing: 1.5,
            at: 0.5,
            height: 0.07,
        },
        ..PipeShape::STRAIGHT
    });
    assert!((crown(&pipe, 3.5) + 1.57).abs() < 1e-9 && (crown(&pipe, 3.0) + 1.5).abs() < 1e-9);
    let (depth, n) = pipe.probe(DVec3::new(2.0, 0.5, -1.568)).unwrap();
    assert!((depth - 2e-3).abs() < 1e-9 && n == DVec3::NEG_Z, "{depth} {n}");
    assert!((pipe.largest_radius() - 0.22).abs() < 1e-12);
}
