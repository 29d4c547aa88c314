//! The tasks as the executors want them: static, not generic. What they do is in `sophie_tasks`.

use sophie_control::mixer::Variant;
use sophie_control::wrench::Configuration;
use sophie_tasks::links::Links;

use crate::board;
use crate::board::cortex_m::retained::Memory;
use crate::board::stm32::Lights;

/// Flight level: inertial sensor.
///
/// `self_test` actuates it first (1.5 s): only where the vehicle must be at rest, never after a reset in flight.
#[embassy_executor::task]
pub async fn imu(links: &'static Links, mut port: board::ImuPort, self_test: bool) -> ! {
    if self_test {
        match port.self_test().await {
            Ok(_) => defmt::info!("imu: self-test passed"),
            Err(fault) => defmt::error!("imu: {=str} ({})", fault.what(), fault),
        }
    }
    sophie_tasks::imu::run(links, port).await
}

/// Flight level: attitude.
#[embassy_executor::task]
pub async fn estimator(links: &'static Links) {
    sophie_tasks::estimator::run(links).await;
}

/// Flight level: attitude and rate control.
#[embassy_executor::task]
pub async fn control(links: &'static Links) {
    sophie_tasks::control::run(links).await;
}

/// Flight level: allocation.
#[embassy_executor::task]
pub async fn mixer(links: &'static Links) {
    sophie_tasks::mixer::run(links, Variant::default(), Configuration::default()).await;
}

/// Flight level: motors.
#[embassy_executor::task]
pub async fn motors(links: &'static Links, port: board::MotorsPort) {
    sophie_tasks::motors::run(links, port).await;
}

/// Steady level: pressure sensors and battery.
#[embassy_executor::task]
pub async fn analog(links: &'static Links, port: board::AnalogPort) -> ! {
    sophie_tasks::analog::run(links, port).await
}

/// Steady level: clamp loops.
#[embassy_executor::task]
pub async fn clamp(links: &'static Links) -> ! {
    sophie_tasks::clamp::run(links).await
}

/// Steady level: tendon servos.
#[embassy_executor::task]
pub async fn servos(links: &'static Links, port: board::ServosPort) -> ! {
    sophie_tasks::servos::run(links, port).await
}

/// Steady level: receiver.
#[embassy_executor::task]
pub async fn rc(links: &'static Links, port: board::ReceiverPort) -> ! {
    sophie_tasks::rc::run(links, port).await
}

/// Steady level: mode logic.
#[embassy_executor::task]
pub async fn commander(links: &'static Links) -> ! {
    sophie_tasks::commander::run(links).await
}

/// Steady level: supervision, watchdog, and what outlives it.
#[embassy_executor::task]
pub async fn supervisor(links: &'static Links, port: board::WatchdogPort, memory: Memory) -> ! {
    sophie_tasks::supervisor::run(links, port, memory).await
}

/// Background: arm sensors.
#[embassy_executor::task]
pub async fn arms(links: &'static Links, port: board::ArmsPort) -> ! {
    sophie_tasks::arms::run(links, port).await
}

/// Background: telemetry to the pilot.
#[embassy_executor::task]
pub async fn telemetry(links: &'static Links, port: board::TelemetryPort) -> ! {
    sophie_tasks::telemetry::run(links, port).await
}

/// Background: lights and buzzer.
#[embassy_executor::task]
pub async fn lights(links: &'static Links, lights: Lights) -> ! {
    super::lights::run(links, lights).await
}

/// Background: the log.
#[embassy_executor::task]
pub async fn report(links: &'static Links) -> ! {
    super::report::run(links).await
}
