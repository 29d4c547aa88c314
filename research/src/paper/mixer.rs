//! The printed mixer matrix and Algorithm 1: consistency, corrections, flights.

mod flown;
mod loops;
mod matrix;

use sophie_control::params::Params;
use sophie_sim::plant::GRAVITY;

use super::printed::Printed;
use super::statics::AtThrust;
use crate::results::model::Section;
use flown::{FLEXIBLE, FROZEN, Hovers, VERBATIM};

/// The mixer.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("mixer", "The mixer matrix and Algorithm 1");
    let (k, infill) = (f64::from(Params::default().gain_k), p.text.infill_percent);
    let thrust = p.mass() * GRAVITY / 4.0;
    matrix::show(&mut s, p, &AtThrust::new(infill, k, thrust));
    loops::show(&mut s, p, thrust);
    let hovers = Hovers::fly(infill, k);
    s.table(hovers.table());
    hovers.figure(&mut s, thrust);
    s.finding = format!(
        "The printed matrix is singular (rank 3); the text's own sense of rotation mends it. Completed with the sideways \
         thrust that the paper leaves out of yaw, Algorithm 1's one-step-old α diverges ({}), the inverse at the frozen \
         angle limit-cycles ({}), the quasi-static one does neither ({}).",
        hovers.outcome(VERBATIM),
        hovers.outcome(FROZEN),
        hovers.outcome(FLEXIBLE)
    );
    s
}
