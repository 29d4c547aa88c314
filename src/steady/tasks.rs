//! The wrappers of the tasks. The firmware spawns each once.

use sophie_boards::retained::Memory;
use sophie_drivers::ground_module::GroundModule;
use sophie_drivers::rc_decoder::Decoder;
use sophie_tasks::links::Links;

/// Pressure sensors and battery.
#[embassy_executor::task]
pub async fn analog(links: &'static Links, port: sophie_boards::AnalogPort) -> ! {
    sophie_tasks::perching::analog::run(links, port).await
}

/// Clamp loops.
#[embassy_executor::task]
pub async fn clamp(links: &'static Links) -> ! {
    sophie_tasks::perching::clamp::run(links).await
}

/// Servo output.
#[embassy_executor::task]
pub async fn servos(links: &'static Links, port: sophie_boards::ServosPort) -> ! {
    sophie_tasks::perching::servos::run(links, port).await
}

/// Receiver.
#[embassy_executor::task]
pub async fn rc(links: &'static Links, port: sophie_boards::ReceiverLine) -> ! {
    sophie_tasks::pilot::rc::run(links, port, Decoder::from_params(&links.params)).await
}

/// Module of optical flow and range.
#[embassy_executor::task]
pub async fn ground(links: &'static Links, port: sophie_boards::GroundLine) -> ! {
    sophie_tasks::navigation::flow_range::run(links, port, GroundModule::from_params(&links.params)).await
}

/// Mode logic.
#[embassy_executor::task]
pub async fn commander(links: &'static Links) -> ! {
    sophie_tasks::pilot::commander::run(links).await
}

/// Position estimate for the hold.
#[embassy_executor::task]
pub async fn position(links: &'static Links) -> ! {
    sophie_tasks::navigation::position::run(links).await
}

/// Deadline supervision and watchdog. Also stores the state that survives a reset.
#[embassy_executor::task]
pub async fn supervisor(links: &'static Links, port: sophie_boards::WatchdogPort, memory: Memory) -> ! {
    sophie_tasks::supervision::supervisor::run(links, port, memory).await
}
