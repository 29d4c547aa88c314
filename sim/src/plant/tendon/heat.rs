//! Heating of a servo that holds.
//!
//! The motor's loss goes with the square of its current, so of its torque; case and winding are one mass:
//! dΔ/dt = (Δ_stall (M/M_stall)² − Δ)/τ. A warm motor is weaker: copper gains 0.39 % of resistance per kelvin, ferrite
//! loses 0.2 % of its field (handbooks), so at the same voltage the stall torque is 1/(1 + 0.0039 Δ) (1 − 0.002 Δ) of
//! the cold one. At 120 °C (insulation of class E) the winding burns: from then on only gear friction holds. An MG996R
//! burns after 10 to 15 min under load (robotics.stackexchange 8103), an STS3215 passes 70 °C. Δ_stall = 0: a cold one.

/// Time constant, s: 10 min, as those that burn (assumed).
const TIME: f64 = 600.0;
/// Temperature of a winding that burns, °C.
const BURNS: f64 = 120.0;
/// Gain of the copper's resistance and loss of the magnets' field, 1/K.
const COPPER: f64 = 0.0039;
const MAGNETS: f64 = 0.002;

/// Temperature of one servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heat {
    /// Rise at stall, K; 0: the servo stays cold.
    at_stall: f64,
    /// Temperature of the air, °C.
    air: f64,
    rise: f64,
    burnt: bool,
}

impl Heat {
    /// A cold servo that warms by `at_stall` K at its stall torque, in air of `air` °C.
    #[must_use]
    pub const fn new(at_stall: f64, air: f64) -> Self {
        Self {
            at_stall,
            air,
            rise: 0.0,
            burnt: false,
        }
    }

    /// Stall torque over the cold servo's, `dt` s later at the share `load` of the cold stall torque; `None` once burnt.
    pub fn step(&mut self, dt: f64, load: f64) -> Option<f64> {
        if self.at_stall == 0.0 {
            return Some(1.0);
        }
        let load = if self.burnt { 0.0 } else { load.clamp(0.0, 1.0) };
        self.rise += (self.at_stall * load * load - self.rise) * dt / TIME;
        self.burnt |= self.air + self.rise > BURNS;
        (!self.burnt).then(|| (1.0 - MAGNETS * self.rise) / (1.0 + COPPER * self.rise))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(heat: &mut Heat, load: f64, seconds: u32) -> Option<f64> {
        for _ in 1..seconds {
            heat.step(1.0, load);
        }
        heat.step(1.0, load)
    }

    #[test]
    fn a_holding_servo_warms_fades_and_burns() {
        // 350 K at stall, 0.59 of it (an MG996R that holds 5.55 kgcm): 122 K in the end, 97 K after 950 s.
        let mut heat = Heat::new(350.0, 23.0);
        let warm = held(&mut heat, 0.59, 600).unwrap();
        let rise = 350.0 * 0.59 * 0.59 * (1.0 - libm::exp(-1.0_f64));
        assert!((heat.rise - rise).abs() < 0.1, "{}", heat.rise);
        assert!((warm - (1.0 - 0.002 * rise) / (1.0 + 0.0039 * rise)).abs() < 1e-3 && warm < 0.7);
        assert!(held(&mut heat, 0.59, 500).is_none());
        // It never comes back.
        assert!(held(&mut heat, 0.0, 5000).is_none());
    }

    #[test]
    fn a_strong_servo_stays_whole() {
        // The paper's: 0.16 of its torque, 9 K.
        let mut heat = Heat::new(350.0, 23.0);
        let warm = held(&mut heat, 0.16, 36_000).unwrap();
        assert!((heat.rise - 350.0 * 0.0256).abs() < 0.1 && warm > 0.94, "{warm}");
    }

    #[test]
    fn a_servo_that_stays_cold_keeps_its_torque() {
        assert_eq!(Heat::new(0.0, 60.0).step(1e4, 1.0), Some(1.0));
    }
}
