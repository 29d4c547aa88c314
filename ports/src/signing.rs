//! MAVLink's signing key, in its stored form.

/// The secret shared by both ends. It is never printed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Key([u8; 32]);

impl Key {
    /// Length of the key as text, in hexadecimal digits.
    pub const DIGITS: usize = 64;

    /// From its bytes.
    pub const fn new(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }

    /// From [`Self::DIGITS`] hexadecimal digits; `None` for anything else.
    pub fn from_hex(text: &str) -> Option<Self> {
        let (pairs, []) = text.as_bytes().as_chunks::<2>() else {
            return None;
        };
        let mut key = [0; 32];
        if pairs.len() != key.len() {
            return None;
        }
        for (byte, &[high, low]) in key.iter_mut().zip(pairs) {
            *byte = (digit(high)? << 4) | digit(low)?;
        }
        Some(Self(key))
    }

    /// Its bytes, for storing.
    pub const fn bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

fn digit(letter: u8) -> Option<u8> {
    char::from(letter).to_digit(16).map(|digit| digit as u8)
}

impl core::fmt::Debug for Key {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Key")
    }
}

/// Stored state of signing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// The secret.
    pub key: Key,
    /// Upper bound of every accepted time stamp, in units of 10 µs since 2015.
    pub bound: u64,
}

impl Record {
    /// A key that has not signed anything yet.
    pub const fn fresh(key: Key) -> Self {
        Self { key, bound: 0 }
    }
}

/// Result of reading the stored key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stored {
    /// No key is stored.
    #[default]
    None,
    /// The stored key.
    Key(Record),
    /// The storage cannot be read and may hold a key.
    Unreadable,
    /// The unreadable part was erased and may have held a key: treated as unreadable until a key is set or removed.
    Lost,
}
