//! Parameters in flash or FRAM.
//!
//! One item of a `sequential_storage` map holds the whole set: a save cut short leaves the old or the new set. An item
//! is a tag and eight bytes per parameter that differs from the board's default: FNV-1a hash of its name, bits of its
//! value. Other firmware reads the parameters that it knows, also by former names.
//!
//! Saves are appended; a page is erased when the log reaches it again. Loading never writes or erases: an erase at
//! start-up could outlast the watchdog.
//!
//! Memory: [`BUFFER`] bytes in the future of a call.

mod foreign;
mod guard;
mod set;

use core::ops::Range;

use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::Error;
use sequential_storage::cache::key_pointers::ArrayKeyPointers;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};
use sophie_control::params::Params;
use sophie_tasks::ports::{Loaded, Storage, StorageError};

use self::guard::ReadOnly;
pub use self::set::hash;
use self::set::{LONGEST, Set};

/// Buffer of a load or save: the longest set, rounded up to 32 bytes.
pub const BUFFER: usize = LONGEST.next_multiple_of(32);

/// Parameter store in `range` of flash `F`.
pub struct ParamStore<F> {
    flash: F,
    range: Range<u32>,
    defaults: &'static Params,
}

struct Found {
    set: Option<Set>,
    /// Written data are unreadable, at least as the newest set.
    damaged: bool,
}

impl Found {
    /// True if a save of `params` over `defaults` would change nothing.
    fn holds(&self, params: &Params, defaults: &Params) -> bool {
        let same = match &self.set {
            Some(set) => set.refused == 0 && !set.renamed && set.over(defaults) == *params,
            None => params == defaults,
        };
        same && !self.damaged
    }
}

impl<F: NorFlash> ParamStore<F> {
    /// A store in `range` of `flash`: 2 to 32 whole erase pages, each long enough for a set. An unsuitable range acts
    /// as unreadable, unwritable storage.
    pub const fn new(flash: F, range: Range<u32>) -> Self {
        Self {
            flash,
            range,
            defaults: &Params::DEFAULT,
        }
    }

    /// Sets the board's defaults, which are not stored.
    pub fn with_defaults(self, defaults: &'static Params) -> Self {
        Self { defaults, ..self }
    }

    /// Returns the flash.
    pub fn release(self) -> F {
        self.flash
    }

    fn config<S: NorFlash>(&self) -> Option<MapConfig<S>> {
        let (start, end) = (self.range.start, self.range.end);
        // The crate's own check subtracts before it compares.
        (start < end && end as usize <= self.flash.capacity())
            .then(|| MapConfig::try_new(start..end).ok())
            .flatten()
    }

    async fn find(&mut self, buffer: &mut [u8; BUFFER]) -> Found {
        let unreadable = Found {
            set: None,
            damaged: true,
        };
        let Some(config) = self.config() else {
            return unreadable;
        };
        let mut guard = ReadOnly::new(&mut self.flash, self.range.clone());
        let mut map = MapStorage::<(), _, _>::new(&mut guard, config, Cache::new_uncached());
        let fetched = map.fetch_item::<Set>(buffer, &()).await;
        let blank = match &fetched {
            Ok(Some(_)) => guard.blank_behind_last_read(buffer).await,
            Ok(None) => guard.blank(buffer).await,
            Err(_) => return unreadable,
        };
        Found {
            set: fetched.unwrap_or_default(),
            damaged: blank != Ok(true),
        }
    }

    /// Foreign owner of a page.
    async fn foreign(&mut self) -> Option<&'static str> {
        self.config::<&mut F>()?;
        let mut page = self.range.start;
        while page < self.range.end {
            let mut head = [0; foreign::HEAD];
            if self.flash.read(page, &mut head).await.is_ok()
                && let Some(owner) = foreign::owner(&head)
            {
                return Some(owner);
            }
            page = page.saturating_add(F::ERASE_SIZE as u32);
        }
        None
    }

    async fn append(&mut self, params: &Params, buffer: &mut [u8; BUFFER]) -> Result<(), StorageError> {
        let config = self.config().ok_or(StorageError::Broken)?;
        // Caches the place of the one key, which moving a page would search for each item.
        let cache = Cache::new(Uncached, Uncached, ArrayKeyPointers::<(), 1>::new());
        let mut map = MapStorage::<(), _, _>::new(&mut self.flash, config, cache);
        map.store_item(buffer, &(), &Set::of(*params, self.defaults))
            .await
            .map_err(|e| match e {
                // A full log makes room by itself; otherwise its flash does not hold the marks.
                Error::ItemTooBig | Error::BufferTooSmall(_) => StorageError::Full,
                _ => StorageError::Broken,
            })
    }
}

impl<F: NorFlash> Storage for ParamStore<F> {
    fn defaults(&self) -> &'static Params {
        self.defaults
    }

    async fn load(&mut self, params: &mut Params) -> Loaded {
        let mut buffer = [0; BUFFER];
        let found = self.find(&mut buffer).await;
        let Some(set) = found.set else {
            let foreign = if found.damaged { self.foreign().await } else { None };
            return Loaded {
                unreadable: found.damaged,
                foreign,
                ..Loaded::default()
            };
        };
        *params = set.over(self.defaults);
        Loaded {
            taken: set.taken,
            refused: set.refused,
            unreadable: found.damaged,
            foreign: None,
        }
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        let mut buffer = [0; BUFFER];
        let found = self.find(&mut buffer).await;
        if found.holds(params, self.defaults) {
            return Ok(());
        }
        // Appending keeps a readable old set until the new one is complete.
        if found.set.is_some() || !found.damaged {
            match self.append(params, &mut buffer).await {
                Ok(()) if self.find(&mut buffer).await.holds(params, self.defaults) => return Ok(()),
                Err(StorageError::Full) => return Err(StorageError::Full),
                // Existing data are in the way.
                Ok(()) | Err(StorageError::Broken) => (),
            }
        }
        self.config::<&mut F>().ok_or(StorageError::Broken)?;
        self.flash
            .erase(self.range.start, self.range.end)
            .await
            .map_err(|_| StorageError::Broken)?;
        self.append(params, &mut buffer).await?;
        if self.find(&mut buffer).await.holds(params, self.defaults) {
            Ok(())
        } else {
            Err(StorageError::Broken)
        }
    }
}
