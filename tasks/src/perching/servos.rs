//! Drives the tendon servos: converts forces to pulses and publishes the estimated tension.
//!
//! Runs at the servos' frame rate (`servo_frame_rate`, 50 to 333 Hz), without pulses until the first force: if the
//! vehicle is on the pipe at power-up, the gears hold. After a restart the drives resume from the retained angles.
//! With stale forces the servos hold; also with a missing tilt, unless the arm is to be released.
//!
//! A servo with uncalibrated marks gets pulses only in actuator tests: the default marks may lie beyond an end stop,
//! where the stall current would burn the servo.
//!
//! The task ends the chain from contact pressure to pulse and measures it (`ChainWatch`).

use embassy_time::{Duration, Instant};
use sophie_control::allocation::wrench::PerArm;
use sophie_control::arming::ArmingInhibit;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::gripper::tendon::{Drive, Reel, TendonDrive};

use crate::deadline::FixedRate;
use crate::links::Links;
use crate::links::link::{Newest, Stamped};
use crate::links::tendon_order::{TendonForce, TendonOrder};
use crate::schedule::TaskId;
use crate::schedule::timing::Run;
use sophie_ports::actuators::Servos;

/// Start of the servos' frames by the board's clock, also of a port's own: after the task has written the pulse widths,
/// which take effect then.
pub const FRAME_AT: Duration = Duration::from_micros(1500);

/// Frame period at `hz` frames a second.
pub fn period(hz: f32) -> Duration {
    Duration::from_micros((1e6 / hz + 0.5) as u64)
}

/// Longest time from the conversion of pressures to the pulse that answers them: up to the frame of the clamp's step,
/// and 2 ms for a conversion it just missed. Frames out of the clamp's phase (all but 50, 100 and 200 Hz) are up to one
/// frame later.
///
/// A miss makes a tendon's force lag by at most 0.3 N per ms, as the clamp's rate limit is 300 N/s. From 20 N (67 ms)
/// its integral waits, and the grip closes later.
pub fn chain_deadline(frame: Duration) -> Duration {
    let in_phase = FRAME_AT + TaskId::Analog.period();
    let (frame_us, clamp_us) = (frame.as_micros().max(1), TaskId::Clamp.period().as_micros());
    if frame_us.is_multiple_of(clamp_us) || clamp_us.is_multiple_of(frame_us) {
        in_phase
    } else {
        in_phase + frame
    }
}

/// Drives the servos; never returns.
pub async fn run(links: &Links, mut port: impl Servos) -> ! {
    let period = period(links.params.servo_frame_rate);
    let mut rate = FixedRate::new(links, TaskId::Servos, period, period);
    let mut tendons = Tendons::new(links);
    let unmarked = tendons.arms.iter().any(|arm| !arm.marked);
    links.report(ArmingInhibit::ServoUnmarked, unmarked);
    let mut chain = ChainWatch::new(period);
    loop {
        let tick = rate.next().await;
        let Some(newest) = links.tendons.newest() else {
            port.write([0.0; 4]).await;
            continue;
        };
        let tilts = links.tilts();
        let output = tendons.step(&newest, tilts.values(), tick.dt);
        let written = Instant::now();
        let began = port.write(output.map(|o| o.pulse_us)).await;
        if let Newest::Fresh(order) = newest {
            chain.answered(links, &order, written, began);
        }
        let now = Instant::now();
        links
            .tension
            .send(tilts.oldest().unwrap_or(now), output.map(|o| o.tension));
        links.reel_angle.send(now, tendons.angles());
    }
}

struct Tendon {
    reel: Reel,
    drive: TendonDrive,
    /// Its marks have been measured.
    marked: bool,
}

impl Tendon {
    fn step(&mut self, asked: TendonForce, tilt: Option<f32>, dt: f32) -> Drive {
        if asked.hold_position {
            self.hold_position(asked, tilt, dt)
        } else {
            let reel = self.reel.softened(asked.stiffness);
            self.drive.step(&reel, asked.force, tilt, dt)
        }
    }

    /// The servo stays; its tension is that of the tendon's learnt stiffness, from which a resumed grip goes on.
    fn hold_position(&mut self, asked: TendonForce, tilt: Option<f32>, dt: f32) -> Drive {
        let reel = self.reel.softened(asked.stiffness);
        self.drive.hold_position(&reel, tilt, dt)
    }
}

struct Tendons {
    arms: PerArm<Tendon>,
    /// An order has arrived: the angles of tendons wound at power-on are set.
    begun: bool,
}

impl Tendons {
    // Not inlined: it runs once and would enlarge the frame of every poll.
    #[inline(never)]
    fn new(links: &Links) -> Self {
        let marks = links.params.servo_marks;
        let marked = [0, 1, 2, 3].map(|servo| marks.has(servo));
        let mut arms = Reel::all(&links.params).map(|reel| Tendon {
            reel,
            drive: TendonDrive::new(),
            marked: false,
        });
        for (tendon, marked) in arms.iter_mut().zip(marked) {
            tendon.marked = marked;
        }
        // Without pulses the angle is unknown.
        let known = links
            .start
            .retained
            .filter(|w| !matches!(w.grip_memory, GripMemory::HeldByGears(_)));
        if let Some(retained) = known {
            for (tendon, angle) in arms.iter_mut().zip(retained.angle) {
                tendon.drive = tendon.drive.resume(angle);
            }
        }
        Self { arms, begun: false }
    }

    fn step(&mut self, newest: &Newest<TendonOrder>, tilts: PerArm<Option<f32>>, dt: f32) -> PerArm<Drive> {
        let mut output = [Drive::default(); 4];
        let placed = match newest {
            Newest::Fresh(Stamped {
                value: TendonOrder::Placed { place, .. },
                ..
            }) => Some(place),
            _ => None,
        };
        let arms = self.arms.iter_mut().zip(tilts).zip(&mut output);
        match newest {
            Newest::Fresh(Stamped {
                value:
                    TendonOrder::Measured(forces)
                    | TendonOrder::Blind(forces)
                    | TendonOrder::Placed { forces, .. },
                ..
            }) => {
                for (arm, (((tendon, tilt), out), asked)) in arms.zip(forces.arms).enumerate() {
                    if forces.wound_at_power_on && !self.begun {
                        tendon.drive.seed_from_tilt(&tendon.reel, tilt);
                    }
                    *out = match placed.filter(|place| place.servo == arm) {
                        Some(place) => tendon.drive.place(&tendon.reel, place.pulse_us, tilt, dt),
                        None => tendon.step(asked, tilt, dt),
                    };
                }
            }
            // Held forces must not start winding.
            Newest::Fresh(Stamped {
                value: order @ TendonOrder::Resumed(_),
                ..
            })
            | Newest::Held(Stamped { value: order, .. }) => {
                for (((tendon, tilt), out), asked) in arms.zip(order.forces().arms) {
                    *out = tendon.hold_position(asked, tilt, dt);
                }
            }
        }
        for (arm, (tendon, out)) in self.arms.iter().zip(&mut output).enumerate() {
            if !tendon.marked {
                // Without a rate limit: the servo's present angle is unknown.
                let place = placed.filter(|place| place.servo == arm);
                out.pulse_us = place.map_or(0.0, |place| place.pulse_us);
            }
        }
        self.begun = true;
        output
    }

    /// Commanded servo angles, rad from release.
    fn angles(&self) -> PerArm<f32> {
        self.arms.each_ref().map(|tendon| tendon.drive.angle())
    }
}

/// Measures from the conversion of pressures to the pulse that answers them.
///
/// Lateness runs until the pulse widths are written, execution until their first pulse begins, response is both.
/// Overtaken conversions and forces without pressure are not measured.
struct ChainWatch {
    deadline: Duration,
    last: Option<Instant>,
}

impl ChainWatch {
    fn new(frame: Duration) -> Self {
        Self {
            deadline: chain_deadline(frame),
            last: None,
        }
    }

    /// The pulse widths of `order` were written at `written` and begin at `began`.
    fn answered(&mut self, links: &Links, order: &Stamped<TendonOrder>, written: Instant, began: Instant) {
        if !matches!(order.value, TendonOrder::Measured(_)) || self.last == Some(order.at) {
            return;
        }
        self.last = Some(order.at);
        links.timing.record_contact(&Run {
            released: order.at,
            started: written,
            ended: began,
            deadline: self.deadline,
            skipped: 0,
        });
    }
}
