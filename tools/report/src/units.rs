//! Units for people; all else is SI.

use sophie_sim::record::FlightRecord;

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

/// Tendon tension (N) to servo torque in kgcm.
pub fn tension_kgcm(record: &FlightRecord, tension: f64) -> f64 {
    kgcm(tension * f64::from(record.scenario.params.reel_radius))
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
