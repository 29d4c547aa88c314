//! Allocation, one step for each demand, with the arms' present tilt in it.
//!
//! Flight level. Deadline: 500 µs after data-ready.

use embassy_time::{Duration, Instant};
use sophie_control::mixer::{Conditions, Mix, Mixer, Variant};
use sophie_control::thrust_curve::ThrustCurve;
use sophie_control::wrench::Configuration;

use crate::deadline::{TaskId, record_run};
use crate::links::{Demand, Links, MixOutput, Setpoint};
use crate::timing::us;

/// Time from data-ready to the motor commands.
pub const DEADLINE: Duration = Duration::from_micros(500);
/// Step time without an estimate, s.
const NOMINAL_DT: f32 = 1e-3;

/// Allocates at 1 kHz; returns only if the link has no receiver left.
pub async fn run(links: &Links, variant: Variant, configuration: Configuration) {
    let Some(mut demand) = links.demand.receiver() else {
        return;
    };
    let mut mixer = Mixer::new(variant, configuration, &links.params);
    let curve = ThrustCurve::from_params(&links.params);
    let mut arms_seen = Instant::MIN;
    let mut readings = [None; 4].into_iter().enumerate();
    let mut last = Instant::MIN;
    loop {
        let message = demand.changed().await;
        let started = Instant::now();
        let dt = (us(message.at.saturating_duration_since(last)) as f32 * 1e-6).clamp(0.5e-3, 5e-3);
        let dt = if last == Instant::MIN { NOMINAL_DT } else { dt };
        last = message.at;
        // Without a fresh voltage the last one still is the best guess; without any, nominal.
        let ratio = links.battery.look(|b| b.value.ratio).unwrap_or(1.0);
        let resting = links
            .setpoint
            .look(|s| matches!(s.value, Setpoint::Resting { .. }));
        if links.arms.look(|arms| arms.at > arms_seen) == Some(true)
            && resting != Some(true)
            && let Some(arms) = links.arms.latest()
        {
            arms_seen = arms.at;
            if let Some(arms) = arms.fresh(links.arms.stale_after) {
                readings = arms.tilt.into_iter().enumerate();
            }
        }
        // One arm a step: all four in one would make it longer than the others.
        if let Some((arm, Some(tilt))) = readings.next() {
            mixer.correct_tilt(arm, tilt);
        }
        let (mix, running) = match message.value {
            Demand::Stop => (
                Mix {
                    yaw_gated: true,
                    ..mixer.idle(dt)
                },
                false,
            ),
            Demand::Idle => (mixer.idle(dt), true),
            Demand::Wrench { wrench, yaw } => (
                mixer.mix(
                    wrench,
                    Conditions {
                        yaw,
                        battery_ratio: ratio,
                        dt,
                    },
                ),
                true,
            ),
        };
        let tilt = mixer.tilt();
        let (thrusts, commands) = if running {
            (mix.thrusts, curve.commands(&mix.thrusts, ratio))
        } else {
            ([0.0; 4], [0.0; 4])
        };
        links.mix.send(
            message.at,
            MixOutput {
                running,
                thrusts,
                commands,
                given: mix.given,
                yaw_gated: mix.yaw_gated,
                tilt: tilt.tilt(),
                tilt_bias: tilt.bias(),
                tilt_fault: tilt.fault(),
            },
        );
        record_run(links, TaskId::Mixer, message.at, started, DEADLINE);
    }
}
