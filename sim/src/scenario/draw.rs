//! Draws of the uncertain quantities: a builder's vehicle and its parts, a day, a pipe.
//!
//! Each number comes from a stream of its own name, so that a further row of a table leaves the other draws of a seed
//! as they are.

use super::Scenario;
use super::uncertain::{QUANTITIES, Quantity, Spread};
use crate::streams::Streams;

/// A part or property that some vehicles, sensors and pipes have and others lack.
pub struct Chance {
    /// Scenario key: a flag, or a number that is 0 without the part.
    pub key: &'static str,
    /// Share of those that have it, 0 to 1.
    pub share: f64,
    /// Source of the share.
    pub source: &'static str,
}

/// What real vehicles, sensors and pipes have, all or some of them; the default mission has none of it but the brake.
pub const CHANCES: &[Chance] = &[
    Chance {
        key: "vehicle.esc_brakes",
        share: 0.7,
        source: "default of BLHeli, not of older controllers (assumed); one that brakes slows down as fast as up",
    },
    Chance {
        key: "vehicle.drag_on_rotors",
        share: 1.0,
        source: "a rotor's drag acts at its hub",
    },
    Chance {
        key: "vehicle.rotor_reaction",
        share: 1.0,
        source: "angular momentum",
    },
    Chance {
        key: "sensors.flow_quality_varies",
        share: 1.0,
        source: "a PMW3901's quality does not show frames that miss motion (PX4, pull request 28632)",
    },
    Chance {
        key: "sensors.range_mixed_pixels",
        share: 1.0,
        source: "users of ST's sensors: the mean of two targets",
    },
    Chance {
        key: "world.pipe_flange_spacing_m",
        share: 0.5,
        source: "pipes with flanges or welds near the spot (assumed)",
    },
];

/// The key that has no effect beside `vehicle.arm_level_n`, which is drawn in its place: a stronger rotor does not move the
/// level of an arm.
const REPLACED: &str = "vehicle.arm_level_share";

/// Time constants of a motor while it gains and loses speed.
const SPIN: [&str; 2] = ["vehicle.motor_tau_s", "vehicle.motor_tau_down_s"];
const BRAKES: &str = "vehicle.esc_brakes";

/// A drawn key of the scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Its name.
    pub key: &'static str,
    /// Its value.
    pub value: Value,
}

/// Value of a drawn key.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Numbers in the key's unit: one, or one an arm or axis.
    Numbers(Vec<f64>),
    /// `true` or `false`.
    Flag(bool),
}

impl Drawn {
    /// The line of a scenario file, without its end.
    #[must_use]
    pub fn line(&self) -> String {
        match &self.value {
            Value::Flag(flag) => format!("{} = {flag}", self.key),
            Value::Numbers(numbers) => match numbers.as_slice() {
                [number] => format!("{} = {number}", self.key),
                several => format!("{} = {several:?}", self.key),
            },
        }
    }

    /// A name for each of its numbers: the key, with `[1]` to `[4]` for one of several.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        names(self.key, self.numbers().len())
    }

    /// Its numbers; 1 or 0 for a flag.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        match &self.value {
            Value::Flag(flag) => vec![f64::from(u8::from(*flag))],
            Value::Numbers(numbers) => numbers.clone(),
        }
    }
}

/// Names of the `count` numbers of `key`.
#[must_use]
pub fn names(key: &str, count: usize) -> Vec<String> {
    if count == 1 {
        vec![key.to_owned()]
    } else {
        (1..=count).map(|index| format!("{key}[{index}]")).collect()
    }
}

/// Draws every quantity that has a spread, and every chance, in the order of the tables. The keys are the same for all
/// seeds.
#[must_use]
pub fn draw(streams: Streams) -> Vec<Drawn> {
    let nominal = Scenario::default_mission();
    let flags = CHANCES.iter().map(|chance| Drawn {
        key: chance.key,
        value: Value::Flag(streams.unit(&format!("unknown has {}", chance.key)) < chance.share),
    });
    let (mut parts, chances): (Vec<Drawn>, Vec<Drawn>) =
        flags.partition(|drawn| QUANTITIES.iter().all(|quantity| quantity.key != drawn.key));
    let has = |key: &str| {
        let drawn = chances.iter().find(|drawn| drawn.key == key);
        drawn.is_none_or(|drawn| drawn.value == Value::Flag(true))
    };
    let mut drawn: Vec<Drawn> = QUANTITIES
        .iter()
        .filter(|quantity| quantity.key != REPLACED)
        .filter_map(|quantity| {
            let share = |of: &str| streams.unit(&format!("unknown {} {of}", quantity.key));
            let mut numbers = numbers(quantity, &nominal, share)?;
            if !has(quantity.key) {
                numbers.fill(0.0);
            }
            Some(Drawn {
                key: quantity.key,
                value: Value::Numbers(numbers),
            })
        })
        .collect();
    if parts
        .iter()
        .any(|part| part.key == BRAKES && part.value == Value::Flag(true))
    {
        brake(&mut drawn);
    }
    drawn.append(&mut parts);
    drawn
}

/// A motor that its controller brakes loses speed as fast as it gains it.
fn brake(drawn: &mut [Drawn]) {
    let [up, down] = SPIN;
    let found = drawn.iter().find(|drawn| drawn.key == up);
    let value = found.map(|up| up.value.clone());
    let place = drawn.iter_mut().find(|drawn| drawn.key == down);
    if let (Some(place), Some(value)) = (place, value) {
        place.value = value;
    }
}

/// The middle of the spread of `quantity` about the numbers of `nominal`; `None` without a spread.
pub(super) fn middle(quantity: &Quantity, nominal: &Scenario) -> Option<Vec<f64>> {
    numbers(quantity, nominal, |_| 0.5)
}

/// The numbers of `quantity` at these shares of its spreads, of all and of each number; `None` without a spread.
fn numbers(quantity: &Quantity, nominal: &Scenario, share: impl Fn(&str) -> f64) -> Option<Vec<f64>> {
    let mut from = (quantity.truth)(nominal);
    if from.is_empty() && matches!(quantity.all, Some(Spread::Within(..) | Spread::Decades(..))) {
        // An optional key without a nominal value: the spread needs none.
        from.push(0.0);
    }
    if from.is_empty() || quantity.all.is_none() && quantity.each.is_none() {
        return None;
    }
    let all = quantity.all.map(|spread| (spread, share("all")));
    let each = |index: usize| quantity.each.map(|spread| (spread, share(&index.to_string())));
    let drawn = from.iter().zip(1..).map(|(&number, index)| {
        let spreads = [all, each(index)].into_iter().flatten();
        spreads.fold(number, |number, (spread, share)| spread.apply(number, share))
    });
    Some(drawn.collect())
}
