//! What tells one image from another: a number of its words in flash. The same sources and compiler give the same one.

#![no_std]

/// The number of these words, in their order.
pub fn of(words: impl IntoIterator<Item = u32>) -> u32 {
    // Odd, so that no step loses bits; the turn carries the upper ones down.
    words.into_iter().fold(0, |id: u32, word| {
        (id ^ word).wrapping_mul(0x9E37_79B1).rotate_left(15)
    })
}
