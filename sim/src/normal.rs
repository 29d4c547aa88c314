//! Normally distributed numbers by the ziggurat method, whose logarithms are `libm`'s: those of a crate of distributions
//! follow the features that other crates switch on, and a seed would mean another flight in another program.
//!
//! The density e^(-x²/2), x ≥ 0, is covered by 256 layers of equal area v (Marsaglia and Tsang, The ziggurat method
//! for generating random variables, J. Stat. Soft. 5(8), 2000). Layer i ≥ 1 is the box from x = 0 to x_i between the
//! heights f(x_i) and f(x_(i+1)); layer 0 is the box up to f(r) with the tail beyond r. In the part of a layer that lies
//! under the density whole, 98.8 % of the draws, a number costs one product.

use std::sync::LazyLock;

use rand::Rng;
use rand::distr::{Distribution, Open01};

const LAYERS: usize = 256;
/// r of 256 layers, where the tail begins: the last layer ends at the density's top, f = 1.
const TAIL: f64 = 3.654_152_885_361_009;

static LAYER: LazyLock<[Layer; LAYERS]> = LazyLock::new(layers);

/// The normal distribution of mean 0 and deviation 1.
#[derive(Clone, Copy, Debug)]
pub struct StandardNormal;

#[derive(Clone, Copy, Default)]
struct Layer {
    /// Width of the box.
    width: f64,
    /// Width of the box above it, under the density whole.
    inner: f64,
    /// Density at either width.
    density: [f64; 2],
}

impl Distribution<f64> for StandardNormal {
    #[inline]
    fn sample<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        loop {
            let bits = rng.next_u64();
            // The layer by eight bits, the place in it, from -1 to below 1, by 52 others.
            let index = (bits % LAYERS as u64) as usize;
            let layer = &LAYER[index];
            let place = (bits >> 12) as f64 * (1.0 / (1u64 << 51) as f64) - 1.0;
            let x = place * layer.width;
            if x.abs() < layer.inner {
                return x;
            }
            if index == 0 {
                return tail(rng).copysign(place);
            }
            let [low, high] = layer.density;
            if high + (low - high) * rng.random::<f64>() < density(x) {
                return x;
            }
        }
    }
}

fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}

/// A number beyond [`TAIL`] (Marsaglia, Generating a variable from the tail of the normal distribution, Technometrics
/// 6, 1964).
#[cold]
fn tail<R: Rng + ?Sized>(rng: &mut R) -> f64 {
    let mut exponential = || -libm::log(rng.sample(Open01));
    loop {
        let (beyond, height): (f64, f64) = (exponential() / TAIL, exponential());
        if 2.0 * height >= beyond * beyond {
            return TAIL + beyond;
        }
    }
}

fn layers() -> [Layer; LAYERS] {
    // The integral of the density beyond r is √(π/2) erfc(r/√2).
    let beyond = libm::sqrt(0.5 * std::f64::consts::PI) * libm::erfc(TAIL * std::f64::consts::FRAC_1_SQRT_2);
    let area = TAIL * density(TAIL) + beyond;
    let mut width = area / density(TAIL);
    let mut inner = TAIL;
    let mut layers = [Layer::default(); LAYERS];
    for (i, layer) in layers.iter_mut().enumerate() {
        *layer = Layer {
            width,
            inner,
            density: [density(width), density(inner)],
        };
        let top = density(inner) + area / inner;
        // The last but one ends at the top, where the width above it is 0 but for rounding.
        let above = if i + 2 < LAYERS {
            libm::sqrt(-2.0 * libm::log(top))
        } else {
            0.0
        };
        (width, inner) = (inner, above);
    }
    layers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::Streams;

    /// First values, which no release, machine or crate version may change.
    #[test]
    fn the_first_values_stay() {
        let mut rng = Streams::new(1).of("normal");
        let first: [u64; 4] = std::array::from_fn(|_| f64::to_bits(StandardNormal.sample(&mut rng)));
        assert_eq!(
            first,
            [
                0x3FE5_61B2_808D_089B,
                0x3FC2_9039_F061_D15C,
                0x3FF2_C4E6_D697_AFB1,
                0x3FDA_31BB_3065_3726
            ]
        );
        let last = (LAYER[1].density[0].to_bits(), LAYER[254].inner.to_bits());
        assert_eq!(last, (0x3F54_A605_B6B9_F70F, 0x3FCB_8D0B_E3FD_F6FE));
    }

    #[test]
    fn layers_have_one_area_and_the_last_ends_at_the_top() {
        let area = LAYER[0].width * density(TAIL);
        for layer in &LAYER[1..] {
            let [low, high] = layer.density;
            assert!((layer.width * (high - low) / area - 1.0).abs() < 1e-9);
        }
        assert_eq!(LAYER[LAYERS - 1].density[1], 1.0);
    }

    /// Shares below multiples of the deviation, within four sigma of a share of four million; the last are of the tail.
    #[test]
    fn the_shares_are_those_of_the_normal_distribution() {
        const DRAWS: usize = 4_000_000;
        let mut rng = Streams::new(2).of("normal");
        let mut drawn: Vec<f64> = (0..DRAWS).map(|_| StandardNormal.sample(&mut rng)).collect();
        drawn.sort_by(f64::total_cmp);
        for x in [
            -4.2, -3.7, -3.0, -2.0, -1.0, -0.3, 0.0, 0.1, 0.5, 1.5, 2.5, 3.5, 3.66, 4.0,
        ] {
            let share = 0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2);
            let below = drawn.partition_point(|d| *d < x) as f64 / DRAWS as f64;
            let sigma = libm::sqrt(share * (1.0 - share) / DRAWS as f64);
            assert!((below - share).abs() < 4.0 * sigma, "{x}: {below} for {share}");
        }
    }
}
