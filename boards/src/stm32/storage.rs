//! Parameters in the board's non-volatile memory.

use embassy_futures::block_on;
use embassy_sync::mutex::Mutex;
use embedded_storage_async::nor_flash::NorFlash;
use sophie_control::params::Params;
use sophie_drivers::param_store::ParamStore;
use sophie_ports::signing::Record;
use sophie_ports::storage::{Loaded, Storage, StorageError};
use sophie_tasks::links::last_value::Raw;
use sophie_tasks::storage::parameters;
use static_cell::StaticCell;

use super::watchdog;

/// The parameters in force and what reading them has found, before anything else runs. Not awaited, so that its 3 KB are
/// the stack's for a moment, and not for good those of every future that starts the board.
pub fn load_parameters(storage: &mut impl Storage) -> (Params, Loaded) {
    block_on(parameters::load(storage))
}

/// Where the board's storage lies, on memory `F`.
pub type StorageCell<F> = StaticCell<Mutex<Raw, ParamStore<F>>>;

/// Parameter storage on memory `F`, for console and MAVLink: the second waits until the first is through.
pub struct BoardStorage<F: 'static> {
    store: &'static Mutex<Raw, ParamStore<F>>,
    defaults: &'static Params,
}

impl<F> Clone for BoardStorage<F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F> Copy for BoardStorage<F> {}

impl<F: NorFlash> BoardStorage<F> {
    /// Storage in all of `memory`, with these defaults, kept in `cell`. Called once.
    pub fn new(cell: &'static StorageCell<F>, memory: F, defaults: &'static Params) -> Self {
        // Every memory here is smaller than 4 GiB.
        let all = 0..memory.capacity() as u32;
        let store = ParamStore::new(memory, all).with_defaults(defaults);
        Self {
            store: cell.init(Mutex::new(store)),
            defaults,
        }
    }
}

impl<F: NorFlash> Storage for BoardStorage<F> {
    fn defaults(&self) -> &'static Params {
        self.defaults
    }

    async fn load(&mut self, params: &mut Params) -> Loaded {
        self.store.lock().await.load(params).await
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        let mut store = self.store.lock().await;
        // May stall the processor beyond the normal time-out; only while disarmed.
        watchdog::be_patient(true).await;
        let saved = store.save(params).await;
        watchdog::be_patient(false).await;
        saved
    }

    async fn save_signing(&mut self, signing: Option<Record>) -> Result<(), StorageError> {
        let mut store = self.store.lock().await;
        watchdog::be_patient(true).await;
        let saved = store.save_signing(signing).await;
        watchdog::be_patient(false).await;
        saved
    }
}
