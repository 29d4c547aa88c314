//! The tasks as static, non-generic executor tasks on a board's ports. `sophie_tasks` has their code,
//! [`sophie_tasks::schedule`] their levels.

use embassy_executor::SpawnError;
use embassy_sync::mutex::Mutex;
use sophie_boards::Board;
use sophie_boards::retained::Memory;
use sophie_control::arming::ArmingInhibit;
use sophie_control::mixer::Flexible;
use sophie_control::wrench::Configuration;
use sophie_drivers::rc_decoder::Decoder;
use sophie_tasks::links::{Links, Raw};
use sophie_tasks::mavlink::Line;
use sophie_tasks::ports::{Look, Storage};
use sophie_tasks::schedule::TaskId;
use sophie_tasks::shared::SharedStorage;
use static_cell::StaticCell;

use super::Levels;

/// The parameters' storage, for console and MAVLink.
type StoragePort = SharedStorage<'static, sophie_boards::StoragePort>;

static STORAGE: StaticCell<Mutex<Raw, sophie_boards::StoragePort>> = StaticCell::new();

/// Most attempts at the inertial sensor's self-test per start.
const SELF_TESTS: u8 = 3;

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
    levels.spawn(TaskId::Motors, motors(links, board.motors)?);
    levels.spawn(TaskId::Mixer, mixer(links)?);
    levels.spawn(TaskId::Control, control(links)?);
    levels.spawn(TaskId::Estimator, estimator(links)?);
    levels.spawn(TaskId::Imu, imu(links, board.imu, self_test)?);
    levels.spawn(TaskId::Supervisor, supervisor(links, board.watchdog, memory)?);
    levels.spawn(TaskId::Commander, commander(links)?);
    levels.spawn(TaskId::Rc, rc(links, board.receiver)?);
    levels.spawn(TaskId::Analog, analog(links, board.analog)?);
    levels.spawn(TaskId::Clamp, clamp(links)?);
    levels.spawn(TaskId::Servos, servos(links, board.servos)?);
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
        mavlink(links, board.mavlink_input, board.mavlink_output, storage())?,
    );
    levels.spawn_unmeasured("lights", lights(links, board.lights)?);
    levels.spawn_unmeasured("report", report(links, looks)?);
    #[cfg(feature = "trace")]
    levels.spawn_unmeasured("trace", super::trace::trace()?);
    Ok(())
}

/// Inertial sensor.
///
/// `self_test` actuates it first (1.5 s): only where the vehicle must be at rest, never after a reset in flight. A
/// failed one is repeated, since a vehicle being carried also fails; the last verdict counts.
#[embassy_executor::task]
async fn imu(links: &'static Links, mut port: sophie_boards::ImuPort, self_test: bool) -> ! {
    for _ in 0..if self_test { SELF_TESTS } else { 0 } {
        let result = port.self_test().await;
        links.report(ArmingInhibit::ImuSelfTest, result.is_err());
        match result {
            Ok(_) => {
                defmt::info!("imu: self-test passed");
                break;
            }
            Err(fault) => defmt::error!("imu: {=str} ({})", fault.what(), fault),
        }
    }
    sophie_tasks::imu::run(links, port).await
}

#[embassy_executor::task]
async fn estimator(links: &'static Links) {
    sophie_tasks::estimator::run(links).await;
}

#[embassy_executor::task]
async fn control(links: &'static Links) {
    sophie_tasks::control::run(links).await;
}

#[embassy_executor::task]
async fn mixer(links: &'static Links) {
    sophie_tasks::mixer::run(links, |p| Flexible::new(Configuration::default(), p)).await;
}

#[embassy_executor::task]
async fn motors(links: &'static Links, port: sophie_boards::MotorsPort) {
    sophie_tasks::motors::run(links, port).await;
}

#[embassy_executor::task]
async fn analog(links: &'static Links, port: sophie_boards::AnalogPort) -> ! {
    sophie_tasks::analog::run(links, port).await
}

#[embassy_executor::task]
async fn clamp(links: &'static Links) -> ! {
    sophie_tasks::clamp::run(links).await
}

#[embassy_executor::task]
async fn servos(links: &'static Links, port: sophie_boards::ServosPort) -> ! {
    sophie_tasks::servos::run(links, port).await
}

#[embassy_executor::task]
async fn rc(links: &'static Links, port: sophie_boards::ReceiverLine) -> ! {
    sophie_tasks::rc::run(links, port, Decoder::from_params(&links.params)).await
}

#[embassy_executor::task]
async fn commander(links: &'static Links) -> ! {
    sophie_tasks::commander::run(links).await
}

/// Also keeps the state that outlives a reset.
#[embassy_executor::task]
async fn supervisor(links: &'static Links, port: sophie_boards::WatchdogPort, memory: Memory) -> ! {
    sophie_tasks::supervisor::run(links, port, memory).await
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
) -> ! {
    let line = Line {
        bytes_per_second: sophie_boards::MAVLINK_BYTES_PER_SECOND,
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
