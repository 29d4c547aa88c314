//! The time axis of panels and bands.

use sophie_sim::record::FlightRecord;

/// Drawing width, px; scales with the page.
pub const WIDTH: f64 = 1000.0;
/// Room for the titles on the left, px.
pub const LEFT: f64 = 74.0;
/// Room on the right, px.
pub const RIGHT: f64 = 14.0;

/// The shown part of the flight.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// First time, s.
    pub from: f64,
    /// Last time, s.
    pub to: f64,
}

impl Span {
    /// The whole flight.
    pub fn all(record: &FlightRecord) -> Self {
        Self {
            from: 0.0,
            to: record.sim_seconds.max(1.0),
        }
    }

    /// Abscissa of a time, px.
    pub fn x(self, t: f64) -> f64 {
        LEFT + (t - self.from) / (self.to - self.from) * (WIDTH - LEFT - RIGHT)
    }

    /// Whether a time is shown.
    pub fn contains(self, t: f64) -> bool {
        (self.from..=self.to).contains(&t)
    }
}
