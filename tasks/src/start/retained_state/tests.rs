//! Reading back retained state, torn and stale copies.

use proptest::prelude::*;
use sophie_ports::retained::{WORDS, Words};

use super::*;

fn held() -> RetainedState {
    RetainedState {
        grip_memory: GripMemory::Controlled(ArmChoice::Rear),
        angle: [0.0, 2.5, 0.0, 2.75],
        force: [0.0, 53.5, 0.0, 61.25],
        fault: [
            None,
            Some(GripFault::Sensor),
            Some(GripFault::Ceiling),
            Some(GripFault::Unfelt),
        ],
        response: [None, Some(0.13), Some(1.37), Some(2.5)],
        gyro_bias: Some(Vec3::new(0.01, -0.02, 0.03)),
        thrust_factor: Some(1.13),
    }
}

fn words(retained: RetainedState, sequence: u32) -> Words {
    retained.to_words(sequence).unwrap_or_default()
}

#[test]
fn what_is_kept_comes_back() {
    for grip_memory in [
        GripMemory::Open,
        GripMemory::Controlled(ArmChoice::All),
        GripMemory::Controlled(ArmChoice::Front),
        GripMemory::HeldByGears(ArmChoice::Rear),
    ] {
        for (gyro_bias, thrust_factor) in [(None, Some(0.6)), (held().gyro_bias, Some(1.5)), (None, None)] {
            let retained = RetainedState {
                grip_memory,
                gyro_bias,
                thrust_factor,
                ..held()
            };
            assert_eq!(
                RetainedState::from_words(&words(retained, 7)),
                Some((retained, 7))
            );
        }
    }
}

#[test]
fn the_checksum_is_the_standard_one() {
    // CRC-32 of sixteen zero words, by zlib: crc32(bytes(64)).
    assert_eq!(checksum(&[0; WORDS]), 0x758D_6336);
}

#[test]
fn every_single_wrong_bit_is_found_out() {
    let good = words(held(), 41);
    assert!(RetainedState::from_words(&good).is_some());
    for word in 0..WORDS {
        for bit in 0..32 {
            let mut bad = good;
            bad[word] ^= 1 << bit;
            assert_eq!(RetainedState::from_words(&bad), None, "word {word} bit {bit}");
            // The other copy takes its place.
            let before = RetainedState {
                grip_memory: GripMemory::HeldByGears(ArmChoice::All),
                ..held()
            };
            assert_eq!(
                RetainedState::newest(&[words(before, 40), bad]),
                Some((before, 40)),
                "word {word} bit {bit}"
            );
        }
    }
}

#[test]
fn a_write_that_a_reset_cut_short_anywhere_loses_one_step_at_most() {
    let (old, new) = (
        held(),
        RetainedState {
            angle: [0.5; 4],
            force: [9.0; 4],
            ..held()
        },
    );
    let other = words(old, 8);
    for written in 0..=WORDS {
        // The copy of two steps ago is overwritten from its start.
        let mut torn = words(RetainedState::default().opened(), 7);
        for (slot, word) in torn.iter_mut().zip(words(new, 9)).take(written) {
            *slot = word;
        }
        let kept = RetainedState::newest(&[torn, other]).map(|(retained, _)| retained);
        let expected = if written == WORDS { new } else { old };
        assert_eq!(kept, Some(expected), "{written} words written");
    }
}

#[test]
fn the_later_copy_counts_also_where_the_sequence_wraps() {
    for sequence in [0, 1, 99, u32::MAX - 1, u32::MAX] {
        let next = sequence.wrapping_add(1);
        let later = RetainedState {
            force: [5.0; 4],
            ..held()
        };
        for copies in [
            [words(held(), sequence), words(later, next)],
            [words(later, next), words(held(), sequence)],
        ] {
            assert_eq!(RetainedState::newest(&copies), Some((later, next)));
        }
    }
}

#[test]
fn what_is_no_number_or_out_of_range_is_neither_kept_nor_used() {
    let nan = f32::NAN;
    let bad = [
        RetainedState {
            angle: [nan, 0.0, 0.0, 0.0],
            ..held()
        },
        RetainedState {
            angle: [0.0, -0.1, 0.0, 0.0],
            ..held()
        },
        RetainedState {
            angle: [0.0, 0.0, 6.6, 0.0],
            ..held()
        },
        RetainedState {
            force: [0.0, 0.0, 0.0, f32::INFINITY],
            ..held()
        },
        RetainedState {
            force: [-1.0, 0.0, 0.0, 0.0],
            ..held()
        },
        RetainedState {
            force: [2001.0, 0.0, 0.0, 0.0],
            ..held()
        },
        RetainedState {
            gyro_bias: Some(Vec3::new(0.0, nan, 0.0)),
            ..held()
        },
        RetainedState {
            gyro_bias: Some(Vec3::new(0.0, 0.0, 0.2)),
            ..held()
        },
        RetainedState {
            grip_memory: GripMemory::Unknown,
            ..held()
        },
    ];
    for retained in bad {
        assert_eq!(retained.to_words(1), None, "{retained:?}");
    }
    // Also with a sound checksum.
    for (word, value) in [
        (4, nan.to_bits()),
        (11, 1e9f32.to_bits()),
        (2, 4),
        (2, 0x0302),
        (2, 1 | 1 << 17),
        (2, 1 | 59 << 24),
        (2, 1 | 151 << 24),
        (3, 4),
        (3, 0x10000),
        (15, 12),
        (15, 251 << 24),
    ] {
        let mut forged = words(held(), 3);
        forged[word] = value;
        forged[WORDS - 1] = checksum(&forged);
        assert_eq!(RetainedState::from_words(&forged), None, "word {word} {value:#x}");
    }
    for retained in bad.into_iter().take(8) {
        assert!(retained.bounded().to_words(1).is_some(), "{retained:?}");
    }
}

#[test]
fn an_implausible_arm_response_is_not_retained() {
    for (response, kept) in [
        (Some(f32::NAN), None),
        (Some(0.12), None),
        (Some(2.6), None),
        (Some(1.234), Some(1.23)),
        (None, None),
    ] {
        let retained = RetainedState {
            response: [response; 4],
            ..held()
        };
        let back = retained
            .bounded()
            .to_words(1)
            .and_then(|w| RetainedState::from_words(&w));
        assert_eq!(back.map(|(r, _)| r.response), Some([kept; 4]), "{response:?}");
    }
}

#[test]
fn blank_memory_is_nothing() {
    for word in [0, u32::MAX, 0xCCCC_CCCC] {
        assert_eq!(RetainedState::newest(&[[word; WORDS]; 2]), None);
    }
}

impl RetainedState {
    fn opened(self) -> Self {
        Self {
            grip_memory: GripMemory::Open,
            ..self
        }
    }
}

proptest! {
    #[test]
    fn noise_is_nothing(noise in prop::array::uniform17(any::<u32>()), marked: bool) {
        let mut words = noise;
        if marked {
            words[0] = MAGIC;
        }
        prop_assert_eq!(RetainedState::from_words(&words), None);
    }

    #[test]
    fn a_burst_of_wrong_bits_is_found_out(start in 0usize..(32 * WORDS - 31), pattern in 1u32..) {
        let mut bad = words(held(), 5);
        for bit in (0..32).filter(|bit| pattern >> bit & 1 != 0) {
            bad[(start + bit) / 32] ^= 1 << ((start + bit) % 32);
        }
        prop_assert_eq!(RetainedState::from_words(&bad), None);
    }

    #[test]
    fn whatever_is_kept_is_sane(angle in prop::array::uniform4(any::<f32>()), force in prop::array::uniform4(any::<f32>())) {
        let retained = RetainedState { angle, force, ..held() }.bounded();
        let back = retained.to_words(1).and_then(|w| RetainedState::from_words(&w));
        prop_assert_eq!(back, Some((retained, 1)));
    }
}
