//! The tendon servos: forces asked for become pulses, and the tension that they can be giving is told.
//!
//! Steady level, at the servos' frame (`servo_frame_rate`, 50 to 333 Hz). Until the first force there are no pulses: after a reset on
//! the pipe the gears hold, and nothing moves before the clamp loop knows what it wants. Forces older than
//! 200 ms hold the servos; so does a missing tilt (100 ms) for its arm, unless that arm is to be released.

use embassy_time::{Duration, Instant};
use sophie_control::tendon::{Drive, Reel, TendonDrive};

use crate::deadline::{FixedRate, TaskId};
use crate::links::Links;
use crate::ports::Servos;

/// Time between two frames of servos that take `hz` frames a second.
pub fn period(hz: f32) -> Duration {
    Duration::from_micros((1e6 / hz + 0.5) as u64)
}

/// Serves the servos for ever.
pub async fn run(links: &Links, mut port: impl Servos) -> ! {
    let period = period(links.params.servo_frame_rate);
    let mut rate = FixedRate::new(links, TaskId::Servos, period, period);
    let reels = Reel::all(&links.params);
    let mut drives = [TendonDrive::new(); 4];
    loop {
        let tick = rate.next().await;
        if links.tendons.latest().is_none() {
            port.write([0.0; 4]).await;
            continue;
        }
        let forces = links.tendons.fresh();
        let tilts = links.arms.fresh().unwrap_or_default().tilt;
        let mut output = [Drive::default(); 4];
        match forces {
            Some(forces) => {
                let asked = forces.force.into_iter().zip(tilts);
                let arms = drives.iter_mut().zip(&reels).zip(output.iter_mut());
                for (((drive, reel), out), (force, tilt)) in arms.zip(asked) {
                    *out = drive.step(reel, force, tilt, tick.dt);
                }
            }
            None => {
                for ((drive, reel), out) in drives.iter().zip(&reels).zip(output.iter_mut()) {
                    *out = drive.hold(reel);
                }
            }
        }
        port.write(output.map(|o| o.pulse_us)).await;
        links.tension.send(Instant::now(), output.map(|o| o.tension));
    }
}
