//! Time between two stamps.

/// Time from the stamp `from` to the stamp `to`, both µs, in s; 0 where `to` is not later.
pub fn seconds(from: u64, to: u64) -> f32 {
    to.saturating_sub(from) as f32 * 1e-6
}
