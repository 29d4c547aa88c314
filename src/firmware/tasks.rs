//! Every task is spawned here. Those of the background are static executor tasks here too; those of the flight level are
//! in `sophie_flight`, compiled for speed, those of the steady level in `sophie_steady`.

use embassy_executor::SpawnError;
use sophie_boards::retained::Memory;
use sophie_boards::{BarometerPort, Board, BufferedInput, BufferedOutput, StoragePort, ThisChip, UsbDriver};
use sophie_flight::tasks as flight;
use sophie_ports::chip_check::ChipCheck;
use sophie_ports::sensors::Barometer;
use sophie_ports::signing::Stored;
use sophie_steady::tasks as steady;
use sophie_tasks::console::one_of::OneOf;
use sophie_tasks::console::terminals::{Keyboards, Screens, Served};
use sophie_tasks::ground_station::console_pipe::{Shell, ShellPort};
use sophie_tasks::ground_station::mavlink::Lines;
use sophie_tasks::links::Links;
use sophie_tasks::schedule::TaskId;
use sophie_tasks::usb::port::{Port, UsbInput, UsbOutput};
use sophie_tasks::usb::{self, Identity, Memory as UsbMemory};
use static_cell::StaticCell;

use super::Levels;

/// The terminals of the console: at a serial line, over USB, or over MAVLink.
type ConsoleInput = Keyboards<'static, OneOf<OneOf<BufferedInput, UsbInput<'static>>, ShellPort<'static>>, 3>;
type ConsoleOutput =
    Screens<'static, OneOf<OneOf<BufferedOutput, UsbOutput<'static>>, ShellPort<'static>>, 3>;

/// Input of MAVLink, of a serial line or of USB.
type MavlinkInput = OneOf<BufferedInput, UsbInput<'static>>;
/// Its output.
type MavlinkOutput = OneOf<BufferedOutput, UsbOutput<'static>>;

static SHELL: Shell = Shell::new();
static SERVED: StaticCell<Served> = StaticCell::new();
static USB_PORT: StaticCell<Port> = StaticCell::new();
static USB_MEMORY: StaticCell<UsbMemory<'static>> = StaticCell::new();

/// Spawns every task; `self_test`: the inertial sensor's, first. Called once.
///
/// # Errors
/// A task that was already spawned: each is static.
pub fn spawn(
    levels: &Levels,
    links: &'static Links,
    board: Board,
    memory: Memory,
    self_test: bool,
) -> Result<(), SpawnError> {
    // Motors first: their first frame is a stop.
    levels.spawn(TaskId::Motors, flight::motors(links, board.motors)?);
    levels.spawn(TaskId::Mixer, flight::mixer(links)?);
    levels.spawn(TaskId::Control, flight::control(links)?);
    levels.spawn(TaskId::Estimator, flight::estimator(links)?);
    levels.spawn(TaskId::Imu, flight::imu(links, board.imu, self_test)?);
    levels.spawn(
        TaskId::Supervisor,
        steady::supervisor(links, board.watchdog, memory)?,
    );
    levels.spawn(TaskId::Commander, steady::commander(links)?);
    levels.spawn(TaskId::Rc, steady::rc(links, board.receiver)?);
    levels.spawn(TaskId::Ground, steady::ground(links, board.ground)?);
    levels.spawn(TaskId::Analog, steady::analog(links, board.analog)?);
    levels.spawn(TaskId::Clamp, steady::clamp(links)?);
    levels.spawn(TaskId::Servos, steady::servos(links, board.servos)?);
    levels.spawn(TaskId::Position, steady::position(links)?);
    levels.spawn(TaskId::Arms, arms(links, board.arms)?);
    if <BarometerPort as Barometer>::FITTED {
        levels.spawn(TaskId::Barometer, barometer(links, board.barometer)?);
    }
    levels.spawn(TaskId::Telemetry, telemetry(links, board.telemetry)?);
    let checks = board.chip.checks;
    let port: &'static Port = USB_PORT.init_with(Port::new);
    let served: &'static Served = SERVED.init(Served::default());
    let (usb_input, usb_output) = port.console();
    let input = served.keyboards([
        OneOf::First(OneOf::First(board.console_input)),
        OneOf::First(OneOf::Second(usb_input)),
        OneOf::Second(SHELL.port()),
    ]);
    let output = served.screens([
        OneOf::First(OneOf::First(board.console_output)),
        OneOf::First(OneOf::Second(usb_output)),
        OneOf::Second(SHELL.port()),
    ]);
    levels.spawn_unmeasured(
        "console",
        console(links, input, output, board.storage, board.chip)?,
    );
    let (usb_input, usb_output) = port.mavlink();
    let lines = Lines {
        inputs: [OneOf::First(board.mavlink_input), OneOf::Second(usb_input)],
        outputs: [OneOf::First(board.mavlink_output), OneOf::Second(usb_output)],
        bytes_per_second: [
            sophie_boards::MAVLINK_BYTES_PER_SECOND,
            sophie_boards::USB_BYTES_PER_SECOND,
        ],
    };
    levels.spawn(
        TaskId::Mavlink,
        mavlink(links, lines, board.storage, board.chip, board.loaded.signing)?,
    );
    match board.usb.driver {
        Some(driver) => {
            let memory = USB_MEMORY.init_with(UsbMemory::new);
            levels.spawn_unmeasured("usb", usb(driver, memory, port, board.usb.identity)?);
        }
        None => defmt::warn!("USB: the core does not answer, or has no supply"),
    }
    levels.spawn_unmeasured("lights", lights(links, board.lights)?);
    levels.spawn_unmeasured("report", report(links, checks)?);
    #[cfg(feature = "trace")]
    levels.spawn_unmeasured("trace", super::trace::trace()?);
    Ok(())
}

#[embassy_executor::task]
async fn arms(links: &'static Links, port: sophie_boards::ArmsPort) -> ! {
    sophie_tasks::perching::arms::run(links, port).await
}

#[embassy_executor::task]
async fn barometer(links: &'static Links, port: BarometerPort) -> ! {
    sophie_tasks::navigation::barometer::run(links, port).await
}

#[embassy_executor::task]
async fn telemetry(links: &'static Links, port: sophie_boards::TelemetryLine) -> ! {
    sophie_tasks::pilot::telemetry::run(links, port).await
}

#[embassy_executor::task]
async fn console(
    links: &'static Links,
    input: ConsoleInput,
    output: ConsoleOutput,
    storage: StoragePort,
    chip: ThisChip,
) -> ! {
    sophie_tasks::console::run(links, input, output, storage, chip).await
}

#[embassy_executor::task]
async fn mavlink(
    links: &'static Links,
    lines: Lines<MavlinkInput, MavlinkOutput, 2>,
    storage: StoragePort,
    chip: ThisChip,
    signing: Stored,
) -> ! {
    sophie_tasks::ground_station::mavlink::run(links, lines, &SHELL, storage, chip, signing).await
}

#[embassy_executor::task]
async fn usb(
    driver: UsbDriver,
    memory: &'static mut UsbMemory<'static>,
    port: &'static Port,
    identity: Identity,
) -> ! {
    usb::run(driver, memory, port, identity).await
}

#[embassy_executor::task]
async fn lights(links: &'static Links, lights: sophie_boards::LightsPort) -> ! {
    super::lights::run(links, lights).await
}

#[embassy_executor::task]
async fn report(links: &'static Links, checks: &'static [ChipCheck]) -> ! {
    super::report::run(links, checks).await
}
