//! The tendon servos: forces asked for become pulses, and the tension that they can be giving is published.
//!
//! Steady level, at the servos' frame (`servo_frame_rate`, 50 to 333 Hz). Until the first force there are no pulses:
//! when power comes on on the pipe the gears hold, and nothing moves before the clamp loop knows what it wants. After a
//! restart the drives go on from the angles that the run before left. Forces older than
//! 200 ms hold the servos; so does a missing tilt (100 ms) for its arm, unless that arm is to be released.

use embassy_time::{Duration, Instant};
use sophie_control::grip_memory::GripMemory;
use sophie_control::tendon::{Drive, Reel, TendonDrive};

use crate::deadline::{FixedRate, TaskId};
use crate::links::Links;
use crate::ports::Servos;

/// Time between two frames of servos that take `hz` frames a second.
pub fn period(hz: f32) -> Duration {
    Duration::from_micros((1e6 / hz + 0.5) as u64)
}

/// Serves the servos; never returns.
pub async fn run(links: &Links, mut port: impl Servos) -> ! {
    let period = period(links.params.servo_frame_rate);
    let mut rate = FixedRate::new(links, TaskId::Servos, period, period);
    let reels = Reel::all(&links.params);
    let mut drives = [TendonDrive::new(); 4];
    // Kept arms are on gears alone: the angle of a servo without pulses is not known.
    let known = links
        .start
        .retained
        .filter(|w| !matches!(w.grip_memory, GripMemory::HeldByGears(_)));
    if let Some(retained) = known {
        for (drive, angle) in drives.iter_mut().zip(retained.angle) {
            *drive = drive.resume(angle);
        }
    }
    let mut told = false;
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
                if forces.found && !told {
                    for ((drive, reel), tilt) in drives.iter_mut().zip(&reels).zip(tilts) {
                        drive.seed_from_tilt(reel, tilt);
                    }
                }
                told = true;
                let asked = forces.force.into_iter().zip(forces.stay).zip(tilts);
                let arms = drives.iter_mut().zip(&reels).zip(output.iter_mut());
                for (((drive, reel), out), ((force, stay), tilt)) in arms.zip(asked) {
                    *out = if stay {
                        drive.hold_position(reel, tilt, tick.dt)
                    } else {
                        drive.step(reel, force, tilt, tick.dt)
                    };
                }
            }
            None => {
                for ((drive, reel), out) in drives.iter().zip(&reels).zip(output.iter_mut()) {
                    *out = drive.hold(reel);
                }
            }
        }
        port.write(output.map(|o| o.pulse_us)).await;
        let now = Instant::now();
        links.tension.send(now, output.map(|o| o.tension));
        links
            .reel_angle
            .send(now, drives.each_ref().map(TendonDrive::angle));
    }
}
