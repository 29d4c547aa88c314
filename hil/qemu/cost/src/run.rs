//! Runs the chain over the inputs and prints the counts.

use core::fmt::Arguments;
use core::hint::black_box;

use sophie_conformance::fold::Fold;

use crate::chain::{self, Chain};
use crate::counter::{self, Tally, gross};
use crate::inputs::{FLIGHT, Inputs, REST, Sequence};

/// A stage: its name and what to call.
type Stage = (&'static str, fn(&mut Chain, &Inputs));

/// In the order of the data. The tilt follows the thrusts, so it comes after the allocation that it serves next.
const STAGES: [Stage; 10] = [
    ("biquads", chain::axes),
    ("filter", chain::filter),
    ("estimator", chain::estimator),
    ("aim", chain::aim),
    ("attitude", chain::attitude),
    ("rate", chain::rate),
    ("allocation", chain::allocation),
    ("tilt", chain::tilt),
    ("commands", chain::commands),
    ("arm-sensor", chain::arm_sensor),
];

/// Counts everything; prints a line for each stage: `stage NAME CALLS TOTAL MIN MAX`.
pub fn run(print: &mut dyn FnMut(Arguments<'_>)) {
    counter::start();
    let overhead = overhead();
    print(format_args!("overhead {overhead}"));
    let commands = stages(print, overhead);
    let (again, tally) = whole(overhead);
    line(print, "whole", &tally);
    print(format_args!("commands {commands}"));
    print(format_args!("commands-whole {again}"));
}

/// Instructions that counting and calling add; stops where the counter does not count right.
fn overhead() -> u32 {
    let nothing = gross(chain::nothing, &mut (), &0);
    for rounds in 1..1000 {
        let count = gross(counter::known_loop, &mut (), &rounds) - nothing;
        assert!(
            count == counter::known(rounds),
            "{count} instructions counted for {rounds} rounds"
        );
    }
    nothing
}

fn stages(print: &mut dyn FnMut(Arguments<'_>), overhead: u32) -> Fold {
    let mut chain = Chain::new();
    let mut sequence = Sequence::new();
    let mut tallies = [Tally::new(); STAGES.len()];
    let mut fold = Fold::new();
    for step in 0..REST + FLIGHT {
        let inputs = black_box(sequence.next());
        for ((name, stage), tally) in STAGES.iter().zip(&mut tallies) {
            let count = gross(*stage, &mut chain, &inputs) - overhead;
            // The arms' sensors speak in four steps of ten, the sticks in one.
            let due = match *name {
                "arm-sensor" => inputs.arm.is_some(),
                "aim" => inputs.setpoint.is_some(),
                _ => true,
            };
            if step >= REST && due {
                tally.add(count);
            }
        }
        add(&mut fold, &chain);
    }
    for ((name, _), tally) in STAGES.iter().zip(&tallies) {
        line(print, name, tally);
    }
    fold
}

fn whole(overhead: u32) -> (Fold, Tally) {
    let mut chain = Chain::new();
    let mut sequence = Sequence::new();
    let mut tally = Tally::new();
    let mut fold = Fold::new();
    for step in 0..REST + FLIGHT {
        let inputs = black_box(sequence.next());
        let count = gross(chain::whole, &mut chain, &inputs) - overhead;
        if step >= REST {
            tally.add(count);
        }
        add(&mut fold, &chain);
    }
    (fold, tally)
}

fn add(fold: &mut Fold, chain: &Chain) {
    for command in chain.flow.commands {
        fold.add(command.to_bits());
    }
}

fn line(print: &mut dyn FnMut(Arguments<'_>), name: &str, t: &Tally) {
    print(format_args!(
        "stage {name} {} {} {} {}",
        t.calls, t.total, t.min, t.max
    ));
}
