//! The stack's knowledge of its vehicle. A scenario sets the truth; the parameters follow it as far as somebody has
//! measured it.

use sophie_control::params::ServoMarks;

use super::uncertain::{Calibration, QUANTITIES, Quantity};
use super::{Scenario, draw, keys};
use crate::plant::tendon::ServoSpec;

/// Knowledge of the vehicle that the stack's parameters have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Known {
    /// Every number of the vehicle, as in the paper's tables.
    #[default]
    Exact,
    /// Each quantity that has a calibration, with that calibration's error; the others are at their defaults.
    Calibrated,
    /// The labels of the parts and what arming demands; all else is at its default.
    AsBuilt,
}

impl Known {
    /// Words of a scenario file and of the command line.
    pub const WORDS: &'static [&'static str] = &["exact", "calibrated", "as-built"];

    /// A word from [`Known::WORDS`].
    #[must_use]
    pub fn from_word(word: &str) -> Self {
        match word {
            "calibrated" => Self::Calibrated,
            "as-built" => Self::AsBuilt,
            _ => Self::Exact,
        }
    }

    /// Its word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Calibrated => "calibrated",
            Self::AsBuilt => "as-built",
        }
    }
}

/// A number of the vehicle, its day or its pipe that the stack has wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Scenario key of the truth, with `[1]` to `[4]` for one of several.
    pub key: String,
    /// The truth, in the key's unit.
    pub truth: f64,
    /// What the parameters assume, in the same unit.
    pub assumed: f64,
}

impl Difference {
    /// Difference of what is assumed from the truth, %; `None` of a truth that is zero.
    #[must_use]
    pub fn percent(&self) -> Option<f64> {
        (self.truth != 0.0).then(|| 100.0 * (self.assumed / self.truth - 1.0))
    }
}

/// Smallest difference that counts: beyond the rounding of a parameter to single precision.
const ROUNDING: f64 = 1e-5;

/// Sets the parameters by the scenario's knowledge of the vehicle.
pub(super) fn believe(scenario: &mut Scenario) {
    labels(scenario);
    for quantity in QUANTITIES {
        match (scenario.known, &quantity.calibration) {
            (Known::Exact, _) if quantity.exact => learn(scenario, quantity, None),
            (Known::AsBuilt, Some(calibration)) if calibration.demanded => {
                learn(scenario, quantity, Some(calibration));
            }
            (Known::Calibrated, Some(calibration)) => learn(scenario, quantity, Some(calibration)),
            _ => (),
        }
    }
}

/// What a builder reads off the parts and files, and what arming demands.
fn labels(scenario: &mut Scenario) {
    let Scenario { params, vehicle, .. } = scenario;
    params.infill = vehicle.infill as f32;
    let servo = ServoSpec::from(vehicle.servo);
    params.servo_stall = servo.stall as f32;
    let slew = servo.slew as f32;
    (params.servo_slew_1, params.servo_slew_2) = (slew, slew);
    (params.servo_slew_3, params.servo_slew_4) = (slew, slew);
    params.servo_range = servo.range as f32;
    params.servo_marks = ServoMarks::S1234;
}

/// Sets the parameters of `quantity` to its truth with the error of `calibration`.
fn learn(scenario: &mut Scenario, quantity: &Quantity, calibration: Option<&Calibration>) {
    let streams = scenario.streams();
    let mut numbers = (quantity.truth)(scenario);
    if let Some(calibration) = calibration {
        for (index, number) in numbers.iter_mut().enumerate() {
            let part = if calibration.apart { index + 1 } else { 0 };
            let share = streams.unit(&format!("calibration {} {part}", quantity.key));
            *number = calibration.error.apply(*number, share);
        }
    }
    (quantity.learn)(scenario, &numbers);
}

impl Scenario {
    /// Sets the parameters to every truth that a calibration could find, without its error: beside what `exact` knows of a
    /// vehicle the arms' mean stiffness, the tendons' slack, the pressure sensors and the pipe.
    pub fn tell_all(&mut self) {
        for quantity in QUANTITIES {
            if quantity.exact || quantity.calibration.is_some() {
                learn(self, quantity, None);
            }
        }
    }

    /// The scenario with the vehicle and the pipe that the parameters assume: what a builder can check before the first
    /// flight. Where they assume nothing, the vehicle has the middle of the builders' spread of an effect that this scenario
    /// has, as the literature gives it, and all else is nominal.
    #[must_use]
    pub fn assumed(&self) -> Self {
        let mut built = Self {
            params: self.params,
            measured: self.measured,
            steps: self.steps.clone(),
            sensors: self.sensors,
            pilot: self.pilot.clone(),
            arms: self.arms,
            mixer: self.mixer,
            ..Self::default_mission()
        };
        built.world.air.wind = self.world.air.wind;
        built.vehicle.infill = self.vehicle.infill;
        built.vehicle.servo = self.vehicle.servo;
        built.vehicle.configuration = self.vehicle.configuration;
        built.vehicle.rotor.spin.brakes = self.vehicle.rotor.spin.brakes;
        built.vehicle.rotor.reaction = self.vehicle.rotor.reaction;
        built.vehicle.air.drag.on_rotors = self.vehicle.air.drag.on_rotors;
        for quantity in QUANTITIES {
            let numbers = (quantity.assumed)(&built);
            let differs = (quantity.truth)(self) != (quantity.truth)(&built);
            if numbers.is_empty()
                && differs
                && quantity.key.starts_with("vehicle.")
                && let Some(middle) = draw::middle(quantity, &built)
            {
                keys::set(&mut built, quantity.key, &middle);
                continue;
            }
            if !numbers.is_empty() && !(quantity.truth)(&built).is_empty() {
                keys::set(&mut built, quantity.key, &numbers);
            }
        }
        built
    }

    /// What the parameters have wrong, in the order of the table.
    #[must_use]
    pub fn differences(&self) -> Vec<Difference> {
        let mut differences = Vec::new();
        for quantity in QUANTITIES {
            let (truth, assumed) = ((quantity.truth)(self), (quantity.assumed)(self));
            let several = truth.len() > 1;
            for (index, (&truth, &assumed)) in truth.iter().zip(&assumed).enumerate() {
                let largest = truth.abs().max(assumed.abs());
                if (truth - assumed).abs() <= ROUNDING * largest {
                    continue;
                }
                let key = quantity.key;
                differences.push(Difference {
                    key: if several {
                        format!("{key}[{}]", index + 1)
                    } else {
                        key.to_owned()
                    },
                    truth,
                    assumed,
                });
            }
        }
        differences
    }
}
