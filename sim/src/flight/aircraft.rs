//! The seam between a flight and what is flown: the tasks in virtual time, or a board that runs the flashed image.

use sophie_control::mode::Mode;
use sophie_control::wrench::PerArm;
use sophie_tasks::links::GripState;
use sophie_tasks::start::StartCause;

use crate::plant::Plant;

/// What is flown: electronics with a flight stack in it, wired to the plant.
///
/// Each millisecond the flight steps the world, hands over what the radio sent, and lets the stack run.
pub trait Aircraft {
    /// Steps the plant by a millisecond under the outputs as they are, and takes its sensors' readings.
    fn step_world(&mut self, plant: &mut Plant);

    /// Takes telemetry bytes sent since the last call; gives their number.
    fn take_telemetry(&mut self, buffer: &mut [u8]) -> usize;

    /// Puts bytes on the receiver's line.
    fn receive(&mut self, bytes: &[u8]);

    /// Lets the stack run until `us` µs after power-up.
    ///
    /// # Errors
    /// One line: why it cannot run any further. It ends the flight.
    fn run_until(&mut self, us: u64) -> Result<(), String>;

    /// What the stack says of its state; `None` before it has said anything.
    fn status(&self) -> Option<Said<'_>>;

    /// State of the grip, as far as it is known; `None` before there is any.
    fn grip(&self) -> Option<GripState>;

    /// What the stack believes and asks for now.
    fn belief(&self) -> Belief;

    /// Command that each motor gets, 0..1.
    fn motors(&self) -> PerArm<f64>;

    /// The board goes dead for `cause` in the mission's step `step`, `at` s after power-up: no task runs, no pin moves,
    /// until [`Self::start`].
    fn cut(&mut self, cause: StartCause, step: usize, at: f64);

    /// The board starts again, `us` µs after power-up.
    fn start(&mut self, us: u64);

    /// The board is not dead.
    fn runs(&self) -> bool;

    /// The last reset.
    fn reset(&self) -> Option<Reset>;

    /// Resets so far.
    fn resets(&self) -> u32;

    /// Missed deadlines of all tasks since power-up.
    fn overruns(&self) -> u32;

    /// State of the vehicle.
    fn mode(&self) -> Mode {
        self.status().map_or(Mode::Calibrating, |s| s.mode)
    }
}

/// A reset of the board.
#[derive(Clone, Copy, Debug)]
pub struct Reset {
    /// Why.
    pub cause: StartCause,
    /// Step of the mission in which it happened.
    pub step: usize,
    /// When the board went dead, s after power-up.
    pub at: f64,
}

/// What a stack says of its state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Said<'a> {
    /// State of the vehicle.
    pub mode: Mode,
    /// Why it is in it, or may not leave it; empty when there is nothing to say.
    pub reason: &'a str,
    /// What the pilot should know besides; empty when there is nothing to say.
    pub warning: &'a str,
}

/// What a stack believes and asks for; NaN where it does not tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief {
    /// Estimated roll, pitch, yaw, rad.
    pub attitude: [f64; 3],
    /// Roll, pitch and yaw that the controller aims at, rad; NaN where there is none.
    pub setpoint: [f64; 3],
    /// Tilt by the arm's own sensor, rad; NaN where there is none.
    pub tilt_measured: PerArm<f64>,
    /// Tilt by the model in the mixer, rad.
    pub tilt_model: PerArm<f64>,
    /// Thrust asked of each rotor, N.
    pub thrust_asked: PerArm<f64>,
    /// Tension asked of each tendon, N.
    pub tension_asked: PerArm<f64>,
    /// Measured contact pressure, Pa; NaN while none is fresh.
    pub pressure: PerArm<f64>,
    /// The rotors could not give all that was asked.
    pub saturated: bool,
}
