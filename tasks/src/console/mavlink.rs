//! State of MAVLink, and its signing key, which only this command sets.

use sophie_control::arming::ArmingInhibit;
use sophie_mavlink::inputs::Counts;
use sophie_mavlink::wire::signing::Refused;
use sophie_ports::signing::{Key, Record, Stored};

use super::Console;
use crate::links::mavlink_line::{LineState, SigningState};
use crate::storage::storing;
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    /// Prints the signing state and the count of refused frames.
    pub(super) async fn mavlink(&mut self) {
        let Some(LineState {
            signing,
            refused,
            inputs,
        }) = self.links.mavlink.fresh()
        else {
            return self.out.line(format_args!("the MAVLink task is silent")).await;
        };
        let signing = match signing {
            SigningState::Off => "off",
            SigningState::On => "on",
            SigningState::Unknown => "not known, nothing is obeyed: the storage is unreadable",
            SigningState::Lost => {
                "lost with unreadable storage, nothing is obeyed until 'mavlink key K' or 'mavlink key off'"
            }
        };
        self.out.line(format_args!("signing {signing}")).await;
        let Refused { unsigned, wrong, old } = refused;
        self.out
            .line(format_args!(
                "refused: {unsigned} unsigned, {wrong} with a wrong signature, {old} old or repeated"
            ))
            .await;
        let Counts {
            poses,
            views,
            targets,
            system,
            source,
            frame,
            value,
            late,
        } = inputs;
        self.out
            .line(format_args!(
                "inputs: {poses} poses, {views} of flow and range, {targets} of the pipe; refused {system} system, {source} source, {frame} frame, {value} value, {late} late"
            ))
            .await;
    }

    /// Stores the key `text` and restarts. The key is never displayed.
    pub(super) async fn mavlink_key(&mut self, text: &str) {
        if !self.keys.private() {
            return self
                .out
                .line(format_args!(
                    "not set: a key is typed at a cable, never over MAVLink"
                ))
                .await;
        }
        let key = match (text, Key::from_hex(text)) {
            ("off", _) => None,
            (_, Some(key)) => Some(key),
            (_, None) => {
                let digits = Key::DIGITS;
                return self
                    .out
                    .line(format_args!(
                        "not set: a key is {digits} hexadecimal digits, or off"
                    ))
                    .await;
            }
        };
        if self.changed() > 0 {
            // The restart would discard unsaved parameters.
            return self
                .out
                .line(format_args!(
                    "not set: 'save' or 'reset' what 'changes' shows first"
                ))
                .await;
        }
        if let Err(why) = storing::inhibit_arming(self.links).await {
            return self.refuse("not set", why).await;
        }
        let record = match key {
            Some(key) => Some(self.record(key).await),
            None => None,
        };
        match storing::save_signing(self.links, &mut self.storage, record).await {
            Ok(()) => {
                let what = if key.is_some() { "on" } else { "off" };
                self.out.last(format_args!("signing {what}; restarting")).await;
                // Arming stays refused: the stored key differs from the one in force.
                self.chip.restart();
            }
            Err(error) => {
                self.links.report(ArmingInhibit::Storing, false);
                self.out.line(format_args!("not set: {}", error.text())).await;
            }
        }
    }

    /// Record of `key` to store. A key that equals the stored one keeps its timestamp bound, against replay of frames
    /// signed earlier.
    async fn record(&mut self, key: Key) -> Record {
        let mut params = *self.storage.defaults();
        match self.storage.load(&mut params).await.signing {
            Stored::Key(record) if record.key == key => record,
            _ => Record::fresh(key),
        }
    }
}
