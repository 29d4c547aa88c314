//! Contact forces: derivatives, energy, points of action.

use super::super::STEP as DT;
use glam::DVec2;

use super::*;

fn at(position: DVec3) -> Pose {
    Pose {
        position,
        attitude: DQuat::IDENTITY,
        velocity: DVec3::ZERO,
        omega: DVec3::ZERO,
    }
}

#[test]
fn the_pads_path_is_differentiated_right() {
    for arm in 0..4 {
        let skin = ArmSkin::new(arm);
        for alpha in [-1.8, -0.9, -0.3, -2e-3, -1e-4, 0.0, 1e-4, 0.4] {
            for s in STATIONS {
                let (_, by_alpha) = skin.point(alpha, s);
                let h = 1e-5;
                let numeric = (skin.point(alpha + h, s).0 - skin.point(alpha - h, s).0) / (2.0 * h);
                assert!(
                    (by_alpha - numeric).length() < 1e-6,
                    "{arm} {alpha} {s}: {by_alpha} {numeric}"
                );
            }
        }
    }
    // Straight arm, station 0.16 m: 0.16 m out; s²/2L = 71.91 mm of rise per radian.
    let (r, by_alpha) = ArmSkin::new(2).point(0.0, 0.16);
    assert!((r - DVec3::new(0.178, 0.16, UNDERSIDE_Z)).length() < 1e-9);
    assert!((by_alpha - DVec3::new(0.0, 0.0, -0.071_91)).length() < 1e-5);
    assert!(ArmSkin::new(1).point(0.0, 0.16).0.y < 0.0 && ArmSkin::new(1).point(0.0, 0.16).0.x < 0.0);
}

#[test]
fn an_arm_bent_to_the_pipe_s_curvature_lies_on_it() {
    // Root on the crown, arc radius R of the pipe.
    let radius = 0.15;
    let skin = ArmSkin::new(0);
    for s in STATIONS {
        let r = skin.point(-ARM_LENGTH / radius, s).0;
        let from_axis = DVec2::new(r.y, r.z - UNDERSIDE_Z - radius).length();
        assert!((from_axis - radius).abs() < 1e-9);
    }
}

#[test]
fn the_virtual_work_of_the_skin_is_consistent() {
    // Power of generalised and point forces agree while only the arm moves.
    let pipe = Pipe {
        north: 0.0,
        half_length: 1.0,
        east: 0.0,
        down: 0.18,
        radius: 0.15,
        friction: 0.5,
        shape: PipeShape::STRAIGHT,
    };
    let mut skin = ArmSkin::new(3);
    let alpha = -ARM_LENGTH / 0.15 - 0.1;
    let load = skin.step(DT, alpha, 0.0, &at(DVec3::ZERO), &pipe);
    assert!(load.moment_alpha > 0.0 && load.force_body.z < 0.0 && load.pressure > 0.0);
    assert!(ArmSkin::new(3).step(DT, -0.3, 0.0, &at(DVec3::ZERO), &pipe) == SkinLoad::default());
    let away = Pipe { north: 5.0, ..pipe };
    assert!(skin.step(DT, alpha, 0.0, &at(DVec3::ZERO), &away) == SkinLoad::default());
}

#[test]
fn a_body_comes_to_rest_at_its_weight_s_depth_and_stays_on_a_slope_of_friction() {
    let (mass, push) = (1.8, 4.0);
    let mut belly = Belly::default();
    let mut pose = at(DVec3::new(0.0, 0.0, -0.06));
    let mut load = BodyLoad::default();
    for i in 0..6000 {
        load = belly.step(DT, &pose, &Surface::Ground(0.5));
        // 4 N from 1.5 s on, below 0.5 · 17.65 N.
        let side = if i > 3000 { push } else { 0.0 };
        let a = load.force_body / mass + DVec3::new(0.0, side / mass, 9.806_65);
        pose.velocity += a * DT;
        pose.position += pose.velocity * DT;
    }
    // 17.65 N on four springs of 4000 N/m: 1.103 mm.
    assert!(
        (pose.position.z + BELLY_Z - 1.103e-3).abs() < 1e-5,
        "{}",
        pose.position.z
    );
    assert!((load.normal.iter().sum::<f64>() - 17.652).abs() < 0.01);
    // Bristles: 4 N on 16 kN/m.
    assert!((pose.position.y - 0.25e-3).abs() < 2e-5, "{}", pose.position.y);
    assert!(pose.velocity.length() < 1e-4);
}

#[test]
fn beyond_the_friction_it_slides_with_coulomb_s_force() {
    let mut p = ContactPoint::default();
    let mut position = DVec3::new(0.0, 0.0, 0.001);
    let velocity = DVec3::new(0.0, 0.3, 0.0);
    let mut touch = Touch::default();
    for _ in 0..1000 {
        position += velocity * DT;
        touch = p.force(
            DT,
            &BELLY,
            PointMotion { position, velocity },
            &Surface::Ground(0.5),
        );
    }
    assert!((touch.normal - 4.0).abs() < 1e-9 && (touch.force.y + 2.0).abs() < 1e-9);
    let motion = PointMotion {
        position,
        velocity: DVec3::new(0.0, 0.0, -1.0),
    };
    let out = p.force(DT, &BELLY, motion, &Surface::Ground(0.5));
    assert!(out.normal == 0.0 && out.force.length() < 1e-12);
}

#[test]
fn a_drooping_tip_pushes_its_arm_up() {
    let mut tip = ArmTip::new(2);
    // Hinge 20 mm under the body, tip 99 mm under it at 0.46 rad, body at 90 mm.
    let load = tip.step(DT, -0.46, 0.0, &at(DVec3::new(0.0, 0.0, -0.09)));
    // 9.02 mm deep, 1500 N/m; lever L cos α.
    let force = 1500.0 * (HINGE_Z + ARM_LENGTH * libm::sin(0.46_f64) - 0.09);
    assert!((load.force_body - DVec3::new(0.0, 0.0, -force)).length() < 1e-9);
    assert!((load.moment_alpha - force * ARM_LENGTH * libm::cos(0.46_f64)).abs() < 1e-9);
    assert!(load.moment_body.x < 0.0);
}
