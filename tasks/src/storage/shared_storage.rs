//! A port with several users, one at a time.

use embassy_sync::mutex::Mutex;
use sophie_control::params::Params;
use sophie_ports::signing::Record;

use crate::links::last_value::Raw;
use sophie_ports::storage::{Loaded, Storage, StorageError};

/// The storage of parameters for console and MAVLink: who comes second waits until the first is through.
pub struct SharedStorage<'a, S> {
    storage: &'a Mutex<Raw, S>,
    defaults: &'static Params,
}

impl<'a, S: Storage> SharedStorage<'a, S> {
    /// One user's view of `storage`, whose board has these defaults.
    pub const fn new(storage: &'a Mutex<Raw, S>, defaults: &'static Params) -> Self {
        Self { storage, defaults }
    }
}

impl<S: Storage> Storage for SharedStorage<'_, S> {
    fn defaults(&self) -> &'static Params {
        self.defaults
    }

    async fn load(&mut self, params: &mut Params) -> Loaded {
        self.storage.lock().await.load(params).await
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        self.storage.lock().await.save(params).await
    }

    async fn save_signing(&mut self, signing: Option<Record>) -> Result<(), StorageError> {
        self.storage.lock().await.save_signing(signing).await
    }
}
