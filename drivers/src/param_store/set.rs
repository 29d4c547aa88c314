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
    params: Params,
    /// What was written as a set: the parameters that differ from these.
    defaults: &'static Params,
    /// What was read as a set: the rows of the table that had a record.
    given: Rows,
    /// Records taken over.
    pub taken: u16,
    /// Records of unknown names, or of values that are not allowed.
    pub refused: u16,
}

impl Set {
    pub(super) const fn of(params: Params, defaults: &'static Params) -> Self {
        Self {
            params,
            defaults,
            given: 0,
            taken: 0,
            refused: 0,
        }
    }

    /// What was read, and for everything else the defaults.
    pub(super) fn over(&self, defaults: &Params) -> Params {
        let mut params = *defaults;
        for (at, row) in (0u32..).zip(Params::TABLE) {
            if self.given >> at & 1 != 0
                && let Some(value) = self.params.get(row.name)
            {
                // Allowed: it was set in the same way when it was read.
                let _ = params.set(row.name, value);
            }
        }
        params
    }
}

/// A bit for each row of the table.
type Rows = u128;
const _: () = assert!(Params::TABLE.len() <= Rows::BITS as usize, "a row has no bit");

impl<'a> Value<'a> for Set {
    /// Writes the tag and a record for each parameter that differs from its default.
    fn serialize_into(&self, buffer: &mut [u8]) -> Result<usize, SerializationError> {
        const SHORT: SerializationError = SerializationError::BufferTooSmall;
        let (tag, mut rest) = buffer.split_first_chunk_mut().ok_or(SHORT)?;
        *tag = TAG;
        let mut length = TAG.len();
        for row in Params::TABLE {
            let [value, default] =
                [&self.params, self.defaults].map(|set| set.get(row.name).unwrap_or(row.default));
            if value.to_bits() == default.to_bits() {
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
        let mut set = Self::of(Params::DEFAULT, &Params::DEFAULT);
        for &[h0, h1, h2, h3, v0, v1, v2, v3] in records {
            let (name, value) = (
                u32::from_le_bytes([h0, h1, h2, h3]),
                f32::from_le_bytes([v0, v1, v2, v3]),
            );
            let mut rows = (0u32..).zip(Params::TABLE);
            match rows.find(|(_, row)| hash(row.name) == name) {
                Some((at, row)) if set.params.set(row.name, value).is_ok() => {
                    set.given |= 1 << at;
                    set.taken += 1;
                }
                _ => set.refused += 1,
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
