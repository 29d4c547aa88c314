//! The flight step, 1 kHz: from a batch of inertial readings to four motor commands.
//!
//! Four stages, each with its own state, owned by a task of the flight level and joined by links
//! (`sophie_tasks::flight`); the links carry the messages of [`messages`] and of [`attitude::messages`] with the data-ready
//! time of the newest reading, from which every deadline counts. World NED, body FRD, quaternions body to world, SI units.
//!
//! | stage | takes | gives | deadline | a miss costs |
//! |---|---|---|---|---|
//! | 1 [`Sensing`] (task `imu`) | [`ImuReading`]s of the part at its own rate, 4 to 8 a step: rad/s, m/s², board axes | [`ImuSample`]: low-passed, calibrated, mounted, body axes | 0.2 ms | the next stages wait; without a mix for 10 ms the motors stop |
//! | 2 [`Estimator`] (`estimator`) | the sample | [`Attitude`]: body to world, rates without bias, specific force | 0.3 ms | the same |
//! | 3 [`Control`] (`control`) | the attitude; the commander's [`setpoint`] at 100 Hz; the last mix's shares | [`Demand`]: stop, idle, a motor test, or a wrench in N and N m | 0.4 ms | the same; a setpoint older than 50 ms is a stop |
//! | 4 [`Mixing`] (`mixer`) | the demand; the arms' tilts at 100 Hz; the battery's voltage | [`MixOutput`]: thrusts in N, commands 0 to 1 by rotor, shares given | 0.5 ms | the frame is late: due 0.6 ms after data-ready |
//!
//! The task `motors` maps rotors to outputs and sends the frame. The arms bend with thrust, so stage 4 follows their tilt
//! at every step: it allocates at the tilt that the last thrusts have left, then moves the tilt by its model, corrected by
//! one arm's sensor a step. What stage 4 could not give comes back to stage 3, which stops its integrals there.
//!
//! [`Estimator`]: crate::attitude::estimator::Estimator
//! [`attitude::messages`]: crate::attitude::messages

mod control;
#[cfg(test)]
mod lying_sensor_tests;
pub mod messages;
pub mod mixing;
mod sensing;
pub mod setpoint;
pub mod spin;
pub mod static_thrust;
mod step_clock;

pub use crate::attitude::messages::{Attitude, ImuReading, ImuSample};
pub use control::{Command, Control};
pub use messages::{Demand, MixOutput, lift};
pub use mixing::{ArmReading, Mixing, MixingStep, Surroundings};
pub use sensing::Sensing;
pub use step_clock::{CONTROL_RATE_HZ, StepClock};
