//! Folds long results into one number.

/// FNV-1a over 32-bit words: `<count> words <hash>`.
#[derive(Clone, Copy)]
pub struct Fold {
    words: u32,
    hash: u32,
}

impl Default for Fold {
    fn default() -> Self {
        Self::new()
    }
}

impl Fold {
    /// An empty fold.
    pub const fn new() -> Self {
        Self {
            words: 0,
            hash: 0x811C_9DC5,
        }
    }

    /// Adds a word.
    pub fn add(&mut self, word: u32) {
        self.words = self.words.wrapping_add(1);
        for byte in word.to_le_bytes() {
            self.hash = (self.hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    }
}

impl core::fmt::Display for Fold {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} words {:08x}", self.words, self.hash)
    }
}

/// Deterministic noise (xorshift32), equal on every machine.
pub struct Noise(u32);

impl Noise {
    /// A sequence for each nonzero `seed`.
    pub const fn new(seed: u32) -> Self {
        Self(seed)
    }

    /// The next word.
    pub fn word(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// Next number in -1..1, exact in binary: equal on every machine.
    pub fn unit(&mut self) -> f32 {
        (self.word() >> 8) as f32 * (2.0 / 16_777_216.0) - 1.0
    }
}
