//! Reads a [`Scenario`] against the tables in [`keys`](super::keys) and [`steps`](super::steps), not through derived
//! structs: messages must name key, value and the allowed values.

use core::ops::Range as Span;
use std::sync::OnceLock;

use sophie_control::gripper::tendon::SPAN_MIN_US;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::defaults::MISSION;
use super::keys::{self, KEYS, Key, Kind, Range, TABLES};
use super::known;
use super::overrides::Overrides;
use super::read_steps::steps_of;
use super::settings::Setting;
use super::source::{Result, Source, Value, as_number, in_order, table};
use super::{Scenario, Step};

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
        known::believe(&mut scenario);
        if let Some(table) = params {
            for Setting { row, value, .. } in self.settings(table)? {
                // In its range: never an error.
                let _ = scenario.params.set(row.name, value);
            }
        }
        self.pipe_clear_of_the_ground(&root, &scenario)?;
        self.servo_marks_apart(&root, &scenario)?;
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

    /// Requires a travel of each servo: angles are shares of it.
    fn servo_marks_apart(&self, root: &Spanned<DeTable<'_>>, scenario: &Scenario) -> Result<()> {
        let v = &scenario.vehicle;
        let least = f64::from(SPAN_MIN_US);
        let mut travels = v.servo_release.iter().zip(&v.servo_full);
        if travels.all(|(release, full)| (release - full).abs() >= least) {
            return Ok(());
        }
        let keys = table(root, "vehicle");
        let find = |wanted: &str| keys.and_then(|t| t.iter().find(|(name, _)| name.get_ref() == wanted));
        let allowed = format!("servo_release_us and servo_full_us of each servo {least} us apart or more");
        for name in ["servo_full_us", "servo_release_us"] {
            if let Some((_, value)) = find(name) {
                return Err(self.bad(&format!("vehicle.{name}"), value, allowed));
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

/// Steps of files without any.
fn default_steps() -> Vec<Step> {
    static STEPS: OnceLock<Vec<Step>> = OnceLock::new();
    STEPS.get_or_init(|| steps_of(MISSION)).clone()
}
