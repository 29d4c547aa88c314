//! The whole check: vehicles that fly pass, others fail with a reason, and no input panics.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use sophie_control::params::Params;

use super::loops::STEPS;
use super::*;
use crate::scenario::Overrides;
use crate::scenario::keys::{KEYS, Kind};

const DRAWS: usize = 60;
/// Most simulated steps of a check: settling and three responses at their longest are 33,000.
const LONGEST: u64 = 40_000;

fn parse(text: &str) -> Scenario {
    Scenario::parse(text, "test.toml", &Overrides::default()).unwrap()
}

fn failing(text: &str) -> Vec<String> {
    Check::of(&parse(text))
        .failing()
        .map(|row| row.name.clone())
        .collect()
}

#[test]
fn the_default_vehicle_can_fly() {
    let check = Check::of(&Scenario::default_mission());
    for row in &check.rows {
        println!("{:20} {:12} {}", row.name, row.shown(), row.limit_shown());
        assert!(
            !row.advice.is_empty() && !row.advice.contains('\n'),
            "{}",
            row.name
        );
    }
    assert!(check.can_fly(), "{:?}", check.failing().collect::<Vec<_>>());
}

#[test]
fn the_check_names_why_a_vehicle_cannot_fly() {
    for (text, names) in [
        ("[vehicle]\nmass_kg = 3.0", &["thrust to weight"][..]),
        ("[vehicle]\nthrust_max_n = 5", &["thrust to weight"]),
        (
            "[vehicle]\ninfill = 8\ngain_k = 3.5\n[world]\npipe_diameter_m = 0.2",
            &[
                "grip force arm 1",
                "grip force arm 2",
                "grip force arm 3",
                "grip force arm 4",
            ],
        ),
        (
            "[params]\nrate_pitch_p = 30",
            &["pitch gain margin", "pitch phase margin"],
        ),
        ("[vehicle]\nconfiguration = 'A'", &["yaw derivative"]),
        (
            include_str!("../../../tests/scenarios/battery-empty.toml"),
            &["flight time"],
        ),
    ] {
        let failed = failing(text);
        println!("{text:?}: {failed:?}");
        for name in names {
            assert!(failed.iter().any(|f| f == name), "{text}: {failed:?}");
        }
    }
}

#[test]
fn a_mission_without_a_pipe_has_no_rows_of_it() {
    let rows = Check::of(&parse(
        "steps = [{ do = 'arm' }, { do = 'take-off' }, { do = 'land' }, { do = 'disarm' }]",
    ))
    .rows;
    assert!(
        rows.iter()
            .all(|row| !row.name.contains("grip") && !row.name.contains("pipe"))
    );
}

/// Samples about half of the vehicle's and world's numbers and `params` parameters from their ranges.
fn sample(rng: &mut Pcg64Mcg, params: f64) -> String {
    let mut text = String::new();
    for table in ["vehicle", "world"] {
        text += &format!("[{table}]\n");
        for key in KEYS {
            let Some((_, name)) = key.name.split_once('.').filter(|(of, _)| *of == table) else {
                continue;
            };
            if rng.random::<bool>() {
                continue;
            }
            let mut within = |range: &crate::scenario::keys::Range| rng.random_range(range.min..=range.max);
            match &key.kind {
                Kind::Number(range, _) | Kind::Optional(range, _) => {
                    text += &format!("{name} = {:.6}\n", within(range))
                }
                Kind::PerAxis([a, b, c], _) => {
                    text += &format!(
                        "{name} = [{:.6}, {:.6}, {:.6}]\n",
                        within(a),
                        within(b),
                        within(c)
                    );
                }
                Kind::Choice(words, _) => {
                    let word = words[rng.random_range(0..words.len())];
                    text += &format!("{name} = '{word}'\n");
                }
                _ => {}
            }
        }
    }
    text += "[params]\n";
    for row in Params::TABLE.iter().filter(|row| row.choices.is_empty()) {
        if rng.random::<f64>() < params {
            // Corners as often as the inside.
            let value = match rng.random_range(0..4) {
                0 => row.min,
                1 => row.max,
                _ => rng.random_range(row.min..=row.max),
            };
            text += &format!("{} = {value:.6}\n", row.name);
        }
    }
    text
}

#[test]
fn no_accepted_scenario_makes_it_panic_or_take_long() {
    let mut rng = Pcg64Mcg::seed_from_u64(13);
    let (mut checked, mut longest) = (0, 0);
    while checked < DRAWS {
        let params = [0.05, 0.5][checked % 2];
        let Ok(scenario) = Scenario::parse(&sample(&mut rng, params), "test.toml", &Overrides::default())
        else {
            continue;
        };
        STEPS.set(0);
        let check = Check::of(&scenario);
        longest = longest.max(STEPS.get());
        assert!(
            check
                .rows
                .iter()
                .all(|row| row.limit.value().is_finite() && !row.advice.is_empty())
        );
        checked += 1;
    }
    println!("longest {longest} steps");
    assert!((1..=LONGEST).contains(&longest), "{longest} steps");
}
