//! The tendon servos: forces asked for become pulses, and the tension that they can be giving is published.
//!
//! At the servos' frame (`servo_frame_rate`, 50 to 333 Hz). Until the first force there are no pulses:
//! when power comes on on the pipe the gears hold, and nothing moves before the clamp loop knows what it wants. After a
//! restart the drives continue from the angles that the run before left. Forces whose measurement is stale leave
//! the servos where they are; so does a missing tilt for its arm, unless that arm is to be released.
//!
//! The task closes the chain from contact pressure to pulse and measures it (`ChainWatch`).

use embassy_time::{Duration, Instant};
use sophie_control::grip_memory::GripMemory;
use sophie_control::tendon::{Drive, Reel, TendonDrive};
use sophie_control::wrench::PerArm;

use crate::deadline::{FixedRate, TaskId};
use crate::links::{Links, Newest, Stamped, TendonForce, TendonOrder};
use crate::ports::Servos;
use crate::timing::Run;

/// When the servos' frames begin by the board's clock: time enough after the task's own start to write the pulse widths,
/// which take effect with the next frame. A port with frames of its own puts them there.
pub const FRAME_AT: Duration = Duration::from_micros(1500);

/// Time between two frames of servos that take `hz` frames a second.
pub fn period(hz: f32) -> Duration {
    Duration::from_micros((1e6 / hz + 0.5) as u64)
}

/// Longest time from the conversion of pressures to the beginning of the pulse that answers them: to the frame of the
/// clamp's step, and 2 ms for a conversion that the clamp sees only as the one before. Frames that do not keep the
/// clamp's phase (all but 50, 100 and 200 Hz) are up to one frame later.
///
/// A miss leaves a tendon's force behind what the pressure asks for: at most by 0.3 N for each ms, since the clamp turns
/// it by 300 N/s at most. From 20 N (67 ms) on its integral waits, and the grip takes longer to close.
pub fn chain_deadline(frame: Duration) -> Duration {
    let in_phase = FRAME_AT + TaskId::Analog.period();
    let (frame_us, clamp_us) = (frame.as_micros().max(1), TaskId::Clamp.period().as_micros());
    if frame_us.is_multiple_of(clamp_us) || clamp_us.is_multiple_of(frame_us) {
        in_phase
    } else {
        in_phase + frame
    }
}

/// Serves the servos; never returns.
pub async fn run(links: &Links, mut port: impl Servos) -> ! {
    let period = period(links.params.servo_frame_rate);
    let mut rate = FixedRate::new(links, TaskId::Servos, period, period);
    let mut tendons = Tendons::new(links);
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

/// One tendon: its reel and the drive of its servo.
struct Tendon {
    reel: Reel,
    drive: TendonDrive,
}

impl Tendon {
    /// One step of `dt` s as `asked`, with the tilt (rad) of its arm.
    fn step(&mut self, asked: TendonForce, tilt: Option<f32>, dt: f32) -> Drive {
        if asked.stay {
            self.stay(tilt, dt)
        } else {
            self.drive.step(&self.reel, asked.force, tilt, dt)
        }
    }

    /// One step of `dt` s that leaves the servo where it is.
    fn stay(&mut self, tilt: Option<f32>, dt: f32) -> Drive {
        self.drive.hold_position(&self.reel, tilt, dt)
    }
}

/// The four tendons.
struct Tendons {
    arms: PerArm<Tendon>,
    /// An order has come: arms that were found wound have their angle.
    begun: bool,
}

impl Tendons {
    fn new(links: &Links) -> Self {
        let mut arms = Reel::all(&links.params).map(|reel| Tendon {
            reel,
            drive: TendonDrive::new(),
        });
        // Kept arms are on gears alone: the angle of a servo without pulses is not known.
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

    /// One step of `dt` s by the newest order, with the fresh tilts (rad).
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
                    if forces.found && !self.begun {
                        tendon.drive.seed_from_tilt(&tendon.reel, tilt);
                    }
                    *out = match placed.filter(|place| place.servo == arm) {
                        Some(place) => tendon.drive.place(&tendon.reel, place.pulse_us, tilt, dt),
                        None => tendon.step(asked, tilt, dt),
                    };
                }
            }
            // Held forces are no order to wind, whatever the arm does.
            Newest::Fresh(Stamped {
                value: TendonOrder::Resumed(_),
                ..
            })
            | Newest::Held(_) => {
                for ((tendon, tilt), out) in arms {
                    *out = tendon.stay(tilt, dt);
                }
            }
        }
        self.begun = true;
        output
    }

    /// Angle to which each servo is sent, rad from release.
    fn angles(&self) -> PerArm<f32> {
        self.arms.each_ref().map(|tendon| tendon.drive.angle())
    }
}

/// Measures from the conversion of pressures to the pulse that answers them, once for each conversion that gets as far.
///
/// Lateness is from the conversion until the pulse widths are written, execution what the servos' frame adds until the
/// first pulse of these widths begins, response both. Conversions that a newer one overtakes never become a pulse, and
/// forces that do not follow from a pressure are not measured.
struct ChainWatch {
    deadline: Duration,
    /// Conversion that was answered last.
    last: Option<Instant>,
}

impl ChainWatch {
    fn new(frame: Duration) -> Self {
        Self {
            deadline: chain_deadline(frame),
            last: None,
        }
    }

    /// The pulse widths of `order` were written at `written`, the first pulse of these begins at `began`.
    fn answered(&mut self, links: &Links, order: &Stamped<TendonOrder>, written: Instant, began: Instant) {
        if !matches!(order.value, TendonOrder::Measured(_)) || self.last == Some(order.at) {
            return;
        }
        self.last = Some(order.at);
        links.record_contact(&Run {
            released: order.at,
            started: written,
            ended: began,
            deadline: self.deadline,
            skipped: 0,
        });
    }
}
