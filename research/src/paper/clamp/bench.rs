//! Closings of one arm on the bench, over infill and diameter.

use sophie_charts::units::kgcm;
use sophie_control::gripper::grip::ArmState;
use sophie_control::params::Params;
use sophie_sim::parallel;
use sophie_sim::plant::tendon::ServoProfile;
use sophie_sim::plant::tendon::ServoSpec;
use sophie_sim::test_stands::arm_stand::{Closed, Closing, close};

use super::super::printed::Printed;

/// Infills (%) and diameters (m) tried.
pub const INFILLS: [f64; 4] = [6.0, 6.9, 8.0, 10.0];
pub const DIAMETERS: [f64; 5] = [0.20, 0.25, 0.30, 0.35, 0.40];
/// Seeds of the noise; closure times are their mean.
pub const SEEDS: u64 = 5;

/// A closing of the grid.
pub struct OnBench {
    /// Infill, %.
    pub infill: f64,
    /// Pipe diameter, m.
    pub diameter: f64,
    pub closed: Closed,
}

impl OnBench {
    /// The arm proved its grip and holds.
    pub fn holds(&self) -> bool {
        holds(&self.closed)
    }

    /// Steady force, kgcm; NaN if the arm does not hold.
    pub fn held_force(&self) -> f64 {
        if self.holds() {
            kgcm(self.closed.steady)
        } else {
            f64::NAN
        }
    }
}

/// Every infill on every pipe, the paper's servo.
pub fn grid(p: &Printed) -> Vec<OnBench> {
    let servo: ServoSpec = ServoProfile::Paper.into();
    let jobs: Vec<(f64, f64)> = INFILLS
        .iter()
        .flat_map(|i| DIAMETERS.iter().map(move |d| (*i, *d)))
        .collect();
    parallel::each(&jobs, |(infill, diameter)| OnBench {
        infill: *infill,
        diameter: *diameter,
        closed: mean_closing(*infill, *diameter, servo, closing_thrust(p)),
    })
}

/// The first seed's closing, with the mean closure time of all seeds.
pub fn mean_closing(infill: f64, diameter: f64, servo: ServoSpec, thrust: f64) -> Closed {
    let mut first = once(infill, diameter, servo, thrust, 1);
    let others = (2..=SEEDS).map(|seed| once(infill, diameter, servo, thrust, seed).closure);
    let all: Option<Vec<f64>> = [first.closure].into_iter().chain(others).collect();
    first.closure = all.map(|times| times.iter().sum::<f64>() / times.len() as f64);
    first
}

/// A closing with one seed.
pub fn once(infill: f64, diameter: f64, servo: ServoSpec, thrust: f64, seed: u64) -> Closed {
    close(&Closing {
        infill,
        diameter,
        servo,
        thrust,
        seconds: 12.0,
        seed,
    })
}

/// Rotor thrust while closing, N: the paper's throttle.
pub fn closing_thrust(p: &Printed) -> f64 {
    0.01 * p.text.clamp_throttle_percent * f64::from(Params::default().thrust_max)
}

/// The arm proved its grip and holds.
pub fn holds(c: &Closed) -> bool {
    c.state == ArmState::Holding && c.closure.is_some()
}
