//! From a tendon's force to the pulse of the servo that winds it, and back to the force that it can give.
//!
//! The reel must take up what the arm's tilt gives away, h (α_ref - α), and then stretch the tendon by F/k.
//! The tilt comes late and noisy from the arm's own sensor, and feeding it to the reel is a positive feedback
//! (a tighter tendon bends the arm, which asks for more reel), so it is low-passed well below the arm's
//! bending mode. What that lag hides is reported by the tension observer, which extrapolates over it.

use crate::filter::LowPass;
use crate::math;
use crate::params::Params;
use crate::wrench::PerArm;

/// Release and full pulse of a servo lie between these, µs: the usual 500 to 2500 with room for a trim.
pub const PULSES_US: (f32, f32) = (550.0, 2450.0);
/// Least distance of the full pulse from the release pulse, µs: less is no servo's travel.
pub const SPAN_MIN_US: f32 = 200.0;
/// Tilt at which the tendon of a servo at release is just taut, rad: 23°, beyond what flight reaches, so that
/// a flying arm never pulls on it (built so; assumed).
pub const REFERENCE_TILT: f32 = 0.4;
/// Largest trim of a servo, µs.
pub const TRIM_MAX_US: f32 = 50.0;
/// Tension (N) that is reported at least until the servo is back at its release position.
pub const RESIDUE: f32 = 0.5;

/// Share of the stall torque that a servo is trusted to give: near stall it neither moves nor cools.
const STALL_SHARE: f32 = 0.85;
/// Share of the servo's speed that is asked of it, so that the commanded angle is the true one.
const SLEW_SHARE: f32 = 0.9;
/// Largest error of the tilt of an arm at rest, rad: half a degree of the sensor's mounting, 4 mrad of the attitude that
/// it is measured against and of noise behind the filters.
const TILT_ERROR: f32 = 0.0127;
/// Largest error of a servo's angle at rest, rad: its dead band of 2 µs in a travel of 1900 µs for 270°.
const SERVO_ERROR: f32 = 0.005;
/// Share of the force limit that is asked for at least: tendons so stiff that less were left have no known force.
const LEAST_SHARE: f32 = 0.5;
/// Speed of paying out on release, rad/s: half the servo's, the arms spring back gently.
const PAY_OUT: f32 = 3.0;
/// Cut-off of each of the two low passes on the tilt, rad/s: a loop gain below 1 at the taut arm's mode
/// (8 Hz, Q about 5) with the static gain k h² / (k h² + arm) of 0.7 to 0.85.
pub const TILT_CUTOFF: f32 = 25.0;
/// The same while the arm stands still, rad/s: a sensor noise of 4 mrad would else move the grip by 30 Pa.
const STILL_CUTOFF: f32 = 5.0;
/// Distance of the tilt from its filter from which the arm counts as moving, rad.
const MOVING: f32 = 0.04;
/// Age of the tilt when the servo's task takes it, s: sensor 20 ms, half of the arms' period of 10 ms.
const TILT_AGE: f32 = 0.025;
/// Angles beyond this are no servo's, rad.
const ANGLE_MAX: f32 = 6.5;
/// Tilts beyond this are not an arm's, rad.
const TILT_MAX: f32 = 2.5;

/// Largest force on a tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceLimit {
    /// Force along the tendon that is never passed, N.
    pub force: f32,
    /// Force that the clamp loop may ask for, N: what is asked is wound by the arm's measured tilt, so the tendon
    /// has more by what that is wrong.
    pub asked: f32,
    /// The servo cannot give the torque that the parameters allow (`servo_torque_max`): its stall torque
    /// limits the force. To be reported at start-up.
    pub capped_by_servo: bool,
}

impl ForceLimit {
    /// The limit by the parameters.
    pub fn from_params(p: &Params) -> Self {
        let servo = STALL_SHARE * p.servo_stall;
        let capped_by_servo = servo < p.servo_torque_max;
        let torque = if capped_by_servo {
            servo
        } else {
            p.servo_torque_max
        };
        let force = math::clamp(torque / p.reel_radius, 0.0, 1e4);
        let wrong = p.tendon_stiffness * (p.tendon_lever * TILT_ERROR + p.reel_radius * SERVO_ERROR);
        Self {
            force,
            asked: math::clamp(force - wrong, LEAST_SHARE * force, force),
            capped_by_servo,
        }
    }
}

/// Reel, tendon and servo of one arm as the parameters describe them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reel {
    radius: f32,
    lever: f32,
    stiffness: f32,
    stall: f32,
    slew: f32,
    range: f32,
    release_us: f32,
    /// From the release to the full pulse, µs; negative for a mirrored servo.
    span_us: f32,
    /// Age of the tilt by the time that the pulse acts, s.
    tilt_age: f32,
    limit: ForceLimit,
}

impl Reel {
    /// The parts of arm `servo` (0..=3) that the parameters describe.
    ///
    /// A full pulse nearer to the release pulse than [`SPAN_MIN_US`] is taken to be that far from it, on the side
    /// that it is on, or on that of the greater room: no parameters make a travel of nothing.
    pub fn from_params(p: &Params, servo: usize) -> Self {
        let [trim, release, full, slew] = match servo {
            0 => [p.servo_trim_1, p.servo_release_1, p.servo_full_1, p.servo_slew_1],
            1 => [p.servo_trim_2, p.servo_release_2, p.servo_full_2, p.servo_slew_2],
            2 => [p.servo_trim_3, p.servo_release_3, p.servo_full_3, p.servo_slew_3],
            _ => [p.servo_trim_4, p.servo_release_4, p.servo_full_4, p.servo_slew_4],
        };
        let (low, high) = PULSES_US;
        let release = math::clamp(release, low, high);
        let full = apart(release, math::clamp(full, low, high));
        Self {
            radius: p.reel_radius,
            lever: p.tendon_lever,
            stiffness: p.tendon_stiffness,
            stall: p.servo_stall,
            slew,
            range: p.servo_range,
            release_us: release + math::clamp(trim, -TRIM_MAX_US, TRIM_MAX_US),
            span_us: full - release,
            // Half of a frame until the task runs, half of one until the servo has moved.
            tilt_age: TILT_AGE + 1.0 / p.servo_frame_rate,
            limit: ForceLimit::from_params(p),
        }
    }

    /// Those of all four arms.
    pub fn all(p: &Params) -> PerArm<Self> {
        [0, 1, 2, 3].map(|servo| Self::from_params(p, servo))
    }

    /// Angle of the servo (rad from release) that gives the force `force` (N) at the tilt `tilt` (rad),
    /// within its travel.
    pub fn angle(&self, force: f32, tilt: f32) -> f32 {
        let take_up = self.lever * (REFERENCE_TILT - tilt) + force / self.stiffness;
        math::clamp(take_up / self.radius, 0.0, self.range)
    }

    /// Force (N, >= 0) of a tendon on a servo at `angle` (rad) with the arm at `tilt` (rad).
    pub fn force(&self, angle: f32, tilt: f32) -> f32 {
        let stretch = self.radius * angle - self.lever * (REFERENCE_TILT - tilt);
        math::clamp(self.stiffness * stretch, 0.0, f32::MAX)
    }

    /// Pulse width (µs, trim included) for the servo at `angle` (rad from release).
    pub fn pulse(&self, angle: f32) -> f32 {
        self.release_us + self.span_us * math::clamp(angle / self.range, 0.0, 1.0)
    }

    /// Angle (rad from release) that the pulse `pulse_us` (µs) asks for: what the servo makes of it, and
    /// [`Reel::pulse`] undone.
    pub fn angle_of(&self, pulse_us: f32) -> f32 {
        (pulse_us - self.release_us) / self.span_us * self.range
    }

    /// Speed (rad/s) that the servo has against the force `force` (N).
    fn speed(&self, force: f32) -> f32 {
        let load = math::clamp(force * self.radius / self.stall, 0.0, 1.0);
        SLEW_SHARE * self.slew * (1.0 - load)
    }
}

/// The full pulse, at least [`SPAN_MIN_US`] from the release pulse, µs.
fn apart(release: f32, full: f32) -> f32 {
    let (low, high) = PULSES_US;
    let span = full - release;
    if span.abs() >= SPAN_MIN_US {
        return full;
    }
    let (room_above, room_below) = (high - release, release - low);
    let above = if span > 0.0 {
        room_above >= SPAN_MIN_US
    } else if span < 0.0 {
        room_below < SPAN_MIN_US
    } else {
        room_above >= room_below
    };
    release + if above { SPAN_MIN_US } else { -SPAN_MIN_US }
}

/// What the drive of one tendon puts out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive {
    /// Pulse width, µs.
    pub pulse_us: f32,
    /// Tension that the servo can be giving now, N; 0 only once it is back at its release position.
    pub tension: f32,
    /// The servo was held because the tilt is missing.
    pub held: bool,
}

/// The drive of one tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonDrive {
    angle: f32,
    tilt: Option<(LowPass, LowPass)>,
    /// Cut-off of both at the last step, rad/s.
    cutoff: f32,
}

impl Default for TendonDrive {
    fn default() -> Self {
        Self::new()
    }
}

impl TendonDrive {
    /// A drive at its release position.
    pub const fn new() -> Self {
        Self {
            angle: 0.0,
            tilt: None,
            cutoff: TILT_CUTOFF,
        }
    }

    /// The same drive, its servo at `angle` (rad from release), where the run before left it.
    pub fn resume(self, angle: f32) -> Self {
        Self {
            angle: math::clamp(angle, 0.0, ANGLE_MAX),
            ..self
        }
    }

    /// Takes the servo to stand where its tendon is just taut at the tilt `tilt` (rad; `None`: at release). For a
    /// tendon that was found wound and is to be paid out: from there on it goes at the drive's speed, not the servo's.
    pub fn find(&mut self, reel: &Reel, tilt: Option<f32>) {
        self.angle = tilt
            .filter(|t| t.abs() <= TILT_MAX)
            .map_or(0.0, |tilt| reel.angle(0.0, tilt));
    }

    /// Angle to which the servo is sent, rad from release.
    pub fn angle(&self) -> f32 {
        self.angle
    }

    /// One step of `dt` s towards `force` N (0, or anything that is no number: pay out to the release
    /// position) with the arm's measured tilt (rad).
    ///
    /// Without a tilt the servo is held where it is, unless it is to pay out, which needs none.
    pub fn step(&mut self, reel: &Reel, force: f32, tilt: Option<f32>, dt: f32) -> Drive {
        let dt = math::clamp(dt, 0.0, 0.2);
        let force = math::clamp(force, 0.0, reel.limit.asked);
        let tilt = tilt.filter(|t| t.abs() <= TILT_MAX);
        self.see(tilt, dt);
        let pays_out = force <= 0.0;
        let held = !pays_out && tilt.is_none();
        if pays_out {
            self.angle = math::slew(self.angle, 0.0, PAY_OUT * dt);
        } else if let Some((_, filtered)) = self.tilt.filter(|_| !held) {
            let target = reel.angle(force, filtered.value());
            let speed = if target > self.angle {
                reel.speed(self.tension(reel))
            } else {
                reel.speed(0.0)
            };
            self.angle = math::slew(self.angle, target, speed * dt);
        }
        self.output(reel, held)
    }

    /// One step of `dt` s that leaves the servo where it is and only looks at the tilt (rad).
    pub fn stay(&mut self, reel: &Reel, tilt: Option<f32>, dt: f32) -> Drive {
        self.see(tilt.filter(|t| t.abs() <= TILT_MAX), math::clamp(dt, 0.0, 0.2));
        self.output(reel, true)
    }

    fn see(&mut self, tilt: Option<f32>, dt: f32) {
        let Some(tilt) = tilt else {
            return;
        };
        let (first, second) = self.tilt.get_or_insert((LowPass::at(tilt), LowPass::at(tilt)));
        let moving = math::clamp((tilt - second.value()).abs() / MOVING, 0.0, 1.0);
        self.cutoff = STILL_CUTOFF + (TILT_CUTOFF - STILL_CUTOFF) * moving;
        let once = first.step(tilt, self.cutoff, dt);
        second.step(once, self.cutoff, dt);
    }

    /// The output without a step: for when there is no order at all.
    pub fn hold(&self, reel: &Reel) -> Drive {
        self.output(reel, true)
    }

    fn output(&self, reel: &Reel, held: bool) -> Drive {
        let wound = self.angle > 1e-3;
        let tension = self.tension(reel);
        Drive {
            pulse_us: reel.pulse(self.angle),
            tension: if wound {
                math::clamp(tension, RESIDUE, f32::MAX)
            } else {
                0.0
            },
            held,
        }
    }

    /// Tension at the present tilt: the filtered one extrapolated over its lag and age, exact for a tilt
    /// that moves evenly. The first filter leads the second by one lag.
    fn tension(&self, reel: &Reel) -> f32 {
        self.tilt.map_or(0.0, |(first, second)| {
            let per_lag = first.value() - second.value();
            let now = second.value() + per_lag * (2.0 + reel.tilt_age * self.cutoff);
            reel.force(self.angle, math::clamp_abs(now, TILT_MAX))
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn params() -> Params {
        Params {
            reel_radius: 0.015,
            tendon_lever: 0.025,
            tendon_stiffness: 8000.0,
            servo_range: 4.71,
            servo_slew_1: 6.16,
            servo_stall: 3.432,
            servo_torque_max: 2.452,
            ..Params::default()
        }
    }

    fn close(a: f32, b: f32, tolerance: f32) -> bool {
        (a - b).abs() <= tolerance
    }

    #[test]
    fn a_tilt_that_is_wrong_leaves_the_force_within_the_limit() {
        let p = params();
        let limit = ForceLimit::from_params(&p);
        // 2.452 N m on 15 mm are 163.47 N; 8000 N/m over 25 mm · 12.7 mrad and 15 mm · 5 mrad are 3.14 N.
        assert!(
            close(limit.force, 163.467, 1e-2) && close(limit.asked, 160.327, 1e-2),
            "{limit:?}"
        );
        let reel = Reel::from_params(&p, 0);
        let (tilt, mounting) = (-1.2, math::deg(0.5));
        let mut drive = TendonDrive::new();
        for _ in 0..400 {
            drive.step(&reel, 1e4, Some(tilt - mounting), 0.02);
        }
        let force = reel.force(drive.angle(), tilt);
        assert!((limit.asked..limit.force).contains(&force), "{force}");
        // A stiff tendon keeps half.
        let stiff = ForceLimit::from_params(&Params {
            tendon_stiffness: 1e5,
            servo_torque_max: 0.5,
            ..p
        });
        assert!(close(stiff.asked, 0.5 * stiff.force, 1e-3), "{stiff:?}");
    }

    #[test]
    fn the_reel_by_hand() {
        let reel = Reel::from_params(&params(), 0);
        // 0.025·(0.4 + 1.0) = 35 mm, 80 N stretch 10 mm: 45 mm on 15 mm are 3 rad.
        assert!(close(reel.angle(80.0, -1.0), 3.0, 1e-4));
        assert!(close(reel.force(3.0, -1.0), 80.0, 0.01));
        // 3/4.71 of 1900 µs above 550 µs.
        assert!(close(reel.pulse(3.0), 1760.2, 0.1));
        // A drooping arm is slack, and so is one in flight up to the reference.
        assert!(reel.force(0.0, -0.46) == 0.0 && reel.force(0.0, 0.39) == 0.0);
        assert!(reel.force(0.0, 0.41) > 0.0);
        // Never beyond the travel.
        assert!(close(reel.angle(160.0, -2.5), 4.71, 1e-6));
    }

    #[test]
    fn each_servo_has_its_own_pulses_trim_and_slew() {
        let p = Params {
            servo_trim_2: -20.0,
            servo_release_3: 2300.0,
            servo_full_3: 700.0,
            servo_trim_3: 10.0,
            servo_slew_4: 3.0,
            ..params()
        };
        let [one, two, mirrored, slow] = Reel::all(&p);
        assert!(close(one.pulse(0.0), 550.0, 1e-3) && close(one.pulse(4.71), 2450.0, 1e-3));
        assert!(close(two.pulse(0.0), 530.0, 1e-3) && close(two.pulse(4.71), 2430.0, 1e-3));
        assert!(close(mirrored.pulse(0.0), 2310.0, 1e-3) && close(mirrored.pulse(4.71), 710.0, 1e-3));
        // Half the travel is half the span, whichever way round.
        assert!(close(mirrored.pulse(2.355), 1510.0, 1e-3));
        assert!(close(slow.speed(0.0), 2.7, 1e-5) && close(one.speed(0.0), 5.544, 1e-5));
    }

    #[test]
    fn a_travel_of_nothing_cannot_be_configured() {
        for (release, full, taken) in [
            (550.0, 550.0, 750.0),
            (2450.0, 2450.0, 2250.0),
            (1600.0, 1600.0, 1400.0),
            (1500.0, 1510.0, 1700.0),
            (1500.0, 1490.0, 1300.0),
            // No room on the side that it is on.
            (2440.0, 2450.0, 2240.0),
            (560.0, 550.0, 760.0),
        ] {
            let p = Params {
                servo_release_1: release,
                servo_full_1: full,
                ..params()
            };
            let reel = Reel::from_params(&p, 0);
            assert!(close(reel.pulse(0.0), release, 1e-3), "{release} {full}");
            assert!(
                close(reel.pulse(4.71), taken, 1e-3),
                "{release} {full}: {}",
                reel.pulse(4.71)
            );
        }
    }

    #[test]
    fn a_weak_servo_caps_the_force_and_says_so() {
        let paper = ForceLimit::from_params(&params());
        assert!(!paper.capped_by_servo && close(paper.force, 2.452 / 0.015, 1e-3));
        // 0.85·0.922 N·m on 15 mm.
        let weak = ForceLimit::from_params(&Params {
            servo_stall: 0.922,
            ..params()
        });
        assert!(weak.capped_by_servo && close(weak.force, 52.25, 0.01));
    }

    #[test]
    fn the_drive_settles_on_the_force_within_the_servo_s_speed() {
        let reel = Reel::from_params(&params(), 0);
        let mut drive = TendonDrive::new();
        let mut last = drive.hold(&reel).pulse_us;
        let per_rad = (2450.0 - 550.0) / 4.71;
        let mut output = Drive::default();
        for _ in 0..100 {
            output = drive.step(&reel, 60.0, Some(-0.8), 0.02);
            assert!((output.pulse_us - last).abs() <= 6.16 * 0.02 * per_rad + 1e-2);
            last = output.pulse_us;
        }
        assert!(close(output.tension, 60.0, 0.1) && !output.held);
        // 25 mm·1.2 + 7.5 mm = 37.5 mm: 2.5 rad.
        assert!(close(output.pulse_us, 550.0 + 2.5 * per_rad, 0.1));
    }

    #[test]
    fn the_observer_sees_through_the_lag_of_a_moving_arm() {
        let reel = Reel::from_params(&params(), 0);
        let mut drive = TendonDrive::new();
        let mut output = Drive::default();
        for i in 0..100 {
            // The arm falls at 0.5 rad/s; the sensor shows where it was 45 ms before.
            let now = -0.2 - 0.5 * 0.02 * i as f32;
            output = drive.step(&reel, 60.0, Some(now + 0.5 * 0.045), 0.02);
        }
        // Lag 2/25 s and age 0.045 s at 0.5 rad/s on 8000 N/m · 0.025 m hide 12.5 N.
        assert!(close(output.tension, 47.5, 0.5), "{}", output.tension);
    }

    #[test]
    fn the_observer_sees_through_the_lag_at_every_frame_rate() {
        for rate in [50.0, 100.0, 333.0] {
            let reel = Reel::from_params(
                &Params {
                    servo_frame_rate: rate,
                    ..params()
                },
                0,
            );
            let mut drive = TendonDrive::new();
            let (dt, mut output) = (1.0 / rate, Drive::default());
            // 25 ms in the sensor and on its way, and a whole frame: half until it is read, half until it acts.
            let age = 0.025 + dt;
            for i in 0..(2.0 * rate) as usize {
                let now = -0.2 - 0.5 * dt * i as f32;
                output = drive.step(&reel, 60.0, Some(now + 0.5 * age), dt);
            }
            // What the filter's lag and the age hide of the arm's fall, 0.5 rad/s on 8000 N/m · 0.025 m.
            let hidden = 100.0 * (2.0 / TILT_CUTOFF + age);
            assert!(
                close(output.tension, 60.0 - hidden, 0.5),
                "{rate} Hz: {}",
                output.tension
            );
        }
    }

    #[test]
    fn a_drive_resumes_where_it_was_and_a_wound_one_is_found_taut() {
        let reel = Reel::from_params(&params(), 0);
        let mut drive = TendonDrive::new();
        for _ in 0..100 {
            drive.step(&reel, 60.0, Some(-0.8), 0.02);
        }
        let before = drive.hold(&reel).pulse_us;
        let mut again = TendonDrive::new().resume(drive.angle());
        assert!(close(again.hold(&reel).pulse_us, before, 1e-3));
        // Without a tilt, then with one that a new attitude shows off by 0.02 rad: the servo stays, and the tension that
        // it then has keeps it there.
        let mut has = 0.0;
        for tilt in [None, None, Some(-0.78), Some(-0.78)] {
            let output = again.stay(&reel, tilt, 0.02);
            assert!(output.held && close(output.pulse_us, before, 1e-3));
            has = output.tension;
        }
        assert!(close(has, 64.0, 0.1), "{has}");
        for _ in 0..50 {
            let pulse = again.step(&reel, has, Some(-0.78), 0.02).pulse_us;
            assert!(close(pulse, before, 0.1), "{pulse} {before}");
        }
        assert!(TendonDrive::new().resume(f32::NAN).angle() == 0.0);
        assert!(TendonDrive::new().resume(1e9).angle() <= ANGLE_MAX);

        // 25 mm·1.2 on 15 mm: 2 rad; paid out in 0.67 s.
        let mut found = TendonDrive::new();
        found.find(&reel, Some(-0.8));
        assert!(close(found.angle(), 2.0, 1e-3));
        let frames = (1..100).find(|_| found.step(&reel, 0.0, Some(-0.8), 0.02).tension <= 0.0);
        assert!(frames.is_some_and(|n| (32..36).contains(&n)), "{frames:?}");
        for tilt in [None, Some(f32::NAN), Some(9.0)] {
            found.find(&reel, tilt);
            assert!(found.angle() == 0.0);
        }
    }

    #[test]
    fn a_missing_tilt_holds_and_paying_out_needs_none() {
        let reel = Reel::from_params(&params(), 0);
        let mut drive = TendonDrive::new();
        for _ in 0..100 {
            drive.step(&reel, 60.0, Some(-0.8), 0.02);
        }
        let before = drive.hold(&reel).pulse_us;
        let output = drive.step(&reel, 90.0, None, 0.02);
        assert!(output.held && close(output.pulse_us, before, 1e-6));
        let mut time = 0.0;
        let mut output = drive.step(&reel, 0.0, None, 0.02);
        while output.tension > 0.0 {
            assert!(time < 5.0);
            time += 0.02;
            output = drive.step(&reel, 0.0, None, 0.02);
        }
        // 2.5 rad at 3 rad/s.
        assert!(close(time, 0.83, 0.04) && close(output.pulse_us, 550.0, 1.0) && !output.held);
    }

    proptest! {
        #[test]
        fn angle_and_force_undo_each_other(force in 0.0f32..160.0, tilt in -1.5f32..0.3) {
            let reel = Reel::from_params(&params(), 0);
            prop_assert!(close(reel.force(reel.angle(force, tilt), tilt), force, 0.05));
        }

        #[test]
        fn no_input_makes_the_output_bad(
            inputs in proptest::collection::vec(
                (proptest::num::f32::ANY, proptest::option::of(proptest::num::f32::ANY), proptest::num::f32::ANY),
                1..40,
            ),
        ) {
            let reel = Reel::from_params(&params(), 0);
            let mut drive = TendonDrive::new();
            for (force, tilt, dt) in inputs {
                let output = drive.step(&reel, force, tilt, dt);
                prop_assert!(output.pulse_us >= 550.0 && output.pulse_us <= 2450.0);
                prop_assert!(output.tension >= 0.0 && output.tension.is_finite());
            }
        }

        #[test]
        fn no_pulses_in_the_table_s_ranges_make_a_bad_reel(
            release in 550.0f32..=2450.0, full in 550.0f32..=2450.0, trim in -50.0f32..=50.0, angle in 0.0f32..=4.71,
        ) {
            let p = Params { servo_release_1: release, servo_full_1: full, servo_trim_1: trim, ..params() };
            let reel = Reel::from_params(&p, 0);
            let pulse = reel.pulse(angle);
            prop_assert!((500.0..=2500.0).contains(&pulse));
            prop_assert!(close(reel.angle_of(pulse), angle, 0.01));
            prop_assert!((reel.pulse(4.71) - reel.pulse(0.0)).abs() >= SPAN_MIN_US - 1e-3);
        }
    }
}
