//! The flexible allocation, by hand and by the arms' static model.

use proptest::prelude::*;

use super::*;
use crate::allocation::desaturation::Given;

const HOVER: Wrench = Wrench {
    thrust: 17.7,
    roll: 0.0,
    pitch: 0.0,
    yaw: 0.0,
};

fn conditions() -> Conditions {
    Conditions {
        yaw: true,
        thrust_ratio: 1.0,
        dt: 1e-3,
    }
}

fn settled(w: Wrench) -> (Flexible, Mix) {
    let mut m = Flexible::new(Configuration::B, &Params::default());
    let mut mix = m.mix(&w, conditions());
    for _ in 0..3000 {
        mix = m.mix(&w, conditions());
    }
    (m, mix)
}

#[test]
fn hover_shares_the_weight_and_lifts_it() {
    let (_, mix) = settled(HOVER);
    assert!(mix.thrusts.iter().all(|t| (t - 4.425).abs() < 0.02), "{mix:?}");
    assert!(mix.given == Given::ALL);
}

#[test]
fn yaw_moves_no_rotor_by_more_than_its_limit_and_the_rest_is_reported() {
    // Each rotor has room for 2.56 N of yaw.
    let limit = Params::default().yaw_thrust_max;
    let (m, _) = settled(HOVER);
    for yaw in [0.8, -0.8] {
        let (mut a, mut b) = (m, m);
        let still = a.mix(&HOVER, conditions());
        let turning = b.mix(&Wrench { yaw, ..HOVER }, conditions());
        let by = |i: usize| (turning.thrusts[i] - still.thrusts[i]).abs();
        let most = (0..4).map(by).fold(0.0, f32::max);
        assert!((most - limit).abs() < 0.02, "{yaw}: {most}");
        assert!((0.3..0.7).contains(&turning.given.yaw) && turning.given.saturated());
    }
}

#[test]
fn it_gives_the_wrench_once_the_arms_have_followed() {
    let w = Wrench {
        thrust: 18.0,
        roll: 0.3,
        pitch: -0.2,
        yaw: 0.04,
    };
    let (m, mix) = settled(w);
    let p = Params::default();
    let g = Geometry::from_params(&p, Configuration::B);
    let model = *m.tilt().model();
    let got = g.wrench(&mix.thrusts, &mix.thrusts.map(|t| model.angle(t)));
    assert!((got.thrust - w.thrust).abs() < 0.02, "{got:?}");
    assert!((got.roll - w.roll).abs() < 2e-3 && (got.pitch - w.pitch).abs() < 5e-3);
    assert!((got.yaw - w.yaw).abs() < 2e-3, "{got:?}");
}

#[test]
fn it_gives_the_wrench_in_a_as_well() {
    // Stiff enough that A's authority is not reversed.
    let p = Params {
        gain_k: 1.0,
        ..Params::default()
    };
    let w = Wrench {
        thrust: 18.0,
        roll: 0.3,
        pitch: -0.2,
        yaw: 0.02,
    };
    let mut m = Flexible::new(Configuration::A, &p);
    let mut mix = m.mix(&w, conditions());
    for _ in 0..3000 {
        mix = m.mix(&w, conditions());
    }
    let model = *m.tilt().model();
    let got = Geometry::from_params(&p, Configuration::A)
        .wrench(&mix.thrusts, &mix.thrusts.map(|t| model.angle(t)));
    assert!((got.thrust - w.thrust).abs() < 0.02, "{got:?}");
    assert!((got.roll - w.roll).abs() < 2e-3 && (got.pitch - w.pitch).abs() < 5e-3);
    assert!((got.yaw - w.yaw).abs() < 2e-3, "{got:?}");
}

#[test]
fn yaw_is_gated_during_spool_up_and_never_kicks() {
    let mut m = Flexible::new(Configuration::B, &Params::default());
    let mut last = [0.25f32; 4];
    for i in 0..4000 {
        let thrust = 1.0 + 18.0 * i as f32 / 4000.0;
        let mix = m.mix(
            &Wrench {
                thrust,
                yaw: 0.05,
                ..Wrench::default()
            },
            conditions(),
        );
        let mean = 0.25 * m.tilt().thrusts().iter().sum::<f32>();
        assert!(mix.yaw_gated == (mean < 2.15) || (mean - 2.15).abs() < 0.02);
        for (a, b) in mix.thrusts.iter().zip(&last) {
            assert!(i == 0 || (a - b).abs() < 1.6, "{i}: {b} -> {a}");
        }
        last = mix.thrusts;
    }
}

#[test]
fn yaw_keeps_within_its_limit_on_every_rotor_of_a_rolling_vehicle() {
    // Arms bent differently take different shares of a yaw command.
    let limit = Params::default().yaw_thrust_max;
    for roll in [0.6, -0.6] {
        let w = Wrench { roll, ..HOVER };
        let (m, _) = settled(w);
        for yaw in [0.8, -0.8] {
            let (mut a, mut b) = (m, m);
            let still = a.mix(&w, conditions());
            let turning = b.mix(&Wrench { yaw, ..w }, conditions());
            let by = |i: usize| (turning.thrusts[i] - still.thrusts[i]).abs();
            let most = (0..4).map(by).fold(0.0, f32::max);
            assert!((most - limit).abs() < 0.02, "{roll} {yaw}: {most}");
        }
    }
}

#[test]
fn a_sagging_battery_lowers_the_limit() {
    let mut m = Flexible::new(Configuration::B, &Params::default());
    let sagged = Conditions {
        thrust_ratio: 0.8,
        ..conditions()
    };
    for _ in 0..3000 {
        let mix = m.mix(
            &Wrench {
                thrust: 40.0,
                ..Wrench::default()
            },
            sagged,
        );
        // 8.3 N · 0.8².
        assert!(mix.thrusts.iter().all(|t| *t <= 5.3121), "{:?}", mix.thrusts);
    }
}

#[test]
fn giving_yaw_up_leaves_no_yaw_pattern_behind() {
    let (mut m, before) = settled(Wrench { yaw: 0.06, ..HOVER });
    assert!(before.thrusts[0] - before.thrusts[1] > 0.3);
    let mut mix = before;
    for i in 0..3000 {
        let thrust = 17.7 * (1.0 - i as f32 / 3000.0);
        let c = Conditions {
            yaw: false,
            ..conditions()
        };
        mix = m.mix(
            &Wrench {
                thrust,
                ..Wrench::default()
            },
            c,
        );
    }
    let [a, b, c, d] = mix.thrusts;
    assert!(
        (a - b).abs() < 0.01 && (a - c).abs() < 0.01 && (a - d).abs() < 0.01,
        "{:?}",
        mix.thrusts
    );
}

proptest! {
    #[test]
    fn any_input_gives_thrusts_within_the_limits(bits in prop::collection::vec(any::<[u32; 4]>(), 1..40)) {
        let mut m = Flexible::new(Configuration::B, &Params::default());
        for [t, l, p, n] in &bits {
            let f = f32::from_bits;
            let w = Wrench { thrust: f(*t), roll: f(*l), pitch: f(*p), yaw: f(*n) };
            let mix = m.mix(&w, Conditions { yaw: true, thrust_ratio: f(*n), dt: 1e-3 });
            let ratio = Limits::thrust_ratio(f(*n));
            let most = 8.3 * ratio * ratio;
            prop_assert!(mix.thrusts.iter().all(|t| (0.25..=most * 1.000_001).contains(t)), "{:?}", mix);
            for (arm, measured) in [*t, *l, *p, *n, *t].into_iter().enumerate() {
                m.tilt_mut().correct(arm, f(measured));
            }
            prop_assert!(m.tilt().tilt().iter().all(|a| a.is_finite()));
        }
    }
}
