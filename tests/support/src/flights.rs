//! Checks shared by tests of whole flights.

use sophie_sim::record::FlightRecord;

/// Requires a grip within tolerance on every chosen arm of a perch.
pub fn proven(record: &FlightRecord) -> Result<(), String> {
    let perches = record.phases.iter().filter(|p| p.name == "perch").count();
    let arms = record.scenario.arms.mask().into_iter().filter(|m| *m).count();
    // A grip that outlasts a reset is proven again.
    let resets = record.phases.iter().any(|p| p.name == "reset");
    let (proofs, wanted) = (record.grip.len(), perches * arms);
    if proofs < wanted || proofs > wanted && !resets {
        return Err(format!(
            "{} grips proven of {}",
            record.grip.len(),
            perches * arms
        ));
    }
    let p = &record.scenario.params;
    for grip in &record.grip {
        let error = (grip.pressure - f64::from(p.grip_pressure)).abs();
        if error.is_nan() || error > f64::from(p.grip_tolerance) {
            return Err(format!("arm {} proven at {:.0} N/m²", grip.arm, grip.pressure));
        }
        if !(grip.torque > 0.0 && grip.torque <= f64::from(p.servo_torque_max)) {
            return Err(format!("arm {} held with {:.2} N·m", grip.arm, grip.torque));
        }
        if !(grip.closure > 0.0 && grip.closure <= f64::from(p.clamp_timeout)) {
            return Err(format!("arm {} closed in {:.2} s", grip.arm, grip.closure));
        }
    }
    Ok(())
}
