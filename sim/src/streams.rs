//! Random numbers by name: each part has a stream of its own, so that a new part leaves the flights of old seeds
//! unchanged.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The random streams of one seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Streams {
    seed: u64,
}

impl Streams {
    /// The streams of `seed`.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// The stream `name`, from its beginning.
    #[must_use]
    pub fn of(self, name: &str) -> Pcg64Mcg {
        Pcg64Mcg::seed_from_u64(fnv_1a(self.seed, name))
    }

    /// The first number of the stream `name`, from 0 to below 1.
    #[must_use]
    pub fn unit(self, name: &str) -> f64 {
        self.of(name).random()
    }

    /// A number of its own for each `name`, evenly from `from` to below `to`.
    #[must_use]
    pub fn within(self, name: &str, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit(name)
    }
}

/// FNV-1a of `seed` and `name`: its definition is fixed, unlike that of the standard library's hash.
fn fnv_1a(seed: u64, name: &str) -> u64 {
    let bytes = seed.to_le_bytes().into_iter().chain(name.bytes());
    bytes.fold(0xCBF2_9CE4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    })
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    /// First values, which no release, machine or crate version may change.
    #[test]
    fn the_first_values_stay() {
        let first = |seed, name: &str| Streams::new(seed).of(name).random::<u64>();
        assert_eq!(first(1, "gust"), 0xBC4B_DBBC_0CC6_FFF5);
        assert_eq!(first(2, "gust"), 0x698D_21F9_EB22_E22F);
        assert_eq!(first(1, "imu"), 0xF5AB_EF7C_384D_1720);
    }

    #[test]
    fn seeds_and_names_give_streams_of_their_own() {
        let names = ["gust", "imu", "imu.noise", "fsr.1", "fsr.2", "eyes", "pose", ""];
        let first: HashSet<u64> = (0..500)
            .flat_map(|seed| names.map(|name| Streams::new(seed).of(name).random()))
            .collect();
        assert_eq!(first.len(), 500 * names.len());
    }

    #[test]
    fn names_of_one_seed_and_seeds_of_one_name_are_not_alike() {
        let alike = |pairs: &mut dyn Iterator<Item = (f64, f64)>| {
            let products: Vec<f64> = pairs.map(|(a, b)| 12.0 * (a - 0.5) * (b - 0.5)).collect();
            products.iter().sum::<f64>() / products.len() as f64
        };
        let unit = |seed, name| Streams::new(seed).unit(name);
        let names = alike(&mut (0..20_000).map(|s| (unit(s, "fsr.1"), unit(s, "fsr.2"))));
        let seeds = alike(&mut (0..20_000).map(|s| (unit(s, "gust"), unit(s + 1, "gust"))));
        // Three sigma of 20,000 pairs: 0.021.
        assert!(names.abs() < 0.021 && seeds.abs() < 0.021, "{names} {seeds}");
    }

    #[test]
    fn a_value_is_within_its_bounds() {
        for seed in 0..1000 {
            let value = Streams::new(seed).within("offset", -0.15, 0.05);
            assert!((-0.15..0.05).contains(&value), "{value}");
        }
    }
}
