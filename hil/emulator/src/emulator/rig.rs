//! The emulated board on a test rig, at rest, wired as in `hil/README.md`.

use std::path::Path;

use rigless::device::Level;
use rigless::emulator::{self, AccessKind, Driver, Host, Settled, Start, Stop, Watch};
use rigless::image::Image;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::{NO_DEADLINE, VirtualNanos};

use super::{MS, gaps};
use crate::board_kind;
use crate::boards::h743::{H743, MATEK};
use crate::boards::wired::Wired;
use crate::chips::icm42688p::Sample;
use crate::elf::Firmware;
use crate::log::{Line, Log};
use crate::processor::chip::Chip;
use crate::processor::pads::At;
use crate::processor::rtt::Rtt;
use crate::suite::{self, Test};
use crate::wires::Gap;

/// Virtual time limit.
const LONGEST: u64 = 30_000 * MS;
const SPEED: f64 = 1.0;
const PORTS: std::ops::Range<u64> = 0x5802_0000..0x5802_2C00;
/// Duration and period, ns: not in step with 1 kHz.
const STALL: u64 = 600_000;
const STALL_EVERY: u64 = 1_700_000;
/// Wrong crystal, Hz, at which the chip still starts.
const CRYSTAL: u64 = 6_000_000;
/// Parameter flash.
const PARAMETERS: std::ops::Range<u64> = 0x081C_0000..0x0820_0000;
/// Test voltage: half the supply, V.
const HALF: f64 = 1.65;
/// The same from resistors 20 % apart.
const UNEQUAL: f64 = 1.5;
/// Inertial samples per millisecond; 1 g in millionths.
const SAMPLES: u64 = 4;
const G: i32 = 1_000_000;
/// At an arm's sensor, marking up, m/s².
const UP: [f64; 3] = [0.0, 0.0, 9.806_65];

/// Jumpers: motor 1 to servo 3, servo 1 to servo 4, receiver output to input.
static MOTOR: [At; 2] = [MATEK.motors.pins[0], MATEK.servos[2].pin];
static SERVO: [At; 2] = [MATEK.servos[0].pin, MATEK.servos[3].pin];
const RECEIVER: [At; 2] = [At(2, 6), At(2, 7)];
/// Alternate function of the receiver's output.
const PORT_FUNCTION: u8 = 7;

/// Defects of a rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defect {
    /// Nothing.
    None,
    /// Wrong crystal frequency.
    Crystal,
    /// Inertial sensor unplugged.
    NoImu,
    /// Sensor of arm 3 unplugged.
    NoArm,
    /// No jumpers.
    NoJumpers,
    /// Divider of unequal resistors.
    Divider,
    /// Stands still for a third of the time, 0.6 ms at once.
    Stalls,
    /// The watchdog's clock stands still.
    Watchdog,
    /// A reset erases the stored parameters.
    Forgets,
}

/// Result of a test.
#[derive(Debug)]
pub struct Ended {
    /// Exit status; `None` if the test did not end within 30 s.
    pub status: Option<u32>,
    /// Its log.
    pub lines: Vec<Line>,
    /// Gaps of the emulator.
    pub gaps: Vec<Gap>,
}

/// Reads the reference board's test image, the only rig here.
///
/// # Errors
/// One line: the mistake in the file.
pub fn read(path: &Path) -> Result<Firmware, String> {
    Firmware::read(path, board_kind::find(MATEK.name)?)
}

/// Runs `test` from power-on on a rig with `defect`.
///
/// # Errors
/// One line: why the emulator refuses.
pub fn run(image: &Firmware, test: &Test, defect: Defect) -> Result<Ended, String> {
    let failed = |e: &dyn std::fmt::Display| format!("emulator: {e}");
    let bytes = suite::entering(image, test)?;
    let images = [Image::new(&image.path, bytes, None).map_err(|e| failed(&e))?];
    let mut session = Session::new(Box::new(Wired::new(H743::new()?, &MATEK, SPEED)?), 0, NO_DEADLINE)
        .map_err(|e| failed(&e))?;
    session.run_until(VirtualNanos(1));
    let mut start = Start::new(&images);
    start.semihosting = true;
    let rig = Rig {
        defect,
        next: 0,
        rtt: Rtt::new(image.rtt),
        log: Vec::new(),
        resets: 0,
        samples: 0,
    };
    let finished = emulator::run(session, &start, rig).map_err(|e| failed(&e))?;
    let mut log = Log::new(&image.table);
    let mut lines = Vec::new();
    for (at, bytes) in &finished.driver.log {
        lines.extend(log.take(at / MS, bytes));
    }
    Ok(Ended {
        status: finished.exit_status,
        lines,
        gaps: gaps(&finished.session),
    })
}

struct Rig {
    defect: Defect,
    next: u64,
    rtt: Rtt,
    log: Vec<(u64, Vec<u8>)>,
    resets: usize,
    samples: u8,
}

impl Rig {
    fn set_up(&self, board: &mut Wired<H743>, now: VirtualNanos) {
        board.power_up(now);
        let half = if self.defect == Defect::Divider {
            UNEQUAL
        } else {
            HALF
        };
        let [battery, current, servos] = [0.0; 3];
        board.set_analog([half, half, half, half, battery, current, servos]);
        for arm in 0..4 {
            if let Some(sensor) = board.arm(arm) {
                sensor.up = UP;
            }
        }
        match self.defect {
            Defect::Crystal => board.chip.fit_crystal(CRYSTAL),
            Defect::NoImu => board.silence_imu(true),
            Defect::NoArm => board.silence_arm(2, true),
            _ => {}
        }
    }

    /// Feeds a millisecond of samples at rest, all different.
    fn shake(&mut self, board: &mut Wired<H743>, now: u64) {
        let Some(imu) = board.imu() else { return };
        for nth in 0..SAMPLES {
            self.samples = (self.samples + 1) % 7;
            let noise = self.samples as i32 * 100;
            imu.feed(Sample {
                at: now + nth * MS / SAMPLES,
                rate: [noise, -noise, noise],
                force: [noise, -noise, noise - G],
            });
        }
    }

    fn carry(&self, board: &mut Wired<H743>, now: VirtualNanos) {
        if self.defect == Defect::NoJumpers {
            return;
        }
        let (motor, servo) = (board.chip.first_motor_is_high(), board.chip.first_servo_is_high());
        // A serial line rests high; its bytes are transferred separately.
        for ([from, to], function, peripheral) in [
            (MOTOR, MATEK.motors.function, motor),
            (SERVO, MATEK.servos[0].function, servo),
            (RECEIVER, PORT_FUNCTION, true),
        ] {
            let high = match board.chip.function(now, from) {
                Some(carried) => carried == function && peripheral,
                None => board.chip.is_high(now, from),
            };
            if board.chip.is_high(now, to) != high {
                board
                    .chip
                    .drive(now, to, if high { Level::High } else { Level::Low });
            }
        }
    }
}

fn erase(host: &mut dyn Host) {
    for address in PARAMETERS.step_by(8) {
        // Fails only without flash there.
        let _ = host.program(address, Width::W64, u64::MAX);
    }
}

impl Driver<Wired<H743>> for Rig {
    fn on_settled(&mut self, session: &mut Session<Wired<H743>>, host: &mut dyn Host, settled: Settled) {
        match settled {
            Settled::Access { access, .. }
                if PORTS.contains(&access.address) && access.kind == AccessKind::Write =>
            {
                self.carry(session.board_mut(), access.virtual_time);
            }
            Settled::Stop(stop) => {
                let resets = session.resets().len();
                if std::mem::replace(&mut self.resets, resets) != resets && self.defect == Defect::Forgets {
                    erase(host);
                }
                self.carry(session.board_mut(), stop.at);
            }
            Settled::Hit(hit) => {
                let bytes = self.rtt.drain(host);
                self.log.push((hit.at.0, bytes));
            }
            _ => {}
        }
    }

    fn on_stop(
        &mut self,
        session: &mut Session<Wired<H743>>,
        stop: Stop,
        host: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        let board = session.board_mut();
        if self.next == 0 {
            self.set_up(board, stop.at);
            // The last output comes just before the end, between stops.
            host.watch(Watch::Writes {
                address: self.rtt.written(),
                length: 4,
            });
        }
        self.shake(board, stop.at.0);
        if self.defect != Defect::NoJumpers
            && let Some(line) = board.receiver()
        {
            line.outgoing.extend(line.incoming.drain(..));
        }
        if self.defect == Defect::Watchdog {
            board.chip.still_watchdog();
        }
        if self.defect == Defect::Stalls {
            let stalls = self.next % STALL_EVERY < STALL;
            host.hold(stalls);
            self.next += if stalls { STALL } else { STALL_EVERY - STALL };
        } else {
            self.next += MS;
        }
        (self.next < LONGEST).then_some(VirtualNanos(self.next))
    }
}
