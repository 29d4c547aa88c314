//! The parameters at start-up: the defaults, and over them what is stored.

use sophie_control::arming::Refusal;
use sophie_control::params::Params;

use crate::links::Links;
use crate::ports::{Loaded, Storage};

/// The parameters to fly with, and what reading them gave. Called once, before [`Links::new`].
pub async fn load(storage: &mut impl Storage) -> (Params, Loaded) {
    let mut params = *storage.defaults();
    let loaded = storage.load(&mut params).await;
    (params, loaded)
}

/// Refuses arming when the storage could not be read. Values that were refused do not: their defaults are sound.
pub fn report(links: &Links, loaded: Loaded) {
    let foreign = loaded.foreign.is_some();
    links.report(Refusal::StorageUnreadable, loaded.unreadable && !foreign);
    links.report(Refusal::StorageForeign, foreign);
}
