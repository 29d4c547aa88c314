//! Reads a [`Scenario`] against the tables in [`keys`](super::keys) and [`steps`](super::steps), not through derived
//! structs: messages must name key, value and the allowed values.

use core::ops::Range as Span;
use std::sync::OnceLock;

use sophie_control::params::ServoMarks;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::defaults::MISSION;
use super::keys::{self, KEYS, Key, Kind, Range, TABLES};
use super::overrides::Overrides;
use super::read_steps::steps_of;
use super::settings::Setting;
use super::source::{Result, Source, Value, as_number, in_order, table};
use super::{Scenario, Step};
use crate::plant::tendon::ServoSpec;

impl Source<'_> {
    pub(super) fn scenario(&self, overrides: &Overrides) -> Result<Scenario> {
        let root = self.document()?;
        let mut scenario = Scenario::empty();
        let (mut steps, mut params) = (None, None);
        for (name, span, value) in in_order(root.get_ref()) {
            match (name, value.get_ref()) {
                ("steps", DeValue::Array(_)) => steps = Some(self.steps(value)?),
                ("steps", _) => return Err(self.bad("steps", value, "a list such as [{ do = \"arm\" }]")),
                ("params", DeValue::Table(table)) => params = Some(table),
                (_, DeValue::Table(table)) if TABLES.contains(&name) => {
                    self.table(name, table, &mut scenario)?
                }
                (_, _) if TABLES.contains(&name) => {
                    return Err(self.bad(name, value, format!("a table, written [{name}]")));
                }
                _ => self.key(name, &span, value, &mut scenario)?,
            }
        }
        overrides.apply(&mut scenario);
        params_from_vehicle(&mut scenario);
        if let Some(table) = params {
            for Setting { row, value, .. } in self.settings(table)? {
                // In its range: never an error.
                let _ = scenario.params.set(row.name, value);
            }
        }
        self.pipe_clear_of_the_ground(&root, &scenario)?;
        self.arms(&root, &scenario)?;
        scenario.steps = steps.unwrap_or_else(default_steps);
        Ok(scenario)
    }

    fn table(&self, table: &str, content: &DeTable<'_>, scenario: &mut Scenario) -> Result<()> {
        for (name, span, value) in in_order(content) {
            self.key(&format!("{table}.{name}"), &span, value, scenario)?;
        }
        Ok(())
    }

    fn key(&self, name: &str, span: &Span<usize>, value: &Value<'_>, scenario: &mut Scenario) -> Result<()> {
        let Some(Key { kind, .. }) = KEYS.iter().find(|k| k.name == name) else {
            let known = KEYS
                .iter()
                .map(|k| k.name)
                .chain(TABLES.iter().copied())
                .chain(["steps"]);
            return Err(self.unknown(name, span, value, known.map(str::to_owned)));
        };
        match kind {
            Kind::Number(range, field) => *field(scenario) = self.number(name, value, range)?,
            Kind::Optional(range, field) => *field(scenario) = Some(self.number(name, value, range)?),
            Kind::PerArm(range, field) => {
                let allowed = || format!("four numbers, each {}", range.allowed());
                let items = value.get_ref().as_array().filter(|a| a.len() == 4);
                let items = items.ok_or_else(|| self.bad(name, value, allowed()))?;
                for (slot, item) in field(scenario).iter_mut().zip(items.iter()) {
                    *slot = self.number(name, item, range)?;
                }
            }
            Kind::PerAxis(ranges, field) => {
                let allowed = || {
                    let each = ranges.each_ref().map(Range::allowed);
                    format!("three numbers for roll, pitch and yaw: {}", each.join(", "))
                };
                let items = value.get_ref().as_array().filter(|a| a.len() == 3);
                let items = items.ok_or_else(|| self.bad(name, value, allowed()))?;
                let slots = field(scenario).iter_mut();
                for ((slot, range), item) in slots.zip(ranges).zip(items.iter()) {
                    *slot = self.number(name, item, range)?;
                }
            }
            Kind::Flag(field) => {
                let flag = value.get_ref().as_bool();
                *field(scenario) = flag.ok_or_else(|| self.bad(name, value, "true or false"))?;
            }
            Kind::Choice(words, set) => {
                let word = value.get_ref().as_str().filter(|w| words.contains(w));
                set(
                    scenario,
                    word.ok_or_else(|| self.bad(name, value, words.join(", ")))?,
                );
            }
            Kind::PerArmChoice(words, set) => {
                let items = value.get_ref().as_array().filter(|a| a.len() == 4);
                let allowed = || format!("four words, each {}", words.join(", "));
                let items = items.ok_or_else(|| self.bad(name, value, allowed()))?;
                for (arm, item) in items.iter().enumerate() {
                    let word = item.get_ref().as_str().filter(|w| words.contains(w));
                    set(
                        scenario,
                        arm,
                        word.ok_or_else(|| self.bad(name, item, words.join(", ")))?,
                    );
                }
            }
            Kind::Seed(field) => {
                let seed = as_number(value).and_then(keys::seed);
                *field(scenario) = seed.ok_or_else(|| self.bad(name, value, keys::SEED_ALLOWED))?;
            }
            Kind::Text(set) => {
                let text = value
                    .get_ref()
                    .as_str()
                    .filter(|t| !t.chars().any(char::is_control));
                set(
                    scenario,
                    text.ok_or_else(|| self.bad(name, value, "one line of text"))?,
                );
            }
        }
        Ok(())
    }

    /// Requires room below the pipe.
    fn pipe_clear_of_the_ground(&self, root: &Spanned<DeTable<'_>>, scenario: &Scenario) -> Result<()> {
        let lowest = scenario.world.pipe_diameter + 0.2;
        if scenario.world.pipe_top >= lowest {
            return Ok(());
        }
        let keys = table(root, "world");
        let find = |wanted: &str| keys.and_then(|t| t.iter().find(|(name, _)| name.get_ref() == wanted));
        let allowed = format!("pipe_top_m at least 0.2 m above pipe_diameter_m, here {lowest:.3} m");
        for name in ["pipe_top_m", "pipe_diameter_m"] {
            if let Some((_, value)) = find(name) {
                return Err(self.bad(&format!("world.{name}"), value, allowed));
            }
        }
        Ok(())
    }
}

/// The stack's parameters follow the vehicle unless the file sets them. Without a lens position in the file they assume
/// the lens at the centre of mass; it is near enough to need no measuring.
fn params_from_vehicle(scenario: &mut Scenario) {
    let Scenario {
        params,
        vehicle,
        sensors,
        ..
    } = scenario;
    let lens = [&mut params.flow_x, &mut params.flow_y, &mut params.flow_z];
    for (measured, place) in lens.into_iter().zip(sensors.flow_place) {
        *measured = place.map_or(*measured, |m| m as f32);
    }
    params.infill = vehicle.infill as f32;
    params.gain_k = vehicle.gain_k as f32;
    let [a1, a2, b1, b2] = vehicle.arm_coefficients.map(|c| c as f32);
    (params.arm_a1, params.arm_a2, params.arm_b1, params.arm_b2) = (a1, a2, b1, b2);
    params.arm_level_share = vehicle.arm_level_share as f32;
    params.mass = vehicle.body.mass as f32;
    let [roll, pitch, yaw] = vehicle.body.inertia.map(|i| i as f32);
    (params.inertia_roll, params.inertia_pitch, params.inertia_yaw) = (roll, pitch, yaw);
    params.torque_ratio = vehicle.rotor.torque_ratio as f32;
    params.motor_tau = vehicle.rotor.time_constant as f32;
    params.thrust_max = vehicle.rotor.thrust_max as f32;
    let servo = ServoSpec::from(vehicle.servo);
    params.servo_stall = servo.stall as f32;
    let slew = servo.slew as f32;
    (params.servo_slew_1, params.servo_slew_2) = (slew, slew);
    (params.servo_slew_3, params.servo_slew_4) = (slew, slew);
    params.servo_range = servo.range as f32;
    // The servos take pulses and marks from the parameters (`ServoSpec::measured`).
    params.servo_marks = ServoMarks::S1234;
}

/// Steps of files without any.
fn default_steps() -> Vec<Step> {
    static STEPS: OnceLock<Vec<Step>> = OnceLock::new();
    STEPS.get_or_init(|| steps_of(MISSION)).clone()
}
