//! Thrust of a rotor near a surface below.
//!
//! Over a floor, by images of all four rotors (P. J. Sanchez-Cuevas, G. Heredia, A. Ollero, "Characterization of the
//! aerodynamic ground effect and its influence in multirotor control", 2017):
//! T/T∞ = 1 / (1 - (R/4z)² - R² z/(d² + 4z²)^1.5 - R² z/2(2d² + 4z²)^1.5 - 2 R² z K/(b² + 4z²)^1.5), z the hub's height, d
//! the distance of neighbours, b that of opposite hubs, K 2.
//!
//! Over a pipe: the gain of the rotor's own image, 1 / (1 - (R/4z)²) (Cheeseman and Bennett 1955), times the share of the
//! disc that has the pipe below it; the air of the other rotors flows past. A rotor farther over the pipe pulls more: the
//! moment pushes the vehicle off its crown, by 0.03 N·m at 20 mm and z = 0.1 m.

use core::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::super::contact::{ARM_LENGTH, Pipe};
use super::super::propeller::RADIUS;

/// Distance of neighbouring hubs, m.
const NEIGHBOURS: f64 = 2.0 * ARM_LENGTH;
/// Empirical factor of the air that rises between the rotors.
const BODY: f64 = 2.0;
/// Lowest height of the formula over the radius: a rotor on standing arms has 0.75.
const LOWEST: f64 = 0.5;

/// What the rotor's own image takes from 1 at the hub's height `z`, m.
fn own_image(z: f64) -> f64 {
    let share = RADIUS / (4.0 * z);
    share * share
}

/// Factor on the thrust of a rotor `height` m above a floor.
#[must_use]
pub fn over_floor(height: f64) -> f64 {
    let z = height.max(LOWEST * RADIUS);
    let (r2, d2) = (RADIUS * RADIUS, NEIGHBOURS * NEIGHBOURS);
    let image = |distance2: f64| {
        let far = distance2 + 4.0 * z * z;
        z / (far * far.sqrt())
    };
    let less = own_image(z)
        + r2 * image(d2)
        + 0.5 * r2 * image(2.0 * d2)
        // Opposite hubs are √2 d apart.
        + 2.0 * BODY * r2 * image(2.0 * d2);
    1.0 / (1.0 - less)
}

/// Factor on the thrust of a rotor with its hub at `hub` (m, NED) over `pipe`.
#[must_use]
pub fn over_pipe(hub: DVec3, pipe: &Pipe) -> f64 {
    let across = pipe.across(hub);
    let height = -across.y - pipe.radius;
    if height <= 0.0 || (hub.x - pipe.north).abs() > pipe.half_length {
        return 1.0;
    }
    let own = 1.0 / (1.0 - own_image(height.max(LOWEST * RADIUS)));
    1.0 + (own - 1.0) * share_over(across.x, pipe.radius)
}

/// Share of a disc's area over a strip of half width `half` (m), its centre `aside` (m) of the strip's middle.
fn share_over(aside: f64, half: f64) -> f64 {
    // Share of the disc left of a chord at `x` radii.
    let left = |x: f64| {
        let x = x.clamp(-1.0, 1.0);
        (libm::asin(x) + x * (1.0 - x * x).sqrt() + FRAC_PI_2) / PI
    };
    left((half - aside) / RADIUS) - left((-half - aside) / RADIUS)
}

#[cfg(test)]
mod tests {
    use super::super::tests::pipe;
    use super::*;

    /// One term after the other by hand at z = R: 0.0625, 0.1270³ / (0.1267 + 0.0645)^1.5 = 0.0245, 0.0058, 0.0463.
    #[test]
    fn the_floor_s_gain_is_the_formula_s_and_ends_with_height() {
        assert!(
            (1.0 / over_floor(RADIUS) - (1.0 - 0.1391)).abs() < 1e-3,
            "{}",
            over_floor(RADIUS)
        );
        // Cheeseman and Bennett's single rotor gives 1.067 there: a multirotor gains more.
        assert!(over_floor(RADIUS) > 1.0 / (1.0 - 0.0625));
        // Published: the effect reaches up to about five radii.
        assert!(over_floor(5.0 * RADIUS) < 1.03);
        assert!(over_floor(3.0) - 1.0 < 2e-3);
        assert_eq!(over_floor(0.0), over_floor(LOWEST * RADIUS));
    }

    #[test]
    fn a_rotor_on_an_arm_has_a_third_of_its_disc_over_the_pipe() {
        let share = share_over(ARM_LENGTH, 0.15);
        assert!((share - 0.36).abs() < 0.02, "{share}");
        assert!((share_over(0.0, 1.0) - 1.0).abs() < 1e-12);
        assert!(share_over(0.5, 0.15).abs() < 1e-12);
        assert!((share_over(0.02, 0.06) - share_over(-0.02, 0.06)).abs() < 1e-12);
    }

    /// East of the crown, the western rotors come over the pipe: their thrust rolls the vehicle on to the east.
    #[test]
    fn off_the_crown_the_pipe_pushes_on() {
        let p = pipe();
        let top = p.down - p.radius;
        let gain = |east: f64| over_pipe(DVec3::new(p.north, p.east + east, top - 0.1), &p);
        let (west, right) = (gain(0.02 - ARM_LENGTH), gain(0.02 + ARM_LENGTH));
        assert!(west > right && right > 1.0, "{west} {right}");
        // Two rotors a side of 4.43 N on levers of 0.178 m.
        let moment = 2.0 * 4.43 * ARM_LENGTH * (west - right);
        assert!((0.02..0.05).contains(&moment), "{moment}");
        assert_eq!(over_pipe(DVec3::new(p.north, p.east, top + 0.1), &p), 1.0);
        assert_eq!(over_pipe(DVec3::new(p.north + 5.0, p.east, top - 0.1), &p), 1.0);
    }
}
