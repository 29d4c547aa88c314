//! Units for people; all else is SI.

/// 1 kgcm in N·m.
pub const KGCM: f64 = 0.098_066_5;

/// rad to degrees.
pub fn deg(rad: f64) -> f64 {
    rad.to_degrees()
}

/// N·m to kgcm.
pub fn kgcm(torque: f64) -> f64 {
    torque / KGCM
}

/// Rounded to five decimals: short, and finer than a reader needs.
pub fn tidy(value: f64) -> f64 {
    (value * 1e5).round() / 1e5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kilogram_on_a_centimetre() {
        assert!((kgcm(9.806_65 * 0.01) - 1.0).abs() < 1e-12);
        assert!((deg(core::f64::consts::PI) - 180.0).abs() < 1e-12);
    }
}
