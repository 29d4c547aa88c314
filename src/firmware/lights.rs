//! Lights and buzzer on the vehicle. Background, 10 Hz.
//!
//! | state light | meaning |
//! |---|---|
//! | fast blinking | calibrating: leave the vehicle alone |
//! | short flash each second | disarmed |
//! | on | rotors may turn |
//! | double flash each second | on the pipe, rotors stopped |
//!
//! The fault light is on while arming is refused or the failsafe acts; the buzzer sounds in the failsafe and while the
//! vehicle leaves the pipe autonomously.

use embassy_time::{Duration, Ticker};
use sophie_control::mode::Mode;
use sophie_tasks::links::Links;

use sophie_boards::LightsPort;

/// Duration of a step; ten steps make a pattern.
const PERIOD: Duration = Duration::from_millis(100);

/// Ten steps, in order.
const FAST: [bool; 10] = [true, false, true, false, true, false, true, false, true, false];
const FLASH: [bool; 10] = [
    true, false, false, false, false, false, false, false, false, false,
];
const DOUBLE: [bool; 10] = [true, false, true, false, false, false, false, false, false, false];
const ON: [bool; 10] = [true; 10];

pub async fn run(links: &Links, mut lights: LightsPort) -> ! {
    let mut ticker = Ticker::every(PERIOD);
    loop {
        for step in 0..10 {
            let status = links.status.fresh();
            let pattern = match status.map(|s| s.mode) {
                None | Some(Mode::Calibrating) => FAST,
                Some(Mode::Disarmed) => FLASH,
                Some(Mode::Perched) => DOUBLE,
                Some(_) => ON,
            };
            // A missing commander is a fault.
            let fault = status.is_none_or(|s| s.reason.is_some());
            let acts = status.is_some_and(|s| matches!(s.mode, Mode::Failsafe | Mode::Escaping));
            let alarm = acts && DOUBLE[step];
            lights.show(pattern[step], fault, alarm);
            ticker.next().await;
        }
    }
}
