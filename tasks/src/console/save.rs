//! From the working copy to storage, and into force.

use embassy_time::{Duration, Instant, Timer, with_timeout};
use sophie_control::arming::ArmingInhibit;

use super::Console;
use crate::links::Status;
use crate::ports::{Chip, SerialInput, SerialOutput, Storage, StorageError};

/// Time that the commander has to answer: fifty of its periods.
const COMMANDER: Duration = Duration::from_millis(500);
/// Time between two looks at its answer.
const LOOK: Duration = Duration::from_millis(5);
/// Longest save: an erase takes 4 s at worst (STM32F7 datasheet, 256 KiB), and two of them may be needed.
const LONGEST: Duration = Duration::from_secs(10);

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    /// Stores the working copy and restarts. Arming is refused meanwhile: storing may stall the processor.
    pub(super) async fn save(&mut self) {
        if let Err(status) = self.hold_arming().await {
            return self.refuse("not saved", status).await;
        }
        let saved = with_timeout(LONGEST, self.storage.save(&self.params))
            .await
            .unwrap_or(Err(StorageError::Broken));
        match saved {
            Ok(()) => {
                self.links.report(ArmingInhibit::StorageFull, false);
                self.links.report(ArmingInhibit::StorageUnreadable, false);
                self.links.report(ArmingInhibit::StorageForeign, false);
                self.out.last(format_args!("saved; restarting")).await;
                // Arming stays refused: the parameters in force are no longer those that are stored.
                self.chip.restart();
            }
            Err(error) => {
                let (reason, text) = match error {
                    StorageError::Full => (ArmingInhibit::StorageFull, "the storage is full"),
                    StorageError::Broken => (
                        ArmingInhibit::StorageUnreadable,
                        "the storage does not keep what is written",
                    ),
                };
                self.links.report(reason, true);
                self.links.report(ArmingInhibit::Storing, false);
                self.out
                    .line(format_args!(
                        "not saved: {text}; your changes are kept until a restart"
                    ))
                    .await;
            }
        }
    }

    /// Refuses arming from here on, unless the motors may turn; what the commander says then.
    pub(super) async fn hold_arming(&self) -> Result<(), Option<Status>> {
        self.stopped()?;
        self.links.report(ArmingInhibit::Storing, true);
        // The pilot may have armed just before: what counts is what the commander says after it has seen the report.
        let seen = with_timeout(COMMANDER, self.next_status()).await;
        let held = seen.map_err(|_| None).and_then(|()| self.stopped());
        if held.is_err() {
            self.links.report(ArmingInhibit::Storing, false);
        }
        held
    }

    /// Waits for a status that was decided from now on.
    async fn next_status(&self) {
        let asked = Instant::now();
        while self.links.status.latest().is_none_or(|status| status.at <= asked) {
            Timer::after(LOOK).await;
        }
    }
}
