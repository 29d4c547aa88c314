//! A mission flown by the tasks, replayed from its inputs in a [`FlightChain`], gives the same bits.

use embassy_time::Instant;
use sophie_chain::FlightChain;
use sophie_control::allocation::mixer::Flexible;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::chain::{ArmReading, Attitude, Command, Demand, ImuReading, MixOutput, Surroundings};
use sophie_control::gripper::grip::GripState;
use sophie_ports::retained::StartCause;
use sophie_sim::flight::aircraft::{Aircraft, ReportedStatus, Reset, StackEstimate};
use sophie_sim::flight::fly_with;
use sophie_sim::flight::stack::Stack;
use sophie_sim::plant::Plant;
use sophie_sim::record::Silent;
use sophie_sim::scenario::Scenario;
use sophie_tasks::links::Links;
use sophie_tasks::links::messages::ArmAngles;

struct Step {
    at_us: u64,
    batch: Vec<ImuReading>,
    command: Command,
    surroundings: Surroundings,
    attitude: Attitude,
    demand: Demand,
    mix: MixOutput,
    motors: PerArm<f64>,
}

struct Recorded {
    stack: Stack,
    tape: Vec<Step>,
}

/// Period of late readings of two arms, ms.
const LATE_EVERY: usize = 500;

/// Sends two readings older than the limit, with values whose use would move the tilt.
fn send_late_readings(links: &Links) {
    let Some(newest) = links.arms.latest() else {
        return;
    };
    let now = Instant::now();
    let mut tilt = newest.value.tilt;
    for late in tilt.iter_mut().step_by(2).flatten() {
        late.at = now - links.arms.stale_after * 2;
        late.value += 0.3;
    }
    links.arms.send(now, ArmAngles { tilt });
}

fn command(links: &Links) -> Command {
    let Some(message) = links.setpoint.latest() else {
        return Command::default();
    };
    Command {
        setpoint: message
            .fresh(links.setpoint.stale_after)
            .unwrap_or(Setpoint::Stop),
        at_us: message.at.as_micros(),
        gentle: links.gentle.look(|message| message.value).unwrap_or(false),
    }
}

fn surroundings(links: &Links) -> Surroundings {
    let arms = links.arms.latest().map(|message| ArmReading {
        at_us: message.at.as_micros(),
        tilt: message.value.within(links.arms.stale_after).values(),
    });
    Surroundings {
        battery_ratio: links.battery.latest().map(|battery| battery.value.ratio),
        thrust_root: links.thrust_factor.look(|factor| factor.value.root),
        arms,
    }
}

impl Aircraft for Recorded {
    fn step_world(&mut self, plant: &mut Plant) {
        self.stack.step_world(plant);
    }

    // The flight level answers a batch before the clock advances and before other events.
    fn run_until(&mut self, us: u64) -> Result<(), String> {
        let links = self.stack.links;
        let batch = self.stack.board.imu_batch();
        if self.tape.len() % LATE_EVERY == LATE_EVERY - 1 {
            send_late_readings(links);
        }
        let (command, surroundings) = (command(links), surroundings(links));
        self.stack.run_until(us)?;
        let sample = links.imu.latest().ok_or("no sample")?;
        let mix = links.mix.latest().ok_or("no mix")?;
        assert_eq!(sample.at, mix.at);
        self.tape.push(Step {
            at_us: sample.at.as_micros(),
            batch: batch.to_vec(),
            command,
            surroundings,
            attitude: links.attitude.latest().ok_or("no attitude")?.value,
            demand: links.demand.latest().ok_or("no demand")?.value,
            mix: mix.value,
            motors: self.stack.motors(),
        });
        Ok(())
    }

    fn take_telemetry(&mut self, buffer: &mut [u8]) -> usize {
        self.stack.take_telemetry(buffer)
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.stack.receive(bytes);
    }

    fn status(&self) -> Option<ReportedStatus<'_>> {
        self.stack.status()
    }

    fn grip(&self) -> Option<GripState> {
        self.stack.grip()
    }

    fn estimate(&self) -> StackEstimate {
        self.stack.estimate()
    }

    fn motors(&self) -> PerArm<f64> {
        self.stack.motors()
    }

    fn cut(&mut self, cause: StartCause, step: usize, at: f64) {
        self.stack.cut(cause, step, at);
    }

    fn start(&mut self, us: u64) {
        self.stack.start(us);
    }

    fn runs(&self) -> bool {
        self.stack.runs()
    }

    fn reset(&self) -> Option<Reset> {
        self.stack.reset()
    }

    fn resets(&self) -> u32 {
        self.stack.resets()
    }

    fn overruns(&self) -> u32 {
        self.stack.overruns()
    }
}

/// With -0 as 0.
fn bits(attitude: &Attitude, mix: &MixOutput) -> Vec<u32> {
    let Attitude {
        q,
        rate,
        gyro_bias,
        dt,
        ..
    } = attitude;
    let mut numbers = vec![q.w, q.x, q.y, q.z, *dt];
    for vector in [rate, gyro_bias] {
        numbers.extend(vector.to_array());
    }
    for four in [mix.thrusts, mix.commands, mix.tilt, mix.tilt_bias] {
        numbers.extend(four);
    }
    numbers.extend([mix.given.roll_pitch, mix.given.thrust_shift, mix.given.yaw]);
    numbers.into_iter().map(f32::to_bits).collect()
}

#[test]
fn a_mission_gives_the_same_bits_through_the_tasks_and_through_the_chain() {
    let scenario = Scenario::default_mission();
    let recorded = || Recorded {
        stack: Stack::new(&scenario),
        tape: vec![],
    };
    let (record, Recorded { stack, tape }) = fly_with(&scenario, recorded, &mut Silent);
    assert!(record.outcome.accomplished, "{}", record.outcome.reason);

    let params = &stack.links.params;
    let allocation = Flexible::new(scenario.vehicle.configuration, params);
    let mut chain = FlightChain::new(params, params.imu_rate.number(), allocation);
    let mut flown = 0;
    for (ms, step) in tape.iter().enumerate() {
        let due = chain.step(step.at_us, &step.batch, &step.command, &step.surroundings);
        assert!(due, "{ms} ms");
        let flow = &chain.flow;
        assert_eq!(flow.demand, step.demand, "{ms} ms, {:?}", step.command);
        assert_eq!(
            bits(&flow.attitude, &flow.mix),
            bits(&step.attitude, &step.mix),
            "{ms} ms: {:?} and {:?}",
            flow.mix,
            step.mix
        );
        assert_eq!(flow.mix.commands.map(f64::from), step.motors, "{ms} ms");
        flown += usize::from(flow.mix.running);
    }
    assert!(flown > 30_000, "{flown} ms with turning rotors");
    let some = |what: fn(&Setpoint) -> bool| tape.iter().any(|step| what(&step.command.setpoint));
    assert!(some(|s| matches!(s, Setpoint::Angle { .. })) && some(|s| matches!(s, Setpoint::Resting { .. })));
    let learnt = |step: &Step| step.mix.tilt_bias.iter().all(|bias| bias.abs() > 1e-3);
    assert!(tape.iter().any(learnt), "no arm's sensor corrected its tilt");
}
