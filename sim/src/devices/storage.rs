//! Storage of the simulated board: parameters and MAVLink's key. It survives a restart of the board, not the end of the
//! process.

use std::cell::Cell;

use sophie_control::params::Params;
use sophie_ports::signing::{Record, Stored};
use sophie_ports::storage::{Loaded, Storage, StorageError};

/// Stored values of a board.
#[derive(Debug)]
pub struct Memory {
    /// Stored parameters.
    pub params: Cell<Params>,
    /// Stored key of MAVLink, `None` without signing.
    pub signing: Cell<Option<Record>>,
}

impl Memory {
    /// The key that the next start loads.
    pub fn key(&self) -> Stored {
        self.signing.get().map_or(Stored::None, Stored::Key)
    }
}

/// The storage of a board.
#[derive(Clone, Copy, Debug)]
pub struct Port(pub &'static Memory);

impl Storage for Port {
    async fn load(&mut self, params: &mut Params) -> Loaded {
        *params = self.0.params.get();
        Loaded {
            signing: self.0.key(),
            ..Loaded::default()
        }
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        self.0.params.set(*params);
        Ok(())
    }

    async fn save_signing(&mut self, signing: Option<Record>) -> Result<(), StorageError> {
        self.0.signing.set(signing);
        Ok(())
    }
}
