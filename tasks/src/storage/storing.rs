//! Storing parameters: only while the motors stand, with arming refused from before to after.

use embassy_time::{Duration, Instant, Timer, with_timeout};
use sophie_control::arming::ArmingInhibit;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_ports::signing::Record;

use crate::links::Links;
use sophie_ports::storage::{Storage, StorageError};

/// Time that the commander has to answer: fifty of its periods.
const COMMANDER: Duration = Duration::from_millis(500);
/// Time between two looks at its answer.
const LOOK: Duration = Duration::from_millis(5);
/// Longest save: an erase takes 4 s at worst (STM32F7 datasheet, 256 KiB), and two of them may be needed.
const LONGEST: Duration = Duration::from_secs(10);

/// Why nothing is stored or tried now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotNow {
    /// Motors may turn.
    While(Mode),
    /// The commander is silent: they may as well.
    Silent,
    /// Another line stores.
    Storing,
}

/// Motors stand still, as far as the commander says.
///
/// # Errors
/// What it says instead.
pub fn stopped(links: &Links) -> Result<(), NotNow> {
    match links.status.fresh().map(|status| status.mode) {
        Some(Mode::Disarmed | Mode::Calibrating) => Ok(()),
        Some(mode) => Err(NotNow::While(mode)),
        None => Err(NotNow::Silent),
    }
}

/// Refuses arming from here on, unless the motors may turn or another line has it refused for the same.
///
/// # Errors
/// What is in the way.
pub async fn hold_arming(links: &Links) -> Result<(), NotNow> {
    stopped(links)?;
    // Who stores lifts it at the end, and would lift it for the other as well.
    if links.hardware().contains(ArmingInhibit::Storing) {
        return Err(NotNow::Storing);
    }
    links.report(ArmingInhibit::Storing, true);
    // The pilot may have armed just before: what counts is what the commander says after it has seen the report.
    let seen = with_timeout(COMMANDER, next_status(links)).await;
    let held = seen.map_err(|_| NotNow::Silent).and_then(|()| stopped(links));
    if held.is_err() {
        links.report(ArmingInhibit::Storing, false);
    }
    held
}

/// Waits for a status that was decided from now on.
async fn next_status(links: &Links) {
    let asked = Instant::now();
    while links.status.latest().is_none_or(|status| status.at <= asked) {
        Timer::after(LOOK).await;
    }
}

/// Stores `params` while arming is held, and reports what the storage is like. Arming stays refused after a success.
///
/// # Errors
/// Storage that is full or broken; arming is held no longer then.
pub async fn save(links: &Links, storage: &mut impl Storage, params: &Params) -> Result<(), StorageError> {
    let saved = with_timeout(LONGEST, storage.save(params))
        .await
        .unwrap_or(Err(StorageError::Broken));
    report(links, saved);
    saved
}

/// Stores MAVLink's key, or that there is none, as [`save`] does the parameters.
///
/// # Errors
/// As [`save`].
pub async fn save_signing(
    links: &Links,
    storage: &mut impl Storage,
    signing: Option<Record>,
) -> Result<(), StorageError> {
    let saved = with_timeout(LONGEST, storage.save_signing(signing))
        .await
        .unwrap_or(Err(StorageError::Broken));
    report(links, saved);
    saved
}

/// Reports what the storage is like after a save.
fn report(links: &Links, saved: Result<(), StorageError>) {
    match saved {
        Ok(()) => {
            links.report(ArmingInhibit::StorageFull, false);
            links.report(ArmingInhibit::StorageUnreadable, false);
            links.report(ArmingInhibit::StorageForeign, false);
        }
        Err(error) => {
            let reason = match error {
                StorageError::Full => ArmingInhibit::StorageFull,
                StorageError::Broken => ArmingInhibit::StorageUnreadable,
            };
            links.report(reason, true);
            links.report(ArmingInhibit::Storing, false);
        }
    }
}

/// True where `params` are not those in force.
pub fn differ(links: &Links, params: &Params) -> bool {
    let bits = |params: &Params, name| params.get(name).map(f32::to_bits);
    Params::TABLE
        .iter()
        .any(|row| bits(params, row.name) != bits(&links.params, row.name))
}
