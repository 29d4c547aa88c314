//! A vehicle over MAVLink: commands with their acknowledgement, parameters, messages and restarts.
//!
//! A command is repeated until it is acknowledged; progress extends the wait. The vehicle is judged by numbers; its texts
//! are kept for the builder alone.

mod files;

use std::collections::{BTreeMap, VecDeque};
use std::io::ErrorKind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use mavlink_core::{MavlinkVersion, Message, MessageData};
use sophie_control::arming::ArmingInhibit;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_dialect::*;
use sophie_mavlink::wire::frame::{COMPONENT, Frame, SYSTEM};
use sophie_ports::signing::Key;
use sophie_tasks::perching::arms;

use crate::Failure;
use crate::port::{CONSOLE_BAUD, PortName};
use crate::station::{Heard, Line, STATION, STATION_COMPONENT};

/// Least time from the first attempt at a request to the second; each further one waits half as long again, which makes
/// six in ten seconds.
const ATTEMPT: Duration = Duration::from_millis(500);
/// Share of the patience that a slow board is given in each wait: it gets no order twice, and its parts are not silent
/// for being late.
const SHARE: u32 = 20;
/// Silence that ends a list of parameters, and a look at a line that says nothing.
const QUIET: Duration = Duration::from_secs(1);
/// Longest silence after a report of progress, one a second, before the acknowledgement counts as lost on its way.
const PROGRESS: Duration = Duration::from_secs(3);
/// Longest wait for the text behind a refusal.
const REASON: Duration = Duration::from_millis(500);
/// Vendor of a vehicle that this program knows.
const VENDOR: &str = "SOPHIE";
/// Longest restart of a board: erasing flash, self-tests, and an emulated board at half the speed.
const RESTART: Duration = Duration::from_secs(30);
/// Time between two attempts to reopen a lost port, and between two looks at a state that changes.
const AGAIN: Duration = Duration::from_millis(100);
/// Longest time to store parameters: erasing flash twice.
const STORED: Duration = Duration::from_secs(12);
/// Largest number of messages kept for the reader; the oldest go first.
const KEPT: usize = 4096;
/// Number of attempts at one parameter.
const TRIES: u32 = 4;
/// Largest step back of the board's time that two messages in another order make, ms.
const REORDERED_MS: u32 = 50;
/// The console's prompt, by which it is known where MAVLink was expected.
const PROMPT: &[u8] = b"\n> ";

/// Complaint about a vehicle that lacks the messages of the set-up.
const FOREIGN: &str = "this is no vehicle of this program's release: it does not know the set-up's messages";

/// Who a vehicle is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Name of the board.
    pub board: String,
    /// Version of the firmware.
    pub version: String,
    /// Revision of the chip; empty if the board knows none.
    pub chip: String,
    /// Identity of the image.
    pub image: u32,
    /// Identity of its table of parameters.
    pub table: u32,
}

/// The parameters that will be stored, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values(pub BTreeMap<String, f32>);

impl Values {
    /// Value of `name`.
    pub fn get(&self, name: &str) -> Option<f32> {
        self.0.get(name).copied()
    }

    /// The same as the flight stack has them; what this program does not know is left out.
    pub fn params(&self) -> Params {
        let mut params = Params::DEFAULT;
        for (name, value) in &self.0 {
            let _ = params.set(name, *value);
        }
        params
    }
}

/// Messages of the vehicle.
#[derive(Default)]
struct Inbox {
    messages: VecDeque<MavMessage>,
    /// The newest bytes as they came, while no message has come.
    bytes: Vec<u8>,
}

impl Heard for Inbox {
    fn hear(&mut self, frame: &Frame<'_>) {
        if let Ok(message) = MavMessage::parse(MavlinkVersion::V2, frame.id, frame.payload) {
            if self.messages.len() >= KEPT {
                self.messages.pop_front();
            }
            self.messages.push_back(message);
        }
    }

    fn came(&mut self, bytes: &[u8]) {
        if self.messages.is_empty() {
            self.bytes.extend(bytes);
            let old = self.bytes.len().saturating_sub(256);
            self.bytes.drain(..old);
        }
    }

    fn is_empty(&self) -> bool {
        self.messages.is_empty()
    }
}

/// A vehicle that has answered.
pub struct Vehicle {
    line: Option<Line<Inbox>>,
    name: PortName,
    key: Option<Key>,
    /// Longest silence while an answer is due.
    patience: Duration,
    /// Its mode by its newest heartbeat.
    mode: Option<u32>,
    /// Texts that were not taken yet.
    texts: Vec<String>,
    /// The board's time since its start by its newest message, ms, and the number of restarts seen in it.
    boot_ms: u32,
    boots: u32,
    /// Number of the newest request for a file.
    sequence: u16,
    /// Raised from outside, as by Ctrl-C. It is obeyed once, so that the caller can still tidy up.
    stop: Arc<AtomicBool>,
    heeds: bool,
}

impl Vehicle {
    /// Opens `port` and waits for a vehicle; `key` signs. `patience` is the longest silence while an answer is due. When
    /// `stop` is raised, the current wait ends once.
    ///
    /// # Errors
    /// One line: the port cannot be opened, or no vehicle answers there.
    pub fn open(
        port: &PortName,
        key: Option<Key>,
        patience: Duration,
        stop: Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        let mut vehicle = Self {
            line: None,
            name: port.clone(),
            key,
            patience,
            mode: None,
            texts: Vec::new(),
            boot_ms: 0,
            boots: 0,
            sequence: 0,
            stop,
            heeds: true,
        };
        vehicle.connect(port)?;
        if vehicle.heartbeat(patience)?.is_none() {
            return Err(Failure::Input(vehicle.unanswered()?));
        }
        Ok(vehicle)
    }

    fn connect(&mut self, port: &PortName) -> Result<(), Failure> {
        // Closed first: the system reuses the name of a port that went away only when no process has it open.
        self.line = None;
        let ends = port.open()?;
        let line = Line::open(ends, self.key, Inbox::default());
        self.line = Some(line.map_err(|error| Failure::Input(format!("{}: {error}", self.name)))?);
        self.boot_ms = 0;
        Ok(())
    }

    /// Why no vehicle has answered.
    fn unanswered(&mut self) -> Result<String, Failure> {
        let bytes = |vehicle: &Self| match &vehicle.line {
            Some(line) => line.station().heard.bytes.clone(),
            None => Vec::new(),
        };
        let mut came = bytes(self);
        if !has_prompt(&came) {
            if let PortName::Serial(path, _) = &self.name {
                self.connect(&PortName::Serial(path.clone(), CONSOLE_BAUD))?;
            }
            // A console is silent until something is typed.
            if let Some(line) = &self.line {
                let _ = line.station().send_raw(b"\r");
            }
            self.wait(QUIET, |_| None::<()>)?;
            came.extend(bytes(self));
        }
        let (port, time) = (&self.name, self.patience.as_secs_f32());
        Ok(if has_prompt(&came) {
            format!(
                "{port}: this is the text console, MAVLink is wanted: the board's USB socket, or its MAVLink port"
            )
        } else if came.is_empty() {
            format!("{port}: no vehicle answers within {time} s, nothing came; expected MAVLink")
        } else if self.key.is_some() {
            format!("{port}: no vehicle answers within {time} s that signs with this key")
        } else {
            format!("{port}: no vehicle answers within {time} s, what came is no MAVLink")
        })
    }

    /// Name of the port.
    pub fn port(&self) -> String {
        self.name.to_string()
    }

    /// Number of starts of the board that were noticed since the session began, unexpected ones among them.
    pub const fn starts(&self) -> u32 {
        self.boots
    }

    /// The board's time since its start by its newest message, ms.
    pub const fn up_ms(&self) -> u32 {
        self.boot_ms
    }

    /// From here on Ctrl-C is ignored: a begun operation must not be left half done.
    pub const fn see_it_through(&mut self) {
        self.heeds = false;
    }

    /// Texts that have come since the last call.
    pub fn texts(&mut self) -> Vec<String> {
        std::mem::take(&mut self.texts)
    }

    fn failed(&self, why: &str) -> Failure {
        Failure::Board(format!("{}: {why}", self.name))
    }

    /// Takes in all that has come so far: what came before a request is no answer to it, and no movement of now.
    ///
    /// # Errors
    /// The line is lost, or Ctrl-C.
    pub fn catch_up(&mut self) -> Result<(), Failure> {
        while self.next(false)?.is_some() {}
        Ok(())
    }

    /// The next message; `None` without one, after 20 ms if it `waits`.
    fn next(&mut self, waits: bool) -> Result<Option<MavMessage>, Failure> {
        if self.heeds && self.stop.load(Ordering::Relaxed) {
            self.heeds = false;
            return Err(Failure::Stopped(format!("{}: stopped by Ctrl-C", self.name)));
        }
        let Some(line) = &self.line else {
            return Err(self.failed("the line is lost"));
        };
        let mut station = if waits { line.wait() } else { line.station() };
        let message = station.heard.messages.pop_front();
        let ended = station.ended;
        drop(station);
        if let Some(ms) = message.as_ref().and_then(boot_ms) {
            if is_earlier(ms, self.boot_ms) {
                self.boots += 1;
            }
            self.boot_ms = ms;
        }
        match &message {
            None => {
                if let Some(error) = ended {
                    self.line = None;
                    return Err(self.failed(&match error {
                        ErrorKind::UnexpectedEof => "the line was closed".to_owned(),
                        other => format!("the line is lost: {other}"),
                    }));
                }
            }
            Some(MavMessage::HEARTBEAT(beat)) => self.mode = Some(beat.custom_mode),
            Some(MavMessage::STATUSTEXT(text)) => {
                self.texts.extend(text.text.to_str().ok().map(ToOwned::to_owned));
            }
            Some(_) => (),
        }
        Ok(message)
    }

    /// The first thing that `wanted` finds in the messages of `time`.
    ///
    /// # Errors
    /// The line is lost, or Ctrl-C.
    pub fn wait<T>(
        &mut self,
        time: Duration,
        mut wanted: impl FnMut(&MavMessage) -> Option<T>,
    ) -> Result<Option<T>, Failure> {
        let begun = Instant::now();
        loop {
            if let Some(found) = self.next(true)?.as_ref().and_then(&mut wanted) {
                return Ok(Some(found));
            }
            if begun.elapsed() >= time {
                return Ok(None);
            }
        }
    }

    fn heartbeat(&mut self, time: Duration) -> Result<Option<()>, Failure> {
        self.wait(time, |message| {
            matches!(message, MavMessage::HEARTBEAT(_)).then_some(())
        })
    }

    fn send<M: MessageData>(&mut self, message: &M) -> Result<(), Failure> {
        let Some(line) = &self.line else {
            return Err(self.failed("the line is lost"));
        };
        let sent = line.station().send(message);
        sent.map_err(|error| self.failed(&format!("the line is lost: {error}")))
    }

    /// Sends `message` until `wanted` finds its answer.
    fn asked<M: MessageData, T>(
        &mut self,
        what: &str,
        message: &M,
        mut wanted: impl FnMut(&MavMessage) -> Option<T>,
    ) -> Result<T, Failure> {
        self.catch_up()?;
        let begun = Instant::now();
        let mut attempt = self.attempt();
        loop {
            self.send(message)?;
            if let Some(found) = self.wait(attempt, &mut wanted)? {
                return Ok(found);
            }
            if begun.elapsed() >= self.patience {
                return Err(self.silent(what));
            }
            attempt += attempt / 2;
        }
    }

    /// Time from the first attempt at a request to the second.
    fn attempt(&self) -> Duration {
        self.silence(ATTEMPT).min(self.patience)
    }

    /// Silence of a message after which its source counts as missing: `least`, and more where the patience is long, as
    /// with an emulated board on a busy machine.
    pub fn silence(&self, least: Duration) -> Duration {
        least.max(self.patience / SHARE)
    }

    fn silent(&self, what: &str) -> Failure {
        let time = self.patience.as_secs_f32();
        self.failed(&format!("the vehicle fell silent for {time} s after {what}"))
    }

    /// Gives `command` and returns its result; `seen` looks at the messages meanwhile. A vehicle that is at work on it
    /// takes a repetition for the same command.
    ///
    /// # Errors
    /// The line is lost, the vehicle falls silent, or Ctrl-C.
    pub fn command_with(
        &mut self,
        command: MavCmd,
        params: &[f32],
        mut seen: impl FnMut(&MavMessage),
    ) -> Result<MavResult, Failure> {
        let number = command as u16;
        let mut values = [0.0; 7];
        values.iter_mut().zip(params).for_each(|(to, from)| *to = *from);
        let [param1, param2, param3, param4, param5, param6, param7] = values;
        let mut message = COMMAND_LONG_DATA {
            param1,
            param2,
            param3,
            param4,
            param5,
            param6,
            param7,
            command: number,
            target_system: SYSTEM,
            target_component: COMPONENT,
            confirmation: 0,
        };
        let name = format!("{command:?}");
        let what = name.trim_start_matches("MAV_CMD_").to_owned();
        self.catch_up()?;
        let mut up_ms = self.boot_ms;
        let mut answered = Instant::now();
        let mut attempt = self.attempt();
        loop {
            self.send(&message)?;
            let mut time = attempt;
            while let Some(result) = self.wait(time, |message| {
                seen(message);
                let was = up_ms;
                up_ms = boot_ms(message).unwrap_or(was);
                let restarted = is_earlier(up_ms, was);
                match acknowledged(message, number) {
                    None if restarted => Some(None),
                    None => None,
                    result => Some(result),
                }
            })? {
                match result {
                    // What was to be acknowledged is gone.
                    None => return Err(self.failed(&format!("the board has restarted after {what}"))),
                    Some(MavResult::MAV_RESULT_IN_PROGRESS) => (),
                    Some(result) => return Ok(result),
                }
                answered = Instant::now();
                time = PROGRESS.min(self.patience / 2);
            }
            if answered.elapsed() >= self.patience {
                return Err(self.silent(&what));
            }
            attempt += attempt / 2;
            message.confirmation = message.confirmation.saturating_add(1);
        }
    }

    /// Gives `command` and returns its result.
    ///
    /// # Errors
    /// As [`Self::command_with`].
    pub fn command(&mut self, command: MavCmd, params: &[f32]) -> Result<MavResult, Failure> {
        self.command_with(command, params, |_| ())
    }

    /// Asks for one message.
    fn request<T>(
        &mut self,
        id: u32,
        what: &str,
        mut wanted: impl FnMut(&MavMessage) -> Option<T>,
    ) -> Result<T, Failure> {
        let command = MavCmd::MAV_CMD_REQUEST_MESSAGE as u16;
        let message = COMMAND_LONG_DATA {
            param1: id as f32,
            command,
            target_system: SYSTEM,
            target_component: COMPONENT,
            ..COMMAND_LONG_DATA::DEFAULT
        };
        let answer = self.asked(what, &message, |message| {
            match (wanted(message), acknowledged(message, command)) {
                (Some(found), _) => Some(Some(found)),
                (None, None | Some(MavResult::MAV_RESULT_ACCEPTED)) => None,
                (None, Some(_)) => Some(None),
            }
        })?;
        answer.ok_or_else(|| Failure::Input(format!("{}: {FOREIGN}", self.name)))
    }

    /// Who it is.
    ///
    /// # Errors
    /// As [`Self::command`]; a vehicle that wants signed frames answers nothing.
    pub fn identity(&mut self) -> Result<Identity, Failure> {
        let text = |text: Result<&str, std::str::Utf8Error>| text.unwrap_or_default().to_owned();
        let id = COMPONENT_INFORMATION_BASIC_DATA::ID;
        let asked = self.request(id, "its identity was asked for", |message| match message {
            MavMessage::COMPONENT_INFORMATION_BASIC(basic) => Some((
                text(basic.vendor_name.to_str()),
                text(basic.model_name.to_str()),
                text(basic.software_version.to_str()),
                text(basic.hardware_version.to_str()),
            )),
            _ => None,
        });
        let (vendor, board, version, chip) = asked.map_err(|failure| match failure {
            Failure::Board(line) => {
                let key = match self.key {
                    None => "it may want signed frames: --mavlink-key FILE",
                    Some(_) => "is this its key?",
                };
                Failure::Input(format!("{line}; {key}"))
            }
            other => other,
        })?;
        if vendor != VENDOR {
            return Err(Failure::Input(format!("{}: {FOREIGN}", self.name)));
        }
        let bytes = self.request(
            AUTOPILOT_VERSION_DATA::ID,
            "its version was asked for",
            |message| match message {
                MavMessage::AUTOPILOT_VERSION(version) => Some(version.flight_custom_version),
                _ => None,
            },
        )?;
        let both = u64::from_be_bytes(bytes);
        Ok(Identity {
            board,
            version,
            chip,
            image: (both >> 32) as u32,
            table: both as u32,
        })
    }

    /// The arming checks that fail.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn arming(&mut self) -> Result<Vec<ArmingInhibit>, Failure> {
        let failing = self.request(
            SOPHIE_ARMING_DATA::ID,
            "its arming checks were asked for",
            |message| match message {
                MavMessage::SOPHIE_ARMING(arming) => Some(arming.failing),
                _ => None,
            },
        )?;
        Ok(inhibits(failing))
    }

    /// Sends the messages `ids` each `period_us` µs; 0 for their own period, -1 for never.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn stream(&mut self, ids: &[u32], period_us: f32) -> Result<(), Failure> {
        for id in ids {
            self.command(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, &[*id as f32, period_us])?;
        }
        Ok(())
    }

    /// Every parameter that will be stored. Values that are lost on the way are asked for one by one.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn values(&mut self) -> Result<Values, Failure> {
        let mut values = Values::default();
        let mut seen = Vec::new();
        self.catch_up()?;
        self.send(&PARAM_REQUEST_LIST_DATA {
            target_system: SYSTEM,
            target_component: COMPONENT,
        })?;
        let quiet = QUIET.max(self.attempt());
        while let Some((index, count, name, value)) = self.wait(quiet, param_value)? {
            seen.resize(usize::from(count).max(seen.len()), false);
            if let Some(seen) = seen.get_mut(usize::from(index)) {
                *seen = true;
            }
            values.0.insert(name, value);
            if seen.iter().all(|seen| *seen) {
                return Ok(values);
            }
        }
        // A list that was lost whole begins with its first parameter.
        if seen.is_empty() {
            seen.push(false);
        }
        let mut index = 0;
        while index < seen.len() {
            if !seen.get(index).copied().unwrap_or_default() {
                let (count, name, value) = self.value_at(index)?;
                seen.resize(usize::from(count).max(seen.len()), false);
                values.0.insert(name, value);
            }
            index += 1;
        }
        Ok(values)
    }

    fn value_at(&mut self, index: usize) -> Result<(u16, String, f32), Failure> {
        let message = PARAM_REQUEST_READ_DATA {
            param_index: i16::try_from(index).unwrap_or(i16::MAX),
            target_system: SYSTEM,
            target_component: COMPONENT,
            ..PARAM_REQUEST_READ_DATA::DEFAULT
        };
        self.asked("a parameter was asked for", &message, |message| {
            let (at, count, name, value) = param_value(message)?;
            (usize::from(at) == index).then_some((count, name, value))
        })
    }

    /// The value of `name` that will be stored.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn value(&mut self, name: &str) -> Result<f32, Failure> {
        let message = PARAM_REQUEST_READ_DATA {
            param_index: -1,
            param_id: id(name).into(),
            target_system: SYSTEM,
            target_component: COMPONENT,
        };
        self.asked("a parameter was asked for", &message, |message| {
            let (_, _, named, value) = param_value(message)?;
            (named == name).then_some(value)
        })
    }

    /// Sets `name` to `value`; returns the vehicle's value afterwards, which differs after a refusal.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn set(&mut self, name: &str, value: f32) -> Result<f32, Failure> {
        let message = PARAM_SET_DATA {
            param_value: value,
            target_system: SYSTEM,
            target_component: COMPONENT,
            param_id: id(name).into(),
            param_type: MavParamType::MAV_PARAM_TYPE_REAL32 as u8,
        };
        let mut tries = 1..TRIES;
        loop {
            let now = self.asked("a parameter was set", &message, |message| {
                let (_, _, named, value) = param_value(message)?;
                (named == name).then_some(value)
            })?;
            // A list under way may have sent the value before.
            if now.to_bits() == value.to_bits() || tries.next().is_none() {
                return Ok(now);
            }
        }
    }

    /// Longest start, from the restart to DISARMED.
    pub fn longest_start(&self) -> Duration {
        RESTART.max(self.patience)
    }

    /// Waits until the board reports DISARMED and its slowest sensors, those of the arms, have started.
    ///
    /// # Errors
    /// It does not within the longest start, or as [`Self::command`].
    pub fn ready(&mut self, mut waits: impl FnMut(&str)) -> Result<(), Failure> {
        self.catch_up()?;
        let begun = Instant::now();
        let mut said = false;
        loop {
            let mode = Mode::ALL.into_iter().find(|mode| self.mode == Some(*mode as u32));
            let started = u64::from(self.boot_ms) >= arms::START.as_millis();
            let name = match mode {
                Some(Mode::Disarmed) if started => return Ok(()),
                Some(Mode::Disarmed) => "the arms' sensors start",
                mode => mode.map_or("no mode", Mode::name),
            };
            if !said {
                said = true;
                waits(name);
            }
            if begun.elapsed() > self.longest_start() {
                return Err(self.failed(&format!("the board does not come to DISARMED: {name}")));
            }
            self.wait(AGAIN, |_| None::<()>)?;
        }
    }

    /// Stores the parameters, restarts the board, and waits until it answers again.
    ///
    /// # Errors
    /// The board refuses, or does not come back.
    pub fn store_and_restart(&mut self) -> Result<(), Failure> {
        // The board may have stored already: only its answer decides.
        let heeds = std::mem::replace(&mut self.heeds, false);
        let done = self.store().and_then(|()| self.restart());
        self.heeds = heeds;
        done
    }

    fn store(&mut self) -> Result<(), Failure> {
        let result = self.command(MavCmd::MAV_CMD_PREFLIGHT_STORAGE, &[1.0])?;
        if result != MavResult::MAV_RESULT_ACCEPTED {
            return Err(self.refused("not stored"));
        }
        let begun = Instant::now();
        loop {
            // Storing begins with the task's next run.
            self.wait(AGAIN, |_| None::<()>)?;
            let failing = self.arming()?;
            if !failing.contains(&ArmingInhibit::Storing) {
                let bad = [ArmingInhibit::StorageFull, ArmingInhibit::StorageUnreadable];
                return match failing.iter().find(|why| bad.contains(why)) {
                    Some(why) => Err(self.failed(&format!("not stored: {}", why.text()))),
                    None => Ok(()),
                };
            }
            if begun.elapsed() > STORED {
                return Err(self.failed("the board does not end storing"));
            }
        }
    }

    /// Restarts the board and waits until it answers again.
    ///
    /// # Errors
    /// The board refuses, or does not come back.
    fn restart(&mut self) -> Result<(), Failure> {
        self.restarting(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN)
    }

    /// Gives `command` with 1, which restarts the board, and waits until it answers again.
    ///
    /// # Errors
    /// The board refuses, or does not come back.
    pub fn restarting(&mut self, command: MavCmd) -> Result<(), Failure> {
        self.catch_up()?;
        let heeds = std::mem::replace(&mut self.heeds, false);
        let before = self.boots;
        let done = match self.command(command, &[1.0]) {
            Ok(MavResult::MAV_RESULT_ACCEPTED) => self.come_back(before),
            // The restart was faster than its acknowledgement, which it may have taken away with the port.
            _ if self.line.is_none() || self.boots > before => self.come_back(before),
            Ok(_) => Err(self.refused("not restarted")),
            Err(failure) => Err(failure),
        };
        self.heeds = heeds;
        done
    }

    /// The vehicle's newest text, which gives the reason of a refusal and follows its acknowledgement.
    ///
    /// # Errors
    /// The line is lost, or Ctrl-C.
    pub fn reason(&mut self) -> Result<String, Failure> {
        self.wait(REASON, |message| {
            matches!(message, MavMessage::STATUSTEXT(_)).then_some(())
        })?;
        let newest = self.texts().pop();
        Ok(newest.unwrap_or_else(|| "refused without a reason".to_owned()))
    }

    /// One line of a refusal, with the vehicle's reason.
    pub fn refused(&mut self, what: &str) -> Failure {
        match self.reason() {
            Ok(reason) => self.failed(&format!("{what}: {reason}")),
            Err(failure) => failure,
        }
    }

    /// Waits until the board has restarted more than `before` times. A port on USB disappears during the restart.
    fn come_back(&mut self, before: u32) -> Result<(), Failure> {
        let begun = Instant::now();
        let mut last = self.failed("the board does not restart");
        while begun.elapsed() < self.longest_start() {
            if self.line.is_none() {
                std::thread::sleep(AGAIN);
                match self.connect(&self.name.clone()) {
                    Ok(()) => self.boots += 1,
                    Err(failure) => {
                        last = failure;
                        continue;
                    }
                }
            }
            let restarted = self.boots > before;
            self.mode = None;
            match self.heartbeat(AGAIN) {
                Ok(Some(())) if restarted => return Ok(()),
                Ok(_) => (),
                Err(failure) => last = failure,
            }
        }
        Err(last)
    }

    /// Ends what runs at the board: a calibration, a turning motor, a servo away from its mark.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn calm(&mut self) -> Result<(), Failure> {
        self.command(MavCmd::MAV_CMD_SOPHIE_CALIBRATE, &[0.0])?;
        // Twice: while a motor test is not acknowledged yet, the first counts as its repetition.
        for _ in 0..2 {
            self.command(MavCmd::MAV_CMD_DO_MOTOR_TEST, &[1.0, 0.0, 0.0])?;
        }
        Ok(())
    }
}

/// A console's prompt is among the bytes; heartbeats that it echoes may follow.
fn has_prompt(bytes: &[u8]) -> bool {
    bytes.windows(PROMPT.len()).any(|part| part == PROMPT)
}

fn acknowledged(message: &MavMessage, command: u16) -> Option<MavResult> {
    let MavMessage::COMMAND_ACK(ack) = message else {
        return None;
    };
    let here = (ack.target_system, ack.target_component) == (STATION, STATION_COMPONENT);
    if ack.command != command || !here {
        return None;
    }
    [
        MavResult::MAV_RESULT_ACCEPTED,
        MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
        MavResult::MAV_RESULT_DENIED,
        MavResult::MAV_RESULT_UNSUPPORTED,
        MavResult::MAV_RESULT_FAILED,
        MavResult::MAV_RESULT_IN_PROGRESS,
        MavResult::MAV_RESULT_CANCELLED,
    ]
    .into_iter()
    .find(|result| *result as u8 == ack.result)
}

/// The board's time since its start, ms, in the messages that come all the time.
fn boot_ms(message: &MavMessage) -> Option<u32> {
    match message {
        MavMessage::ATTITUDE(attitude) => Some(attitude.time_boot_ms),
        MavMessage::SOPHIE_ARMS(arms) => Some(arms.time_boot_ms),
        MavMessage::RC_CHANNELS(channels) => Some(channels.time_boot_ms),
        MavMessage::SOPHIE_ARMING(arming) => Some(arming.time_boot_ms),
        _ => None,
    }
}

/// The board's time `ms` is that of a later start than `was`.
const fn is_earlier(ms: u32, was: u32) -> bool {
    ms.saturating_add(REORDERED_MS) < was
}

/// Index, count, name and value.
fn param_value(message: &MavMessage) -> Option<(u16, u16, String, f32)> {
    let MavMessage::PARAM_VALUE(value) = message else {
        return None;
    };
    let name = value.param_id.to_str().ok()?.to_owned();
    Some((value.param_index, value.param_count, name, value.param_value))
}

/// A parameter's name as the protocol has it.
fn id(name: &str) -> [u8; 16] {
    let mut bytes = [0; 16];
    bytes
        .iter_mut()
        .zip(name.bytes())
        .for_each(|(to, from)| *to = from);
    bytes
}

/// The arming checks of SOPHIE_ARMING's and SOPHIE_CHECK's bits.
pub fn inhibits(bits: u64) -> Vec<ArmingInhibit> {
    let all = ArmingInhibit::ALL.into_iter();
    all.filter(|inhibit| bits & (1 << (*inhibit as u8)) != 0)
        .collect()
}
