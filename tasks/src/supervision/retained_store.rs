//! Writes the retained state for the supervisor, 100 Hz.
//!
//! The stored state is at most 30 ms old (a servo frame and a run), in which a winding servo turns 0.2 rad. A stale or
//! missing message leaves it unchanged.

use crate::start::retained_state::RetainedState;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::attitude::mounting::Mounting;
use sophie_control::gripper::force_per_thrust;

use crate::links::Links;
use crate::links::tendon_order::TendonOrder;
use sophie_ports::retained::Retain;

/// Writer of the retained state.
pub struct RetainedStore<R> {
    port: R,
    retained: RetainedState,
    sequence: u32,
}

impl<R: Retain> RetainedStore<R> {
    /// Continues from the last run's state.
    pub fn new(links: &Links, port: R) -> Self {
        Self {
            port,
            retained: links.start.retained.unwrap_or_default(),
            sequence: links.start.sequence,
        }
    }

    /// Keeps the present state, once the commander knows the arms.
    pub fn keep(&mut self, links: &Links) {
        if let Some(grip_memory) = links.grip_memory.fresh() {
            self.retained.grip_memory = grip_memory;
        }
        if let Some(angle) = links.reel_angle.fresh() {
            self.retained.angle = angle;
        }
        if let Some(TendonOrder::Measured(tendons) | TendonOrder::Blind(tendons)) = links.tendons.fresh() {
            // A rotor's thrust bends its arm off the pipe. The reset stops it, and the tendon's share against it would
            // then press the pipe.
            let thrusts = links
                .mix
                .fresh()
                .filter(|m| m.running)
                .map_or([0.0; 4], |m| m.thrusts);
            let per_thrust = force_per_thrust(&links.params);
            for ((slot, asked), thrust) in self.retained.force.iter_mut().zip(tendons.arms).zip(thrusts) {
                *slot = asked.force - per_thrust * thrust;
            }
        }
        if let Some(grip) = links.grip.fresh() {
            let mut fault: PerArm<_> = [None; 4];
            for (slot, arm) in fault.iter_mut().zip(grip.arms) {
                *slot = arm.fault.filter(|f| f.is_latched());
            }
            self.retained.fault = fault;
            self.retained.response = grip.arms.map(|arm| arm.response);
        }
        if let Some(attitude) = links.attitude.fresh().filter(|a| a.calibrated) {
            // In sensor axes: the next start may use another mounting.
            let mounting = Mounting::from(links.params.imu_mounting);
            self.retained.gyro_bias = Some(mounting.to_board(attitude.gyro_bias));
        }
        if let Some(factor) = links.thrust_factor.fresh() {
            self.retained.thrust_factor = Some(factor.value);
        }
        self.retained = self.retained.bounded();
        let sequence = self.sequence.wrapping_add(1);
        if let Some(words) = self.retained.to_words(sequence) {
            self.sequence = sequence;
            // Alternates the copies: a reset during the write leaves the other one valid.
            self.port.keep(sequence & 1 == 1, &words);
        }
    }
}
