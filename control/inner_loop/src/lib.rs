//! The inner loop of the SOPHIE flight stack: the 1 kHz flight step ([`chain`]) with the attitude and allocation laws, the
//! parameters and the maths that it rests on.
//!
//! A package of its own, since a package has one level of optimisation: this one is compiled for speed, the laws around it
//! (`sophie_control`, which passes all of this on), at 200 Hz and less, for size. Units, frames and order of the arms are
//! those of `sophie_control`.

#![no_std]
#![deny(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic
)]
// Tests compare floats exactly where exactness is the point.
#![cfg_attr(not(test), deny(clippy::float_cmp))]

pub mod allocation;
pub mod attitude;
pub mod chain;
pub mod maths;
pub mod params;
