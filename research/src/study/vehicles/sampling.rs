//! Which vehicles are flown.

use sophie_sim::scenario::{Overrides, Scenario};
use sophie_sim::streams::Streams;

/// A vehicle with its pilot and its world.
#[derive(Clone, Debug)]
pub struct SampledVehicle {
    /// The seed of the vehicle and of its flight.
    pub seed: u64,
    /// As a scenario file.
    pub text: String,
    /// What the file says.
    pub scenario: Scenario,
}

/// Lateral gusts act this far from the centre of mass, m: moment over force.
const GUST_LEVER: f64 = 0.04;

/// Draws vehicle `seed`. `spread` scales what makes one vehicle unlike another of its kind: mass, inertia, torque ratio
/// and arms; 1 is the whole range, 0 none.
///
/// # Errors
/// One line: a value outside what a scenario takes, which no spread up to 1 gives.
pub fn sample(seed: u64, spread: f64) -> Result<SampledVehicle, String> {
    let text = text(seed, spread);
    let scenario = Scenario::parse(&text, &format!("vehicle {seed}"), &Overrides::default())
        .map_err(|e| e.to_string())?;
    Ok(SampledVehicle { seed, text, scenario })
}

fn text(seed: u64, spread: f64) -> String {
    let streams = Streams::new(seed);
    let within = |name: &str, from: f64, to: f64| streams.within(name, from, to);
    let about = |name: &str, share: f64| 1.0 + spread * within(name, -share, share);
    let by_arm = |name: &str, most: f64| -> Vec<f64> {
        (1..=4)
            .map(|arm| spread * within(&format!("{name} {arm}"), -most, most))
            .collect()
    };
    let nominal = Scenario::default_mission().vehicle;
    let inertia = nominal.body.inertia;
    let [roll, pitch, yaw] = [("roll", inertia[0]), ("pitch", inertia[1]), ("yaw", inertia[2])]
        .map(|(axis, inertia)| inertia * about(&format!("inertia {axis}"), 0.30));
    let gains = list(by_arm("arm gain", 0.20).iter().map(|gain| 1.0 + gain));
    let offsets = list(by_arm("arm offset", 3.0).into_iter());
    let gust = within("gust", 0.0, 0.1);
    format!(
        "name = \"vehicle {seed}\"\n\
         seed = {seed}\n\
         [vehicle]\n\
         infill = {:.3}\n\
         gain_k = {:.3}\n\
         mass_kg = {:.4}\n\
         inertia_kgm2 = [{roll:.5}, {pitch:.5}, {yaw:.5}]\n\
         torque_ratio_m = {:.5}\n\
         motor_tau_s = {:.4}\n\
         battery_charge_percent = {:.1}\n\
         arm_gain = {gains}\n\
         arm_offset_deg = {offsets}\n\
         [world]\n\
         pipe_diameter_m = {:.3}\n\
         pipe_friction = {:.3}\n\
         pipe_east_m = {:.3}\n\
         gust_force_n = {gust:.4}\n\
         gust_moment_nm = {:.5}\n\
         [pilot]\n\
         delay_s = {:.3}\n\
         eye_noise_m = {:.4}\n",
        within("infill", 5.0, 10.0),
        within("gain K", 5.0, 8.4),
        nominal.body.mass * about("mass", 0.08),
        nominal.rotor.torque_ratio * about("torque ratio", 0.12),
        within("motors", 0.035, 0.065),
        within("battery", 60.0, 100.0),
        within("pipe diameter", 0.2, 0.4),
        within("pipe friction", 0.45, 0.8),
        Scenario::default_mission().world.pipe_position[1] + within("pipe east", -1.0, 1.0),
        GUST_LEVER * gust,
        within("pilot delay", 0.18, 0.32),
        within("pilot eyes", 0.0, 0.02),
    )
}

fn list(values: impl Iterator<Item = f64>) -> String {
    let values: Vec<String> = values.map(|v| format!("{v:.4}")).collect();
    format!("[{}]", values.join(", "))
}

#[cfg(test)]
mod tests {
    use crate::study::vehicles::sampling::*;

    #[test]
    fn every_vehicle_is_a_scenario_and_the_stack_knows_all_of_it_but_the_arms() {
        let nominal = Scenario::default_mission();
        for seed in 0..200 {
            let sampled = sample(seed, 1.0).unwrap();
            let Scenario { vehicle, params, .. } = &sampled.scenario;
            assert_eq!(sampled.scenario.seed, seed);
            assert!((vehicle.body.mass - f64::from(params.mass)).abs() < 1e-6);
            assert!((vehicle.infill - f64::from(params.infill)).abs() < 1e-5);
            assert!((vehicle.rotor.spin.up - f64::from(params.motor_tau)).abs() < 1e-6);
            assert!((vehicle.body.inertia[2] - f64::from(params.inertia_yaw)).abs() < 1e-6);
            assert_ne!(vehicle.arm_gain, nominal.vehicle.arm_gain);
            assert_eq!(params.arm_a1, nominal.params.arm_a1);
        }
    }

    #[test]
    fn without_spread_the_vehicles_differ_by_what_is_known_of_them_alone() {
        let nominal = Scenario::default_mission().vehicle;
        let vehicle = sample(7, 0.0).unwrap().scenario.vehicle;
        assert!((vehicle.body.mass - nominal.body.mass).abs() < 1e-4);
        assert_eq!(vehicle.arm_gain, nominal.arm_gain);
        assert_eq!(vehicle.arm_offset, nominal.arm_offset);
        assert_ne!(vehicle.infill, nominal.infill);
    }

    #[test]
    fn the_draws_cover_their_ranges_evenly() {
        let masses: Vec<f64> = (0..400)
            .map(|seed| sample(seed, 1.0).unwrap().scenario.vehicle.body.mass)
            .collect();
        let nominal = Scenario::default_mission().vehicle.body.mass;
        let below = masses.iter().filter(|mass| **mass < nominal).count();
        assert!((160..=240).contains(&below), "{below}");
        let most = masses
            .iter()
            .map(|m| (m / nominal - 1.0).abs())
            .fold(0.0, f64::max);
        assert!((0.07..=0.0801).contains(&most), "{most}");
    }
}
