//! The emulator's ICM-42688-P with additions after DS-000347 rev. 1.8: data-ready pulses on INT1 (§12.5, §14.50), the
//! self-test (§14.52; factory codes after the maker's application note), a separate sample per data-ready.

use std::collections::VecDeque;

use rigless::chip::icm42688p::Icm42688p;
use rigless::chip::{Timeline, spi};
use rigless::snapshot::store;
use rigless::time::{EventId, VirtualNanos};
use serde::{Deserialize, Serialize};

mod reg {
    //! Addresses in bank 0 unless named otherwise.
    pub const DEVICE_CONFIG: u8 = 0x11;
    pub const PWR_MGMT0: u8 = 0x4E;
    pub const GYRO_CONFIG0: u8 = 0x4F;
    pub const INT_SOURCE0: u8 = 0x65;
    pub const SELF_TEST_CONFIG: u8 = 0x70;
    pub const REG_BANK_SEL: u8 = 0x76;
    pub const B1_XG_ST_DATA: u8 = 0x5F;
    pub const B2_XA_ST_DATA: u8 = 0x3B;
}

/// Address bit of a read (§9.6).
const READ: u8 = 0x80;
/// PWR_MGMT0: low-noise mode, as sampling requires.
const GYRO_ON: u8 = 0x0C;
/// INT_SOURCE0.
const DATA_READY_ON_INT1: u8 = 0x08;
/// Factory codes of gyroscope and accelerometer: response to actuation.
const CODES: [[u8; 3]; 2] = [[101, 97, 106], [118, 121, 109]];
/// Response of code 1, counts at 250 °/s and 2 g full scale; each code adds 1 %.
const CODE_BASE: f64 = 2620.0;
/// Counts per °/s and per g during the test.
const TEST_COUNTS: [f64; 2] = [32_768.0 / 250.0, 32_768.0 / 2.0];
/// Far more than a millisecond's samples.
const QUEUE: usize = 64;

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Sample {
    /// Start of validity, ns.
    pub at: u64,
    /// Angular rate, thousandths of °/s.
    pub rate: [i32; 3],
    /// Specific force, millionths of g.
    pub force: [i32; 3],
}

#[derive(Debug, Serialize, Deserialize)]
pub struct Imu {
    inner: Icm42688p,
    /// Since power-on.
    pub pulses: u64,
    /// Line cut: the part samples, no pulse arrives.
    pub line_cut: bool,
    /// Ready times of unread samples, ns.
    pub pulsed: Vec<u64>,
    samples: VecDeque<Sample>,
    now: Sample,
    transfer: Option<Transfer>,
    bank: u8,
    rate_code: u8,
    power: u8,
    sources: u8,
    actuated: u8,
    #[serde(skip)]
    next: Option<(EventId, VirtualNanos)>,
}

/// Address byte, and data bytes so far.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Transfer {
    address: u8,
    passed: u8,
}

store!(Imu);

impl Default for Imu {
    fn default() -> Self {
        Self {
            inner: Icm42688p::new(),
            pulses: 0,
            line_cut: false,
            pulsed: Vec::new(),
            samples: VecDeque::new(),
            now: Sample {
                force: [0, 0, -1_000_000],
                ..Sample::default()
            },
            transfer: None,
            bank: 0,
            rate_code: 6,
            power: 0,
            sources: 0x10,
            actuated: 0,
            next: None,
        }
    }
}

impl Imu {
    /// Queues a sample; drops the oldest if full.
    pub fn feed(&mut self, sample: Sample) {
        if self.samples.len() >= QUEUE {
            self.samples.pop_front();
        }
        self.samples.push_back(sample);
    }

    fn measure(&mut self, now: u64) {
        while let Some(sample) = self.samples.front().copied()
            && sample.at <= now
        {
            self.now = sample;
            self.samples.pop_front();
        }
        let mut senses = [self.now.rate, self.now.force];
        for (sensor, axes) in senses.iter_mut().enumerate() {
            // Bits 0 to 2 actuate the gyroscope, 3 to 5 the accelerometer, with supply bit 6.
            let powered = sensor == 0 || self.actuated & 0x40 != 0;
            for (axis, value) in axes.iter_mut().enumerate() {
                if powered && self.actuated & (1 << (3 * sensor + axis)) != 0 {
                    let scale = [1e3, 1e6][sensor] / TEST_COUNTS[sensor];
                    *value += (response(CODES[sensor][axis]) * scale) as i32;
                }
            }
        }
        let [[x, y, z], [ax, ay, az]] = senses;
        self.inner.set_rate(x, y, z);
        self.inner.set_acceleration(ax, ay, az);
    }

    /// ns; `None` without data-ready.
    fn period(&self) -> Option<u64> {
        let period = match self.rate_code & 0x0F {
            3 => 125_000,
            4 => 250_000,
            5 => 500_000,
            6 => 1_000_000,
            _ => return None,
        };
        let on = self.power & GYRO_ON == GYRO_ON && self.sources & DATA_READY_ON_INT1 != 0;
        on.then_some(period)
    }

    fn schedule(&mut self, from: VirtualNanos, c: &mut Timeline<'_, '_>) {
        self.next = self.period().map(|period| {
            let at = VirtualNanos(from.0 + period);
            (c.schedule(at), at)
        });
    }

    fn written(&mut self, register: u8, value: u8, c: &mut Timeline<'_, '_>) {
        match (self.bank, register) {
            (_, reg::REG_BANK_SEL) => self.bank = value & 0x07,
            (0, reg::DEVICE_CONFIG) if value & 1 != 0 => {
                (self.bank, self.rate_code, self.power, self.sources, self.actuated) = (0, 6, 0, 0x10, 0);
                self.schedule(c.now(), c);
            }
            (0, reg::GYRO_CONFIG0) => {
                self.rate_code = value;
                self.schedule(c.now(), c);
            }
            (0, reg::PWR_MGMT0) => {
                self.power = value;
                self.schedule(c.now(), c);
            }
            (0, reg::INT_SOURCE0) => {
                self.sources = value;
                self.schedule(c.now(), c);
            }
            (0, reg::SELF_TEST_CONFIG) => self.actuated = value,
            _ => {}
        }
    }

    fn code(&self, register: u8) -> Option<u8> {
        let (codes, first) = match self.bank {
            1 => (&CODES[0], reg::B1_XG_ST_DATA),
            2 => (&CODES[1], reg::B2_XA_ST_DATA),
            _ => return None,
        };
        codes.get(usize::from(register.checked_sub(first)?)).copied()
    }
}

/// Counts.
fn response(code: u8) -> f64 {
    CODE_BASE * 1.01f64.powi(i32::from(code) - 1)
}

impl spi::Peer for Imu {
    fn select(&mut self, c: &mut Timeline<'_, '_>) {
        self.measure(c.now().0);
        self.transfer = None;
        self.inner.select(c);
    }

    fn deselect(&mut self, c: &mut Timeline<'_, '_>) {
        self.inner.deselect(c);
    }

    fn transfer(&mut self, mosi: u32, bits: u8, c: &mut Timeline<'_, '_>) -> u32 {
        let byte = (mosi & 0xFF) as u8;
        let miso = self.inner.transfer(mosi, bits, c);
        let Some(transfer) = &mut self.transfer else {
            self.transfer = Some(Transfer {
                address: byte,
                passed: 0,
            });
            return miso;
        };
        let Transfer { address, passed } = *transfer;
        transfer.passed = passed.saturating_add(1);
        let register = (address & !READ).wrapping_add(passed);
        if address & READ != 0 {
            return self.code(register).map_or(miso, u32::from);
        }
        // A write takes one byte (§9.6).
        if passed == 0 {
            self.written(register, byte, c);
        }
        miso
    }

    fn on_event(&mut self, event: EventId, c: &mut Timeline<'_, '_>) {
        if let Some((id, at)) = self.next
            && id == event
        {
            self.measure(at.0);
            self.pulses += u64::from(!self.line_cut);
            self.pulsed.push(at.0);
            self.schedule(at, c);
        }
    }

    fn restarted(&mut self, c: &mut Timeline<'_, '_>) {
        self.schedule(c.now(), c);
    }
}
