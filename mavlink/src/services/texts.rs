//! Texts for the operator: changes of mode and reason, warnings, and each arming check that begins to fail.

use core::fmt::Write;

use heapless::{Deque, String};
use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::mode::{Mode, Reason};

use crate::services::telemetry::text;
use crate::vehicle::{Condition, Vehicle};
use sophie_dialect::{MavSeverity, STATUSTEXT_DATA};

/// Longest text of one message.
pub const LONGEST: usize = 50;
/// Prefix of an arming check.
pub const ARMING: &str = "arming: ";
/// Largest number of waiting texts; further ones are dropped.
const WAITING: usize = 4;

/// A text and its severity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// Severity (MAV_SEVERITY).
    pub severity: u8,
    /// The words.
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

/// The texts that wait, and the state that the last ones reported.
#[derive(Clone, Debug, Default)]
pub struct Texts {
    waiting: Deque<Text, WAITING>,
    mode: Option<Mode>,
    reason: Option<Reason>,
    warning: &'static str,
    /// Reported defect of signing.
    signing: &'static str,
    /// Failing arming checks that were reported.
    named: ArmingInhibits,
}

impl Texts {
    /// Before the first text.
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

    /// Reports the whole state again, for a new station.
    pub fn repeat(&mut self) {
        *self = Self {
            waiting: core::mem::take(&mut self.waiting),
            ..Self::new()
        };
    }

    /// Reports every failing arming check again, after a refused arming.
    pub fn name_checks(&mut self) {
        self.named = ArmingInhibits::NONE;
    }

    /// Queues `words`, cut to [`LONGEST`].
    pub fn say(&mut self, severity: MavSeverity, words: core::fmt::Arguments<'_>) {
        let mut text = String::new();
        // The rest is left out.
        let _ = write!(Cut(&mut text), "{words}");
        let severity = severity as u8;
        let _ = self.waiting.push_back(Text { severity, text });
    }

    /// The next text, given the state of the vehicle and the defect of signing; `""` means no defect.
    pub fn next(&mut self, vehicle: &Vehicle, signing: &'static str) -> Option<Text> {
        if let Some(condition) = &vehicle.condition {
            self.observe(condition, signing);
        }
        self.waiting.pop_front()
    }

    fn observe(&mut self, condition: &Condition, signing: &'static str) {
        // One text at a time: the state may change before the next.
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

/// Writes up to the string's capacity.
struct Cut<'a>(&'a mut String<LONGEST>);

impl Write for Cut<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for letter in text.chars() {
            self.0.push(letter).map_err(|_| core::fmt::Error)?;
        }
        Ok(())
    }
}
