//! The list of steps of a scenario file.

use toml::de::DeTable;

use super::Step;
use super::error::ScenarioError;
use super::source::{Result, Source, Value, in_order};
use super::steps::{STEPS, StepKind, Whereabouts};

impl Source<'_> {
    pub(super) fn steps(&self, list: &Value<'_>) -> Result<Vec<Step>> {
        let items = list.get_ref().as_array().map(|a| a.iter()).unwrap_or_default();
        let mut steps = Vec::new();
        let mut whereabouts = Whereabouts::OnGroundDisarmed;
        for (i, item) in items.enumerate() {
            let key = format!("steps[{i}]");
            let step = self.step(&key, item)?;
            whereabouts = whereabouts
                .after(&step)
                .map_err(|allowed| ScenarioError::StepOrder {
                    at: self.at(&item.span()),
                    key,
                    step: step.name().to_owned(),
                    allowed,
                })?;
            steps.push(step);
        }
        if steps.is_empty() {
            return Err(ScenarioError::NoSteps {
                at: self.at(&list.span()),
            });
        }
        Ok(steps)
    }

    fn step(&self, key: &str, item: &Value<'_>) -> Result<Step> {
        let names = || STEPS.iter().map(|k| k.name).collect::<Vec<_>>().join(", ");
        let table = item.get_ref().as_table();
        let table = table.ok_or_else(|| self.bad(key, item, "a table such as { do = \"arm\" }"))?;
        let Some((_, name)) = table.iter().find(|(name, _)| name.get_ref() == "do") else {
            let (at, key) = (self.at(&item.span()), format!("{key}.do"));
            return Err(ScenarioError::MissingKey {
                at,
                key,
                allowed: names(),
            });
        };
        let kind = name
            .get_ref()
            .as_str()
            .and_then(|word| STEPS.iter().find(|k| k.name == word));
        let kind = kind.ok_or_else(|| self.bad(&format!("{key}.do"), name, names()))?;
        Ok((kind.build)(self.step_numbers(key, kind, table)?))
    }

    fn step_numbers(&self, key: &str, kind: &StepKind, table: &DeTable<'_>) -> Result<[f64; 3]> {
        let mut numbers = [0.0; 3];
        for (slot, number) in numbers.iter_mut().zip(kind.numbers) {
            *slot = number.default * number.range.si;
        }
        for (name, span, value) in in_order(table).into_iter().filter(|(name, ..)| *name != "do") {
            let key = format!("{key}.{name}");
            let slots = numbers.iter_mut().zip(kind.numbers);
            let Some((slot, number)) = slots.into_iter().find(|(_, n)| n.key == name) else {
                let table = key.strip_suffix(name).unwrap_or_default();
                let known = kind
                    .numbers
                    .iter()
                    .map(|n| n.key)
                    .chain(["do"])
                    .map(|n| format!("{table}{n}"));
                return Err(self.unknown(&key, &span, value, known));
            };
            *slot = self.number(&key, value, &number.range)?;
        }
        Ok(numbers)
    }
}

pub(super) fn steps_of(text: &str) -> Vec<Step> {
    let source = Source { file: "", text };
    let Ok(root) = source.document() else {
        return Vec::new();
    };
    let list = root.get_ref().iter().find(|(name, _)| name.get_ref() == "steps");
    list.and_then(|(_, value)| source.steps(value).ok())
        .unwrap_or_default()
}
