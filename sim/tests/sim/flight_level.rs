//! The flight level on the soft vehicle, by allocation.

use sophie_control::allocation::wrench::Configuration::{A, B};
use sophie_sim::mixers::Variant::{Flexible, Frozen, Paper, Rigid};
use sophie_sim::scenario::Scenario;
use sophie_sim::test_stands::flight_level::{Maneuver, Rig, level, vehicle};

/// 15 s with the paper's roll to 25° and back.
fn doublet(t: f64) -> Maneuver {
    let roll = match t {
        8.0..9.5 => 25f32.to_radians(),
        9.5..11.0 => -25f32.to_radians(),
        _ => 0.0,
    };
    Maneuver { roll, yaw_rate: 0.0 }
}

#[test]
fn it_hovers() {
    let e = Rig::new(&Scenario::default_mission()).fly(15.0, level);
    assert!(
        e.worst_roll < 3.0 && e.worst_pitch < 3.0 && e.worst_yaw < 6.0,
        "{e:?}"
    );
}

#[test]
fn it_turns_with_the_stick() {
    let mut rig = Rig::new(&Scenario::default_mission());
    rig.fly(12.0, |t| Maneuver {
        roll: 0.0,
        yaw_rate: if (5.0..9.0).contains(&t) { 0.4 } else { 0.0 },
    });
    let yaw = rig.plant.euler()[2];
    assert!((1.4..1.8).contains(&yaw), "{yaw}");
}

#[test]
fn the_flexible_mixer_flies_b_for_every_gain_and_infill() {
    for gain_k in [1.0, 5.03, 7.75, 8.4] {
        for infill in [4.0, 6.0, 6.9, 8.0, 10.0] {
            let e = Rig::new(&vehicle(B, gain_k, infill, Flexible)).fly(16.0, doublet);
            assert!(
                e.worst_yaw < 6.0 && e.rms_roll < 8.0,
                "K {gain_k}, {infill} %: {e:?}"
            );
        }
    }
}

#[test]
fn rigid_and_paper_lose_yaw_in_a_where_c_exceeds_one_and_only_there() {
    for mixer in [Rigid, Paper] {
        let lost = Rig::new(&vehicle(A, 7.75, 6.9, mixer)).fly(16.0, level);
        assert!(lost.worst_yaw > 60.0, "{mixer:?} {lost:?}");
        let kept = Rig::new(&vehicle(A, 1.0, 6.9, mixer)).fly(16.0, level);
        assert!(kept.worst_yaw < 6.0, "{mixer:?} {kept:?}");
    }
}

#[test]
fn the_frozen_inverse_limit_cycles_where_c_is_large_and_only_there() {
    let cycling = Rig::new(&vehicle(B, 7.75, 6.9, Frozen)).fly(16.0, level);
    let stiff = Rig::new(&vehicle(B, 1.0, 6.9, Frozen)).fly(16.0, level);
    let flexible = Rig::new(&vehicle(B, 7.75, 6.9, Flexible)).fly(16.0, level);
    assert!(cycling.swing > 1.5 && cycling.worst_yaw > 5.0, "{cycling:?}");
    assert!(
        stiff.swing < 0.7 && flexible.swing < 0.7,
        "{stiff:?} {flexible:?}"
    );
}

#[test]
fn mismatched_arms_are_learnt_by_their_sensors() {
    // Arms up to 15 % and 3° off, gusts of 0.35 N and 0.015 N·m, equal true loop gain: a rigid mixer's yaw commands
    // come out 1 - C = 4.9 times larger.
    let off = |mixer, loop_gain: f32, sensors: bool| {
        let mut s = vehicle(B, 7.75, 6.9, mixer);
        s.vehicle.arm_gain = [1.15, 0.85, 0.9, 1.1];
        s.vehicle.arm_offset = [3.0, -3.0, 2.0, -2.0].map(f64::to_radians);
        s.world.gust_force = 0.35;
        s.world.gust_moment = 0.015;
        s.params.rate_yaw_p *= loop_gain;
        s.params.rate_yaw_i *= loop_gain;
        if !sensors {
            s.params.tilt_bias_gain = 0.0;
        }
        Rig::new(&s).fly(40.0, level).rms_yaw
    };
    let with = off(Flexible, 1.0, true);
    let without = off(Flexible, 1.0, false);
    let rigid = off(Rigid, 1.0 / 4.9, false);
    assert!(
        with < 3.0 && without > 2.0 * with && rigid > 2.0 * with,
        "{with} {without} {rigid}"
    );
}

#[test]
fn rate_and_direct_setpoints_fly_and_hand_back_without_a_kick() {
    use sophie_control::allocation::wrench::Wrench;
    use sophie_control::chain::setpoint::Setpoint;
    use sophie_control::maths::vector::Vec3;

    const WEIGHT: f32 = 17.7;
    let level = Setpoint::Angle {
        roll: 0.0,
        pitch: 0.0,
        yaw_rate: 0.0,
        thrust: WEIGHT,
    };
    let rate = Setpoint::Rate {
        rate: Vec3::new(0.6, 0.0, 0.0),
        thrust: WEIGHT,
    };
    let moment = Wrench {
        thrust: WEIGHT,
        roll: 0.02,
        ..Wrench::default()
    };
    for (setpoint, seconds, least, most) in [
        (rate, 0.5, 8.0, 22.0),
        (Setpoint::Direct { wrench: moment }, 0.5, 3.0, 15.0),
    ] {
        let mut rig = Rig::new(&Scenario::default_mission());
        rig.fly(10.0, |_| Maneuver {
            roll: 0.0,
            yaw_rate: 0.0,
        });
        for _ in 0..(seconds * 1000.0) as usize {
            rig.step(setpoint);
        }
        let rolled = rig.plant.euler()[0].to_degrees();
        assert!((least..most).contains(&rolled), "{setpoint:?}: {rolled}");
        let (mut farthest, mut swung) = (rolled, rolled);
        for _ in 0..3000 {
            rig.step(level);
            let roll = rig.plant.euler()[0].to_degrees();
            farthest = farthest.max(roll);
            swung = swung.min(roll);
        }
        let end = rig.plant.euler()[0].to_degrees();
        assert!(
            farthest < rolled + 12.0 && swung > -8.0 && end.abs() < 3.0,
            "{setpoint:?}: {farthest} {swung} {end}"
        );
    }
}
