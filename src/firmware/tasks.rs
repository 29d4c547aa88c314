//! Every task is spawned here. Those of the background are static executor tasks here too, compiled for size; those of
//! the other levels are in [`sophie_flight`], compiled for speed.

use embassy_executor::SpawnError;
use sophie_boards::Board;
use sophie_boards::retained::Memory;
use sophie_flight::tasks as flight;
use sophie_tasks::links::Links;
use sophie_tasks::ports::Look;
use sophie_tasks::schedule::TaskId;

use super::Levels;

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
    levels.spawn(TaskId::Arms, arms(links, board.arms)?);
    levels.spawn(TaskId::Telemetry, telemetry(links, board.telemetry)?);
    let looks = board.chip.looks;
    let (input, output) = (board.console_input, board.console_output);
    levels.spawn_unmeasured(
        "console",
        console(links, input, output, board.storage, board.chip)?,
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
    input: sophie_boards::ConsoleInput,
    output: sophie_boards::ConsoleOutput,
    storage: sophie_boards::StoragePort,
    chip: sophie_boards::ThisChip,
) -> ! {
    sophie_tasks::console::run(links, input, output, storage, chip).await
}

#[embassy_executor::task]
async fn lights(links: &'static Links, lights: sophie_boards::LightsPort) -> ! {
    super::lights::run(links, lights).await
}

#[embassy_executor::task]
async fn report(links: &'static Links, looks: &'static [Look]) -> ! {
    super::report::run(links, looks).await
}
