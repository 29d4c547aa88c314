//! Commands and their acknowledgements.

pub(crate) mod calibration;
mod intervals;
mod obeyed;
pub(crate) mod orders;
pub mod report;
mod restart;

pub use self::obeyed::{OBEYED, Obeyed, When};
use super::answer::Answer;
use crate::services::Services;
use crate::vehicle::Vehicle;
use crate::wire::requests::{Command, Peer};
use sophie_control::calibration::procedure::Procedure;
use sophie_dialect::*;

/// A received command, with its sender and the state of the vehicle.
#[derive(Clone, Copy)]
pub(crate) struct Received<'a> {
    pub(crate) command: &'a Command,
    pub(crate) from: Peer,
    /// Time of receipt, µs.
    pub(crate) now: u64,
    pub(crate) vehicle: &'a Vehicle,
}

/// The answer to a command.
pub(crate) struct Reply {
    pub(crate) result: MavResult,
    /// The requested message, sent behind the acknowledgement: clients wait for that first.
    pub(crate) then: Option<Answer>,
}

impl From<MavResult> for Reply {
    fn from(result: MavResult) -> Self {
        Self { result, then: None }
    }
}

impl From<Answer> for Reply {
    fn from(answer: Answer) -> Self {
        Self {
            result: MavResult::MAV_RESULT_ACCEPTED,
            then: Some(answer),
        }
    }
}

impl Services {
    /// Obeys a command; `None` if the acknowledgement comes later.
    pub(crate) fn command(&mut self, received: &Received<'_>, procedure: &mut Procedure) -> Option<Reply> {
        let Received {
            command,
            now,
            vehicle,
            ..
        } = *received;
        let [first, second, ..] = command.params;
        let reply: Reply = match u32::from(command.number) {
            n if n == MavCmd::MAV_CMD_REQUEST_MESSAGE as u32 => self.once(first, second),
            n if n == MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL as u32 => {
                self.set_interval(first, second, now).into()
            }
            n if n == MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL as u32 => self.get_interval(first),
            n if n == MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN as u32 => {
                self.reboot(first, now, vehicle).into()
            }
            n if n == MavCmd::MAV_CMD_PREFLIGHT_STORAGE as u32 => self.storage(first, vehicle).into(),
            n if n == MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION as u32 => {
                return self.guide_calibration(received, procedure).map(Reply::from);
            }
            n if n == MavCmd::MAV_CMD_SOPHIE_REPORT as u32 => {
                return self.report(received).map(Reply::from);
            }
            n if n == MavCmd::MAV_CMD_SOPHIE_SET_BROWN_OUT as u32 => {
                return self.brown_out(received).map(Reply::from);
            }
            n if n == MavCmd::MAV_CMD_SOPHIE_CALIBRATE as u32 => {
                return self.calibrate(received, procedure).map(Reply::from);
            }
            _ => {
                return self.order_by(received, procedure).map(Reply::from);
            }
        };
        Some(reply)
    }

    fn refuse_armed(&mut self) -> MavResult {
        self.refuse("disarm first")
    }

    /// Rejects a command for now; a text gives the reason.
    fn refuse(&mut self, why: &str) -> MavResult {
        self.texts
            .say(MavSeverity::MAV_SEVERITY_WARNING, format_args!("refused: {why}"));
        MavResult::MAV_RESULT_TEMPORARILY_REJECTED
    }

    /// Rejects a command that this vehicle does not have.
    fn unsupported(&mut self, why: &str) -> MavResult {
        self.refuse(why);
        MavResult::MAV_RESULT_UNSUPPORTED
    }

    /// Rejects a command with wrong parameters.
    fn deny(&mut self, why: &str) -> MavResult {
        self.refuse(why);
        MavResult::MAV_RESULT_DENIED
    }
}

/// A command's field as a whole, non-negative number.
fn whole(value: f32) -> Option<u32> {
    let number = value as u32;
    // Beyond 2^24 a float has no room for every whole number: message numbers and µs of minutes stay below. From 2^32 on the
    // conversion gives its largest, whatever the value.
    let fits = (0.0..4_294_967_296.0).contains(&value);
    (fits && (number as f32 - value).abs() <= 0.0).then_some(number)
}

/// An optional field: NaN means "not given" in the standard, and stands for 0. [`request`] also makes a NaN of the
/// other spelling, `INT32_MAX` in a whole field.
///
/// [`request`]: crate::wire::requests::request
const fn or_zero(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value }
}
