//! MAVLink's key in a set: ten values under names that no parameter has, stored atomically with the parameters. The
//! first value without the others marks a lost key.

use sophie_ports::signing::{Key, Record, Stored};

use super::hash;

/// Eight of the key, two of the bound.
const WORDS: usize = 10;
/// Name of the first; the others follow.
const FIRST: u32 = hash("mavlink.signing");

/// The values read so far.
#[derive(Clone, Copy, Default)]
pub(super) struct Words {
    words: [u32; WORDS],
    /// Those that were there, one bit each.
    given: u16,
}

impl Words {
    pub(super) const COUNT: usize = WORDS;

    /// Takes the value called `name`; false for a parameter's.
    pub(super) fn take(&mut self, name: u32, value: u32) -> bool {
        let at = name.wrapping_sub(FIRST);
        let Some(word) = self.words.get_mut(at as usize) else {
            return false;
        };
        *word = value;
        self.given |= 1 << at;
        true
    }

    /// State of the stored key; an incomplete key is reported as lost.
    pub(super) fn stored(&self) -> Stored {
        match self.record() {
            Some(record) => Stored::Key(record),
            None if self.given == 0 => Stored::None,
            None => Stored::Lost,
        }
    }

    /// The record, if every value was there.
    fn record(&self) -> Option<Record> {
        let ([k0, k1, k2, k3, k4, k5, k6, k7], [low, high]) = self.words.split_first_chunk::<8>()? else {
            return None;
        };
        let mut key = [0; 32];
        for (bytes, word) in key.chunks_exact_mut(4).zip([k0, k1, k2, k3, k4, k5, k6, k7]) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        (self.given == (1 << WORDS) - 1).then_some(Record {
            key: Key::new(key),
            bound: u64::from(*high) << 32 | u64::from(*low),
        })
    }

    /// Names and values of `stored`.
    pub(super) fn of(stored: &Stored) -> impl Iterator<Item = (u32, u32)> + use<> {
        let mut words = [0; WORDS];
        if let Stored::Key(Record { key, bound }) = stored {
            let bound = [*bound as u32, (bound >> 32) as u32];
            let (quads, _) = key.bytes().as_chunks::<4>();
            let key = quads.iter().map(|quad| u32::from_le_bytes(*quad));
            for (word, value) in words.iter_mut().zip(key.chain(bound)) {
                *word = value;
            }
        }
        let count = match stored {
            Stored::None => 0,
            Stored::Key(_) => WORDS,
            Stored::Unreadable | Stored::Lost => 1,
        };
        (FIRST..).zip(words).take(count)
    }
}

#[cfg(test)]
mod tests {
    use sophie_control::params::{Params, RENAMED};

    use super::*;

    #[test]
    fn no_parameter_has_a_name_of_the_key() {
        let names = Params::TABLE.iter().map(|row| row.name);
        for name in names.chain(RENAMED.iter().map(|renamed| renamed.old)) {
            assert!(hash(name).wrapping_sub(FIRST) as usize >= WORDS, "{name}");
        }
    }

    #[test]
    fn a_record_is_read_as_it_was_written_and_half_of_one_is_a_lost_one() {
        let record = Record {
            key: Key::new(core::array::from_fn(|n| n as u8)),
            bound: 0x1234_5678_9ABC,
        };
        let mut words = Words::default();
        assert_eq!(words.stored(), Stored::None);
        for (name, value) in Words::of(&Stored::Key(record)) {
            assert_eq!(words.record(), None);
            assert!(words.take(name, value));
            assert_ne!(words.stored(), Stored::None);
        }
        assert_eq!(words.stored(), Stored::Key(record));
        let mut words = Words::default();
        assert_eq!(Words::of(&Stored::None).count(), 0);
        for (name, value) in Words::of(&Stored::Lost) {
            assert!(words.take(name, value));
        }
        assert_eq!(words.stored(), Stored::Lost);
        assert!(!words.take(hash("infill"), 0));
    }
}
