//! Copies of words (`boards/src/cortex_m/copy.rs`), which the compiler calls for messages and slices.

#[embedded_test::tests]
mod tests {
    use core::hint::black_box;

    /// Three turns of the longest copy's loop and every remainder.
    const WORDS: usize = 32;
    const UNTOUCHED: u8 = 0xA5;

    /// Aligned bytes between two guard words.
    #[derive(Clone, Copy)]
    #[repr(C, align(4))]
    struct Framed<const N: usize> {
        before: [u8; 4],
        bytes: [u8; N],
        after: [u8; 4],
    }

    // Runs without the board, whose future would take 6 KiB of RAM: its clocks are not needed.
    #[test]
    fn a_copy_is_exact_and_nothing_around_it_changes() {
        let from: [u32; WORDS] = core::array::from_fn(|i| 0x0102_0304_u32.wrapping_mul(2 * i as u32 + 1));
        let untouched = u32::from_ne_bytes([UNTOUCHED; 4]);
        for words in 0..=WORDS {
            let mut to = [untouched; WORDS + 2];
            let (source, target) = (&from[..black_box(words)], &mut to[1..=words]);
            black_box(target).copy_from_slice(black_box(source));
            let to = black_box(to);
            assert!(to[1..=words] == from[..words], "{words} words");
            assert!(
                to[0] == untouched && to[words + 1..].iter().all(|w| *w == untouched),
                "around {words} words"
            );
        }
        bytes::<65>();
        bytes::<66>();
        bytes::<67>();
        bytes::<79>();
        bytes::<95>();
    }

    /// Longer than what the compiler copies without a call.
    fn bytes<const N: usize>() {
        let framed = |bytes| Framed {
            before: [UNTOUCHED; 4],
            bytes,
            after: [UNTOUCHED; 4],
        };
        let from = black_box(framed(core::array::from_fn::<u8, N, _>(|i| 3 * i as u8 + 1)));
        let mut to = black_box(framed([0; N]));
        to.bytes = from.bytes;
        let to = black_box(to);
        assert!(to.bytes == core::array::from_fn(|i| 3 * i as u8 + 1), "{N} bytes");
        assert!(
            to.before == [UNTOUCHED; 4] && to.after == [UNTOUCHED; 4],
            "around {N} bytes"
        );
    }
}
