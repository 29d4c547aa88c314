//! Parameters in the board's non-volatile memory.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::NorFlash;
use sophie_control::params::Params;
use sophie_drivers::param_store::ParamStore;
use sophie_ports::signing::Record;
use sophie_ports::storage::{Loaded, Storage, StorageError};
use sophie_tasks::storage::parameters;

use super::watchdog;

/// The parameters in force and what reading them has found, before anything else runs. Not awaited, so that its 3 KB are
/// the stack's for a moment, and not for good those of every future that starts the board.
pub fn load_parameters(storage: &mut impl Storage) -> (Params, Loaded) {
    block_on(parameters::load(storage))
}

/// Parameter storage on memory `F`.
pub struct BoardStorage<F>(ParamStore<F>);

impl<F: NorFlash> BoardStorage<F> {
    /// Storage in all of `memory`, with these defaults.
    pub fn new(memory: F, defaults: &'static Params) -> Self {
        // Every memory here is smaller than 4 GiB.
        let all = 0..memory.capacity() as u32;
        Self(ParamStore::new(memory, all).with_defaults(defaults))
    }
}

impl<F: NorFlash> Storage for BoardStorage<F> {
    fn defaults(&self) -> &'static Params {
        self.0.defaults()
    }

    async fn load(&mut self, params: &mut Params) -> Loaded {
        self.0.load(params).await
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        // May stall the processor beyond the normal time-out; only while disarmed.
        watchdog::be_patient(true).await;
        let saved = self.0.save(params).await;
        watchdog::be_patient(false).await;
        saved
    }

    async fn save_signing(&mut self, signing: Option<Record>) -> Result<(), StorageError> {
        watchdog::be_patient(true).await;
        let saved = self.0.save_signing(signing).await;
        watchdog::be_patient(false).await;
        saved
    }
}
