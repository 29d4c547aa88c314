//! Setpoint of the attitude loop as angles.

use sophie_control::attitude::attitude_loop::Target;

/// Target roll (±π), pitch (±π/2), and heading less the present one, rad.
#[must_use]
pub fn angles(target: Target) -> [f64; 3] {
    let [x, y, z] = target.down.to_array().map(f64::from);
    [
        libm::atan2(y, z),
        libm::atan2(-x, libm::hypot(y, z)),
        f64::from(target.ahead),
    ]
}

#[cfg(test)]
mod tests {
    use sophie_control::maths::vector::Quat;

    use super::*;

    #[test]
    fn the_angles_are_those_of_the_attitude() {
        let down = Quat::from_euler(0.4, -0.3, 2.0).down_in_body() * 0.9;
        let [roll, pitch, ahead] = angles(Target { down, ahead: 0.1 });
        assert!(
            (roll - 0.4).abs() < 3e-3 && (pitch + 0.3).abs() < 3e-3,
            "{roll} {pitch}"
        );
        assert!((ahead - 0.1).abs() < 1e-6);
    }
}
