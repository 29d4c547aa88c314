//! A BNO055 on I2C after its datasheet (BST-BNO055-DS000 rev. 1.4), as far as the driver of an arm's sensor uses it.
//!
//! | behaviour | section |
//! |---|---|
//! | no acknowledge for 400 ms after power-on and 650 ms after a reset by SYS_TRIGGER | 1.2, table 0-2 |
//! | identity registers, two pages, the page selected by PAGE_ID | 4.2 |
//! | all but mode and interrupts, a reset too, take writes in the configuration mode only | 3.3 |
//! | the byte that resets it acknowledged or, as drivers of others report, not | |
//! | 7 ms from the configuration mode, 19 ms into it; until then the old mode stays | table 3-6 |
//! | fusion at 100 Hz; SYS_STATUS 5 while it runs, 6 without fusion, 0 idle | 3.3, 4.3.58 |
//! | gravity, Euler angles, UNIT_SEL's scales, axis remapping | 3.4, 3.6 |
//! | calibration of the gyroscope rises from 0 to 3 within 3 s at rest (assumed) | 3.10 |
//!
//! Missing: clock stretching (not on the emulator's bus), the other sensors' raw data, interrupts, power modes.

use std::collections::BTreeMap;

use rigless::chip::{Timeline, i2c};
use rigless::snapshot::store;
use serde::{Deserialize, Serialize};

mod reg {
    pub const PAGE_ID: u8 = 0x07;
    pub const EUL_DATA: u8 = 0x1A;
    pub const GRV_DATA: u8 = 0x2E;
    pub const TEMP: u8 = 0x34;
    pub const CALIB_STAT: u8 = 0x35;
    pub const SYS_STATUS: u8 = 0x39;
    pub const UNIT_SEL: u8 = 0x3B;
    pub const OPR_MODE: u8 = 0x3D;
    pub const SYS_TRIGGER: u8 = 0x3F;
    pub const AXIS_MAP_CONFIG: u8 = 0x41;
    pub const AXIS_MAP_SIGN: u8 = 0x42;
    /// Writable only in configuration mode, except mode and trigger.
    pub const SETTINGS: core::ops::RangeInclusive<u8> = 0x3B..=0x6A;
}

const MS: u64 = 1_000_000;
/// Start-up time from power-on and from a reset, ns.
const BOOT: [u64; 2] = [400 * MS, 650 * MS];
/// Into and out of configuration mode, ns.
const SWITCH: [u64; 2] = [19 * MS, 7 * MS];
/// Period of the fusion, ns.
const FUSION: u64 = 10 * MS;
/// Rest per step of the gyroscope's calibration, ns (assumed).
const CALIBRATION: u64 = 1000 * MS;
/// Identity registers from 0 on: chip, accelerometer, magnetometer, gyroscope, software revision, boot loader.
const IDENTITY: [u8; 7] = [0xA0, 0xFB, 0x32, 0x0F, 0x11, 0x03, 0x15];
const RESET_VALUES: [(u8, u8); 6] = [
    (0x36, 0x0F),
    (reg::TEMP, 24),
    (reg::UNIT_SEL, 0x80),
    (reg::OPR_MODE, 0x10),
    (reg::AXIS_MAP_CONFIG, 0x24),
    (0x40, 0x02),
];

#[derive(Debug, Serialize, Deserialize)]
pub struct Bno055 {
    address: u8,
    registers: Vec<u8>,
    page: u8,
    pointer: u8,
    first: bool,
    boots_at: u64,
    /// Next mode and its time, ns.
    switch: Option<(u8, u64)>,
    /// Time of power-on or of the last reset, ns.
    since: u64,
    fused: u64,
    /// The byte that resets it is not acknowledged.
    pub refuses_reset: bool,
    /// A register's number that is not acknowledged once, at the next write.
    pub refuses: Option<u8>,
    /// The bytes of each write, and how many of them came.
    pub written: BTreeMap<Vec<u8>, u32>,
    /// Those of the write under way.
    bytes: Vec<u8>,
    /// Specific force at rest (up), m/s², chip axes.
    pub up: [f64; 3],
    /// Times at which it was read, ns.
    pub read_at: Vec<u64>,
}

store!(Bno055);

impl Bno055 {
    /// Powered at time 0.
    pub fn new(address: u8) -> Self {
        let mut chip = Self {
            address,
            registers: Vec::new(),
            page: 0,
            pointer: 0,
            first: false,
            boots_at: 0,
            switch: None,
            since: 0,
            fused: 0,
            refuses_reset: false,
            refuses: None,
            written: BTreeMap::new(),
            bytes: Vec::new(),
            up: [0.0, 0.0, 9.806_65],
            read_at: Vec::new(),
        };
        chip.restart(BOOT[0]);
        chip
    }

    fn restart(&mut self, ready: u64) {
        self.registers = vec![0; 128];
        self.registers[..IDENTITY.len()].copy_from_slice(&IDENTITY);
        for (register, value) in RESET_VALUES {
            self.registers[usize::from(register)] = value;
        }
        self.page = 0;
        self.switch = None;
        self.boots_at = ready;
        self.since = self.boots_at;
    }

    fn mode(&self) -> u8 {
        self.registers[usize::from(reg::OPR_MODE)] & 0x0F
    }

    fn settle(&mut self, now: u64) {
        if let Some((mode, at)) = self.switch
            && at <= now
        {
            self.switch = None;
            self.since = at;
            self.fused = 0;
            let register = &mut self.registers[usize::from(reg::OPR_MODE)];
            *register = *register & 0xF0 | mode;
        }
        let running = now.saturating_sub(self.since);
        let mode = self.mode();
        // IMU to NDOF fuse; AMG and its parts do not.
        let fusing = mode >= 0x08;
        self.registers[usize::from(reg::SYS_STATUS)] = match mode {
            0 => 0,
            _ if fusing => 5,
            _ => 6,
        };
        if !fusing {
            return;
        }
        let gyro = (running / CALIBRATION).min(3) as u8;
        self.registers[usize::from(reg::CALIB_STAT)] = gyro << 4 | if gyro == 3 { 0xC0 } else { 0 };
        if running / FUSION > self.fused {
            self.fused = running / FUSION;
            self.fuse();
        }
    }

    fn fuse(&mut self) {
        let map = self.registers[usize::from(reg::AXIS_MAP_CONFIG)];
        let signs = self.registers[usize::from(reg::AXIS_MAP_SIGN)];
        let axis = |nth: usize| {
            let from = usize::from(map >> (2 * nth) & 3).min(2);
            // Sign bits: 2 for x, 1 for y, 0 for z.
            let sense = if signs >> (2 - nth) & 1 == 1 { -1.0 } else { 1.0 };
            sense * self.up[from]
        };
        let up = [axis(0), axis(1), axis(2)];
        let units = self.registers[usize::from(reg::UNIT_SEL)];
        // m/s² in hundredths, or mg.
        let gravity = if units & 1 == 0 { 100.0 } else { 1000.0 / 9.806_65 };
        let angle = if units & 4 == 0 {
            16.0 * 180.0 / std::f64::consts::PI
        } else {
            900.0
        };
        let roll = up[1].atan2(up[2]);
        let pitch = (-up[0]).atan2(up[1].hypot(up[2]));
        self.put(reg::GRV_DATA, up.map(|v| v * gravity));
        self.put(reg::EUL_DATA, [0.0, roll * angle, pitch * angle]);
    }

    fn put(&mut self, register: u8, values: [f64; 3]) {
        for (nth, value) in values.into_iter().enumerate() {
            let at = usize::from(register) + 2 * nth;
            self.registers[at..at + 2].copy_from_slice(&(value.round() as i16).to_le_bytes());
        }
    }

    /// False: not acknowledged.
    fn write_register(&mut self, register: u8, value: u8, now: u64) -> bool {
        if register == reg::PAGE_ID {
            self.page = value & 1;
            return true;
        }
        // Page 1 holds settings of the single sensors, which the fusion overrides.
        if self.page != 0 {
            return true;
        }
        match register {
            reg::OPR_MODE => {
                let (old, new) = (self.mode(), value & 0x0F);
                if old != new {
                    self.switch = Some((new, now + SWITCH[usize::from(old == 0)]));
                }
            }
            reg::SYS_TRIGGER if value & 0x20 != 0 && self.mode() == 0 => {
                self.restart(now + BOOT[1]);
                return !self.refuses_reset;
            }
            _ if reg::SETTINGS.contains(&register) && self.mode() == 0 => {
                self.registers[usize::from(register)] = value;
            }
            _ => {}
        }
        true
    }
}

impl Bno055 {
    fn note(&mut self) {
        if !self.bytes.is_empty() {
            *self.written.entry(std::mem::take(&mut self.bytes)).or_default() += 1;
        }
    }
}

impl i2c::Peer for Bno055 {
    fn start(&mut self, address: u8, _: bool, c: &mut Timeline<'_, '_>) -> bool {
        let now = c.now().0;
        if address != self.address || now < self.boots_at {
            return false;
        }
        self.settle(now);
        self.first = true;
        self.note();
        true
    }

    fn write(&mut self, byte: u8, c: &mut Timeline<'_, '_>) -> bool {
        if self.first && self.refuses == Some(byte) {
            self.refuses = None;
            return false;
        }
        self.bytes.push(byte);
        if std::mem::take(&mut self.first) {
            self.pointer = byte & 0x7F;
            return true;
        }
        let acknowledged = self.write_register(self.pointer, byte, c.now().0);
        self.pointer = (self.pointer + 1) & 0x7F;
        acknowledged
    }

    fn read(&mut self, _: bool, c: &mut Timeline<'_, '_>) -> u8 {
        if (self.page, self.pointer) == (0, reg::GRV_DATA) {
            self.read_at.push(c.now().0);
        }
        let value = match (self.page, self.pointer) {
            (page, reg::PAGE_ID) => page,
            (0, register) => self.registers[usize::from(register)],
            _ => 0,
        };
        self.pointer = (self.pointer + 1) & 0x7F;
        value
    }

    fn stop(&mut self, _: &mut Timeline<'_, '_>) {
        self.note();
    }
}
