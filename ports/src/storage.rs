//! Where parameters and the signing key outlive power.

use sophie_control::params::Params;

use crate::signing::{Record, Stored};

/// What reading the stored parameters gave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Loaded {
    /// Parameters taken over.
    pub taken: u16,
    /// Stored values that were left out: unknown here, or no longer allowed.
    pub refused: u16,
    /// The storage is damaged, or does not answer: what could not be read keeps its default.
    pub unreadable: bool,
    /// Whose data lie there instead of parameters, where that is another firmware; the defaults are in force.
    pub foreign: Option<&'static str>,
    /// MAVLink's key.
    pub signing: Stored,
}

/// Why parameters were not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StorageError {
    /// They do not fit.
    Full,
    /// The memory does not keep what is written to it, or does not answer.
    Broken,
}

impl StorageError {
    /// What is wrong, for people.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Full => "the storage is full",
            Self::Broken => "the storage does not keep what is written",
        }
    }
}

/// Where parameters outlive power.
pub trait Storage {
    /// The parameters of this board when nothing is stored.
    fn defaults(&self) -> &'static Params {
        &Params::DEFAULT
    }

    /// Puts what is stored into `params`, which holds the defaults. Blank storage changes nothing and is no fault.
    async fn load(&mut self, params: &mut Params) -> Loaded;

    /// Stores every parameter that differs from its default, and nothing else; whatever was damaged before is gone then.
    /// May stall the processor for a second: only while the motors stand still.
    ///
    /// # Errors
    /// Storage that is full or broken. What was stored before may be lost.
    async fn save(&mut self, params: &Params) -> Result<(), StorageError>;

    /// Stores MAVLink's key, or that there is none, and leaves the stored parameters as they are. May stall the processor
    /// as [`Self::save`] does.
    ///
    /// # Errors
    /// Storage that is full, broken, or not readable: it keeps what it has then.
    async fn save_signing(&mut self, signing: Option<Record>) -> Result<(), StorageError>;
}
