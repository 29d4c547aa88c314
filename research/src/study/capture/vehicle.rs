//! Vehicles sampled over the model's uncertainties: infill, stiffness, gains of the arms, tendon parameters.

use sophie_sim::scenario::{Overrides, Scenario};
use sophie_sim::streams::Streams;

/// Infill, %, and stiffness K, which the stack's parameters follow.
const INFILL: (f64, f64) = (4.0, 10.0);
const GAIN_K: (f64, f64) = (5.0, 8.4);
/// How far each arm bends more or less than its equation says, share; the stack knows nothing of it.
const ARMS: f64 = 0.20;
/// Factor, up or down, by which the stack's tendon parameters are off the arm's.
const RESPONSE: f64 = 2.0;

/// The vehicle of touch `seed`.
///
/// # Errors
/// One line: a value outside what a scenario takes, which no sample has.
pub fn sample(seed: u64) -> Result<Scenario, String> {
    let streams = Streams::new(seed);
    let within = |name: &str, (from, to): (f64, f64)| streams.within(&format!("vehicle.{name}"), from, to);
    let arms = [1, 2, 3, 4].map(|arm| {
        let gain = 1.0 + within(&format!("arm gain {arm}"), (-ARMS, ARMS));
        format!("{gain:.4}")
    });
    let text = format!(
        "seed = {seed}\n[vehicle]\ninfill = {:.3}\ngain_k = {:.3}\narm_gain = [{}]\n",
        within("infill", INFILL),
        within("gain K", GAIN_K),
        arms.join(", ")
    );
    let mut scenario = Scenario::parse(&text, &format!("vehicle {seed}"), &Overrides::default())
        .map_err(|e| e.to_string())?;
    // As much too large as too small: sampled evenly in the logarithm.
    let times = |name: &str| libm::pow(RESPONSE, within(name, (-1.0, 1.0))) as f32;
    scenario.params.tendon_bend *= times("tendon bend");
    scenario.params.tendon_relief *= times("tendon relief");
    Ok(scenario)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stack_follows_the_stiffness_and_is_wrong_of_arms_and_tendons() {
        let nominal = Scenario::default_mission();
        // Of tendon_bend and tendon_relief: least and largest factor.
        let mut spread = [(f32::MAX, 0.0_f32); 2];
        for seed in 0..200 {
            let Scenario { vehicle, params, .. } = sample(seed).unwrap();
            assert!(
                (INFILL.0..=INFILL.1).contains(&vehicle.infill),
                "{}",
                vehicle.infill
            );
            assert!((vehicle.infill - f64::from(params.infill)).abs() < 1e-5);
            assert!((vehicle.gain_k - f64::from(params.gain_k)).abs() < 1e-5);
            assert!(
                vehicle
                    .arm_gain
                    .iter()
                    .all(|gain| (gain - 1.0).abs() <= ARMS + 1e-4)
            );
            assert_ne!(vehicle.arm_gain, nominal.vehicle.arm_gain);
            assert_eq!(params.arm_a1, nominal.params.arm_a1);
            let times = [
                params.tendon_bend / nominal.params.tendon_bend,
                params.tendon_relief / nominal.params.tendon_relief,
            ];
            for ((least, most), times) in spread.iter_mut().zip(times) {
                (*least, *most) = (least.min(times), most.max(times));
            }
        }
        for (least, most) in spread {
            assert!(
                (0.5..0.53).contains(&least) && (1.9..=2.0).contains(&most),
                "{least} {most}"
            );
        }
    }
}
