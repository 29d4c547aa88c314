//! A set of parameters as an item of the map.

use sequential_storage::map::{SerializationError, Value};
use sophie_control::params::{ParamInfo, Params, RENAMED, Renamed};
use sophie_ports::signing::Stored;

use super::key::Words;

const TAG: [u8; 4] = *b"SPH1";
/// Hash of the name and bits of the value, both little-endian.
const RECORD: usize = 8;
/// Exceeds the table, so that other firmware's sets are readable.
pub(super) const RECORDS: usize = 256;
pub(super) const LONGEST: usize = TAG.len() + RECORDS * RECORD;

const _: () = assert!(
    Params::TABLE.len() + Words::COUNT <= RECORDS,
    "the buffer does not hold every parameter and the key"
);

/// Key of a parameter in storage: 32-bit FNV-1a hash of its name.
pub const fn hash(name: &str) -> u32 {
    let mut rest = name.as_bytes();
    let mut hash = 0x811C_9DC5;
    while let [byte, tail @ ..] = rest {
        hash = (hash ^ *byte as u32).wrapping_mul(0x0100_0193);
        rest = tail;
    }
    hash
}

pub(super) struct Set {
    params: Params,
    /// MAVLink's key.
    pub signing: Stored,
    /// For writing: parameters equal to these are not stored.
    defaults: &'static Params,
    /// For reading: table rows with a record.
    given: Rows,
    /// A record has an old name, which the next save renews.
    pub renamed: bool,
    /// Records accepted.
    pub taken: u16,
    /// Records of unknown names or invalid values.
    pub refused: u16,
}

impl Set {
    pub(super) const fn of(params: Params, signing: Stored, defaults: &'static Params) -> Self {
        Self {
            params,
            signing,
            defaults,
            given: Rows::NONE,
            renamed: false,
            taken: 0,
            refused: 0,
        }
    }

    pub(super) fn over(&self, defaults: &Params) -> Params {
        let mut params = *defaults;
        for (at, row) in Params::TABLE.iter().enumerate() {
            if self.given.contains(at)
                && let Some(value) = self.params.get(row.name)
            {
                // Valid, as when read.
                let _ = params.set(row.name, value);
            }
        }
        params
    }
}

/// Table rows, one bit each.
#[derive(Clone, Copy)]
struct Rows([u32; RECORDS / 32]);

impl Rows {
    const NONE: Self = Self([0; RECORDS / 32]);

    fn insert(&mut self, at: usize) {
        if let Some(word) = self.0.get_mut(at / 32) {
            *word |= 1 << (at % 32);
        }
    }

    fn contains(&self, at: usize) -> bool {
        self.0.get(at / 32).is_some_and(|word| word >> (at % 32) & 1 != 0)
    }
}

struct Known {
    at: usize,
    row: &'static ParamInfo,
    renamed: Option<&'static Renamed>,
}

impl Known {
    fn find(name: u32) -> Option<Self> {
        let renamed = RENAMED.iter().find(|renamed| hash(renamed.old) == name);
        let name = renamed.map_or(name, |renamed| hash(renamed.new));
        let mut rows = Params::TABLE.iter().enumerate();
        let (at, row) = rows.find(|(_, row)| hash(row.name) == name)?;
        Some(Self { at, row, renamed })
    }
}

impl<'a> Value<'a> for Set {
    fn serialize_into(&self, buffer: &mut [u8]) -> Result<usize, SerializationError> {
        const SHORT: SerializationError = SerializationError::BufferTooSmall;
        let (tag, mut rest) = buffer.split_first_chunk_mut().ok_or(SHORT)?;
        *tag = TAG;
        let mut length = TAG.len();
        let values = Params::TABLE.iter().filter_map(|row| {
            let [value, default] =
                [&self.params, self.defaults].map(|set| set.get(row.name).unwrap_or(row.default));
            (value.to_bits() != default.to_bits()).then_some((hash(row.name), value.to_bits()))
        });
        for (hash, value) in values.chain(Words::of(&self.signing)) {
            let (name, tail) = rest.split_first_chunk_mut().ok_or(SHORT)?;
            let (bits, tail) = tail.split_first_chunk_mut().ok_or(SHORT)?;
            *name = hash.to_le_bytes();
            *bits = value.to_le_bytes();
            rest = tail;
            length += RECORD;
        }
        Ok(length)
    }

    fn deserialize_from(buffer: &'a [u8]) -> Result<(Self, usize), SerializationError> {
        let (records, []) = buffer
            .strip_prefix(&TAG)
            .ok_or(SerializationError::InvalidFormat)?
            .as_chunks::<RECORD>()
        else {
            return Err(SerializationError::InvalidFormat);
        };
        let mut set = Self::of(Params::DEFAULT, Stored::None, &Params::DEFAULT);
        let mut key = Words::default();
        // Rows recorded under the table's name, which precedes an old name.
        let mut under_new = Rows::NONE;
        for &[h0, h1, h2, h3, v0, v1, v2, v3] in records {
            let name = u32::from_le_bytes([h0, h1, h2, h3]);
            let bits = u32::from_le_bytes([v0, v1, v2, v3]);
            if key.take(name, bits) {
                continue;
            }
            let value = f32::from_bits(bits);
            let Some(Known { at, row, renamed }) = Known::find(name) else {
                set.refused += 1;
                continue;
            };
            set.renamed |= renamed.is_some();
            if renamed.is_some() && under_new.contains(at) {
                continue;
            }
            let value = renamed.map_or(value, |renamed| renamed.convert(value));
            if set.params.set(row.name, value).is_err() {
                set.refused += 1;
                continue;
            }
            if renamed.is_none() {
                under_new.insert(at);
            }
            set.taken += u16::from(!set.given.contains(at));
            set.given.insert(at);
        }
        set.signing = key.stored();
        Ok((set, buffer.len()))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn no_two_names_share_a_hash() {
        let names = Params::TABLE.iter().map(|row| row.name);
        let names = names.chain(RENAMED.iter().map(|renamed| renamed.old));
        let hashes: BTreeSet<u32> = names.map(hash).collect();
        assert_eq!(hashes.len(), Params::TABLE.len() + RENAMED.len());
        // Published 32-bit FNV-1a vectors: stored keys must not change.
        assert_eq!(
            [hash(""), hash("a"), hash("foobar")],
            [0x811C_9DC5, 0xE40C_292C, 0xBF9C_F968]
        );
    }
}
