//! Runs the conformance image on the emulated core with the memory of QEMU's mps2 machines.

use std::num::{NonZeroU32, NonZeroU64};
use std::path::Path;

use rigless::emulator::{self, Driver, Host, Start, Stop};
use rigless::image::Image;
use rigless::machine::armv7m::{Config, Core, Fpu, Variant};
use rigless::machine::{Board, Target};
use rigless::mcu::{Bare, Mcu};
use rigless::session::Session;
use rigless::snapshot::{self, Reader, Store, Writer};
use rigless::soc::{Bus, Cpu, Endian, Region};
use rigless::time::{NO_DEADLINE, VirtualNanos};

/// Memory of mps2-an386 and mps2-an500, as linked.
const MEMORY: &[Region] = &[
    Region::flash("code", 0, 4 << 20),
    Region::ram("ram", 0x2000_0000, 4 << 20),
];
/// Ten times the usual virtual time.
const LONGEST: VirtualNanos = VirtualNanos(10_000_000_000);
const LINES: u16 = 32;

/// A Cortex-M core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoreKind {
    /// FPv4, single precision.
    M4F,
    /// FPv5, double precision.
    M7,
}

#[derive(Debug)]
struct Machine {
    mcu: Bare,
    kind: CoreKind,
}

impl Store for Machine {
    fn store(&self, to: &mut Writer) -> Result<(), snapshot::Error> {
        self.mcu.bus().store(to)
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), snapshot::Error> {
        self.mcu.bus_mut().load(from)
    }
}

impl Board for Machine {
    fn name(&self) -> &'static str {
        "core"
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec!["core"]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.mcu)
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let (variant, fpu) = match self.kind {
            CoreKind::M4F => (Variant::M4, Fpu::FpV4Sp),
            CoreKind::M7 => (Variant::M7, Fpu::FpV5Dp),
        };
        let hz = NonZeroU64::new(100_000_000).expect("not zero");
        let core = Core {
            variant,
            clock_hz: hz,
            interrupt_lines: NonZeroU32::new(u32::from(LINES)).expect("not zero"),
            // As on an STM32; the image's priorities differ in three bits.
            priority_bits: 4,
            refclk_divider: NonZeroU32::new(8).expect("not zero"),
            instructions_per_second: hz,
            boot: "code",
        };
        let mut config = Config::new(core, &[]);
        config.fpu = fpu;
        // The code region itself is at zero, not an alias.
        config.vector_table = Some(0);
        vec![Target::new("core", &mut self.mcu, config.spec())]
    }
}

#[derive(Default)]
struct Console(Vec<u8>);

impl Driver<Machine> for Console {
    fn on_stop(&mut self, _: &mut Session<Machine>, _: Stop, _: &mut dyn Host) -> Option<VirtualNanos> {
        None
    }

    fn on_console(&mut self, _: VirtualNanos, _: u64, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }
}

/// Output of the image `elf` on the emulated core.
///
/// # Errors
/// The image cannot be read or placed, does not end, or ends with a status other than 0.
pub fn run(elf: &Path, kind: CoreKind) -> Result<String, Box<dyn std::error::Error>> {
    let cpu = Cpu::new("core", true, LINES, Endian::Little);
    let mcu = Bare::new(Bus::builder(cpu, MEMORY, []))?;
    let images = [Image::read(elf, None)?];
    let mut session = Session::new(Box::new(Machine { mcu, kind }), 0, NO_DEADLINE)?;
    session.run_until(LONGEST);
    let mut start = Start::new(&images);
    start.semihosting = true;
    let finished = emulator::run(session, &start, Console::default())?;
    let log = String::from_utf8_lossy(&finished.driver.0).into_owned();
    match finished.exit_status {
        Some(0) => Ok(log),
        Some(status) => Err(format!("the image ended with status {status}, having printed\n{log}").into()),
        None => Err(format!(
            "the image did not end within {} s, having printed\n{log}",
            LONGEST.0 / 1_000_000_000
        )
        .into()),
    }
}
