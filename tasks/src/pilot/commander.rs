//! The commander, 100 Hz: runs the mode logic on the state of the vehicle.
//!
//! A miss delays a state machine whose shortest timer is 50 ms; rotors stop when its setpoint is stale.

use embassy_time::{Duration, Instant};
use sophie_control::attitude::motion::Motion;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::gripper::tendon::ForceLimit;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::mode::{Inputs, Mode, ModeLogic, Outputs};
use sophie_control::navigation::flow_range::FlowRangeLimit;
use sophie_control::vibration::{VibrationMeter, VibrationWatch};

use crate::deadline::FixedRate;
use crate::links::Links;
use crate::links::messages::Status;
use crate::navigation::flow_limit::FlowLimit;
use crate::pilot::warning::Warning;
use crate::schedule::{Level, TaskId};

/// Smallest infill flown in the paper, %.
const INFILL_FLOWN: f32 = 6.0;
const LATE_WINDOW: Duration = Duration::from_secs(1);
/// Allowed deadline misses of the flight level per window: 1 % of one task's runs.
const LATE_MAX: u32 = 10;

/// Steps the mode logic; never returns.
pub async fn run(links: &Links) -> ! {
    let grip_memory = links
        .start
        .retained
        .map_or(GripMemory::Unknown, |retained| retained.grip_memory);
    let thrust_factor = links.start.retained.and_then(|retained| retained.thrust_factor);
    let mut logic = ModeLogic::resume(&links.params, &links.hold_gains, grip_memory, thrust_factor);
    let mut late = Lateness::new();
    let mut flow_limit = FlowLimit::default();
    let mut vibration = Shaking::new(links);
    let mut rate = FixedRate::of(links, TaskId::Commander);
    loop {
        let tick = rate.next().await;
        let inputs = collect(links, late.step(links, tick.started));
        let Outputs {
            mode,
            rotors,
            tendons,
            grip_memory,
            reason,
            inhibits,
            actuator_test,
            remote,
            gentle,
            thrust_factor,
        } = logic.step(&inputs, tick.dt);
        links.setpoint.send(tick.started, rotors);
        links.clamp_command.send(tick.started, tendons);
        links.grip_memory.send(tick.started, grip_memory);
        links.actuator_test_answer.send(tick.started, actuator_test);
        links.remote_answer.send(tick.started, remote);
        links.gentle.send(tick.started, gentle);
        links.thrust_factor.send(tick.started, thrust_factor);
        let limit = flow_limit.step(links, mode, tick.started);
        let vibrates = vibration.step(links, tick.started);
        let warning = warning(links, mode, limit, vibrates);
        links.status.send(
            tick.started,
            Status {
                mode,
                reason,
                warning,
                inhibits,
            },
        );
    }
}

/// Warning that does not affect the modes.
fn warning(links: &Links, mode: Mode, limit: Option<FlowRangeLimit>, vibrates: bool) -> &'static str {
    let started = Warning::Restarted(links.start.cause);
    let servos = Warning::Servos(links.servo_supply());
    let clipped = links
        .attitude
        .fresh_to(Instant::now(), |a| a.clipped)
        .unwrap_or(false);
    if links.stack_is_scarce() {
        Warning::Stack.text()
    } else if clipped {
        Warning::AccelClips.text()
    } else if links.mix.fresh().is_some_and(|m| m.running && m.tilt_fault) {
        Warning::ArmTilt.text()
    } else if !servos.text().is_empty() {
        servos.text()
    } else if mode.rotors_stand() && !started.text().is_empty() {
        started.text()
    } else if let Some(fault) = links.position_fault.fresh() {
        Warning::Position(fault).text()
    } else if let Some(limit) = limit {
        Warning::Limit(limit).text()
    } else if vibrates {
        Warning::Vibrates.text()
    } else if mode == Mode::Disarmed && ForceLimit::from_params(&links.params).capped_by_servo {
        Warning::ServoWeak.text()
    } else if mode == Mode::Disarmed && links.params.infill < INFILL_FLOWN {
        Warning::InfillLow.text()
    } else {
        ""
    }
}

fn collect(links: &Links, late: bool) -> Inputs {
    Inputs {
        sticks: links.rc.fresh().map(|rc| rc.sticks),
        motion: links.attitude.fresh().map(|a| Motion {
            q: a.q,
            rate: a.rate,
            accel: a.accel,
            calibrated: a.calibrated,
        }),
        // Zero is correct: the motors stop at the same age of the mix.
        lift: links.mix.fresh().map_or(0.0, |mix| mix.lift()),
        roll_moment: links.mix.fresh().map_or(0.0, |mix| mix.roll(links.params.arm_d)),
        grip: links.grip.fresh(),
        tilts: links.tilts().values(),
        fsr_fault: links
            .contact
            .fresh()
            .map_or([true; 4], |contact| contact.arms.map(|arm| arm.is_err())),
        battery: links.battery.fresh().map(|b| b.voltage),
        servo_supply: links.servo_supply(),
        late,
        hardware: links.hardware(),
        actuator_test: links.actuator_test.fresh(),
        remote: links.remote.fresh(),
        position: links.position.fresh(),
        target: links.pipe_target.fresh(),
    }
}

/// Lift of rotors that carry the vehicle, share of its weight: they idle at less.
const FLIES: f32 = 0.5;

/// Vibration at the inertial sensor.
struct Shaking {
    meter: VibrationMeter,
    watch: VibrationWatch,
    /// Raw readings taken.
    seen: u32,
}

impl Shaking {
    fn new(links: &Links) -> Self {
        Self {
            meter: VibrationMeter::new(&links.params),
            watch: VibrationWatch::default(),
            seen: 0,
        }
    }

    /// Takes the readings since the last step and sends each second's vibration; true while it is beyond the mark.
    fn step(&mut self, links: &Links, now: Instant) -> bool {
        let meter = &mut self.meter;
        let mut second = None;
        links.raw_forces.take(&mut self.seen, |force| {
            second = meter.take(force).or(second);
        });
        let least = FLIES * links.params.mass * GRAVITY;
        let flies = links.mix.fresh_to(now, |mix| mix.lift() > least);
        self.watch.step(flies.unwrap_or(false), second.as_ref());
        if let Some(second) = second {
            links.vibration.send(now, second);
        }
        self.watch.strong()
    }
}

/// Missed deadlines of the flight level; too many forbid arming.
struct Lateness {
    window_start: Instant,
    count_at_start: u32,
    late: bool,
}

impl Lateness {
    fn new() -> Self {
        Self {
            window_start: Instant::now(),
            count_at_start: 0,
            late: false,
        }
    }

    fn step(&mut self, links: &Links, now: Instant) -> bool {
        let count = TaskId::ALL
            .into_iter()
            .filter(|task| task.level() == Level::Flight)
            .fold(0u32, |n, task| n.wrapping_add(links.timing.task(task).overruns));
        let many = count.wrapping_sub(self.count_at_start) > LATE_MAX;
        self.late |= many;
        if now.saturating_duration_since(self.window_start) >= LATE_WINDOW {
            *self = Self {
                window_start: now,
                count_at_start: count,
                late: many,
            };
        }
        self.late
    }
}
