//! Checks that the image can fly a scenario: some settings are built in.

use sophie_control::allocation::wrench::Configuration;
use sophie_ports::retained::StartCause;
use sophie_sim::mixers::Variant;
use sophie_sim::scenario::{Faults, PositionSensor, Scenario, Step, keys};

/// Refuses a scenario that needs another image.
///
/// # Errors
/// One line: the scenario, the setting, its value and the image's.
pub fn check(scenario: &Scenario) -> Result<(), String> {
    let name = &scenario.name;
    if scenario.mixer != Variant::default() {
        return Err(format!(
            "{name}: mixer {}: the image allocates by {}",
            keys::mixer_word(scenario.mixer),
            keys::mixer_word(Variant::default())
        ));
    }
    if scenario.vehicle.configuration != Configuration::default() {
        return Err(format!(
            "{name}: configuration {}: the image flies {}",
            keys::configuration_word(scenario.vehicle.configuration),
            keys::configuration_word(Configuration::default())
        ));
    }
    if scenario.sensors.position == PositionSensor::Pose {
        return Err(format!(
            "{name}: sensors.position {}: the bench has flow alone",
            keys::position_sensor_word(scenario.sensors.position)
        ));
    }
    // The gains are those of the sensors' parts, not faults that begin in flight.
    let gains = Faults {
        pressure_gain: scenario.faults.pressure_gain,
        ..Faults::default()
    };
    if scenario.faults != gains {
        return Err(format!(
            "{name}: [faults]: the bench breaks parts by its own plan: allowed is pressure_gain"
        ));
    }
    for step in &scenario.steps {
        if let Step::Reset { cause, .. } = step
            && *cause != StartCause::Watchdog
        {
            return Err(format!(
                "{name}: step {}: the bench cannot cut the power: allowed is a reset by the watchdog",
                step.name()
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scenario_that_the_image_cannot_fly_is_refused_by_name() {
        let mut scenario = Scenario::default_mission_with(&Default::default());
        assert_eq!(check(&scenario), Ok(()));
        scenario.params.rate_pitch_p = 9.0;
        assert_eq!(check(&scenario), Ok(()));
        scenario.sensors.position = PositionSensor::Pose;
        assert!(check(&scenario).unwrap_err().contains("position pose"));
        scenario.sensors.position = PositionSensor::Flow;
        assert_eq!(check(&scenario), Ok(()));
        scenario.sensors.position = PositionSensor::None;
        scenario.faults.tilt_offset[0] = 0.1;
        assert!(check(&scenario).unwrap_err().contains("faults"));
        scenario.faults = Faults::default();
        scenario.faults.pressure_gain[0] = 1.2;
        assert_eq!(check(&scenario), Ok(()));
        scenario.mixer = Variant::Rigid;
        assert!(check(&scenario).unwrap_err().contains("mixer rigid"));
    }
}
