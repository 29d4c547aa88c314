//! A set of parameters as one item of the map.

use sequential_storage::map::{SerializationError, Value};
use sophie_control::params::Params;

/// Marks an item as ours, and how it is laid out.
const TAG: [u8; 4] = *b"SPH1";
/// Bytes of a record: hash of the name and bits of the value, both little-endian.
const RECORD: usize = 8;
/// Most records of a set. More than the table has, so that a set of other firmware can be read.
const RECORDS: usize = 128;
/// Bytes of the longest set.
pub(super) const LONGEST: usize = TAG.len() + RECORDS * RECORD;

const _: () = assert!(
    Params::TABLE.len() <= RECORDS,
    "the buffer does not hold every parameter"
);

/// What stands for a parameter's name in storage: its 32-bit FNV-1a hash.
pub const fn hash(name: &str) -> u32 {
    let mut rest = name.as_bytes();
    let mut hash = 0x811C_9DC5;
    while let [byte, tail @ ..] = rest {
        hash = (hash ^ *byte as u32).wrapping_mul(0x0100_0193);
        rest = tail;
    }
    hash
}

/// A set of parameters.
pub(super) struct Set {
    pub params: Params,
    /// Records taken over.
    pub taken: u16,
    /// Records of unknown names, or of values that are not allowed.
    pub refused: u16,
}

impl Set {
    pub(super) const fn of(params: Params) -> Self {
        Self {
            params,
            taken: 0,
            refused: 0,
        }
    }
}

impl<'a> Value<'a> for Set {
    /// Writes the tag and a record for each parameter that differs from its default.
    fn serialize_into(&self, buffer: &mut [u8]) -> Result<usize, SerializationError> {
        const SHORT: SerializationError = SerializationError::BufferTooSmall;
        let (tag, mut rest) = buffer.split_first_chunk_mut().ok_or(SHORT)?;
        *tag = TAG;
        let mut length = TAG.len();
        for row in Params::TABLE {
            let value = self.params.get(row.name).unwrap_or(row.default);
            if value.to_bits() == row.default.to_bits() {
                continue;
            }
            let (name, tail) = rest.split_first_chunk_mut().ok_or(SHORT)?;
            let (bits, tail) = tail.split_first_chunk_mut().ok_or(SHORT)?;
            *name = hash(row.name).to_le_bytes();
            *bits = value.to_bits().to_le_bytes();
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
        let mut set = Self::of(Params::default());
        for &[h0, h1, h2, h3, v0, v1, v2, v3] in records {
            let (name, value) = (
                u32::from_le_bytes([h0, h1, h2, h3]),
                f32::from_le_bytes([v0, v1, v2, v3]),
            );
            let row = Params::TABLE.iter().find(|row| hash(row.name) == name);
            if row.is_some_and(|row| set.params.set(row.name, value).is_ok()) {
                set.taken += 1;
            } else {
                set.refused += 1;
            }
        }
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
        let hashes: BTreeSet<u32> = Params::TABLE.iter().map(|row| hash(row.name)).collect();
        assert_eq!(hashes.len(), Params::TABLE.len());
        // Published vectors of FNV-1a, 32 bit: what is stored must mean the same in every release.
        assert_eq!(
            [hash(""), hash("a"), hash("foobar")],
            [0x811C_9DC5, 0xE40C_292C, 0xBF9C_F968]
        );
    }
}
