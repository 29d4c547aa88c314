//! Which touches of the pipe the vehicle holds: lateral offset, lean, sink rate, sideways speed, heading, friction and
//! diameter.
//!
//! Half of the touches come from anywhere and half of those are called off, the others are what a careful pilot means:
//! of these the half-widths are measured, on four pipes.

mod draw;
pub mod map;
pub mod report;

use sophie_sim::parallel;

use super::touch::{self, End, Touched};

pub use self::draw::{GAUGES, Gauge, Planned, plan};

/// What became of a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The grip was proven, and on the pilot's wish the vehicle let go and flew away.
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
    /// What was meant.
    pub planned: Planned,
    /// What was seen.
    pub touched: Touched,
    /// What became of it.
    pub outcome: Outcome,
}

/// Flies `count` touches with the seeds `seed`, `seed` + 1, …, headed up to `heading` (rad) off the pipe; the same arguments
/// give the same touches.
///
/// # Errors
/// One line: a vehicle did not arm.
pub fn fly(count: u64, seed: u64, heading: f64) -> Result<Vec<Flown>, String> {
    let planned: Vec<Planned> = (0..count)
        .map(|i| plan(i, seed.wrapping_add(i), heading))
        .collect();
    let flown = parallel::each(&planned, |planned| {
        let touched = touch::fly(&planned.touch)?;
        Some(Flown {
            planned: *planned,
            touched,
            outcome: Outcome::of(&touched),
        })
    });
    flown
        .into_iter()
        .zip(&planned)
        .map(|(flown, planned)| {
            let seed = planned.touch.seed;
            flown.ok_or_else(|| format!("seed {seed}: the vehicle did not arm"))
        })
        .collect()
}
