//! Every task is spawned here. Those of the background are static executor tasks here too, compiled for size; those of
//! the other levels are in `sophie_flight`, compiled for speed.

use embassy_executor::SpawnError;
use embassy_sync::mutex::Mutex;
use sophie_boards::Board;
use sophie_boards::retained::Memory;
use sophie_flight::tasks as flight;
use sophie_tasks::links::{Links, Raw};
use sophie_tasks::mavlink::Line;
use sophie_tasks::mavlink::signing::Stored;
use sophie_tasks::ports::{Look, Storage};
use sophie_tasks::schedule::TaskId;
use sophie_tasks::shared::SharedStorage;
use static_cell::StaticCell;

use super::Levels;

/// The parameters' storage, for console and MAVLink.
type StoragePort = SharedStorage<'static, sophie_boards::StoragePort>;

static STORAGE: StaticCell<Mutex<Raw, sophie_boards::StoragePort>> = StaticCell::new();

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
        flight::supervisor(links, board.watchdog, memory)?,
    );
    levels.spawn(TaskId::Commander, flight::commander(links)?);
    levels.spawn(TaskId::Rc, flight::rc(links, board.receiver)?);
    levels.spawn(TaskId::Analog, flight::analog(links, board.analog)?);
    levels.spawn(TaskId::Clamp, flight::clamp(links)?);
    levels.spawn(TaskId::Servos, flight::servos(links, board.servos)?);
    levels.spawn(TaskId::Position, flight::position(links)?);
    levels.spawn(TaskId::Arms, arms(links, board.arms)?);
    levels.spawn(TaskId::Telemetry, telemetry(links, board.telemetry)?);
    let looks = board.chip.looks;
    let (input, output) = (board.console_input, board.console_output);
    let defaults = board.storage.defaults();
    let storage: &'static _ = STORAGE.init(Mutex::new(board.storage));
    let storage = || SharedStorage::new(storage, defaults);
    levels.spawn_unmeasured("console", console(links, input, output, storage(), board.chip)?);
    levels.spawn(
        TaskId::Mavlink,
        mavlink(
            links,
            board.mavlink_input,
            board.mavlink_output,
            storage(),
            board.loaded.signing,
        )?,
    );
    levels.spawn_unmeasured("lights", lights(links, board.lights)?);
    levels.spawn_unmeasured("report", report(links, looks)?);
    #[cfg(feature = "trace")]
    levels.spawn_unmeasured("trace", super::trace::trace()?);
    Ok(())
}

#[embassy_executor::task]
async fn arms(links: &'static Links, port: sophie_boards::ArmsPort) -> ! {
    sophie_tasks::arms::run(links, port).await
}

#[embassy_executor::task]
async fn telemetry(links: &'static Links, port: sophie_boards::TelemetryLine) -> ! {
    sophie_tasks::telemetry::run(links, port).await
}

#[embassy_executor::task]
async fn console(
    links: &'static Links,
    input: sophie_boards::BufferedInput,
    output: sophie_boards::BufferedOutput,
    storage: StoragePort,
    chip: sophie_boards::ThisChip,
) -> ! {
    sophie_tasks::console::run(links, input, output, storage, chip).await
}

#[embassy_executor::task]
async fn mavlink(
    links: &'static Links,
    input: sophie_boards::BufferedInput,
    output: sophie_boards::BufferedOutput,
    storage: StoragePort,
    signing: Stored,
) -> ! {
    let line = Line {
        bytes_per_second: sophie_boards::MAVLINK_BYTES_PER_SECOND,
        signing,
    };
    sophie_tasks::mavlink::run(links, input, output, storage, || sophie_boards::restart(), line).await
}

#[embassy_executor::task]
async fn lights(links: &'static Links, lights: sophie_boards::LightsPort) -> ! {
    super::lights::run(links, lights).await
}

#[embassy_executor::task]
async fn report(links: &'static Links, looks: &'static [Look]) -> ! {
    super::report::run(links, looks).await
}
