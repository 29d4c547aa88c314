//! The flight stack on the simulated board: every task spawned on the virtual executor.

use rand_pcg::Pcg64Mcg;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_tasks::deadline::TaskId;
use sophie_tasks::links::Links;

use crate::board::{Board, Port};
use crate::clock::VirtualTime;
use crate::scenario::Scenario;

/// The running stack of one flight.
pub struct Stack {
    time: VirtualTime,
    /// The board that it runs on.
    pub board: &'static Board,
    /// Its links.
    pub links: &'static Links,
}

impl Stack {
    /// Powers the board up and spawns the tasks.
    ///
    /// Board and links are leaked: tasks borrow them for ever, as they do statics on a real board.
    pub fn new(scenario: &Scenario, rng: &mut Pcg64Mcg) -> Self {
        let time = VirtualTime::new();
        let board: &'static Board = Box::leak(Box::new(Board::configured(&scenario.params, rng)));
        let links: &'static Links = Box::leak(Box::new(Links::new(calibrated(scenario.params, board))));
        let (mixer, configuration) = (scenario.mixer, scenario.vehicle.configuration);

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
        time.spawn(sophie_tasks::supervisor::run(links, Port(board)));
        // Background.
        time.spawn(sophie_tasks::arms::run(links, Port(board)));
        time.spawn(sophie_tasks::telemetry::run(links, Port(board)));
        Self { time, board, links }
    }

    /// Lets the tasks run until `us` µs after power-up.
    pub fn run_until(&self, us: u64) {
        self.time.run_until(us);
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
        TaskId::ALL
            .iter()
            .map(|&task| self.links.timing(task).overruns)
            .sum()
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
