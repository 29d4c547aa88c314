//! The control loops in hover, identified from the code that flies.
//!
//! A loop is opened between control and mixer. `vehicle` has the response of body rates to a moment (allocation, thrust
//! curve, plant), `laws` that of the moment to a body rate (filter, attitude and rate loop). Each is identified by an
//! impulse of one step of 1 ms; their product is the loop's gain L(e^{jωT}), which gives the [`margins`].

mod hold;
mod laws;
mod margins;
mod response;
mod resting;
mod vehicle;

pub use hold::hold_margins;
pub use laws::Laws;
pub use margins::Margins;
pub use response::{Complex, Response};
pub use resting::{Place, resting_margins, slide};
#[cfg(test)]
pub use vehicle::STEPS;
pub use vehicle::{AXES, Hovering};

use sophie_control::chain::CONTROL_RATE_HZ;

use crate::scenario::Scenario;

/// Step of attitude and rate loop, s.
const STEP: f64 = 1.0 / CONTROL_RATE_HZ as f64;
/// Lowest frequency, rad/s: below every integral's corner.
const LOWEST: f64 = 1e-3;
/// 3 % apart, which finds a margin to 1 %.
const PER_DECADE: f64 = 60.0;

/// Margins about roll, pitch and yaw of the vehicle of `scenario` in hover.
#[must_use]
pub fn margins(scenario: &Scenario) -> [Margins; 3] {
    let laws = Laws::of(&scenario.params);
    let hovering = Hovering::of(scenario);
    std::array::from_fn(|axis| margins_of(&hovering.response(axis), &laws, axis))
}

/// Margins of the loop about `axis` that `laws` close around `vehicle`'s response about it.
#[must_use]
pub fn margins_of(vehicle: &Response, laws: &Laws, axis: usize) -> Margins {
    let curve: Vec<_> = frequencies()
        .map(|omega| {
            let angle = omega / f64::from(CONTROL_RATE_HZ);
            // A measurement at the end of a step acts in the next one.
            let delay = Complex::from_angle(-angle);
            let gain = vehicle.at(angle).rotate(laws.at(axis, angle)).rotate(delay);
            (omega, gain)
        })
        .collect();
    Margins::of(&curve, STEP)
}

/// From [`LOWEST`] to half the control rate, rad/s.
fn frequencies() -> impl Iterator<Item = f64> {
    rising(LOWEST, std::f64::consts::PI / STEP)
}

/// From `low` to `top`, [`PER_DECADE`].
fn rising(low: f64, top: f64) -> impl Iterator<Item = f64> {
    let count = (libm::log10(top / low) * PER_DECADE) as i32;
    (0..=count).map(move |i| low * libm::pow(top / low, f64::from(i) / f64::from(count)))
}

#[cfg(test)]
mod tests;
