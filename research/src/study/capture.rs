//! Which touches of the pipe the vehicle holds: lateral offset, lean, sink rate, sideways speed, heading, friction and
//! diameter.
//!
//! Half of the touches come from anywhere and half of those are called off, the others are what a careful pilot means:
//! of these the half-widths are measured, on four pipes.

pub mod map;
pub mod report;
mod sampling;
mod vehicle;

use std::fmt;

use sophie_sim::parallel;
use sophie_sim::scenario::Scenario;

use super::touch::{self, End, Touched};

pub use self::sampling::{GAUGES, Gauge, Planned, plan};

/// What became of a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The grip was proven, and on the pilot's demand the vehicle let go and flew away.
    Released,
    /// The grip was proven; letting go was refused or not done in time.
    Held,
    /// The arms never closed: left at once.
    Refused,
    /// The arms began to close, and the vehicle left without a grip.
    FlownAway,
    /// On the ground.
    Lost,
}

impl Outcome {
    /// Best first.
    pub const ALL: [Self; 5] = [
        Self::Released,
        Self::Held,
        Self::Refused,
        Self::FlownAway,
        Self::Lost,
    ];

    /// In tables and legends.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Released => "held and let go",
            Self::Held => "held, not let go",
            Self::Refused => "refused",
            Self::FlownAway => "flown away from",
            Self::Lost => "lost",
        }
    }

    fn of(touched: &Touched) -> Self {
        match touched.end {
            End::Lost => Self::Lost,
            // A broken propeller holds nothing, whatever the plant does with it.
            _ if touched.clearance <= 0.0 && touched.closed => Self::FlownAway,
            _ if touched.clearance <= 0.0 => Self::Refused,
            End::Released => Self::Released,
            _ if touched.proven => Self::Held,
            _ if touched.closed => Self::FlownAway,
            _ => Self::Refused,
        }
    }

    /// The grip was proven and nothing was lost.
    #[must_use]
    pub fn is_held(self) -> bool {
        matches!(self, Self::Released | Self::Held)
    }
}

/// A touch that was flown.
#[derive(Clone, Copy, Debug)]
pub struct Flown {
    /// The planned touch.
    pub planned: Planned,
    /// The flown touch.
    pub touched: Touched,
    /// What became of it.
    pub outcome: Outcome,
}

/// Which touches are flown, and with which vehicles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// How many.
    pub count: u64,
    /// Of the first; the next have the numbers after it.
    pub seed: u64,
    /// Largest heading off the pipe, rad.
    pub heading: f64,
    /// Every touch is of another vehicle: stiffness, arms and tendons are sampled. Otherwise all are of the default one.
    pub uncertain: bool,
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let vehicles = if self.uncertain {
            ", each of another vehicle"
        } else {
            ""
        };
        write!(
            f,
            "{} touches of the pipe from seed {}{vehicles}",
            self.count, self.seed
        )
    }
}

/// Flies what `request` asks for; the same request gives the same touches.
///
/// # Errors
/// One line: a vehicle did not arm.
pub fn fly(request: &Request) -> Result<Vec<Flown>, String> {
    let seeds: Vec<(u64, u64)> = (0..request.count)
        .map(|i| (i, request.seed.wrapping_add(i)))
        .collect();
    let flown = parallel::each(&seeds, |&(i, seed)| {
        let planned = plan(i, seed, request.heading);
        let vehicle = if request.uncertain {
            vehicle::sample(seed)?
        } else {
            Scenario::default_mission()
        };
        let touched = touch::fly_as(vehicle, &planned.touch, |_, _, _| ())
            .ok_or_else(|| format!("seed {seed}: the vehicle did not arm"))?;
        Ok(Flown {
            planned,
            touched,
            outcome: Outcome::of(&touched),
        })
    });
    flown.into_iter().collect()
}
