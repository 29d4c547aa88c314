//! The emulated board, advanced by a millisecond at a time. This room alone knows the emulator library.
//!
//! The emulator's core runs in a thread of its own and stops each millisecond until it gets the next [`Wires`]. The two
//! threads take turns, so a run is deterministic.

pub mod conformance;
mod outputs;
pub mod rig;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use rigless::emulator::{self, AccessKind, Driver, Host, Settled, Start, Stop};
use rigless::image::Image;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::{NO_DEADLINE, VirtualNanos};
use sophie_control::allocation::wrench::PerArm;
use sophie_control::params::{ArmBusSpeed, FlowPort, Params};
use sophie_sim::plant::esc::EscSpec;

use self::outputs::Outputs;
use crate::board_kind::Kind;
use crate::boards::f405::{self, F405};
use crate::boards::h743::{self, H743};
use crate::boards::wired::Wired;
use crate::chain::Counted;
use crate::chips::icm42688p::Sample;
use crate::chips::line::Line;
use crate::elf::Firmware;
use crate::esc::{self, Esc};
use crate::processor::chip::{Chip, Clock, Options};
use crate::processor::count::{Counter, Marks};
use crate::processor::pads::Pads;
use crate::processor::rtt::Rtt;
use crate::processor::serial;
use crate::stored;
use crate::wires::{BoardFault, Digest, FarEnd, Gap, Hung, Latency, Pins, Reads, Run, Wires};

const MS: u64 = 1_000_000;
/// Port registers of both processors (RM0433 table 8, RM0090 table 1).
const PORTS: [std::ops::Range<u64>; 2] = [0x5802_0000..0x5802_2C00, 0x4002_0000..0x4002_2C00];
/// All pins must be configured by then, ns: the arms' buses wait for their chips.
const START_UP: u64 = 1000 * MS;
/// Longer latencies from data-ready to motor frame are lost samples, ns.
const SAMPLE: u64 = 250_000;

/// Corrupted flash holds each word's address, xored.
const NOISE: u64 = 0x5A5A_5A5A;

/// Bytes of the task header in embassy-executor 0.10; its states "spawned" and "queued to run".
const HEADER: u64 = 64;
const SPAWNED: u64 = 1;
const QUEUED: u64 = 1 << 8;

/// Overflows the stack: `push {r0-r7, lr}`, repeated.
const RECURSION: u64 = 0xE7FD_B5FF;
/// Locks the processor up: `cpsid f` (priority of a hard fault) and `udf`.
const LOCK_UP: u64 = 0xDE00_B671;
/// Distance from the end of RAM, bytes: no image has statics there.
const SPARE: u64 = 0x1000;

/// Emulation settings.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Instructions per core cycle.
    pub speed: f64,
    /// Stored parameters.
    pub params: Params,
    /// Motor controllers as built.
    pub esc: EscSpec,
}

/// An emulated board.
pub struct Emulator {
    wires: Option<SyncSender<Wires>>,
    pins: Receiver<Pins>,
    thread: Option<JoinHandle<Result<Run, String>>>,
}

impl Emulator {
    /// The board with `firmware`, powered, before its first instruction.
    ///
    /// # Errors
    /// One line: why the emulator refuses.
    pub fn power_on(firmware: &Firmware, settings: Settings) -> Result<Self, String> {
        let image = Image::new(&firmware.path, firmware.bytes.clone(), None)
            .map_err(|e| format!("{}: {e}", firmware.path.display()))?;
        let kind = firmware.board.kind;
        let (first, end) = firmware.params;
        let stored = stored::sectors(kind, (end - first) as usize, &settings.params)?;
        let stored =
            Image::new(Path::new("parameters"), stored, Some(first)).map_err(|e| format!("emulator: {e}"))?;
        let mut images = vec![image, stored];
        if let Some(loader) = firmware.loader.clone() {
            let loader = Image::new(Path::new("loader"), loader.bytes, Some(loader.at));
            images.push(loader.map_err(|e| format!("emulator: {e}"))?);
        }
        let line = esc::Line::of(settings.params.motor_protocol, settings.esc);
        let receiver = serial::Setup::of(settings.params.rc_protocol, kind);
        let (wires, wires_in) = sync_channel(1);
        let (pins_out, pins) = sync_channel(1);
        let driver = World {
            wires: wires_in,
            pins: pins_out,
            ms: 0,
            rtt: Rtt::new(firmware.rtt),
            params: firmware.params,
            receiver,
            flow_module: settings.params.flow_port == FlowPort::Msp,
            arm_buses: settings.params.arm_bus_khz,
            erases: BTreeMap::new(),
            cached: 0,
            tasks: firmware.tasks.clone(),
            flash: firmware.board.flash,
            spare: firmware.board.ram.last().map_or(0, |(_, end)| end - SPARE),
            impossible: Vec::new(),
            dark: false,
            escs: std::array::from_fn(|_| Esc::new(line)),
            servos: [0.0; 4],
            resets: 0,
            high: [false; 4],
            still: None,
            hung: None,
            latency: Latency::default(),
            digest: Digest::default(),
            pulses: Vec::new(),
            outputs: Outputs::default(),
            counter: Counter::new(firmware, marks(kind))?,
        };
        let thread = std::thread::Builder::new()
            .name("emulator".to_owned())
            .spawn(move || match kind {
                Kind::MatekH743 => run(H743::new()?, &h743::MATEK, settings.speed, &images, driver),
                Kind::F405 => run(F405::new()?, &f405::PADS, settings.speed, &images, driver),
            })
            .map_err(|e| format!("emulator: {e}"))?;
        let mut emulator = Self {
            wires: Some(wires),
            pins,
            thread: Some(thread),
        };
        emulator.wait()?;
        Ok(emulator)
    }

    /// Runs a millisecond.
    ///
    /// # Errors
    /// One line: why the processor stopped.
    pub fn advance(&mut self, wires: Wires) -> Result<Pins, String> {
        if let Some(sender) = &self.wires {
            let _ = sender.send(wires);
        }
        self.wait()
    }

    /// Ends the run.
    ///
    /// # Errors
    /// One line: why the emulator failed.
    pub fn finish(&mut self) -> Result<Run, String> {
        self.wires = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(run)) => run,
            Some(Err(_)) => Err("emulator: it panicked".to_owned()),
            None => Err("emulator: the run has ended already".to_owned()),
        }
    }

    fn wait(&mut self) -> Result<Pins, String> {
        match self.pins.recv() {
            Ok(pins) => Ok(pins),
            Err(_) => Err(match self.finish() {
                Ok(_) => "emulator: the run ended early".to_owned(),
                Err(why) => why,
            }),
        }
    }
}

const fn marks(kind: Kind) -> Marks {
    match kind {
        Kind::MatekH743 => h743::MARKS,
        Kind::F405 => f405::MARKS,
    }
}

fn run<C: Chip>(
    chip: C,
    pads: &'static Pads,
    speed: f64,
    images: &[Image],
    driver: World,
) -> Result<Run, String> {
    let failed = |e: &dyn std::fmt::Display| format!("emulator: {e}");
    let board = Wired::new(chip, pads, speed)?;
    let mut session = Session::new(Box::new(board), 0, NO_DEADLINE).map_err(|e| failed(&e))?;
    session.run_until(VirtualNanos(1));
    let mut finished = emulator::run(session, &Start::new(images), driver).map_err(|e| failed(&e))?;
    let (at, instructions) = finished
        .stop
        .map_or((VirtualNanos(0), 0), |s| (s.at, s.instruction_count));
    let mut gaps = gaps(&finished.session);
    let started = finished.session.resets().last().map_or(0, |reset| reset.at.0);
    let miswired = if at.0 - started.min(at.0) > START_UP {
        let World {
            receiver,
            flow_module,
            arm_buses,
            ..
        } = finished.driver;
        finished
            .session
            .board_mut()
            .miswired(at, receiver, flow_module, arm_buses)
    } else {
        Vec::new()
    };
    gaps.extend(miswired.into_iter().map(|(at, what)| Gap {
        kind: "miswired",
        at,
        what,
    }));
    let board = finished.session.board_mut();
    let reads = Reads {
        barometer: board
            .barometer()
            .map_or(Vec::new(), |part| std::mem::take(&mut part.read_at)),
        arms: std::array::from_fn(|arm| {
            board
                .arm(arm)
                .map_or(Vec::new(), |part| std::mem::take(&mut part.read_at))
        }),
        written: std::array::from_fn(|arm| {
            board
                .arm(arm)
                .map_or(BTreeMap::new(), |part| std::mem::take(&mut part.written))
        }),
    };
    let world = finished.driver;
    gaps.extend(world.impossible.iter().map(|fault| Gap {
        kind: "refused",
        at: "fault".to_owned(),
        what: format!("this part cannot have {fault:?}"),
    }));
    if world.cached > 0 {
        gaps.push(Gap {
            kind: "told",
            at: "FLASH".to_owned(),
            what: format!("{} writes and erases begun with the data cache on", world.cached),
        });
    }
    Ok(Run {
        gaps,
        instructions,
        escs: world.escs.map(|esc| esc.stats),
        latency_us: world.latency,
        hung: world.hung,
        erases: world.erases,
        outputs: world.outputs.found,
        servos: world.servos,
        pins_digest: world.digest.0,
        reads,
        counted: world.counter.map_or_else(Counted::default, Counter::finish),
    })
}

fn gaps<C: Chip>(session: &Session<Wired<C>>) -> Vec<Gap> {
    let mut gaps = Vec::new();
    let mut add = |kind, at: String, what: String| gaps.push(Gap { kind, at, what });
    for entry in session.unmapped() {
        add(
            "unmapped",
            format!("{:#010x}", entry.address),
            format!("first from {:#010x}", entry.program_counter),
        );
    }
    for (address, fault) in session.refused() {
        add("refused", format!("{address:#010x}"), format!("{fault:?}"));
    }
    for entry in session.unimplemented().values() {
        add(
            "unimplemented",
            format!("{}.{}", entry.instance, entry.register),
            format!(
                "{} reads, {} writes, first from {:#010x}",
                entry.reads, entry.writes, entry.program_counter
            ),
        );
    }
    for (address, entry) in session.undefined() {
        add(
            "undefined",
            format!("{} {address:#010x}", entry.instance),
            format!(
                "{} reads, {} writes, first from {:#010x}",
                entry.reads, entry.writes, entry.program_counter
            ),
        );
    }
    for (instance, request) in session.unrouted() {
        add("unrouted", format!("{instance} request {request}"), String::new());
    }
    for entry in session.told() {
        add(
            "told",
            format!("{}.{}", entry.instance, entry.register),
            entry.reason.to_owned(),
        );
    }
    gaps
}

struct World {
    wires: Receiver<Wires>,
    pins: SyncSender<Pins>,
    ms: u64,
    rtt: Rtt,
    /// Parameter flash: first address and end.
    params: (u64, u64),
    /// Required set-up of the receiver's port.
    receiver: serial::Setup,
    /// A flow and range module is wired.
    flow_module: bool,
    /// Required speed of the arms' buses.
    arm_buses: ArmBusSpeed,
    erases: BTreeMap<u64, u32>,
    cached: u32,
    tasks: BTreeMap<String, u64>,
    /// Flash: first address and end.
    flash: (u64, u64),
    spare: u64,
    /// Faults that the part cannot have.
    impossible: Vec<BoardFault>,
    dark: bool,
    escs: PerArm<Esc>,
    servos: PerArm<f64>,
    resets: usize,
    high: PerArm<bool>,
    /// Start of a standstill, ns.
    still: Option<u64>,
    hung: Option<Hung>,
    latency: Latency,
    digest: Digest,
    /// Recent data-ready, ns.
    pulses: Vec<u64>,
    outputs: Outputs,
    counter: Option<Counter>,
}

impl World {
    fn read<C: Chip>(
        &mut self,
        session: &mut Session<Wired<C>>,
        now: VirtualNanos,
        host: &mut dyn Host,
    ) -> Pins {
        let resets = session.resets();
        let new = resets.get(self.resets..).unwrap_or_default();
        let resets: Vec<_> = new.iter().map(|r| (r.at.0, format!("{:?}", r.cause))).collect();
        self.resets += resets.len();
        if !resets.is_empty() && !self.dark {
            host.hold(false);
        }

        let board = session.board_mut();
        if let Some(imu) = board.imu() {
            self.pulses.append(&mut imu.pulsed);
        }
        self.motors(board, now, resets.first().map_or(u64::MAX, |(at, _)| *at));
        let servos = board
            .servo_pulses(now)
            .map(|pulse| pulse.map_or(0.0, |(width, _)| width as f64 * 1e-3));
        if servos != self.servos {
            self.servos = servos;
            servos.iter().for_each(|us| self.digest.word(us.to_bits()));
        }
        let telemetry = heard(board.receiver());
        let console = far_end(board.console());
        let mavlink = far_end(board.mavlink());
        telemetry.iter().for_each(|byte| self.digest.byte(*byte));
        Pins {
            ms: self.ms,
            motors: self.escs.each_ref().map(|esc| esc.command(now.0)),
            servos,
            telemetry,
            console,
            mavlink,
            log: self.rtt.drain(host),
            signals: board.signals(now),
            resets,
        }
    }

    /// Takes edges until `now`; `reset`: time of a reset within this millisecond.
    fn motors<C: Chip>(&mut self, board: &mut Wired<C>, now: VirtualNanos, reset: u64) {
        let driven = board.motors_driven(now);
        for edge in board.motor_edges() {
            self.digest
                .word(edge.at << 3 | (edge.channel as u64) << 1 | u64::from(edge.high));
            if edge.at >= reset {
                self.started();
            }
            if !driven[edge.channel] {
                continue;
            }
            self.high[edge.channel] = edge.high;
            if let (Some(since), Some(hung)) = (self.still, &mut self.hung) {
                hung.high = self.high;
                if edge.high {
                    hung.last_rise_us = edge.at.saturating_sub(since) as f64 * 1e-3;
                }
            }
            let Some(began) = self.escs[edge.channel].edge(edge.at, edge.high) else {
                continue;
            };
            // A stopped motor's frames follow no sample.
            let ready = self.pulses.iter().rev().find(|at| **at <= began);
            if edge.channel == 0
                && self.escs[0].command(edge.at) > 0.0
                && let Some(age) = ready.map(|at| began - at)
                && age < SAMPLE
            {
                self.latency.add(age as f64 * 1e-3);
            }
        }
        self.pulses.retain(|at| at + MS > now.0);
        if reset <= now.0 {
            self.started();
        }
    }

    fn started(&mut self) {
        self.still = None;
        self.high = [false; 4];
    }

    fn inflict<C: Chip>(
        &mut self,
        fault: BoardFault,
        session: &mut Session<Wired<C>>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> bool {
        let board = session.board_mut();
        match fault {
            BoardFault::ImuUnplugged(out) => board.silence_imu(out),
            BoardFault::DataReadyCut(cut) => board.cut_data_ready(cut),
            BoardFault::ImuWord(mask) => board.flip_imu_word(u64::from(mask)),
            BoardFault::PadDivider(sensor, divider) => board.divide(sensor, divider),
            BoardFault::ArmUnplugged(arm, out) => board.silence_arm(arm, out),
            BoardFault::ArmRefusesReset(arm, refuses) => {
                if let Some(part) = board.arm(arm) {
                    part.refuses_reset = refuses;
                }
            }
            BoardFault::ArmRefuses(arm, register) => {
                if let Some(part) = board.arm(arm) {
                    part.refuses = Some(register);
                }
            }
            BoardFault::ClockHeld(bus, us) => return board.hold_clock(bus, us),
            BoardFault::BusErrors(bus, every) => return board.err_on_bus(bus, every),
            BoardFault::Supply(false) => {
                board.brown_out();
                session.reset_by_pin(stop.at, stop.instruction_count, host);
                self.dark = true;
                host.hold(true);
            }
            BoardFault::Supply(true) => {
                self.dark = false;
                host.hold(false);
            }
            BoardFault::TaskHung(name) => return self.hang(name, host),
            BoardFault::StackOverflow(name) => return self.replace(name, RECURSION, host),
            BoardFault::LockUp(name) => return self.replace(name, LOCK_UP, host),
            BoardFault::CorruptParameters => {
                let (first, end) = self.params;
                let mut words = (first..end).step_by(4);
                return words.all(|at| host.program(at, Width::W32, at ^ NOISE).is_ok());
            }
            BoardFault::ForeignParameters => {
                let (first, _) = self.params;
                let mut words = board.foreign().iter().zip((first..).step_by(4));
                return words.all(|(word, at)| host.program(at, Width::W32, *word).is_ok());
            }
            BoardFault::FactoryOptions => board.chip.set_options(Options::Factory),
            BoardFault::FirstRevision => board.chip.age(),
            BoardFault::NoCrystal => board.chip.stop_clock(Clock::Crystal),
            BoardFault::NoPll => board.chip.stop_clock(Clock::Pll),
            BoardFault::LoaderClocks(always) => board.chip.start_from_loader(stop.at, always),
            BoardFault::ReceiverNoise(per_million) => board.receiver_noise(per_million),
            BoardFault::Hang(still) => {
                host.hold(still);
                self.still = still.then_some(stop.at.0);
                self.hung = still.then_some(Hung {
                    last_rise_us: 0.0,
                    high: self.high,
                });
            }
            BoardFault::ResetPin => session.reset_by_pin(stop.at, stop.instruction_count, host),
        }
        true
    }

    /// Marks a task as queued outside its executor's queue: it never runs again.
    fn hang(&self, name: &str, host: &mut dyn Host) -> bool {
        let mut word = |at: u64| host.read(at, Width::W32).unwrap_or(0);
        // The executor's header has no fixed layout: the state word reads "spawned" in every task.
        let mut places = (0..HEADER).step_by(4);
        let state = places.find(|place| {
            self.tasks
                .values()
                .all(|task| word(task + place) & !QUEUED == SPAWNED)
        });
        let (Some(state), Some(task)) = (state, self.tasks.get(name)) else {
            return false;
        };
        host.write(task + state, Width::W32, SPAWNED | QUEUED).is_ok()
    }

    /// Replaces the start of a task's function by `code`, two instructions.
    fn replace(&self, name: &str, code: u64, host: &mut dyn Host) -> bool {
        let Some(task) = self.tasks.get(name) else {
            return false;
        };
        // The only code address in the executor's header.
        let (first, end) = self.flash;
        let in_flash = |word: u64| word & 1 == 1 && (first..end).contains(&word);
        let mut places = (0..HEADER).step_by(4).map(|place| task + place);
        let place = places.find(|at| host.read(*at, Width::W32).is_ok_and(in_flash));
        place.is_some_and(|at| {
            host.write(self.spare, Width::W32, code).is_ok()
                && host.write(at, Width::W32, self.spare | 1).is_ok()
        })
    }

    fn write<C: Chip>(
        &mut self,
        session: &mut Session<Wired<C>>,
        stop: Stop,
        wires: Wires,
        host: &mut dyn Host,
    ) {
        for fault in wires.faults {
            if !self.inflict(fault, session, stop, host) {
                self.impossible.push(fault);
            }
        }
        let board = session.board_mut();
        let count = wires.imu.len().max(1) as u64;
        for (nth, (rate, force)) in (1..).zip(wires.imu) {
            let [rate, force] = [rate, force].map(|vector| board.on_imu(vector));
            let sample = Sample {
                at: self.ms * MS + nth * MS / count,
                rate: rate.map(|v| (v.to_degrees() * 1e3).round() as i32),
                force: force.map(|v| (v / 9.806_65 * 1e6).round() as i32),
            };
            if let Some(imu) = board.imu() {
                imu.feed(sample);
            }
        }
        for (arm, [x, y, z]) in wires.arms.into_iter().enumerate() {
            if let Some(sensor) = board.arm(arm) {
                // Marking up, x forward: the chip's y points left, its z up.
                sensor.up = [-x, y, z];
            }
        }
        board.set_air(wires.air);
        board.set_analog(wires.analog);
        if let Some(line) = board.receiver() {
            line.outgoing.extend(wires.receiver);
        }
        if let Some(line) = board.console() {
            line.outgoing.extend(wires.console.into_iter().map(u16::from));
        }
        if let Some(line) = board.mavlink() {
            line.outgoing.extend(wires.mavlink.into_iter().map(u16::from));
        }
        if let Some(line) = board.ground() {
            line.outgoing.extend(wires.ground.into_iter().map(u16::from));
        }
    }
}

fn heard(line: Option<&mut Line>) -> Vec<u8> {
    let words = line.map_or(Vec::new(), |line| std::mem::take(&mut line.incoming));
    words.into_iter().map(|word| word as u8).collect()
}

fn far_end(line: Option<&mut Line>) -> FarEnd {
    FarEnd {
        waiting: line.as_ref().map_or(0, |line| line.outgoing.len()),
        heard: heard(line),
    }
}

impl<C: Chip> Driver<Wired<C>> for World {
    fn on_settled(&mut self, session: &mut Session<Wired<C>>, _: &mut dyn Host, settled: Settled) {
        if let Some(counter) = &mut self.counter {
            match settled {
                Settled::Hit(hit) => counter.on_hit(hit),
                Settled::Access { access, .. } => counter.on_access(&access),
                _ => {}
            }
        }
        if let Settled::Access { access, .. } = settled
            && access.kind == AccessKind::Write
        {
            let chip = &session.board().chip;
            if let Some(sector) = chip.erased(access.address, access.value) {
                *self.erases.entry(sector).or_default() += 1;
            }
            if chip.changes_cached_flash(access.address, access.value) {
                self.cached += 1;
            }
            if PORTS.iter().any(|ports| ports.contains(&access.address)) {
                self.outputs.check(session, access.virtual_time);
            }
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Wired<C>>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        if self.ms == 0 {
            session.board_mut().power_up(stop.at);
        }
        let pins = self.read(session, stop.at, host);
        self.pins.send(pins).ok()?;
        let wires = self.wires.recv().ok()?;
        self.write(session, stop, wires, host);
        if let Some(counter) = &mut self.counter {
            counter.on_millisecond(self.ms, host);
        }
        // On a fixed grid: a stop may come late.
        self.ms += 1;
        Some(VirtualNanos(self.ms * MS))
    }
}
