//! Stores the working copy and restarts to apply it.

use sophie_control::arming::ArmingInhibit;

use super::Console;
use crate::links::mavlink_line::SigningState;
use crate::storage::storing;
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    /// Stores the working copy and restarts. Arming is refused meanwhile: storing may stall the processor.
    pub(super) async fn save(&mut self) {
        if self.links.hardware().contains(ArmingInhibit::Stored) {
            return self
                .out
                .line(format_args!(
                    "not saved: others were stored over MAVLink, restart first and set yours again"
                ))
                .await;
        }
        if let Err(why) = storing::inhibit_arming(self.links).await {
            return self.refuse("not saved", why).await;
        }
        match storing::save(self.links, &mut self.storage, &self.params).await {
            Ok(()) => {
                let signing = self.links.mavlink.fresh().map(|line| line.signing);
                if signing == Some(SigningState::Unknown) {
                    // Unreadable content is lost; the storage records that a key may have existed.
                    self.out
                        .line(format_args!(
                            "MAVLink's key, if there was one, is lost: set it again, or 'mavlink key off'"
                        ))
                        .await;
                }
                self.out.last(format_args!("saved; restarting")).await;
                // Arming stays refused: the stored parameters differ from those in force.
                self.chip.restart();
            }
            Err(error) => {
                let text = error.text();
                self.out
                    .line(format_args!(
                        "not saved: {text}; your changes are kept until a restart"
                    ))
                    .await;
            }
        }
    }
}
