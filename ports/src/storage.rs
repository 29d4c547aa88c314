//! Storage of parameters and of the signing key without power.

use sophie_control::params::Params;

use crate::signing::{Record, Stored};

/// Result of reading the stored parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Loaded {
    /// Number of parameters loaded.
    pub taken: u16,
    /// Number of stored values that were ignored: unknown here, or outside their present range.
    pub refused: u16,
    /// The storage is damaged or does not answer: unread parameters keep their defaults.
    pub unreadable: bool,
    /// Name of another firmware whose data occupy the storage; the defaults are in force.
    pub foreign: Option<&'static str>,
    /// MAVLink's key.
    pub signing: Stored,
}

/// Why parameters were not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StorageError {
    /// The parameters do not fit.
    Full,
    /// The memory does not keep written data, or does not answer.
    Broken,
}

impl StorageError {
    /// Error text for people.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Full => "the storage is full",
            Self::Broken => "the storage does not keep what is written",
        }
    }
}

/// Storage of parameters without power.
pub trait Storage {
    /// Defaults of this board, in force if nothing is stored.
    fn defaults(&self) -> &'static Params {
        &Params::DEFAULT
    }

    /// Loads the stored parameters into `params`, which holds the defaults. Blank storage changes nothing and reports
    /// no error.
    async fn load(&mut self, params: &mut Params) -> Loaded;

    /// Stores exactly the parameters that differ from their defaults; this also removes damaged entries. May stall the
    /// processor for a second: call only while the motors are stopped.
    ///
    /// # Errors
    /// The storage is full or broken; the previous parameters may be lost.
    async fn save(&mut self, params: &Params) -> Result<(), StorageError>;

    /// Stores MAVLink's key, or its absence, and keeps the stored parameters. May stall the processor as [`Self::save`]
    /// does.
    ///
    /// # Errors
    /// The storage is full, broken, or not readable; its contents then stay unchanged.
    async fn save_signing(&mut self, signing: Option<Record>) -> Result<(), StorageError>;
}
