//! Data between the emulated board and the simulated world, free of the emulator's types.

use std::collections::BTreeMap;

use sophie_control::allocation::wrench::PerArm;

use crate::chain::Counted;
use crate::esc::EscStats;

/// Inputs for the next millisecond.
#[derive(Clone, Debug, Default)]
pub struct Wires {
    /// Evenly spread samples: body rate (rad/s), specific force (m/s²), body axes.
    pub imu: Vec<([f64; 3], [f64; 3])>,
    /// Gravity at each arm's sensor, m/s², arm axes (forward, right, down).
    pub arms: PerArm<[f64; 3]>,
    /// Pressure (Pa) and temperature (°C) at the barometer; `None`: it answers no more.
    pub air: Option<(f64, f64)>,
    /// Pads of pressure 1 to 4 (V), battery voltage (V) and current (A), servo battery (V).
    pub analog: [f64; 7],
    /// Parity, if any, is the top bit.
    pub receiver: Vec<u16>,
    /// Bytes typed at the console.
    pub console: Vec<u8>,
    /// Bytes from a MAVLink client.
    pub mavlink: Vec<u8>,
    /// Bytes from the flow and range module.
    pub ground: Vec<u8>,
    /// Faults and repairs in this millisecond.
    pub faults: Vec<BoardFault>,
}

/// A fault or event; faults last unless stated otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardFault {
    /// Inertial sensor unplugged (true) or plugged in.
    ImuUnplugged(bool),
    /// Data-ready of the inertial sensor cut (true) or joined; its bus works.
    DataReadyCut(bool),
    /// Bits flipped in its next word.
    ImuWord(u8),
    /// Divider of 1 to n at pressure sensor 0 to 3.
    PadDivider(usize, u32),
    /// Sensor of arm 0 to 3 unplugged (true) or plugged in.
    ArmUnplugged(usize, bool),
    /// Arm bus 0 or 1: clock stretched by this many µs after each byte; 0: none.
    ClockHeld(usize, u32),
    /// Arm bus 0 or 1: one spurious bus error in about this many bytes; 0 turns them off.
    BusErrors(usize, u32),
    /// The sensor of arm 0 to 3 does not acknowledge (true) the byte that resets it, and resets.
    ArmRefusesReset(usize, bool),
    /// The sensor of arm 0 to 3 does not acknowledge this register's number, at its next write alone.
    ArmRefuses(usize, u8),
    /// Fails (false) or returns.
    Supply(bool),
    /// The task (name in `src/flight` or `src/firmware`) hangs in its await.
    TaskHung(&'static str),
    /// The task recurses endlessly at its next run.
    StackOverflow(&'static str),
    /// The task faults at hard fault priority: the processor locks up (ARMv7-M B1.5.15).
    LockUp(&'static str),
    /// Parameter flash overwritten, as by foreign firmware.
    CorruptParameters,
    /// Parameter flash begins as ArduPilot leaves it.
    ForeignParameters,
    /// As of a new chip: no brown-out level. Before the first instruction only.
    FactoryOptions,
    /// A processor of the first revision.
    FirstRevision,
    /// Crystal does not start. Before the first instruction only.
    NoCrystal,
    /// Core PLL never locks. Before the first instruction only.
    NoPll,
    /// Started by the chip's loader, its clocks running; true: after each reset as well. Before the first instruction only.
    LoaderClocks(bool),
    /// This many in a million bytes from the receiver come right but with noise on them, as the port sees it. Before the
    /// first instruction only.
    ReceiverNoise(u32),
    /// Processor halted (true) or running; the watchdog runs.
    Hang(bool),
    /// A pulse.
    ResetPin,
}

/// Outputs in the last millisecond.
#[derive(Clone, Debug, Default)]
pub struct Pins {
    /// Time since power-on, ms.
    pub ms: u64,
    /// As decoded by the controllers, 0..1.
    pub motors: PerArm<f64>,
    /// Servo pulses, µs; 0: none.
    pub servos: PerArm<f64>,
    /// Bytes to the receiver.
    pub telemetry: Vec<u8>,
    /// The console.
    pub console: FarEnd,
    /// MAVLink.
    pub mavlink: FarEnd,
    /// Bytes of the log, as in the probe's buffer.
    pub log: Vec<u8>,
    /// State light, fault light and buzzer.
    pub signals: [bool; 3],
    /// Time (ns since power-on) and cause.
    pub resets: Vec<(u64, String)>,
}

/// The far end of a serial line both ways.
#[derive(Clone, Debug, Default)]
pub struct FarEnd {
    /// Bytes from the board in the last millisecond.
    pub heard: Vec<u8>,
    /// Bytes towards the board that the line has not yet carried.
    pub waiting: usize,
}

/// Results of a run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Gaps and mistakes that the emulator found.
    pub gaps: Vec<Gap>,
    /// Instructions executed.
    pub instructions: u64,
    /// Input of each motor controller.
    pub escs: PerArm<EscStats>,
    /// Data-ready to motor frame, µs.
    pub latency_us: Latency,
    /// The motors' pins at the processor's last standstill.
    pub hung: Option<Hung>,
    /// Erases of each sector, by first address.
    pub erases: BTreeMap<u64, u32>,
    /// The outputs around resets.
    pub outputs: Vec<Output>,
    /// Servo pulses at the end, µs; 0: none.
    pub servos: PerArm<f64>,
    /// Digest of motor edges, servo pulses and telemetry.
    pub pins_digest: u64,
    /// Steps with counted instructions.
    pub counted: Counted,
    /// Readings from the arms' buses.
    pub reads: Reads,
}

/// Times at which parts on the arms' buses gave a measurement, ns.
#[derive(Clone, Debug, Default)]
pub struct Reads {
    /// Pressures of the barometer.
    pub barometer: Vec<u64>,
    /// Measurements of each arm's sensor.
    pub arms: PerArm<Vec<u64>>,
    /// Writes to each arm's sensor, register first, with their counts.
    pub written: PerArm<BTreeMap<Vec<u8>, u32>>,
}

impl Reads {
    /// Measurements a second of the barometer and of each arm's sensor, between `from` and `to`, s.
    #[must_use]
    pub fn rates(&self, from: f64, to: f64) -> (f64, PerArm<f64>) {
        let rate = |times: &Vec<u64>| {
            let within = times
                .iter()
                .filter(|ns| (from..to).contains(&(**ns as f64 * 1e-9)));
            within.count() as f64 / (to - from)
        };
        (rate(&self.barometer), self.arms.each_ref().map(rate))
    }
}

/// An output around resets.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Connected device.
    pub what: String,
    /// Processor pin.
    pub pin: String,
    /// Pulled up until the firmware drives it.
    pub pulled_up: bool,
    /// Time from each start until driven, µs; `None`: never.
    pub after_us: Vec<Option<f64>>,
}

impl Output {
    /// The output at the first start.
    pub fn new(what: String, pin: impl std::fmt::Display) -> Self {
        Self {
            what,
            pin: pin.to_string(),
            pulled_up: false,
            after_us: vec![None],
        }
    }
}

/// Motor pins during a standstill of the processor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hung {
    /// Time to the last rising edge, µs; 0 without one.
    pub last_rise_us: f64,
    /// Pins high at the end.
    pub high: PerArm<bool>,
}

/// Statistics of a latency.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Latency {
    /// Number of values.
    pub count: u64,
    /// Sum, µs.
    pub sum: f64,
    /// Largest value, µs.
    pub worst: f64,
}

impl Latency {
    /// Adds a value, µs.
    pub fn add(&mut self, us: f64) {
        self.count += 1;
        self.sum += us;
        self.worst = self.worst.max(us);
    }

    /// Mean, µs.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
}

/// A gap of the emulation: behaviour that the emulator does not model or finds wrong.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Gap {
    /// `unmapped`, `refused`, `unimplemented`, `undefined`, `unrouted`, `told` or `miswired`.
    pub kind: &'static str,
    /// Instance and register, address, or pin.
    pub at: String,
    /// Description.
    pub what: String,
}

/// FNV-1a.
#[derive(Clone, Copy, Debug)]
pub struct Digest(pub u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Adds a word.
    pub fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.byte(byte);
        }
    }

    /// Adds a byte.
    pub fn byte(&mut self, byte: u8) {
        self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
}
