//! MAVLink's signing key, as it is stored.

/// The secret that both ends know. It is never shown.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Key([u8; 32]);

impl Key {
    /// Length of its text.
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

/// What is stored of signing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// The secret.
    pub key: Key,
    /// No frame with a later time has been taken, in units of 10 µs since 2015.
    pub bound: u64,
}

impl Record {
    /// A key that has signed nothing yet.
    pub const fn fresh(key: Key) -> Self {
        Self { key, bound: 0 }
    }
}

/// What is known of the stored key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stored {
    /// None is stored.
    #[default]
    None,
    /// This one.
    Key(Record),
    /// The storage cannot be read: there may be one.
    Unreadable,
    /// There may have been one in what could not be read and was erased: as good as unreadable until one is set, or none.
    Lost,
}
