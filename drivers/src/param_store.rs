//! Parameters in flash or FRAM.
//!
//! One item of a `sequential_storage` map holds the whole set, so that a save that power cuts short leaves either the
//! old set or the new one, never a mixture. An item is a tag and one record of eight bytes for each parameter that
//! differs from the board's default: the FNV-1a hash of its name and the bits of its value. Firmware with other parameters
//! still reads those that it knows, and those that it knows under another name.
//!
//! Saves are appended; a page is erased when the log comes round to it. Loading never writes and never erases, whatever
//! it finds: an erase at start-up could outlast the watchdog.
//!
//! Memory: one buffer of [`BUFFER`] bytes in the future of the call, none in between.

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

/// Bytes of the buffer of a load or a save: the longest set, in whole words of 32 bytes.
pub const BUFFER: usize = LONGEST.next_multiple_of(32);

/// The parameter store in `range` of flash `F`.
pub struct ParamStore<F> {
    flash: F,
    range: Range<u32>,
    defaults: &'static Params,
}

/// What was found in the flash.
struct Found {
    set: Option<Set>,
    /// Something was written there that cannot be read, at least not as the newest set.
    damaged: bool,
}

impl Found {
    /// True when this is just what a save of `params` leaves where they would else be `defaults`.
    fn holds(&self, params: &Params, defaults: &Params) -> bool {
        let same = match &self.set {
            Some(set) => set.refused == 0 && !set.renamed && set.over(defaults) == *params,
            None => params == defaults,
        };
        same && !self.damaged
    }
}

impl<F: NorFlash> ParamStore<F> {
    /// A store in the bytes `range` of `flash`: at least two whole erase pages, each long enough for a set, at most 32.
    ///
    /// A range that does not suit shows as a storage that cannot be read or written.
    pub const fn new(flash: F, range: Range<u32>) -> Self {
        Self {
            flash,
            range,
            defaults: &Params::DEFAULT,
        }
    }

    /// The same for a board with these defaults: what is like them is not stored.
    pub fn with_defaults(self, defaults: &'static Params) -> Self {
        Self { defaults, ..self }
    }

    /// Gives the flash back.
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

    /// Reads without writing.
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

    /// Whose data lie in a page, where they are another firmware's.
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
        // The place of the one key is remembered, or moving a page's items would search it once for each of them.
        let cache = Cache::new(Uncached, Uncached, ArrayKeyPointers::<(), 1>::new());
        let mut map = MapStorage::<(), _, _>::new(&mut self.flash, config, cache);
        map.store_item(buffer, &(), &Set::of(*params, self.defaults))
            .await
            .map_err(|e| match e {
                // A log that is full makes room for one set by itself, or its flash does not hold the marks.
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
        // Appending keeps the old set until the new one is complete; where no old one can be read there is none to keep.
        if found.set.is_some() || !found.damaged {
            match self.append(params, &mut buffer).await {
                Ok(()) if self.find(&mut buffer).await.holds(params, self.defaults) => return Ok(()),
                Err(StorageError::Full) => return Err(StorageError::Full),
                // What was there is in the way.
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
