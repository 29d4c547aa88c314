//! Random samples of faults: seed, part of the flight and moment follow from the sample's number, or from environment
//! variables.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::*;

/// A random sample of faulty missions.
pub(super) struct FaultSample {
    number: u64,
    seeds: Vec<u64>,
    faults: Vec<Fault>,
    parts: Vec<Part>,
    pub(super) count: usize,
}

impl FaultSample {
    /// `count` missions of `seeds` with every fault in every part.
    pub(super) fn of(number: u64, seeds: &[u64], count: usize) -> Self {
        Self {
            number,
            seeds: seeds.to_vec(),
            faults: FAULTS.to_vec(),
            parts: PARTS.to_vec(),
            count,
        }
    }

    /// The sample set by `SOPHIE_DRAW`, `SOPHIE_SEEDS`, `SOPHIE_COUNT`, `SOPHIE_FAULTS` and `SOPHIE_PARTS`; by default
    /// 200 missions of sample 1, seeds 1 to 100, every fault and part.
    pub(super) fn asked() -> Self {
        let number = |name: &str, or: u64| {
            let asked = std::env::var(name).ok();
            asked.map_or(or, |n| {
                n.parse().unwrap_or_else(|_| panic!("{name}: a number, not {n}"))
            })
        };
        Self {
            number: number("SOPHIE_DRAW", 1),
            seeds: super::super::autonomous::campaign(),
            faults: named_in("SOPHIE_FAULTS", &FAULTS),
            parts: named_in("SOPHIE_PARTS", &PARTS),
            count: number("SOPHIE_COUNT", 200) as usize,
        }
    }

    /// Flies them; returns the violated requirements.
    pub(super) fn judge(&self) -> Vec<String> {
        let mut rng = Pcg64Mcg::seed_from_u64(self.number);
        let times = |sensor| -> Vec<_> {
            if self.faults.iter().all(|fault| fault.sensor() != sensor) {
                return vec![];
            }
            let times = sophie_sim::parallel::each(&self.seeds, |seed| (*seed, parts(*seed, sensor)));
            times
                .into_iter()
                .filter_map(|(seed, parts)| Some((seed, parts?)))
                .collect()
        };
        let by = [times(PositionSensor::Flow), times(PositionSensor::Pose)];
        let mut cases = vec![];
        for i in 0..self.count {
            // The faults take turns; seed, part and moment are random.
            let fault = self.faults[i % self.faults.len()];
            let known = &by[usize::from(fault.sensor() == PositionSensor::Pose)];
            let (seed, times) = known[rng.random_range(0..known.len())];
            let part = self.parts[rng.random_range(0..self.parts.len())];
            let (from, to) = times[part as usize];
            cases.push((seed, fault, part, rng.random_range(from..=to)));
        }
        let flown =
            sophie_sim::parallel::each(&cases, |&(seed, fault, part, at)| flown(seed, fault, part, at));
        flown.into_iter().flatten().collect()
    }
}

/// The items of `all` that the variable `name` lists; all of them without the variable.
fn named_in<T: Copy + std::fmt::Debug>(name: &str, all: &[T]) -> Vec<T> {
    let Ok(asked) = std::env::var(name) else {
        return all.to_vec();
    };
    let one = |asked: &str| {
        let found = all.iter().find(|one| format!("{one:?}") == asked);
        *found.unwrap_or_else(|| panic!("{name}: {asked} is none of {all:?}"))
    };
    asked.split(',').map(one).collect()
}
