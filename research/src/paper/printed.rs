//! The paper's printed numbers, from their one file.

use serde::Deserialize;

/// Has table and row of every number.
const FILE: &str = include_str!("printed.toml");

/// All printed numbers.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Printed {
    /// Statements on Eq. 1.
    pub eq_1: Eq1,
    /// Signs of the printed mixer matrix.
    pub mixer_matrix: MixerMatrix,
    /// Table I.
    pub table_1: Table1,
    /// Table II, by rows.
    pub table_2: Vec<Mass>,
    /// Table III, by rows.
    pub table_3: Vec<Roll>,
    /// Table IV.
    pub table_4: Clamp,
    /// Table V, by rows.
    pub table_5: Vec<Endurance>,
    /// Table VI, by rows.
    pub table_6: Vec<Robot>,
    /// Numbers in the text.
    pub text: Text,
}

/// Statements on Eq. 1.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Eq1 {
    /// C_P, from and to.
    pub power_exponent: [f64; 2],
    /// Largest tilt of the static model, degrees.
    pub valid_tilt_deg: f64,
    /// Least infill of its validity, %.
    pub valid_infill_percent: f64,
}

/// Signs of the yaw row, rotors 1 to 4.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MixerMatrix {
    /// Printed matrix, over C_Q.
    pub yaw_row: [f64; 4],
    /// Algorithm 1's senses of rotation.
    pub algorithm_1_row: [f64; 4],
}

/// Table I: °/N, °/(N %), °/N², °/(N² %).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table1 {
    /// A1.
    pub a1: f64,
    /// A2.
    pub a2: f64,
    /// B1.
    pub b1: f64,
    /// B2.
    pub b2: f64,
}

/// A row of Table II.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mass {
    /// Equipment.
    pub equipment: String,
    /// Mass of one, g.
    pub mass_g: f64,
    /// Count.
    pub count: u32,
}

/// A row of Table III.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Roll {
    /// Infill, %.
    pub infill_percent: f64,
    /// κ.
    pub kappa: f64,
    /// Δα_max, degrees.
    pub delta_alpha_max_deg: f64,
    /// (φ+Δα)_max without over with the autopilot's corrections.
    pub ratio: f64,
}

/// Table IV.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Clamp {
    /// Closure times, s.
    pub closure_s: [f64; 4],
    /// Steady servo forces in the printed order, kgcm.
    pub force_kgcm: [f64; 4],
}

/// A row of Table V.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Endurance {
    /// Infill, %.
    pub infill_percent: f64,
    /// Flight time, min.
    pub flight_min: f64,
    /// Inspection time, min.
    pub inspection_min: f64,
    /// Specific strength, kNm/kg.
    pub strength_knm_per_kg: f64,
}

/// A row of Table VI.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Robot {
    /// Name.
    pub robot: String,
    /// Flight time, min.
    pub flight_min: f64,
    /// Inspection time, min.
    pub inspection_min: f64,
    /// Specific strength, kNm/kg.
    pub strength_knm_per_kg: f64,
}

/// Numbers in the text, with their sections.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Text {
    /// Vehicle mass, kg (III-B).
    pub total_mass_kg: f64,
    /// Nominal thrust of a rotor, g (III-A).
    pub motor_thrust_g: f64,
    /// Stall torque of a servo, kg·cm (III-A).
    pub servo_stall_kgcm: f64,
    /// Infill, % (Fig. 1, V-D).
    pub infill_percent: f64,
    /// Roll angle, ° (V-A).
    pub roll_deg: f64,
    /// ΔT/T of the manoeuvre (V-A).
    pub delta_thrust_share: f64,
    /// Target contact pressure of a grip, Pa (IV-D).
    pub pressure_pa: f64,
    /// Pressure sensor error, Pa (IV-D).
    pub fsr_error_pa: f64,
    /// Largest servo torque, kg·cm (IV-D).
    pub force_max_kgcm: f64,
    /// Throttle while closing, % (IV-D).
    pub clamp_throttle_percent: f64,
    /// Lowest flyable infill, % (abstract, VI).
    pub flyable_infill_percent: f64,
    /// Cycles between the comparisons of the arms (V-C).
    pub fatigue_cycles: [f64; 2],
    /// Flight battery, mAh (V-D, 4S).
    pub flight_battery_mah: f64,
    /// Servo battery, mAh (V-D, 2S).
    pub servo_battery_mah: f64,
    /// Weight saved, from and to, % (V-D).
    pub weight_saving_percent: [f64; 2],
    /// Inspection time gained over MHYRO, % (V-D).
    pub inspection_gain_percent: f64,
    /// Efficiency lost against the semi-rigid vehicle, % (V-D).
    pub efficiency_loss_percent: f64,
}

impl Printed {
    /// Reads the file.
    pub fn read() -> Self {
        match toml::from_str(FILE) {
            Ok(printed) => printed,
            // A test reads the embedded file.
            Err(error) => unreachable!("{error}"),
        }
    }

    /// Mass by Table II, kg.
    pub fn mass(&self) -> f64 {
        self.table_2
            .iter()
            .map(|row| row.mass_g * f64::from(row.count))
            .sum::<f64>()
            * 1e-3
    }
}

#[cfg(test)]
mod tests {
    use crate::paper::printed::*;

    #[test]
    fn the_file_is_whole_and_is_what_the_stack_flies() {
        let p = Printed::read();
        assert_eq!(
            (p.table_2.len(), p.table_3.len(), p.table_5.len(), p.table_6.len()),
            (6, 3, 4, 4)
        );
        let t = &p.table_1;
        for (printed, flown) in [
            (t.a1, sophie_control::allocation::arm_deflection::A1),
            (t.a2, sophie_control::allocation::arm_deflection::A2),
            (t.b1, sophie_control::allocation::arm_deflection::B1),
            (t.b2, sophie_control::allocation::arm_deflection::B2),
        ] {
            assert!((printed - f64::from(flown)).abs() < 1e-6);
        }
        assert!((p.mass() - 1.805).abs() < 1e-9);
    }
}
