//! Runs the chain over the inputs and prints the counts.

use core::fmt::Arguments;
use core::hint::black_box;

use sophie_chain::FlightChain;
use sophie_conformance::fold::Fold;
use sophie_control::chain::Demand;

use crate::chain::{self, Laws};
use crate::counter::{self, Tally, gross, line};
use crate::inputs::{FLIGHT, Inputs, REST, Sequence};
use crate::position;

type Part<S> = (&'static str, fn(&mut S, &Inputs));

/// Stages in order, each after its laws.
const FILTER: Part<FlightChain> = ("filter", chain::filter);
const ESTIMATOR: Part<FlightChain> = ("estimator", chain::estimator);
const CONTROL: Part<FlightChain> = ("control", chain::control);
const MIXING: Part<FlightChain> = ("mixing", chain::mixing);
const BEFORE_CONTROL: [Part<Laws>; 4] = [
    ("biquads", chain::axes),
    ("aim", chain::aim),
    ("attitude", chain::attitude),
    ("rate", chain::rate),
];
/// Laws of mixing; the tilt follows the allocated thrusts.
const BEFORE_MIXING: [Part<Laws>; 4] = [
    ("allocation", chain::allocation),
    ("tilt", chain::tilt),
    ("commands", chain::commands),
    ("arm-sensor", chain::arm_sensor),
];

/// Counts and prints a line per stage: `stage NAME CALLS TOTAL MIN MAX`.
pub fn run(print: &mut dyn FnMut(Arguments<'_>)) {
    counter::start();
    let overhead = overhead();
    print(format_args!("overhead {overhead}"));
    let commands = stages(print, overhead);
    let (again, tally) = whole(overhead);
    line(print, "whole", &tally);
    position::run(print, overhead);
    print(format_args!("commands {commands}"));
    print(format_args!("commands-whole {again}"));
}

/// Instructions of counting and calling; panics if the counter is wrong.
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

struct Counts {
    overhead: u32,
    tallies: [(&'static str, Tally); 12],
}

impl Counts {
    fn new(overhead: u32) -> Self {
        let stages = [FILTER.0, ESTIMATOR.0, CONTROL.0, MIXING.0];
        let laws = BEFORE_CONTROL.iter().chain(&BEFORE_MIXING);
        let mut names = stages.into_iter().chain(laws.map(|(name, _)| *name));
        let tallies = core::array::from_fn(|_| (names.next().unwrap_or_default(), Tally::new()));
        Self { overhead, tallies }
    }

    fn call<S>(&mut self, (name, work): Part<S>, state: &mut S, inputs: &Inputs, due: bool) {
        let count = gross(work, state, inputs) - self.overhead;
        // Arm sensors are due in four steps of ten, sticks in one.
        let due = due
            && match name {
                "arm-sensor" => inputs.arm.is_some(),
                "aim" => inputs.renewed,
                _ => true,
            };
        let mine = self.tallies.iter_mut().find(|(other, _)| *other == name);
        if let Some((_, tally)) = mine
            && due
        {
            tally.add(count);
        }
    }
}

fn stages(print: &mut dyn FnMut(Arguments<'_>), overhead: u32) -> Fold {
    let mut chain = chain::at_rest();
    let mut laws = Laws::new(&chain);
    let mut sequence = Sequence::new();
    let mut counts = Counts::new(overhead);
    let mut fold = Fold::new();
    for step in 0..REST + FLIGHT {
        let inputs = black_box(sequence.next());
        let due = step >= REST;
        counts.call(FILTER, &mut chain, &inputs, due);
        if !stepped(&chain, &inputs) {
            continue;
        }
        counts.call(ESTIMATOR, &mut chain, &inputs, due);
        laws.take(&chain);
        for law in BEFORE_CONTROL {
            counts.call(law, &mut laws, &inputs, due);
        }
        counts.call(CONTROL, &mut chain, &inputs, due);
        laws.take(&chain);
        let asked = matches!(chain.flow.demand, Demand::Wrench(_) | Demand::Resting(_));
        for law in BEFORE_MIXING {
            counts.call(law, &mut laws, &inputs, due && asked);
        }
        counts.call(MIXING, &mut chain, &inputs, due);
        add(&mut fold, &chain);
    }
    for (name, tally) in &counts.tallies {
        line(print, name, tally);
    }
    fold
}

fn whole(overhead: u32) -> (Fold, Tally) {
    let mut chain = chain::at_rest();
    let mut sequence = Sequence::new();
    let mut tally = Tally::new();
    let mut fold = Fold::new();
    for step in 0..REST + FLIGHT {
        let inputs = black_box(sequence.next());
        let count = gross(chain::whole, &mut chain, &inputs) - overhead;
        if !stepped(&chain, &inputs) {
            continue;
        }
        if step >= REST {
            tally.add(count);
        }
        add(&mut fold, &chain);
    }
    (fold, tally)
}

/// The batch gave a step: a NaN reading leaves one too few.
fn stepped(chain: &FlightChain, inputs: &Inputs) -> bool {
    chain.flow.at_us == inputs.at_us
}

fn add(fold: &mut Fold, chain: &FlightChain) {
    for command in chain.flow.mix.commands {
        fold.add(command.to_bits());
    }
}
