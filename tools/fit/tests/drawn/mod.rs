//! Vehicles as builders have them, drawn from the table of uncertain numbers.

use sophie_sim::scenario::{Overrides, Scenario, draw};
use sophie_sim::streams::Streams;

/// The vehicle of `seed` on its day.
pub fn vehicle(seed: u64) -> Scenario {
    let mut text = format!("seed = {seed}\n");
    for drawn in draw::draw(Streams::new(seed)) {
        let (table, key) = drawn.key.split_once('.').unwrap();
        if matches!(table, "vehicle" | "world") && key != "pipe_flange_spacing_m" {
            text += &format!("{}\n", drawn.line());
        }
    }
    Scenario::parse(&text, "drawn", &Overrides::default()).unwrap()
}
