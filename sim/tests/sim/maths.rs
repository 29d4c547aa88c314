//! The elementary functions of a flight, bit for bit: a machine or a build that fails here flies other flights of a seed.

use glam::{DQuat, DVec2, DVec3};

/// FNV-1a of the bits of what `f` gives for 20,000 arguments from -7 to 7.
fn bits<const N: usize>(f: impl Fn(f64) -> [f64; N]) -> u64 {
    let values = (0..20_000).flat_map(|i| f(f64::from(i - 10_000) * 7e-4));
    values.fold(0xCBF2_9CE4_8422_2325, |hash, x| {
        (hash ^ x.to_bits()).wrapping_mul(0x0100_0000_01B3)
    })
}

#[test]
fn elementary_functions_have_the_bits_of_every_other_machine() {
    let found = [
        bits(|x| [libm::sin(x), libm::cos(x), libm::tan(x)]),
        bits(|x| libm::sincos(x).into()),
        bits(|x| [libm::asin(x / 7.0), libm::acos(x / 7.0), libm::atan(x)]),
        bits(|x| [libm::atan2(x, 1.3), libm::hypot(x, 1.3)]),
        bits(|x| [libm::exp(x), libm::log(x + 7.5), libm::pow(x + 7.5, 1.37)]),
    ];
    assert_eq!(
        found,
        [
            0xC92D_0003_72C3_C180,
            0xAA52_8DEE_02D5_7018,
            0x212A_78B1_4326_967E,
            0xF5B9_75BF_6647_8213,
            0x207C_760D_FD09_3F0A
        ]
    );
}

/// glam's own, by its feature `libm`.
#[test]
fn rotations_have_the_bits_of_every_other_machine() {
    let turned = |x| DQuat::from_rotation_x(x) * DQuat::from_rotation_z(0.3 * x) * DVec3::new(0.3, -0.2, x);
    let found = [
        bits(|x| turned(x).to_array()),
        bits(|x| DQuat::from_scaled_axis(DVec3::new(0.1, x, -0.7)).to_array()),
        bits(|x| [DVec2::from_angle(x).angle_to(DVec2::new(x, 2.0))]),
    ];
    assert_eq!(
        found,
        [
            0xD4FC_A80C_E1BE_573A,
            0xA68E_A438_E12B_23ED,
            0x4E77_5F5C_83CE_80F2
        ]
    );
}
