//! The flight stack on the simulated board: all tasks on the virtual executor, dropped at a reset.

use glam::DVec3;
use rand::Rng;
use rand_pcg::Pcg64Mcg;
use sophie_control::allocation::wrench::{Configuration, PerArm};
use sophie_control::gripper::grip::GripState;
use sophie_control::maths::scalar;
use sophie_control::maths::vector::Vec3;
use sophie_control::mode::Reason;
use sophie_control::navigation::flow_range_sample::Flow;
use sophie_control::params::{FlowPort, Params};
use sophie_drivers::rc_decoder::Decoder;
use sophie_mixers::{Mixer, Variant};
use sophie_ports::retained::{StartCause, Words};
use sophie_tasks::links::Links;
use sophie_tasks::links::link::{Newest, Stamped};
use sophie_tasks::links::messages::Status;
use sophie_tasks::schedule::TaskId;
use sophie_tasks::start::Start;

use super::aircraft::{Aircraft, ReportedStatus, Reset, StackEstimate};
use crate::board::{Board, Port};
use crate::clock::VirtualTime;
use crate::devices::companion::Companion;
use crate::devices::flow_module::{FlowLine, FlowSender};
use crate::live::Live;
use crate::plant::Plant;
use crate::scenario::{Known, PositionSensor, Scenario};
use crate::target_angles;

/// Step index of a reset that a client ordered, not the mission.
const NO_STEP: usize = usize::MAX;

/// The stack of one flight.
pub struct Stack {
    /// Executor and start time (µs after power-up); `None` while nothing runs.
    running: Option<(VirtualTime, u64)>,
    /// Board that the stack runs on.
    pub board: &'static Board,
    /// Its links.
    pub links: &'static Links,
    params: Params,
    mixer: Variant,
    configuration: Configuration,
    reset: Option<Reset>,
    resets: u32,
    /// Missed deadlines of earlier runs.
    overruns: u32,
    noise: Pcg64Mcg,
    /// Real time and MAVLink clients; `None` in pure virtual time.
    live: Option<Live>,
    /// The computer that sends poses; `None` without it.
    companion: Option<Companion>,
    /// The board has a barometer.
    barometer: bool,
    /// The flow module's line; `None` without the module.
    flow_module: Option<FlowLine>,
}

impl Stack {
    /// Powers the board up and spawns the tasks.
    ///
    /// Board and links are leaked: tasks borrow them as `'static`, like statics of a real board.
    pub fn new(scenario: &Scenario) -> Self {
        Self::with(scenario, None)
    }

    /// The same, at the pace and with the clients of `live`.
    pub fn live(scenario: &Scenario, live: Live) -> Self {
        Self::with(scenario, Some(live))
    }

    fn with(scenario: &Scenario, live: Option<Live>) -> Self {
        let board: &'static Board = Box::leak(Box::new(Board::of(scenario)));
        let mut params = match scenario.known {
            Known::AsBuilt => scenario.params,
            Known::Exact | Known::Calibrated => levelled(scenario.params, board),
        };
        if scenario.sensors.position == PositionSensor::Flow {
            params.flow_port = FlowPort::Msp;
        }
        let companion = match scenario.sensors.position {
            PositionSensor::None | PositionSensor::Flow => None,
            PositionSensor::Pose => Some(Companion::new(scenario, live.as_ref().map(Live::line))),
        };
        let mut stack = Self {
            running: None,
            board,
            links: Box::leak(Box::new(Links::new(params))),
            params,
            mixer: scenario.mixer,
            configuration: scenario.vehicle.configuration,
            reset: None,
            resets: 0,
            overruns: 0,
            noise: scenario.streams().of("memory"),
            live,
            companion,
            barometer: scenario.sensors.barometer,
            flow_module: FlowSender::of(scenario).map(FlowLine::new),
        };
        stack.spawn(0);
        stack
    }

    /// Spawns the tasks `us` µs after power-up.
    fn spawn(&mut self, us: u64) {
        let (links, board) = (self.links, self.board);
        board.configure_motors(&links.params);
        let (variant, configuration) = (self.mixer, self.configuration);
        let mixer = move |p: &Params| Mixer::new(variant, configuration, p);
        let time = VirtualTime::new();
        // Flight level.
        time.spawn(sophie_tasks::flight::imu::run(links, Port(board)));
        time.spawn(sophie_tasks::flight::estimator::run(links));
        time.spawn(sophie_tasks::flight::control::run(links));
        time.spawn(sophie_tasks::flight::mixer::run(links, mixer));
        time.spawn(sophie_tasks::flight::motors::run(links, Port(board)));
        // Steady level.
        time.spawn(sophie_tasks::perching::analog::run(links, Port(board)));
        time.spawn(sophie_tasks::perching::clamp::run(links));
        time.spawn(sophie_tasks::perching::servos::run(links, Port(board)));
        let decoder = Decoder::from_params(&links.params);
        time.spawn(sophie_tasks::pilot::rc::run(links, Port(board), decoder));
        if let Some(module) = &self.flow_module {
            module.spawn(&time, links);
        }
        time.spawn(sophie_tasks::pilot::commander::run(links));
        time.spawn(sophie_tasks::navigation::position::run(links));
        time.spawn(sophie_tasks::supervision::supervisor::run(
            links,
            Port(board),
            Port(board),
        ));
        // Background.
        time.spawn(sophie_tasks::perching::arms::run(links, Port(board)));
        if self.barometer {
            time.spawn(sophie_tasks::navigation::barometer::run(links, Port(board)));
        }
        time.spawn(sophie_tasks::pilot::telemetry::run(links, Port(board)));
        if let Some(live) = &mut self.live {
            live.spawn(&time, links);
        } else if let Some(companion) = &mut self.companion {
            companion.spawn(&time, links);
        }
        self.running = Some((time, us));
    }
}

impl Stack {
    /// The estimated position in world axes, m.
    fn position(&self) -> Option<[f64; 3]> {
        let position = self.links.position.fresh().map(|e| e.position);
        match &self.flow_module {
            Some(module) => {
                let position = position.map(|p| DVec3::from_array(p.to_array().map(f64::from)));
                module.in_world(position).map(|p| p.to_array())
            }
            None => self.in_world(position?),
        }
    }

    /// Range, m, and flow, rad/s, of the flow module; `None` if older than the link allows.
    fn range_and_flow(&self) -> (Option<f64>, Option<[f64; 2]>) {
        let ground = &self.links.ground;
        let Some(Stamped { at, value: seen }) = ground.latest() else {
            return (None, None);
        };
        let oldest = at.as_micros().saturating_sub(ground.stale_after.as_micros());
        let range = seen.range.filter(|range| range.at_us >= oldest);
        let flow = seen
            .flow
            .filter(|flow| flow.until_us >= oldest && flow.quality > 0);
        let rate = |flow: Flow| flow.angle.map(|angle| f64::from(angle / flow.seconds));
        (
            range.and_then(|range| range.distance).map(f64::from),
            flow.and_then(Flow::checked).map(rate),
        )
    }

    /// Converts a position from the companion computer's axes to world axes, m.
    fn in_world(&self, position: Vec3) -> Option<[f64; 3]> {
        let companion = self.companion.as_ref()?;
        let position = DVec3::from_array(position.to_array().map(f64::from));
        Some(companion.in_world(position).to_array())
    }
}

impl Aircraft for Stack {
    fn step_world(&mut self, plant: &mut Plant) {
        self.board.step_world(plant);
        if let Some(companion) = &mut self.companion {
            companion.step(plant);
        }
        if let Some(module) = &mut self.flow_module {
            module.step(plant);
        }
    }

    fn take_telemetry(&mut self, buffer: &mut [u8]) -> usize {
        self.board.take_telemetry(buffer)
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.board.receive(bytes);
    }

    fn run_until(&mut self, us: u64) -> Result<(), String> {
        if let Some(live) = &mut self.live {
            live.begin(us)?;
        }
        if let (Some(companion), Some((_, start))) = (&mut self.companion, &self.running) {
            companion.send(us, *start);
        }
        if let Some(module) = &mut self.flow_module {
            module.send(us);
        }
        if let Some((time, start)) = &self.running {
            time.run_until(us.saturating_sub(*start));
        }
        if let Some(live) = &mut self.live {
            live.end();
            if let Some(params) = live.restarts() {
                self.params = params;
                self.cut(StartCause::Software, NO_STEP, us as f64 * 1e-6);
                self.start(us);
            }
        }
        Ok(())
    }

    fn status(&self) -> Option<ReportedStatus<'_>> {
        let Status {
            mode,
            reason,
            warning,
            ..
        } = self.links.status.latest()?.value;
        Some(ReportedStatus {
            mode,
            reason: reason.map_or("", Reason::text),
            warning,
        })
    }

    fn grip(&self) -> Option<GripState> {
        self.links.grip.latest().map(|g| g.value)
    }

    fn estimate(&self) -> StackEstimate {
        let links = self.links;
        let wide = |v: PerArm<f32>| v.map(f64::from);
        let mix = links.mix.latest().map(|m| m.value).unwrap_or_default();
        let estimate = links
            .attitude
            .latest()
            .map(|a| a.value.q.to_euler())
            .unwrap_or_default();
        // The target heading is relative to the present one.
        let target = links.target.latest().map(|v| {
            let [roll, pitch, ahead] = target_angles::angles(v.value);
            let heading = scalar::wrap_pi(estimate.2 + ahead as f32);
            [roll, pitch, f64::from(heading)]
        });
        // Held pressures do not count as measured; held forces are what the servos still hold.
        let pressure = match links.contact.newest() {
            Some(Newest::Fresh(contact)) => wide(contact.value.arms.map(|arm| arm.unwrap_or(0.0))),
            Some(Newest::Held(_)) | None => [f64::NAN; 4],
        };
        let force = links
            .tendons
            .latest()
            .map_or([0.0; 4], |order| order.value.forces().arms.map(|arm| arm.force));
        let (range, flow) = self.range_and_flow();
        StackEstimate {
            attitude: [estimate.0, estimate.1, estimate.2].map(f64::from),
            setpoint: target.filter(|_| mix.running).unwrap_or([f64::NAN; 3]),
            tilt_measured: links.tilts().values().map(|a| a.map_or(f64::NAN, f64::from)),
            tilt_model: wide(mix.tilt),
            thrust_asked: wide(mix.thrusts),
            tension_asked: wide(force),
            pressure,
            saturated: mix.running && mix.given.saturated(),
            position: self.position(),
            pose: links
                .external_pose
                .fresh()
                .and_then(|pose| self.in_world(pose.pose.position)),
            range,
            flow,
        }
    }

    fn motors(&self) -> PerArm<f64> {
        self.board.actuators().motors
    }

    // Retained memory survives, except a loss of power.
    fn cut(&mut self, cause: StartCause, step: usize, at: f64) {
        self.overruns = self.overruns();
        self.running = None;
        self.board.reset();
        if let Some(live) = &self.live {
            live.reset();
        }
        if let Some(companion) = &self.companion {
            companion.reset();
        }
        if let Some(module) = &self.flow_module {
            module.reset();
        }
        if cause.loses_memory() {
            let noise: [Words; 2] = core::array::from_fn(|_| core::array::from_fn(|_| self.noise.random()));
            self.board.memory.set(noise);
        }
        let start = Start::new(cause, &self.board.memory.get());
        self.links = Box::leak(Box::new(Links::starting(self.params, start)));
        self.reset = Some(Reset { cause, step, at });
        self.resets += 1;
    }

    fn start(&mut self, us: u64) {
        self.spawn(us);
    }

    fn runs(&self) -> bool {
        self.running.is_some()
    }

    fn reset(&self) -> Option<Reset> {
        self.reset
    }

    fn resets(&self) -> u32 {
        self.resets
    }

    fn overruns(&self) -> u32 {
        let now: u32 = TaskId::ALL
            .iter()
            .map(|&task| self.links.timing.task(task).overruns)
            .sum();
        self.overruns + now + self.links.timing.contact().overruns
    }
}

/// The board's parameters after `calibrate level`, with what the table's lean leaves.
fn levelled(params: Params, board: &Board) -> Params {
    let [accel_bias_x, accel_bias_y, accel_bias_z] = board.accel_bias;
    Params {
        accel_bias_x,
        accel_bias_y,
        accel_bias_z,
        ..params
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_has_no_pressure_while_none_is_fresh() {
        let scenario = Scenario::default_mission();
        let mut stack = Stack::new(&scenario);
        assert!(stack.estimate().pressure.iter().all(|p| p.is_nan()));
        stack.run_until(50_000).unwrap();
        assert!(stack.estimate().pressure.iter().all(|p| p.is_finite()));
        // The newest conversion is 21 ms old.
        let contact = stack.links.contact.latest().unwrap();
        let old = embassy_time::Instant::now() - embassy_time::Duration::from_millis(21);
        stack.links.contact.send(old, contact.value);
        assert!(stack.estimate().pressure.iter().all(|p| p.is_nan()));
    }
}
