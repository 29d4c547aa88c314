//! What happened, in words: changes of mode and reason, warnings, and every arming check that begins to fail.

use core::fmt::Write;

use heapless::{Deque, String};
use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::mode::{Mode, Reason};

use crate::services::telemetry::text;
use crate::vehicle::{Condition, Vehicle};
use sophie_dialect::{MavSeverity, STATUSTEXT_DATA};

/// Longest text of one message.
pub const LONGEST: usize = 50;
/// Before an arming check.
pub const ARMING: &str = "arming: ";
/// Texts that wait at most; further ones are dropped.
const WAITING: usize = 4;

/// A text and how urgent it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// How urgent.
    pub severity: u8,
    /// What happened.
    pub text: String<LONGEST>,
}

impl Text {
    /// As a message.
    pub fn message(&self) -> STATUSTEXT_DATA {
        STATUSTEXT_DATA {
            severity: self.severity,
            text: text::<LONGEST>(&self.text).into(),
            id: 0,
            chunk_seq: 0,
        }
    }
}

/// What has been said and what is still to be said.
#[derive(Clone, Debug, Default)]
pub struct Texts {
    waiting: Deque<Text, WAITING>,
    mode: Option<Mode>,
    reason: Option<Reason>,
    warning: &'static str,
    /// What is wrong with signing.
    signing: &'static str,
    /// Arming checks that have been named since they began to fail.
    named: ArmingInhibits,
}

impl Texts {
    /// Before the first.
    pub const fn new() -> Self {
        Self {
            waiting: Deque::new(),
            mode: None,
            reason: None,
            warning: "",
            signing: "",
            named: ArmingInhibits::NONE,
        }
    }

    /// Says all that holds again: someone new listens.
    pub fn repeat(&mut self) {
        *self = Self {
            waiting: core::mem::take(&mut self.waiting),
            ..Self::new()
        };
    }

    /// Names every arming check that fails once more: someone was refused for them.
    pub fn name_checks(&mut self) {
        self.named = ArmingInhibits::NONE;
    }

    /// Says `words`, cut to what there is room for.
    pub fn say(&mut self, severity: MavSeverity, words: core::fmt::Arguments<'_>) {
        let mut text = String::new();
        // What does not fit is left out.
        let _ = write!(Cut(&mut text), "{words}");
        let severity = severity as u8;
        let _ = self.waiting.push_back(Text { severity, text });
    }

    /// The next text, given what the vehicle is like now and what is wrong with signing, if anything.
    pub fn next(&mut self, vehicle: &Vehicle, signing: &'static str) -> Option<Text> {
        if let Some(condition) = &vehicle.condition {
            self.observe(condition, signing);
        }
        self.waiting.pop_front()
    }

    fn observe(&mut self, condition: &Condition, signing: &'static str) {
        // One at a time, as they are sent.
        if !self.waiting.is_empty() {
            return;
        }
        let mode = condition.mode;
        if self.mode != Some(mode) {
            self.mode = Some(mode);
            let severity = match mode {
                Mode::Failsafe => MavSeverity::MAV_SEVERITY_CRITICAL,
                _ => MavSeverity::MAV_SEVERITY_NOTICE,
            };
            self.say(severity, format_args!("{}", mode.name()));
        } else if self.reason != condition.reason {
            self.reason = condition.reason;
            if let Some(reason) = condition.reason {
                self.say(
                    MavSeverity::MAV_SEVERITY_WARNING,
                    format_args!("{}", reason.text()),
                );
            }
        } else if self.warning != condition.warning {
            self.warning = condition.warning;
            if !condition.warning.is_empty() {
                self.say(
                    MavSeverity::MAV_SEVERITY_WARNING,
                    format_args!("{}", condition.warning),
                );
            }
        } else if self.signing != signing {
            self.signing = signing;
            if !signing.is_empty() {
                self.say(MavSeverity::MAV_SEVERITY_ERROR, format_args!("{signing}"));
            }
        } else if let Some(inhibit) = self.unnamed(condition.inhibits) {
            self.say(
                MavSeverity::MAV_SEVERITY_WARNING,
                format_args!("{ARMING}{}", inhibit.text()),
            );
        }
    }

    fn unnamed(&mut self, inhibits: ArmingInhibits) -> Option<ArmingInhibit> {
        self.named = self
            .named
            .iter()
            .filter(|&inhibit| inhibits.contains(inhibit))
            .collect();
        let inhibit = inhibits.iter().find(|&inhibit| !self.named.contains(inhibit))?;
        self.named = self.named.with(inhibit);
        Some(inhibit)
    }
}

/// Writes as much as there is room for.
struct Cut<'a>(&'a mut String<LONGEST>);

impl Write for Cut<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for letter in text.chars() {
            self.0.push(letter).map_err(|_| core::fmt::Error)?;
        }
        Ok(())
    }
}
