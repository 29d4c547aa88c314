//! Results and failures of each allocation.

extern crate std;

use proptest::prelude::*;
use sophie_control::allocation::arm_deflection::ArmModel;
use sophie_control::allocation::desaturation::Given;
use sophie_control::allocation::effectiveness::Geometry;
use sophie_control::allocation::mixer::Limits;
use sophie_control::allocation::wrench::YAW;

use super::*;

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

fn settled(variant: Variant, w: Wrench) -> (Mixer, Mix) {
    let mut m = Mixer::new(variant, Configuration::B, &Params::default());
    let mut mix = m.mix(&w, conditions());
    for _ in 0..3000 {
        mix = m.mix(&w, conditions());
    }
    (m, mix)
}

#[test]
fn hover_shares_the_weight_and_lifts_it() {
    for variant in [Variant::Rigid, Variant::Paper, Variant::Frozen, Variant::Flexible] {
        let (_, mix) = settled(variant, HOVER);
        assert!(
            mix.thrusts.iter().all(|t| (t - 4.425).abs() < 0.02),
            "{variant:?} {:?}",
            mix.thrusts
        );
    }
}

#[test]
fn the_rigid_mixer_yaws_too_much_by_one_plus_c() {
    // C is about -3.9 at K 7.75, ρ 6.9: the arms amplify a yaw command.
    let w = Wrench { yaw: 0.01, ..HOVER };
    let (_, mix) = settled(Variant::Rigid, w);
    let p = Params::default();
    let model = ArmModel::from_params(&p);
    let g = Geometry::from_params(&p, Configuration::B);
    let got = g.wrench(&mix.thrusts, &mix.thrusts.map(|t| model.angle(t)));
    // C = 1 - (dM/dδ) / (dM₀/dδ) along the yaw pattern about hover, arms following and not.
    let yaw = |step: f32, tilt: &dyn Fn(f32) -> f32| {
        let thrusts = YAW.map(|sign| 4.425 + step * sign);
        g.wrench(&thrusts, &thrusts.map(tilt)).yaw
    };
    let slope = |tilt: &dyn Fn(f32) -> f32| yaw(0.5, tilt) - yaw(-0.5, tilt);
    let c = 1.0 - slope(&|t| model.angle(t)) / slope(&|_| 0.0);
    assert!(
        (got.yaw / w.yaw - (1.0 - c)).abs() < 0.15,
        "{} {c}",
        got.yaw / w.yaw
    );
}

#[test]
fn the_frozen_inverse_limit_cycles_where_c_is_large() {
    // Motor lag and static arm around the allocation, small constant yaw demand.
    let swing = |variant, gain_k| {
        let p = Params {
            gain_k,
            yaw_thrust_max: 5.0,
            ..Params::default()
        };
        let mut m = Mixer::new(variant, Configuration::B, &p);
        let w = Wrench { yaw: 0.03, ..HOVER };
        let (mut low, mut high) = (f32::MAX, f32::MIN);
        for i in 0..8000 {
            let mix = m.mix(&w, conditions());
            if i > 4000 {
                low = low.min(mix.thrusts[0]);
                high = high.max(mix.thrusts[0]);
            }
        }
        high - low
    };
    assert!(
        swing(Variant::Frozen, 7.75) > 1.0,
        "{}",
        swing(Variant::Frozen, 7.75)
    );
    assert!(
        swing(Variant::Frozen, 1.0) < 0.05,
        "{}",
        swing(Variant::Frozen, 1.0)
    );
    assert!(
        swing(Variant::Flexible, 7.75) < 0.05,
        "{}",
        swing(Variant::Flexible, 7.75)
    );
}

#[test]
fn yaw_beyond_its_limit_is_reported_as_not_given() {
    for variant in [Variant::Flexible, Variant::Rigid, Variant::Paper] {
        let (_, mix) = settled(variant, Wrench { yaw: 1.0, ..HOVER });
        assert!(
            mix.given.yaw < 0.5 && mix.given.saturated(),
            "{variant:?} {:?}",
            mix.given
        );
        let spread = 0.5 * (mix.thrusts[0] - mix.thrusts[1]);
        assert!(
            spread < 1.55 || variant == Variant::Flexible,
            "{variant:?} {:?}",
            mix.thrusts
        );
    }
    let (_, mix) = settled(Variant::Flexible, HOVER);
    assert!(mix.given == Given::ALL);
}

#[test]
fn yaw_moves_no_rotor_by_more_than_its_limit() {
    // Room for 2.56 N (flexible) and 3.1 N (rigid) of yaw each: only the limit acts.
    let limit = Params::default().yaw_thrust_max;
    for (variant, yaw) in [
        (Variant::Flexible, 0.8),
        (Variant::Rigid, 0.2),
        (Variant::Paper, 0.2),
    ] {
        let (m, _) = settled(variant, HOVER);
        for yaw in [yaw, -yaw] {
            let (mut a, mut b) = (m, m);
            let still = a.mix(&HOVER, conditions());
            let turning = b.mix(&Wrench { yaw, ..HOVER }, conditions());
            let most = turning
                .thrusts
                .iter()
                .zip(&still.thrusts)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f32::max);
            assert!((most - limit).abs() < 0.02, "{variant:?} {most}");
            assert!((0.3..0.7).contains(&turning.given.yaw), "{:?}", turning.given);
        }
    }
}

proptest! {
    #[test]
    fn any_input_gives_thrusts_within_the_limits(bits in prop::collection::vec(any::<[u32; 4]>(), 1..40)) {
        for variant in [Variant::Rigid, Variant::Paper, Variant::Frozen, Variant::Flexible] {
            let mut m = Mixer::new(variant, Configuration::B, &Params::default());
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
}
