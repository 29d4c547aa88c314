//! Tests of a real board: `cargo xtask rig BOARD`. Wiring: `hil/README.md`.
//!
//! | test | what | jumper or part |
//! |---|---|---|
//! | [`t00_clock`] | core clock against the time base | none |
//! | [`t10_timers`] | periods, preemption by the urgent levels | none |
//! | [`t11_copies`] | copies of words, by length | none |
//! | [`t20_imu`] | identity, gravity, sample rate | none |
//! | [`t30_arms`] | each arm's BNO055 | four BNO055 |
//! | [`t40_analog`] | conversions, half the supply | divider of two equal resistors |
//! | [`t50_dshot`] | motor frames, bit by bit | motor 1 to servo 3 |
//! | [`t51_servo`] | servo pulses | servo 1 to servo 4 |
//! | [`t60_receiver`] | the receiver's line, both ways at once | its output to its input |
//! | [`t70_watchdog`] | watchdog reset and retained memory | none |
//! | [`t80_storage`] | a parameter outlives a reset | none |

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod t00_clock;
#[cfg(target_os = "none")]
mod t10_timers;
#[cfg(target_os = "none")]
mod t11_copies;
#[cfg(target_os = "none")]
mod t20_imu;
#[cfg(target_os = "none")]
mod t30_arms;
#[cfg(target_os = "none")]
mod t40_analog;
#[cfg(target_os = "none")]
mod t50_dshot;
#[cfg(target_os = "none")]
mod t51_servo;
#[cfg(target_os = "none")]
mod t60_receiver;
#[cfg(target_os = "none")]
mod t70_watchdog;
#[cfg(target_os = "none")]
mod t80_storage;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("these tests run on a board: cargo xtask rig BOARD");
}

/// Runs before every test and before the second half of one that a reset divides.
#[cfg(target_os = "none")]
#[embedded_test::setup]
fn setup() {
    use sophie_boards::ResetCause;
    use sophie_rig::resumable_test::{ResumableTest, begin};

    match begin() {
        (ResumableTest::Starving(us), ResetCause::Watchdog) => t70_watchdog::bitten(us),
        (ResumableTest::Stored(was), ResetCause::Software) => t80_storage::restarted(was),
        _ => {}
    }
}
