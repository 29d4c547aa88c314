//! Options for vehicle and mission, common to the subcommands that fly or check one.

use std::path::PathBuf;

use clap::Args;
use sophie_control::allocation::wrench::Configuration;
use sophie_control::pilot::rc::ArmChoice;
use sophie_sim::mixers::Variant;
use sophie_sim::scenario::{Assist, Known, Overrides, PositionSensor, Rule, Scenario, keys};

use super::values::{number, seed, word};

/// Vehicle and mission. Options take precedence over the file.
#[derive(Args, Debug)]
pub struct MissionArgs {
    /// Scenario file; without one it is the default mission.
    pub scenario: Option<PathBuf>,
    /// Infill of the arms, 4 to 10 %.
    #[arg(long, visible_alias = "infill", value_name = "PERCENT", value_parser = infill, allow_negative_numbers = true)]
    rho: Option<f64>,
    /// Sense of rotation: A or B.
    #[arg(long, value_name = "A|B", value_parser = configuration)]
    config: Option<Configuration>,
    /// Allocation: flexible, rigid, paper or frozen.
    #[arg(long, value_name = "NAME", value_parser = mixer)]
    mixer: Option<Variant>,
    /// Arms that close: 4 (all), 2 (front pair) or rear.
    #[arg(long, value_name = "2|4|rear", value_parser = arms, allow_negative_numbers = true)]
    arms: Option<ArmChoice>,
    /// What measures the position: none, pose (poses over MAVLink), or flow (flow and range below the vehicle).
    #[arg(long, value_name = "NAME", value_parser = position_sensor)]
    sensors: Option<PositionSensor>,
    /// Autonomy: none, hold (hovers in the mode HOLD), or self (perches autonomously).
    #[arg(long, value_name = "NAME", value_parser = assist)]
    assist: Option<Assist>,
    /// Gain on the elastic term of the arm equation, 1 (literal) to 10.
    #[arg(long, value_name = "K", value_parser = gain_k, allow_negative_numbers = true)]
    gain_k: Option<f64>,
    /// What the flight stack knows of the vehicle: exact, calibrated (each calibration with its error), or as-built.
    #[arg(long, value_name = "NAME", value_parser = known)]
    known: Option<Known>,
    /// Rule of the judge: paper (950 N/m2 at each sensor) or holding (a push from any side).
    #[arg(long, value_name = "NAME", value_parser = judge)]
    judge: Option<Rule>,
    /// Seed of every random number: a whole number from 0 to 9e15.
    #[arg(long, value_name = "N", value_parser = seed, allow_negative_numbers = true)]
    seed: Option<u64>,
}

impl MissionArgs {
    /// The resulting scenario.
    ///
    /// # Errors
    /// One line with file, line, key, value and the allowed range.
    pub fn scenario(&self) -> Result<Scenario, String> {
        match &self.scenario {
            Some(path) => Scenario::load(path, &self.overrides()).map_err(|e| e.to_string()),
            None => Ok(Scenario::default_mission_with(&self.overrides())),
        }
    }

    /// The options' overrides of a scenario.
    pub(super) fn overrides(&self) -> Overrides {
        Overrides {
            known: self.known,
            infill: self.rho,
            gain_k: self.gain_k,
            configuration: self.config,
            mixer: self.mixer,
            arms: self.arms,
            sensors: self.sensors,
            assist: self.assist,
            judge: self.judge,
            seed: self.seed,
        }
    }
}

fn known(text: &str) -> Result<Known, String> {
    word(text, Known::WORDS).map(Known::from_word)
}

fn judge(text: &str) -> Result<Rule, String> {
    word(text, Rule::WORDS).map(Rule::from_word)
}

fn infill(text: &str) -> Result<f64, String> {
    number(text, keys::INFILL)
}

fn gain_k(text: &str) -> Result<f64, String> {
    number(text, keys::GAIN_K)
}

fn configuration(text: &str) -> Result<Configuration, String> {
    word(&text.to_uppercase(), keys::CONFIGURATIONS).map(keys::configuration)
}

fn position_sensor(text: &str) -> Result<PositionSensor, String> {
    word(text, keys::POSITION_SENSORS).map(keys::position_sensor)
}

fn assist(text: &str) -> Result<Assist, String> {
    word(text, keys::ASSISTS).map(keys::assist)
}

fn mixer(text: &str) -> Result<Variant, String> {
    word(text, keys::MIXERS).map(keys::mixer)
}

fn arms(text: &str) -> Result<ArmChoice, String> {
    match text {
        "4" => Ok(ArmChoice::All),
        "2" => Ok(ArmChoice::Front),
        _ => word(text, keys::ARMS)
            .map(keys::arms)
            .map_err(|_| "allowed 4 or all, 2 or front, rear".to_owned()),
    }
}
