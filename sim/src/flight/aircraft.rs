//! Interface of a flight to the electronics: the tasks in virtual time, or an emulated board with the flashed image.

use sophie_control::allocation::wrench::PerArm;
use sophie_control::gripper::grip::GripState;
use sophie_control::mode::Mode;
use sophie_ports::retained::StartCause;

use crate::plant::Plant;

/// Electronics with a flight stack, wired to the plant.
///
/// Each millisecond the flight steps the world, transfers the radio's bytes, and lets the stack run.
pub trait Aircraft {
    /// Steps the plant by 1 ms under the present outputs and samples its sensors.
    fn step_world(&mut self, plant: &mut Plant);

    /// Takes the telemetry sent since the last call; returns the number of bytes.
    fn take_telemetry(&mut self, buffer: &mut [u8]) -> usize;

    /// Puts bytes on the receiver's line.
    fn receive(&mut self, bytes: &[u8]);

    /// Runs the stack until `us` µs after power-up.
    ///
    /// # Errors
    /// One line: the cause of the stop. It ends the flight.
    fn run_until(&mut self, us: u64) -> Result<(), String>;

    /// Reported state; `None` before the first report.
    fn status(&self) -> Option<ReportedStatus<'_>>;

    /// State of the grip; `None` before the first report.
    fn grip(&self) -> Option<GripState>;

    /// Estimates and demands of the stack.
    fn estimate(&self) -> StackEstimate;

    /// Motor commands, 0..1.
    fn motors(&self) -> PerArm<f64>;

    /// Resets the board for `cause` in the mission's step `step`, `at` s after power-up: no task runs, no pin moves,
    /// until [`Self::start`].
    fn cut(&mut self, cause: StartCause, step: usize, at: f64);

    /// Restarts the board `us` µs after power-up.
    fn start(&mut self, us: u64);

    /// False between [`Self::cut`] and [`Self::start`].
    fn runs(&self) -> bool;

    /// The last reset.
    fn reset(&self) -> Option<Reset>;

    /// Resets so far.
    fn resets(&self) -> u32;

    /// Missed deadlines since power-up, all tasks.
    fn overruns(&self) -> u32;

    /// State of the vehicle.
    fn mode(&self) -> Mode {
        self.status().map_or(Mode::Calibrating, |s| s.mode)
    }
}

/// A reset of the board.
#[derive(Clone, Copy, Debug)]
pub struct Reset {
    /// Cause.
    pub cause: StartCause,
    /// Step of the mission.
    pub step: usize,
    /// Time, s after power-up.
    pub at: f64,
}

/// Reported state of a stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReportedStatus<'a> {
    /// State of the vehicle.
    pub mode: Mode,
    /// Reason of the mode, or for staying in it; may be empty.
    pub reason: &'a str,
    /// Warning for the pilot; may be empty.
    pub warning: &'a str,
}

/// Estimates and demands of a stack; NaN where unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StackEstimate {
    /// Estimated roll, pitch, yaw, rad.
    pub attitude: [f64; 3],
    /// Target roll, pitch, yaw, rad; NaN without a target.
    pub setpoint: [f64; 3],
    /// Tilt by the arm's sensor, rad; NaN without a fresh one.
    pub tilt_measured: PerArm<f64>,
    /// Tilt by the mixer's model, rad.
    pub tilt_model: PerArm<f64>,
    /// Thrust asked of each rotor, N.
    pub thrust_asked: PerArm<f64>,
    /// Tension asked of each tendon, N.
    pub tension_asked: PerArm<f64>,
    /// Measured contact pressure, Pa; NaN if none is fresh.
    pub pressure: PerArm<f64>,
    /// The rotors saturated.
    pub saturated: bool,
    /// Estimated position in the true axes, m; `None` without one.
    pub position: Option<[f64; 3]>,
    /// Position of the newest pose in the true axes, m; `None` without a fresh one.
    pub pose: Option<[f64; 3]>,
    /// Newest range, m; `None` without a fresh one.
    pub range: Option<f64>,
    /// Newest flow, rad/s about the forward and the right axis; `None` without a fresh one.
    pub flow: Option<[f64; 2]>,
}
