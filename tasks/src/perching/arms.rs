//! Reads the arms' inertial sensors at 100 Hz: tilt of each arm against the body.
//!
//! Runs in the background: the sensors stretch the I2C clock, and no flight task waits for them. A round of four that
//! overruns its period skips the next ones: 1.7 ms at 400 kHz and 7.0 ms at 100 kHz fit; sensors that hold the clock
//! for 180 us after each byte are read at 64 Hz (15.5 ms) and 48 Hz (20.7 ms). A sensor silent for a second inhibits
//! arming; the others are still read. Each tilt is stamped with its own request.

use embassy_time::{Duration, Instant, with_timeout};
use sophie_control::allocation::wrench::{PerArm, SIDE};
use sophie_control::arming::ArmingInhibit;
use sophie_control::calibration::ArmFit;
use sophie_control::maths::scalar;
use sophie_control::maths::vector::{Quat, Vec3};

use crate::deadline::FixedRate;
use crate::links::Links;
use crate::links::link::Stamped;
use crate::links::messages::ArmAngles;
use crate::schedule::TaskId;
use crate::supervision::silence::SilenceWatch;
use sophie_ports::sensors::ArmImus;

/// Time without a reading before a report.
pub const SILENCE: Duration = Duration::from_secs(1);
/// Time from power-up before silence is reported. A BNO055 answers after 650 ms; its driver finds it by 1.3 s, then
/// resets and configures it in 0.77 s.
pub const START: Duration = Duration::from_millis(2500);
/// Limit of one reading, a transfer of at most 6 ms, or of a step of its set-up, 34 bytes.
const READING: Duration = Duration::from_millis(20);
const REASONS: PerArm<ArmingInhibit> = [
    ArmingInhibit::ArmSensor1,
    ArmingInhibit::ArmSensor2,
    ArmingInhibit::ArmSensor3,
    ArmingInhibit::ArmSensor4,
];

/// Reads the arm sensors; never returns. A failing sensor leaves `None` for its arm.
pub async fn run(links: &Links, mut port: impl ArmImus) -> ! {
    let mut rate = FixedRate::of(links, TaskId::Arms);
    let start = Instant::now() + START - SILENCE;
    let fits: PerArm<ArmFit> = core::array::from_fn(|arm| ArmFit::of(&links.params, arm));
    let mut watches = REASONS.map(|reason| SilenceWatch::new(reason, SILENCE, start));
    loop {
        let round = rate.next().await;
        let mut gravity: PerArm<Option<Stamped<Vec3>>> = [None; 4];
        for (arm, (g, watch)) in gravity.iter_mut().zip(&mut watches).enumerate() {
            let at = Instant::now();
            let reading = with_timeout(READING, port.gravity(arm)).await;
            let reading = reading.ok().and_then(Result::ok).filter(plausible);
            let now = Instant::now();
            match reading {
                Some(_) => watch.heard(links, now),
                None => watch.look(links, now),
            }
            *g = reading.map(|value| Stamped { at, value });
        }
        let Some(body) = links.attitude.fresh().filter(|a| a.calibrated) else {
            continue;
        };
        let mut tilt = [None; 4];
        for (((tilt, gravity), side), fit) in tilt.iter_mut().zip(&gravity).zip(&SIDE).zip(&fits) {
            *tilt = gravity.and_then(|Stamped { at, value }| {
                let shown = arm_tilt(body.q, value, *side)?;
                let value = fit.tilt(shown);
                Some(Stamped { at, value })
            });
        }
        let angles = ArmAngles { tilt };
        links.arms.send(angles.oldest().unwrap_or(round.started), angles);
    }
}

fn plausible(gravity: &Vec3) -> bool {
    gravity.is_finite() && (5.0..15.0).contains(&gravity.norm())
}

/// Tilt (rad, tip up) of an arm on side `side` that measures `gravity` (m/s², its axes) on a body at `q`; `None` if
/// that cannot be gravity.
///
/// A left arm whose tip rises turns about +x, a right arm about -x: the angle between the gravity directions in the y-z
/// plane.
fn arm_tilt(q: Quat, gravity: Vec3, side: f32) -> Option<f32> {
    /// Least share of gravity in the y-z plane for a valid direction.
    const LEAST: f32 = 0.3;
    let body = q.down_in_body();
    let planar = |v: Vec3, length: f32| v.y * v.y + v.z * v.z > (LEAST * length) * (LEAST * length);
    if !plausible(&gravity) || !planar(gravity, gravity.norm()) || !planar(body, 1.0) {
        return None;
    }
    // The arm's view of (y, z) is the body's turned back by the turn about x.
    let turn = scalar::atan2(gravity.y, gravity.z) - scalar::atan2(body.y, body.z);
    Some(scalar::wrap_pi(turn) * side)
}

#[cfg(test)]
mod tests {
    use sophie_control::maths::scalar::{GRAVITY, deg};

    use super::*;

    /// Reading of a sensor on an arm tilted by `tilt`, on a body at `q`.
    fn seen(q: Quat, tilt: f32, side: f32) -> Vec3 {
        let arm = Quat::from_euler(side * tilt, 0.0, 0.0);
        (q * arm).rotate_inverse(Vec3::new(0.0, 0.0, GRAVITY))
    }

    #[test]
    fn tilt_is_found_on_both_sides_whatever_the_attitude() {
        for side in [1.0, -1.0] {
            for tilt in [-90.0f32, -64.0, -26.0, 0.0, 11.0, 30.0].map(deg) {
                for (roll, pitch) in [(0.0, 0.0), (0.3, 0.0), (-0.4, 0.2), (0.1, -0.3)] {
                    let q = Quat::from_euler(roll, pitch, 0.7);
                    let got = arm_tilt(q, seen(q, tilt, side), side).unwrap();
                    // Pitch couples into the planar angle by less than 1 - cos(pitch); micromath adds its error.
                    assert!((got - tilt).abs() < 0.015, "{side} {tilt} {roll} {pitch}: {got}");
                }
            }
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let q = Quat::IDENTITY;
        for bad in [
            Vec3::ZERO,
            Vec3::new(f32::NAN, 0.0, 9.8),
            Vec3::new(0.0, 0.0, 30.0),
            Vec3::new(9.8, 0.0, 0.5),
        ] {
            assert!(arm_tilt(q, bad, 1.0).is_none());
        }
    }
}
