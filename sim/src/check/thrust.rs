//! Check rows of rotor thrust.

use sophie_control::contact::contact_force::RESTING_FORCE;
use sophie_control::mode::{ESCAPE_LEAN, ESCAPE_LIFT};
use sophie_control::pilot::release_throttle::release_thrust;

use super::hover::Built;
use super::row::{Limit, Row};
use crate::plant::contact::{ARM_LENGTH, ARM_X};
use crate::plant::rotor::NOMINAL_VOLTAGE;
use crate::scenario::Scenario;

/// Share of the weight in reserve to stop sinking: 0.5 m/s² stops the failsafe's 0.8 m/s in 0.65 m.
const BRAKE: f64 = 0.05;
/// Gusts beyond this many times their RMS occur once in hours.
pub(super) const GUST_FACTOR: f64 = 3.0;
/// Vertical share of the gust force, as in the plant.
const VERTICAL: f64 = 0.5;
/// Stick share beyond which too little travel is left to climb.
const STICK_MOST: f64 = 0.85;

/// Thrust to weight at the nominal voltage.
///
/// Value: Σ T cos α(T) / W, all rotors at their largest thrust. Limit: the larger of two. The failsafe lands at
/// `battery_critical`, where a rotor gives the share s of its thrust (plant), and must stop sinking and meet gusts:
/// (1 + brake + gusts) / s. The escape from a pipe lifts with 1.35 of the weight at a lean of 8 degrees, battery full:
/// 1.35 / cos 8°.
pub fn to_weight(scenario: &Scenario, built: &Built, perches: bool) -> Row {
    let rotor = &scenario.vehicle.rotor;
    let ratio = built.lift(rotor.thrust_max) / built.weight;
    let landing = (1.0 + BRAKE + gusts(scenario) / built.weight) / critical_share(scenario);
    let escape = f64::from(ESCAPE_LIFT / libm::cosf(ESCAPE_LEAN));
    let needed = if perches { landing.max(escape) } else { landing };
    Row::new("thrust to weight", ratio, "", Limit::AtLeast(needed))
        .advise("make it lighter, or fit stronger rotors")
}

fn critical_share(scenario: &Scenario) -> f64 {
    let (rotor, critical) = (
        &scenario.vehicle.rotor,
        f64::from(scenario.params.battery_critical),
    );
    rotor.steady_thrust(1.0, critical) / rotor.steady_thrust(1.0, NOMINAL_VOLTAGE)
}

/// Thrust against gusts, N: their vertical force, and what four rotors need against their moments.
fn gusts(scenario: &Scenario) -> f64 {
    let w = &scenario.world;
    let moments = w.gust_moment * (1.0 / ARM_LENGTH + 1.0 / ARM_X);
    GUST_FACTOR * (VERTICAL * w.gust_force + moments)
}

/// Share of the throttle stick in hover.
///
/// Value: T / T_max, T a rotor's thrust, T_max the parameter: collective is proportional to the stick. Without
/// tilt W / (4 T_max).
pub fn hover_throttle(scenario: &Scenario, built: &Built) -> Row {
    let throttle = built.hover / f64::from(scenario.params.thrust_max);
    Row::new(
        "hover throttle",
        100.0 * throttle,
        "%",
        Limit::AtMost(100.0 * STICK_MOST),
    )
    .advise("make it lighter, fit stronger rotors, or set thrust_max to what they give")
}

/// Weight left on the pipe at the lowest throttle that opens the arms.
///
/// Value: W - 4 T, N, T from [`release_thrust`]. Below [`RESTING_FORCE`] resting is not detected, and the vehicle lifts
/// off with closed arms.
pub fn release(scenario: &Scenario, built: &Built) -> Row {
    let left = built.weight - f64::from(release_thrust(&scenario.params));
    Row::new(
        "weight on the pipe",
        left,
        "N",
        Limit::AtLeast(f64::from(RESTING_FORCE)),
    )
    .advise("fit weaker rotors: at the least throttle that opens the arms they lift it off the pipe")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(change: impl Fn(&mut Scenario), perches: bool) -> Row {
        let mut s = Scenario::default_mission();
        change(&mut s);
        to_weight(&s, &Built::of(&s), perches)
    }

    #[test]
    fn thrust_to_weight_by_hand() {
        // 4 · 8.3 N over 17.70 N is 1.876; arms at 12.4 degrees take 2.3 % of it.
        let default = row(|_| (), true);
        assert!(default.pass && (default.value - 1.83).abs() < 0.02, "{default:?}");
        let heavy = row(|s| s.vehicle.body.mass = 3.0, true);
        assert!(!heavy.pass && (heavy.value - 1.10).abs() < 0.02, "{heavy:?}");
    }

    #[test]
    fn without_gusts_and_with_a_battery_that_does_not_sag_only_the_brake_is_left() {
        let calm = |s: &mut Scenario| {
            (s.world.gust_force, s.world.gust_moment) = (0.0, 0.0);
            s.params.battery_critical = 14.8;
        };
        assert!((row(calm, false).limit.value() - 1.05).abs() < 1e-6);
        // Escape: 1.35 / cos 8° = 1.363.
        assert!((row(calm, true).limit.value() - 1.363).abs() < 1e-3);
    }

    #[test]
    fn the_stick_and_the_pipe_by_hand() {
        let s = Scenario::default_mission();
        let built = Built::of(&s);
        // 17.70 N of 33.2 N; 0.2 of 33.2 N lifted.
        let throttle = hover_throttle(&s, &built);
        assert!(
            throttle.pass && (throttle.value - 53.3).abs() < 0.1,
            "{throttle:?}"
        );
        let on_pipe = release(&s, &built);
        assert!(
            on_pipe.pass && (on_pipe.value - 11.06).abs() < 0.01,
            "{on_pipe:?}"
        );
    }
}
