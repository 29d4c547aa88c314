//! Identity of a firmware image: a hash of its words in flash. The same sources and compiler give the same hash.

#![no_std]

/// The hash of these words, in their order.
pub fn of(words: impl IntoIterator<Item = u32>) -> u32 {
    // An odd factor, so that no step loses bits; the rotation carries the upper bits down.
    words.into_iter().fold(0, |id: u32, word| {
        (id ^ word).wrapping_mul(0x9E37_79B1).rotate_left(15)
    })
}
