//! Stores parameters, only while the motors stand still; arming is refused from before the write until after it.

use embassy_time::{Duration, Instant, Timer, with_timeout};
use sophie_control::arming::ArmingInhibit;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_ports::signing::Record;

use crate::links::Links;
use sophie_ports::storage::{Storage, StorageError};

/// Time that the commander has to answer: fifty of its periods.
const COMMANDER: Duration = Duration::from_millis(500);
/// Poll period of its answer.
const LOOK: Duration = Duration::from_millis(5);
/// Longest save: an erase takes 4 s at worst (STM32F7 datasheet, 256 KiB), and two of them may be needed.
const LONGEST: Duration = Duration::from_secs(10);

/// Reason against storing or testing now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotNow {
    /// Motors may turn.
    While(Mode),
    /// The commander is silent, so motors may turn.
    Silent,
    /// Another line is storing.
    Storing,
}

/// Checks that the commander reports stopped motors.
///
/// # Errors
/// The reason against it.
pub fn stopped(links: &Links) -> Result<(), NotNow> {
    match links.status.fresh().map(|status| status.mode) {
        Some(Mode::Disarmed | Mode::Calibrating) => Ok(()),
        Some(mode) => Err(NotNow::While(mode)),
        None => Err(NotNow::Silent),
    }
}

/// Inhibits arming for a save, unless the motors may turn or another line already holds the inhibit.
///
/// # Errors
/// The reason against storing.
pub async fn inhibit_arming(links: &Links) -> Result<(), NotNow> {
    stopped(links)?;
    // The inhibit has no owner: the line that finishes first would clear it for both.
    if links.hardware().contains(ArmingInhibit::Storing) {
        return Err(NotNow::Storing);
    }
    links.report(ArmingInhibit::Storing, true);
    // The pilot may have armed just before: waits for a status that the commander has decided after the report.
    let seen = with_timeout(COMMANDER, next_status(links)).await;
    let held = seen.map_err(|_| NotNow::Silent).and_then(|()| stopped(links));
    if held.is_err() {
        links.report(ArmingInhibit::Storing, false);
    }
    held
}

/// Waits for a status decided after this call.
async fn next_status(links: &Links) {
    let asked = Instant::now();
    while links.status.latest().is_none_or(|status| status.at <= asked) {
        Timer::after(LOOK).await;
    }
}

/// Stores `params` while arming is inhibited, and reports the storage's state. After a success arming stays refused.
///
/// # Errors
/// The storage is full or broken; the inhibit is cleared.
pub async fn save(links: &Links, storage: &mut impl Storage, params: &Params) -> Result<(), StorageError> {
    let saved = with_timeout(LONGEST, storage.save(params))
        .await
        .unwrap_or(Err(StorageError::Broken));
    report(links, saved);
    saved
}

/// Stores or removes MAVLink's key, as [`save`] stores the parameters.
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

/// Reports the storage's state after a save.
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

/// True if `params` differ from those in force.
pub fn differ(links: &Links, params: &Params) -> bool {
    let bits = |params: &Params, name| params.get(name).map(f32::to_bits);
    Params::TABLE
        .iter()
        .any(|row| bits(params, row.name) != bits(&links.params, row.name))
}
