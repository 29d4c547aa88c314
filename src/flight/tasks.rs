//! The wrappers of the tasks. The firmware spawns each once.

use sophie_control::allocation::mixer::Flexible;
use sophie_control::allocation::wrench::Configuration;
use sophie_control::arming::ArmingInhibit;
use sophie_tasks::links::Links;

/// Most attempts at the inertial sensor's self-test per start.
const SELF_TESTS: u8 = 3;

/// Inertial sensor.
///
/// `self_test` actuates it first (1.5 s): only while the vehicle must be at rest, never after a reset in flight. A
/// failed test is repeated, since it also fails while the vehicle is carried; the last result counts.
#[embassy_executor::task]
pub async fn imu(links: &'static Links, mut port: sophie_boards::ImuPort, self_test: bool) -> ! {
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
    sophie_tasks::flight::imu::run(links, port).await
}

/// Attitude estimator.
#[embassy_executor::task]
pub async fn estimator(links: &'static Links) {
    sophie_tasks::flight::estimator::run(links).await;
}

/// Attitude and rate control.
#[embassy_executor::task]
pub async fn control(links: &'static Links) {
    sophie_tasks::flight::control::run(links).await;
}

/// Allocation.
#[embassy_executor::task]
pub async fn mixer(links: &'static Links) {
    sophie_tasks::flight::mixer::run(links, |p| Flexible::new(Configuration::default(), p)).await;
}

/// Motor output.
#[embassy_executor::task]
pub async fn motors(links: &'static Links, port: sophie_boards::MotorsPort) {
    sophie_tasks::flight::motors::run(links, port).await;
}
