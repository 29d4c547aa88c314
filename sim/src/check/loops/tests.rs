//! The identified loops against a vehicle simple enough for a formula.

use super::*;

#[test]
fn stiff_level_arms_leave_the_motor_and_the_inertia() {
    let mut s = Scenario::default_mission();
    s.vehicle.coupled_arms = false;
    s.vehicle.arm_coefficients = [0.1, 0.0, 0.0, 0.0];
    s.vehicle.gain_k = 1.0;
    s.params.gain_k = 1.0;
    (s.params.arm_a1, s.params.arm_a2, s.params.arm_b1, s.params.arm_b2) = (0.1, 0.0, 0.0, 0.0);
    // The plant's curve of command to thrust is not the stack's: the gain is the slope of one at the other.
    let hovering = Hovering::of(&s);
    for (axis, inertia) in [0.021, 0.044, 0.063].into_iter().enumerate() {
        let response = hovering.response(axis);
        let slow = response.at(1e-3).length();
        for omega in [1.0, 10.0, 20.0, 60.0] {
            let lag = 1.0 / f64::hypot(1.0, 0.05 * omega);
            let gain = response.at(1e-3 * omega).length() * omega / slow;
            assert!(
                (gain / lag - 1.0).abs() < 0.03,
                "axis {axis}, {omega} rad/s: {gain} {lag}"
            );
        }
        let curve = slow * inertia;
        assert!((0.8..1.25).contains(&curve), "axis {axis}: {curve}");
    }
}
