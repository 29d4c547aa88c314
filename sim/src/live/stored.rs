//! Parameters that outlive a restart of the simulated board, though not the process.

use std::cell::Cell;

use sophie_control::params::Params;
use sophie_tasks::ports::{Loaded, Storage, StorageError};

/// The storage of a board.
#[derive(Clone, Copy)]
pub struct Stored(pub &'static Cell<Params>);

impl Storage for Stored {
    async fn load(&mut self, params: &mut Params) -> Loaded {
        *params = self.0.get();
        Loaded::default()
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        self.0.set(*params);
        Ok(())
    }
}
