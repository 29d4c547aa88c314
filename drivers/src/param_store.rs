//! Parameters in flash or FRAM.
//!
//! One item of a `sequential_storage` map holds the whole set: a save cut short leaves the old or the new set. An item
//! is a tag and eight bytes per parameter that differs from the board's default: FNV-1a hash of its name, bits of its
//! value. Other firmware reads the parameters that it knows, also by former names. MAVLink's key is ten such values.
//!
//! Saves are appended; a page is erased when the log reaches it again. Loading never writes or erases: an erase at
//! start-up could outlast the watchdog.
//!
//! Memory: one buffer of [`BUFFER`] bytes in the store, shared by all callers; otherwise each caller's future would
//! hold its own.

mod foreign;
mod guard;
mod key;
mod set;

use core::ops::Range;

use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::Error;
use sequential_storage::cache::key_pointers::ArrayKeyPointers;
use sequential_storage::cache::{Cache, Uncached};
use sequential_storage::map::{MapConfig, MapStorage};
use sophie_control::params::Params;
use sophie_ports::signing::{Record, Stored};
use sophie_ports::storage::{Loaded, Storage, StorageError};

use self::guard::ReadOnly;
pub use self::set::hash;
use self::set::{LONGEST, Set};

/// Buffer of a load or save: the longest set, rounded up to 32 bytes.
pub const BUFFER: usize = LONGEST.next_multiple_of(32);

/// Parameter store in `range` of flash `F`.
pub struct ParamStore<F> {
    log: Log<F>,
    buffer: [u8; BUFFER],
}

/// Flash range of the sets, and the defaults that they overlay.
struct Log<F> {
    flash: F,
    range: Range<u32>,
    defaults: &'static Params,
}

struct Found {
    set: Option<Set>,
    /// Written data are unreadable, at least as the newest set.
    damaged: bool,
}

/// Content of a set.
struct Content {
    params: Params,
    signing: Stored,
}

impl Found {
    /// Stored content, overlaid on `defaults`.
    fn content(&self, defaults: &Params) -> Content {
        Content {
            params: self.set.as_ref().map_or(*defaults, |set| set.over(defaults)),
            signing: self.set.as_ref().map_or(Stored::None, |set| set.signing),
        }
    }

    /// True if a save of `content` over `defaults` would change nothing.
    fn holds(&self, content: &Content, defaults: &Params) -> bool {
        let Content { params, signing } = content;
        let same = match &self.set {
            Some(set) => {
                set.refused == 0 && !set.renamed && set.over(defaults) == *params && set.signing == *signing
            }
            None => params == defaults && *signing == Stored::None,
        };
        same && !self.damaged
    }
}

impl<F: NorFlash> ParamStore<F> {
    /// A store in `range` of `flash`: 2 to 32 whole erase pages, each long enough for a set. An unsuitable range acts
    /// as unreadable, unwritable storage.
    pub const fn new(flash: F, range: Range<u32>) -> Self {
        Self {
            log: Log {
                flash,
                range,
                defaults: &Params::DEFAULT,
            },
            buffer: [0; BUFFER],
        }
    }

    /// Sets the board's defaults, which are not stored.
    pub fn with_defaults(mut self, defaults: &'static Params) -> Self {
        self.log.defaults = defaults;
        self
    }

    /// Returns the flash.
    pub fn release(self) -> F {
        self.log.flash
    }
}

impl<F: NorFlash> Log<F> {
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

    async fn append(&mut self, content: &Content, buffer: &mut [u8; BUFFER]) -> Result<(), StorageError> {
        let config = self.config().ok_or(StorageError::Broken)?;
        // Caches the place of the one key, which moving a page would search for each item.
        let cache = Cache::new(Uncached, Uncached, ArrayKeyPointers::<(), 1>::new());
        let mut map = MapStorage::<(), _, _>::new(&mut self.flash, config, cache);
        map.store_item(
            buffer,
            &(),
            &Set::of(content.params, content.signing, self.defaults),
        )
        .await
        .map_err(|e| match e {
            // `FullStorage` is reported as broken: a full map reclaims its oldest page, unless the flash does not keep
            // the page marks.
            Error::ItemTooBig | Error::BufferTooSmall(_) => StorageError::Full,
            _ => StorageError::Broken,
        })
    }

    /// Replaces the set `found` by `content`.
    async fn replace(
        &mut self,
        found: Found,
        content: &Content,
        buffer: &mut [u8; BUFFER],
    ) -> Result<(), StorageError> {
        if found.holds(content, self.defaults) {
            return Ok(());
        }
        // Appending keeps a readable old set until the new one is complete.
        if found.set.is_some() || !found.damaged {
            match self.append(content, buffer).await {
                Ok(()) if self.find(buffer).await.holds(content, self.defaults) => return Ok(()),
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
        self.append(content, buffer).await?;
        if self.find(buffer).await.holds(content, self.defaults) {
            Ok(())
        } else {
            Err(StorageError::Broken)
        }
    }
}

impl<F: NorFlash> Storage for ParamStore<F> {
    fn defaults(&self) -> &'static Params {
        self.log.defaults
    }

    async fn load(&mut self, params: &mut Params) -> Loaded {
        let Self { log, buffer } = self;
        let found = log.find(buffer).await;
        let Some(set) = found.set else {
            let foreign = if found.damaged { log.foreign().await } else { None };
            return Loaded {
                unreadable: found.damaged,
                foreign,
                signing: match foreign {
                    None if found.damaged => Stored::Unreadable,
                    _ => Stored::None,
                },
                ..Loaded::default()
            };
        };
        *params = set.over(log.defaults);
        Loaded {
            taken: set.taken,
            refused: set.refused,
            unreadable: found.damaged,
            foreign: None,
            signing: set.signing,
        }
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        let Self { log, buffer } = self;
        let found = log.find(buffer).await;
        let mut content = Content {
            params: *params,
            ..found.content(log.defaults)
        };
        if found.set.is_none() && found.damaged && log.foreign().await.is_none() {
            // Unreadable content is erased; record that it may have held a key.
            content.signing = Stored::Lost;
        }
        log.replace(found, &content, buffer).await
    }

    async fn save_signing(&mut self, signing: Option<Record>) -> Result<(), StorageError> {
        let Self { log, buffer } = self;
        let found = log.find(buffer).await;
        if found.set.is_none() && found.damaged {
            // Parameters that cannot be read are not replaced unasked.
            return Err(StorageError::Broken);
        }
        let content = Content {
            signing: signing.map_or(Stored::None, Stored::Key),
            ..found.content(log.defaults)
        };
        log.replace(found, &content, buffer).await
    }
}
