//! `summary.json`: the flight in numbers, for programs.
//!
//! Units are in the names of the fields. Numbers that do not exist (NaN) are `null`. The fields and their
//! meaning are the doc comments below; `docs/summary-json.md` shows them as one list.

use std::collections::BTreeMap;

use serde::Serialize;
use sophie_control::params::Params;
use sophie_sim::record::FlightRecord;
use sophie_sim::scenario::{Faults, Scenario, faults, keys};

use sophie_charts::units::{deg, kgcm, tidy};

/// The whole file.
#[derive(Serialize)]
pub struct Summary {
    /// Every step was done.
    accomplished: bool,
    /// One line: `mission accomplished`, or what went wrong.
    reason: String,
    /// Name of the scenario.
    scenario: String,
    /// Seed of every random number.
    seed: u64,
    /// Simulated time, s.
    sim_seconds: f64,
    /// Wall time of the simulation, s; the only field that differs between two runs of one seed.
    wall_seconds: f64,
    /// Missed deadlines of all tasks.
    overruns: u32,
    /// Digest of every sample, 16 hexadecimal digits; equal digests mean equal flights to the bit.
    digest: String,
    /// Vehicle, surroundings and pilot.
    settings: Settings,
    /// Steps that were begun, in order.
    phases: Vec<PhaseSummary>,
    /// Chosen arms of each proven grip.
    grip: Vec<GripSummary>,
    /// First fault that each rule of the judge found; `null`: none.
    verdicts: BTreeMap<&'static str, Option<String>>,
    /// Strikes of turning propellers, in order.
    strikes: Vec<StrikeSummary>,
    /// What happened, in order.
    events: Vec<EventSummary>,
}

/// Vehicle, world and pilot.
#[derive(Serialize)]
struct Settings {
    known: &'static str,
    judge: &'static str,
    infill_percent: f64,
    gain_k: f64,
    configuration: &'static str,
    mixer: &'static str,
    arms: &'static str,
    servo: &'static str,
    coupled_arms: bool,
    arm_taper: f64,
    arm_coefficients: [f64; 4],
    arm_level_share: f64,
    arm_gain: [f64; 4],
    arm_offset_deg: [f64; 4],
    arm_damping: f64,
    battery_charge_percent: f64,
    servo_charge_percent: f64,
    mass_kg: f64,
    inertia_kgm2: [f64; 3],
    torque_ratio_m: f64,
    motor_tau_s: f64,
    thrust_max_n: f64,
    gust_force_n: f64,
    gust_moment_nm: f64,
    steady_wind_n: f64,
    steady_wind_from_deg: f64,
    pipe_diameter_m: f64,
    pipe_north_m: f64,
    pipe_east_m: f64,
    pipe_top_m: f64,
    pipe_length_m: f64,
    pipe_friction: f64,
    position_sensor: &'static str,
    pilot_assist: &'static str,
    pilot_delay_s: f64,
    pilot_bandwidth_hz: f64,
    pilot_eye_noise_m: f64,
    pilot_touch_within_m: Option<f64>,
    pilot_touch_drift_m_s: f64,
    pilot_believes_pipe_north_m: f64,
    pilot_believes_pipe_east_m: f64,
    pilot_believes_pipe_top_m: f64,
    pilot_believes_pipe_diameter_m: f64,
    faults: FaultsSummary,
    /// Numbers and flags of the scenario file that are not at their default, by key.
    changed_keys: BTreeMap<&'static str, f64>,
    /// Parameters of the stack that are not at their default, by name.
    params: BTreeMap<&'static str, f32>,
    /// What the parameters have wrong.
    differences: Vec<DifferenceSummary>,
}

/// One number that the parameters have wrong.
#[derive(Serialize)]
struct DifferenceSummary {
    key: String,
    truth: f64,
    assumed: f64,
}

/// Parts that failed or were off, by arm.
#[derive(Serialize)]
struct FaultsSummary {
    at_s: f64,
    pressure: [&'static str; 4],
    tilt: [&'static str; 4],
    tendon: [&'static str; 4],
    pressure_gain: [f64; 4],
    tilt_offset_deg: [f64; 4],
    tendon_slack_mm: [f64; 4],
}

impl FaultsSummary {
    fn of(f: &Faults) -> Self {
        Self {
            at_s: f.at,
            pressure: f.pressure.map(faults::pressure_word),
            tilt: f.tilt.map(faults::tilt_word),
            tendon: f.tendon.map(faults::tendon_word),
            pressure_gain: f.pressure_gain,
            tilt_offset_deg: f.tilt_offset.map(|a| tidy(deg(a))),
            tendon_slack_mm: f.tendon_slack.map(|slack| tidy(1e3 * slack)),
        }
    }
}

/// One step as flown.
#[derive(Serialize)]
struct PhaseSummary {
    name: String,
    start_s: f64,
    end_s: f64,
    done: bool,
    worst_attitude_error_deg: f64,
    worst_tilt_deg: f64,
    saturation: f64,
    battery_v: f64,
    overruns: u32,
}

/// One arm's grip when it was proven.
#[derive(Serialize)]
struct GripSummary {
    arm: u8,
    pressure_pa: f64,
    pressure_true_pa: f64,
    force_kgcm: f64,
    closure_s: f64,
}

/// One strike of a turning propeller.
#[derive(Serialize)]
struct StrikeSummary {
    arm: u8,
    against: &'static str,
    start_s: f64,
    end_s: f64,
    depth_mm: f64,
}

/// One event.
#[derive(Serialize)]
struct EventSummary {
    t_s: f64,
    text: String,
}

impl Summary {
    /// The summary of a flight.
    pub fn of(record: &FlightRecord) -> Self {
        let phase = |p: &sophie_sim::record::Phase| PhaseSummary {
            name: p.name.clone(),
            start_s: tidy(p.start),
            end_s: tidy(p.end),
            done: p.done,
            worst_attitude_error_deg: tidy(deg(p.worst_attitude_error)),
            worst_tilt_deg: tidy(deg(p.worst_tilt)),
            saturation: tidy(p.saturation),
            battery_v: tidy(p.battery_voltage),
            overruns: p.overruns,
        };
        let grip = |g: &sophie_sim::record::Grip| GripSummary {
            arm: g.arm,
            pressure_pa: tidy(g.pressure),
            pressure_true_pa: tidy(g.pressure_true),
            force_kgcm: tidy(kgcm(g.torque)),
            closure_s: tidy(g.closure),
        };
        let strike = |s: &sophie_sim::record::Strike| StrikeSummary {
            arm: s.arm,
            against: s.against.name(),
            start_s: tidy(s.start),
            end_s: tidy(s.end),
            depth_mm: tidy(1e3 * s.depth),
        };
        Self {
            accomplished: record.outcome.accomplished,
            reason: record.outcome.reason.clone(),
            scenario: record.scenario.name.clone(),
            seed: record.scenario.seed,
            sim_seconds: tidy(record.sim_seconds),
            wall_seconds: tidy(record.wall_seconds),
            overruns: record.overruns,
            digest: format!("{:016x}", record.digest),
            settings: Settings::of(&record.scenario),
            phases: record.phases.iter().map(phase).collect(),
            grip: record.grip.iter().map(grip).collect(),
            verdicts: record
                .verdicts
                .iter()
                .map(|verdict| (verdict.rule.word(), verdict.fault.clone()))
                .collect(),
            strikes: record.strikes.iter().map(strike).collect(),
            events: record
                .events
                .iter()
                .map(|e| EventSummary {
                    t_s: tidy(e.t),
                    text: e.text.clone(),
                })
                .collect(),
        }
    }

    /// As JSON text with a line end.
    pub fn to_json(&self) -> String {
        // Numbers, text and string keys only: nothing in here can fail to be written.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}

impl Settings {
    fn of(s: &Scenario) -> Self {
        let (v, w, p) = (&s.vehicle, &s.world, &s.pilot);
        let pipe = p.assumed.pipe(w);
        // A simulated vehicle's servos have their marks, which a new board's have not.
        let usual = Scenario::default_mission().params;
        let changed = Params::TABLE.iter().filter_map(|row| {
            let value = s.params.get(row.name)?;
            (usual.get(row.name)?.to_bits() != value.to_bits()).then_some((row.name, value))
        });
        Self {
            known: s.known.word(),
            judge: s.judge.word(),
            infill_percent: v.infill,
            gain_k: v.gain_k,
            configuration: keys::configuration_word(v.configuration),
            mixer: keys::mixer_word(s.mixer),
            arms: keys::arms_word(s.arms),
            servo: keys::servo_word(v.servo),
            coupled_arms: v.coupled_arms,
            arm_taper: v.arm_taper,
            arm_coefficients: v.arm_coefficients,
            arm_level_share: v.arm_level_share,
            arm_gain: v.arm_gain,
            arm_offset_deg: v.arm_offset.map(|a| tidy(deg(a))),
            arm_damping: v.arm_damping,
            battery_charge_percent: tidy(100.0 * v.battery_charge),
            servo_charge_percent: tidy(100.0 * v.servo_charge),
            mass_kg: v.body.mass,
            inertia_kgm2: v.body.inertia,
            torque_ratio_m: v.rotor.torque_ratio,
            motor_tau_s: v.rotor.spin.up,
            thrust_max_n: v.rotor.thrust_max,
            gust_force_n: w.gust_force,
            gust_moment_nm: w.gust_moment,
            steady_wind_n: w.steady_wind,
            steady_wind_from_deg: tidy(deg(s.wind_from())),
            pipe_diameter_m: w.pipe_diameter,
            pipe_north_m: w.pipe_position[0],
            pipe_east_m: w.pipe_position[1],
            pipe_top_m: w.pipe_top,
            pipe_length_m: w.pipe_length,
            pipe_friction: w.pipe_friction,
            position_sensor: keys::position_sensor_word(s.sensors.position),
            pilot_assist: keys::assist_word(p.assist),
            pilot_delay_s: p.delay,
            pilot_bandwidth_hz: p.bandwidth,
            pilot_eye_noise_m: p.eye_noise,
            pilot_touch_within_m: p.touch_within,
            pilot_touch_drift_m_s: p.touch_drift,
            pilot_believes_pipe_north_m: pipe.position[0],
            pilot_believes_pipe_east_m: pipe.position[1],
            pilot_believes_pipe_top_m: pipe.top,
            pilot_believes_pipe_diameter_m: pipe.diameter,
            faults: FaultsSummary::of(&s.faults),
            changed_keys: keys::changed(s)
                .into_iter()
                .map(|(key, value)| (key, tidy(value)))
                .collect(),
            params: changed.collect(),
            differences: s
                .differences()
                .into_iter()
                .map(|d| DifferenceSummary {
                    key: d.key,
                    truth: tidy(d.truth),
                    assumed: tidy(d.assumed),
                })
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::super::synthetic;
    use super::*;

    const DOCS: &str = include_str!("../../../docs/summary-json.md");

    fn json(record: &FlightRecord) -> Value {
        serde_json::from_str(&Summary::of(record).to_json()).unwrap()
    }

    fn field_names(value: &Value, names: &mut Vec<String>) {
        match value {
            Value::Object(map) => {
                for (name, inner) in map {
                    names.push(name.clone());
                    field_names(inner, names);
                }
            }
            Value::Array(items) => items.iter().for_each(|i| field_names(i, names)),
            _ => {}
        }
    }

    #[test]
    fn the_summary_holds_what_is_documented() {
        let v = json(&synthetic::record());
        assert_eq!(v["accomplished"], true);
        assert_eq!(v["reason"], "mission accomplished");
        assert_eq!((&v["seed"], &v["overruns"]), (&Value::from(1), &Value::from(0)));
        assert_eq!(v["scenario"], "default mission");
        assert_eq!(v["digest"], "0123456789abcdef");
        assert_eq!(v["settings"]["configuration"], "B");
        assert_eq!(v["settings"]["params"], serde_json::json!({}));
        assert!(v["sim_seconds"].as_f64().unwrap() > 70.0 && v["wall_seconds"].is_number());
        assert_eq!(v["phases"].as_array().unwrap().len(), 12);
        assert_eq!(v["phases"][2]["name"], "hover");
        let grip = v["grip"].as_array().unwrap();
        assert_eq!(grip.len(), 4);
        assert_eq!(
            (&grip[0]["arm"], &grip[0]["closure_s"]),
            (&Value::from(1), &Value::from(2.61))
        );
        assert!((grip[0]["force_kgcm"].as_f64().unwrap() - 3.977).abs() < 1e-3);
        let strike = serde_json::json!({
            "arm": 2, "against": "the pipe", "start_s": 31.2, "end_s": 31.24, "depth_mm": 12.0
        });
        assert_eq!(
            v["verdicts"],
            serde_json::json!({ "paper": null, "holding": null })
        );
        assert_eq!(v["strikes"], serde_json::json!([strike]));
        assert!(grip[3]["pressure_pa"].is_number() && grip[3]["pressure_true_pa"].is_number());
    }

    #[test]
    fn every_field_is_in_the_document() {
        let mut names = vec![];
        field_names(&json(&synthetic::record()), &mut names);
        names.sort();
        names.dedup();
        for name in names {
            assert!(DOCS.contains(&format!("`{name}`")), "{name}");
        }
    }

    #[test]
    fn changed_parameters_are_told_and_missing_numbers_are_null() {
        let mut record = synthetic::record();
        record.scenario.params.rate_pitch_p = 9.0;
        record.scenario.vehicle.body.mass = 2.0;
        record.scenario.world.pipe_shape.sag = 0.01;
        record.grip[0].closure = f64::NAN;
        let v = json(&record);
        assert_eq!(
            v["settings"]["params"],
            serde_json::json!({ "rate_pitch_p": 9.0 })
        );
        let keys = serde_json::json!({ "vehicle.mass_kg": 2.0, "world.pipe_sag_m": 0.01 });
        assert_eq!(v["settings"]["changed_keys"], keys);
        assert!(v["grip"][0]["closure_s"].is_null());
        let mass = serde_json::json!([{ "key": "vehicle.mass_kg", "truth": 2.0, "assumed": 1.805 }]);
        assert_eq!(v["settings"]["differences"], mass);
    }
}
