//! The context of every step: the builder, the session, and dialogues with both.

use std::collections::BTreeMap;
use std::time::Instant;

use sophie_board_link::Failure;
use sophie_board_link::parameters;
use sophie_board_link::session::{Session, Turn};

/// Questions and waiting texts of the console.
const READY: &str = "Enter when it is so, any other key ends: ";
const TURNED_EVENLY: &str = "did it turn, evenly, and beep no more? y or n: ";
const WHICH_ROTOR: &str = "which rotor turned, 1 to 4, or 0 for none? ";
const WHICH_WAY: &str = "from above, clockwise (c) or anticlockwise (a)? ";
const MARK: &str = " us\n";
const QUESTIONS: [&str; 5] = [READY, TURNED_EVENLY, WHICH_ROTOR, WHICH_WAY, MARK];

/// The builder's reply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// A line.
    Line(String),
    /// The input has ended.
    End,
}

/// The builder at the terminal.
pub trait User {
    /// Shows a line.
    fn say(&mut self, line: &str);
    /// Shows a line that the next such line replaces.
    fn live(&mut self, line: &str);
    /// Asks, and waits for the reply.
    fn ask(&mut self, question: &str) -> Reply;
    /// A reply that has been typed already; does not wait.
    fn answered(&mut self) -> Option<Reply>;
}

/// Reason for ending a step without a verdict.
#[derive(Debug)]
pub(super) enum Stop {
    /// The builder skips it.
    Skip,
    /// The builder stops here, or the input has ended.
    Quit,
    /// The line or the file is lost.
    Failed(Failure),
}

impl From<Failure> for Stop {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

/// The result of a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Verdict {
    pub passed: bool,
    pub figures: Vec<String>,
    /// The figures were shown already.
    pub shown: bool,
    /// Parameters that are stored and in force.
    pub parameters: BTreeMap<String, f64>,
}

impl Verdict {
    pub(super) fn of(passed: bool, figures: Vec<String>) -> Self {
        Self {
            passed,
            figures,
            ..Self::default()
        }
    }
}

/// The context of a run.
pub(super) struct Walk<'a> {
    pub session: &'a mut Session,
    pub user: &'a mut dyn User,
    /// Count of the board's restarts when the builder last confirmed that the propellers are off.
    off_since: Option<u32>,
    /// Weight of the last pressure sensor, N.
    pub weight: String,
}

impl<'a> Walk<'a> {
    pub(super) fn new(session: &'a mut Session, user: &'a mut dyn User) -> Self {
        Self {
            session,
            user,
            off_since: None,
            weight: "1.3".to_owned(),
        }
    }

    pub(super) fn say(&mut self, line: &str) {
        self.user.say(line);
    }

    /// The builder's reply; `s` skips the step, `q` and the end of input stop.
    pub(super) fn ask(&mut self, question: &str) -> Result<String, Stop> {
        let reply = self.user.ask(&format!("  {question} "));
        understood(reply)
    }

    /// Waits until the vehicle is disarmed and calibrated; returns the lines of `status`.
    pub(super) fn ready(&mut self) -> Result<Vec<String>, Stop> {
        let begun = Instant::now();
        let mut said = false;
        loop {
            let status = self.session.command("status")?;
            let mode = status.first().map_or("nothing", String::as_str);
            if mode.starts_with("DISARMED") {
                return Ok(status);
            }
            if !said {
                said = true;
                self.user.say(&format!("  waiting: {mode}"));
            }
            if begun.elapsed() > self.session.longest_start() {
                let port = self.session.port();
                let mode = mode.to_owned();
                return Err(Stop::Failed(Failure::Board(format!(
                    "{port}: the board does not come to DISARMED: {mode}"
                ))));
            }
            std::thread::sleep(std::time::Duration::from_millis(200));
        }
    }

    /// Confirms to the console that the propellers are off, once for each start of the board; the console's complaint
    /// if it refuses.
    pub(super) fn propellers_off(&mut self) -> Result<Option<String>, Stop> {
        if self.off_since == Some(self.session.restarts()) {
            return Ok(None);
        }
        while self.ask("Type off once all four propellers are off:")? != "off" {}
        let said = self.session.command("propellers off")?;
        if said.iter().any(|line| line.contains("motors may be tried")) {
            self.off_since = Some(self.session.restarts());
            return Ok(None);
        }
        Ok(Some(said.join("; ")))
    }

    /// Types `command` and answers its questions with the builder's replies; returns all output.
    pub(super) fn dialogue(&mut self, command: &str) -> Result<Vec<String>, Stop> {
        self.session.begin(command)?;
        let mut all = Vec::new();
        loop {
            let Turn { lines, question } = self.session.turn(command, &QUESTIONS)?;
            for line in &lines {
                self.user.say(&format!("  | {line}"));
            }
            all.extend(lines);
            let Some(question) = question else {
                return Ok(all);
            };
            if let Err(stop) = self.answer(question) {
                // The console must not be left in the middle of it.
                if !matches!(stop, Stop::Failed(_)) {
                    self.session.cancel()?;
                }
                return Err(stop);
            }
        }
    }

    /// The builder's answer to `question`, pressed at the console.
    fn answer(&mut self, question: &str) -> Result<(), Stop> {
        let keys = match question {
            READY => {
                self.ask("Enter when it is so, s skips, q stops:")?;
                "\r".to_owned()
            }
            MARK => return self.mark(),
            TURNED_EVENLY => self.one_of("Did it turn, evenly, and beep no more? y or n:", "yn")?,
            WHICH_ROTOR => self.one_of("Which rotor turned, 1 to 4, 0 for none, r once more?", "01234r")?,
            _ => self.one_of(
                "From above, clockwise (c) or anticlockwise (a), r once more?",
                "car",
            )?,
        };
        self.press(&keys)
    }

    /// A reply that is one of `keys`.
    fn one_of(&mut self, question: &str, keys: &str) -> Result<String, Stop> {
        loop {
            let reply = self.ask(question)?;
            if reply.len() == 1 && keys.contains(&reply) {
                return Ok(reply);
            }
        }
    }

    /// Moves a servo by the builder's `+`, `-`, `+12` until Enter takes its mark.
    fn mark(&mut self) -> Result<(), Stop> {
        loop {
            let reply = self.ask("+ or - moves it by 10 us (+9: nine times), Enter takes it:")?;
            if reply.is_empty() {
                return self.press("\r");
            }
            let Some(keys) = moves(&reply) else {
                continue;
            };
            for key in keys.bytes() {
                if !self.session.press(key)? {
                    return Ok(());
                }
                let Turn { lines, question } = self.session.turn("a move of the servo", &QUESTIONS)?;
                if let Some(line) = lines.last() {
                    self.user.live(&format!("  | {line}"));
                }
                if question.is_none() {
                    // The command has ended; the next turn finds the prompt.
                    return Ok(self.session.press(b'\r').map(|_| ())?);
                }
            }
        }
    }

    /// Presses the keys, unless the command has ended meanwhile.
    fn press(&mut self, keys: &str) -> Result<(), Stop> {
        for key in keys.bytes() {
            if !self.session.press(key)? {
                self.user.say("  the console has waited too long for the answer");
            }
        }
        Ok(())
    }

    /// Stores the parameters that are set and not saved; returns those of `said`, in force after the restart.
    pub(super) fn keep(&mut self, said: &[String]) -> Result<BTreeMap<String, f64>, Stop> {
        let set: BTreeMap<String, f64> = said.iter().filter_map(|line| changed(line)).collect();
        if parameters::unsaved(self.session)?.is_empty() {
            return Ok(set);
        }
        self.user
            .say("  saving; the board restarts: leave the vehicle at rest");
        parameters::save(self.session)?;
        self.ready()?;
        let rows = parameters::listed(self.session)?;
        for (name, value) in &set {
            let now = rows.iter().find(|listed| listed.name == *name);
            let now = now.map_or("nothing", |listed| &listed.value);
            if now.parse() != Ok(*value) {
                let port = self.session.port();
                return Err(Stop::Failed(Failure::Board(format!(
                    "{port}: read back after the restart: {name} is {now}, saved was {value}"
                ))));
            }
        }
        Ok(set)
    }
}

/// The text of a reply.
///
/// # Errors
/// A reply that ends the step.
pub(super) fn understood(reply: Reply) -> Result<String, Stop> {
    match reply {
        Reply::End => Err(Stop::Quit),
        Reply::Line(line) => match line.trim() {
            "q" => Err(Stop::Quit),
            "s" => Err(Stop::Skip),
            other => Ok(other.to_owned()),
        },
    }
}

/// Name and new value of `arm_zero_1 0 -> 0.04 rad, in force after save`.
fn changed(line: &str) -> Option<(String, f64)> {
    let (change, force) = line.rsplit_once(", ")?;
    if !matches!(force, "in force after save" | "as in force") {
        return None;
    }
    let (old, new) = change.split_once(" -> ")?;
    let name = old.split(' ').next()?;
    Some((name.to_owned(), new.split(' ').next()?.parse().ok()?))
}

/// `+++`, `--`, `+12` as single keys; most is what moves a servo over its whole range.
fn moves(reply: &str) -> Option<String> {
    const MOST: usize = 200;
    let sign = reply.chars().next().filter(|sign| matches!(sign, '+' | '-'))?;
    let count = match reply.get(1..)?.parse() {
        Ok(count) => count,
        Err(_) if reply.chars().all(|c| c == sign) => reply.len(),
        Err(_) => return None,
    };
    (count <= MOST).then(|| sign.to_string().repeat(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_read_from_its_line() {
        let value = |line: &str| changed(line).map(|(name, value)| format!("{name} {value}"));
        for (line, wanted) in [
            (
                "accel_bias_x 0 -> -0.11 m/s2, in force after save",
                Some("accel_bias_x -0.11"),
            ),
            (
                "arm_sign_1 1 along -> -1 reversed, as in force",
                Some("arm_sign_1 -1"),
            ),
            ("infill 6.9 -> 8 %", None),
            ("ended: nothing is changed", None),
        ] {
            assert_eq!(value(line).as_deref(), wanted, "{line}");
        }
    }

    #[test]
    fn moves_of_a_servo_are_counted() {
        for (reply, keys) in [
            ("+", Some("+")),
            ("---", Some("---")),
            ("+4", Some("++++")),
            ("-12", Some("------------")),
        ] {
            assert_eq!(moves(reply).as_deref(), keys, "{reply}");
        }
        for reply in ["", "x", "+-", "+x", "5", "+1000", "+ 1"] {
            assert!(moves(reply).is_none(), "{reply}");
        }
    }
}
