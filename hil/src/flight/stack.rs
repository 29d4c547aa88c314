//! The flight stack on the simulated board: every task spawned on the virtual executor, and thrown away by a reset.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use sophie_control::mixer::Variant;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_control::wrench::Configuration;
use sophie_tasks::deadline::TaskId;
use sophie_tasks::links::Links;
use sophie_tasks::start::{Cause, Start};

use crate::board::{Board, Port};
use crate::clock::VirtualTime;
use crate::scenario::Scenario;

/// A reset of the board.
#[derive(Clone, Copy, Debug)]
pub struct Reset {
    /// Why.
    pub cause: Cause,
    /// Step of the mission in which it happened.
    pub step: usize,
    /// When the board went dead, s after power-up.
    pub at: f64,
}

/// The stack of one flight.
pub struct Stack {
    /// Nothing runs while it is `None`; with it the time of the start, µs after power-up.
    running: Option<(VirtualTime, u64)>,
    /// The board that it runs on.
    pub board: &'static Board,
    /// Its links.
    pub links: &'static Links,
    params: Params,
    mixer: Variant,
    configuration: Configuration,
    /// The last reset and how many there were.
    reset: Option<Reset>,
    resets: u32,
    /// Missed deadlines of the runs before.
    overruns: u32,
    noise: Pcg64Mcg,
}

impl Stack {
    /// Powers the board up and spawns the tasks.
    ///
    /// Board and links are leaked: tasks borrow them for ever, as they do statics on a real board.
    pub fn new(scenario: &Scenario, rng: &mut Pcg64Mcg) -> Self {
        let board: &'static Board = Box::leak(Box::new(Board::configured(&scenario.params, rng)));
        let params = calibrated(scenario.params, board);
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
            noise: Pcg64Mcg::seed_from_u64(!scenario.seed),
        };
        stack.start(0);
        stack
    }

    /// The tasks begin, `us` µs after power-up.
    pub fn start(&mut self, us: u64) {
        let (links, board) = (self.links, self.board);
        let (mixer, configuration) = (self.mixer, self.configuration);
        let time = VirtualTime::new();
        // Flight level.
        time.spawn(sophie_tasks::imu::run(links, Port(board)));
        time.spawn(sophie_tasks::estimator::run(links));
        time.spawn(sophie_tasks::control::run(links));
        time.spawn(sophie_tasks::mixer::run(links, mixer, configuration));
        time.spawn(sophie_tasks::motors::run(links, Port(board)));
        // Steady level.
        time.spawn(sophie_tasks::analog::run(links, Port(board)));
        time.spawn(sophie_tasks::clamp::run(links));
        time.spawn(sophie_tasks::servos::run(links, Port(board)));
        time.spawn(sophie_tasks::rc::run(links, Port(board)));
        time.spawn(sophie_tasks::commander::run(links));
        time.spawn(sophie_tasks::supervisor::run(links, Port(board), Port(board)));
        // Background.
        time.spawn(sophie_tasks::arms::run(links, Port(board)));
        time.spawn(sophie_tasks::telemetry::run(links, Port(board)));
        self.running = Some((time, us));
    }

    /// The board goes dead for `cause` in the mission's step `step`, `at` s after power-up: no task runs, no pin moves, until [`Self::start`]. What
    /// outlives it is what was kept, unless power went too.
    pub fn cut(&mut self, cause: Cause, step: usize, at: f64) {
        self.overruns = self.overruns();
        self.running = None;
        self.board.reset();
        if cause.loses_memory() {
            let noise: [[u32; 16]; 2] =
                core::array::from_fn(|_| core::array::from_fn(|_| self.noise.random()));
            self.board.memory.set(noise);
        }
        let start = Start::new(cause, &self.board.memory.get());
        self.links = Box::leak(Box::new(Links::starting(self.params, start)));
        self.reset = Some(Reset { cause, step, at });
        self.resets += 1;
    }

    /// The tasks run.
    pub fn runs(&self) -> bool {
        self.running.is_some()
    }

    /// The last reset.
    pub fn reset(&self) -> Option<Reset> {
        self.reset
    }

    /// Resets so far.
    pub fn resets(&self) -> u32 {
        self.resets
    }

    /// Lets the tasks run until `us` µs after power-up.
    pub fn run_until(&self, us: u64) {
        if let Some((time, start)) = &self.running {
            time.run_until(us.saturating_sub(*start));
        }
    }

    /// State of the vehicle.
    pub fn mode(&self) -> Mode {
        self.links
            .status
            .latest()
            .map_or(Mode::Calibrating, |s| s.value.mode)
    }

    /// Missed deadlines of all tasks since power-up.
    pub fn overruns(&self) -> u32 {
        let now: u32 = TaskId::ALL
            .iter()
            .map(|&task| self.links.timing(task).overruns)
            .sum();
        self.overruns + now
    }
}

/// The parameters of this very board: its accelerometer was calibrated on a bench.
fn calibrated(params: Params, board: &Board) -> Params {
    let [accel_bias_x, accel_bias_y, accel_bias_z] = board.accel_bias;
    Params {
        accel_bias_x,
        accel_bias_y,
        accel_bias_z,
        ..params
    }
}
