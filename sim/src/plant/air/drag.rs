//! Drag by the velocity relative to the air.
//!
//! Of the body: ½ ρ C_d A |v| v. Of the rotors: linear, 0.175 N·s/m of all (RotorS), 0.33 (Faessler, of 0.61 kg), 0.38
//! (PX4's Iris); it grows with the rotors' speeds, lies in their discs and acts at their hubs, above the centre of mass:
//! a wind pitches and rolls the vehicle. Flapping blades tilt the thrust away from the wind in addition: about 0.3° per
//! m/s of a hinged blade, a1 = (8/3 θ - 2 λ) V / Ω R with θ 0.2, λ 0.09 and Ω R 69 m/s.

use glam::DVec3;

/// Drag as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DragSpec {
    /// Linear drag of the rotors in hover, together, N·s/m.
    pub linear: f64,
    /// The linear drag acts at the hubs and by the rotors' speeds; else at the centre of mass, always.
    pub on_rotors: bool,
    /// C_d A of the body, m².
    pub area: f64,
    /// Tilt of the thrust by air across the disc, rad·s/m.
    pub flapping: f64,
}

impl Default for DragSpec {
    fn default() -> Self {
        Self {
            linear: super::super::DRAG,
            on_rotors: false,
            area: 0.0,
            flapping: 0.0,
        }
    }
}

impl DragSpec {
    /// Force on the body at its centre of mass, N, at `velocity` relative to the air, m/s; any axes.
    #[must_use]
    pub fn on_body(&self, velocity: DVec3, density: f64) -> DVec3 {
        let linear = if self.on_rotors { 0.0 } else { self.linear };
        let mut force = -velocity * linear;
        if self.area > 0.0 {
            force -= velocity * (0.5 * density * self.area * velocity.length());
        }
        force
    }

    /// Whether rotors have drag of their own.
    #[must_use]
    pub fn at_hubs(&self) -> bool {
        self.on_rotors || self.flapping > 0.0
    }

    /// Force on the hub of a rotor, N, with `thrust` (N) along `axis`, at `velocity` relative to the air, m/s, and
    /// `speed` over that in hover; any axes.
    #[must_use]
    pub fn on_rotor(&self, velocity: DVec3, axis: DVec3, thrust: f64, speed: f64) -> DVec3 {
        let across = velocity - axis * velocity.dot(axis);
        let linear = if self.on_rotors {
            0.25 * self.linear * speed
        } else {
            0.0
        };
        across * -(linear + self.flapping * thrust)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REAL: DragSpec = DragSpec {
        linear: 0.3,
        on_rotors: true,
        area: 0.04,
        flapping: 0.005,
    };

    /// ½ · 1.225 · 0.04 · 5².
    #[test]
    fn the_body_s_drag_goes_with_the_square_and_against_the_motion() {
        let force = REAL.on_body(DVec3::new(3.0, -4.0, 0.0), 1.225);
        assert!(
            (force - DVec3::new(-0.3675, 0.49, 0.0)).length() < 1e-9,
            "{force}"
        );
        let linear = DragSpec::default().on_body(DVec3::new(3.0, -4.0, 0.0), 1.225);
        assert!((linear - DVec3::new(-0.9, 1.2, 0.0)).length() < 1e-12);
    }

    #[test]
    fn a_rotor_has_drag_in_its_disc_alone_and_none_at_rest() {
        let up = DVec3::NEG_Z;
        let force = REAL.on_rotor(DVec3::new(4.0, 0.0, 2.0), up, 4.4, 1.0);
        // (0.075 + 0.005 · 4.4) · 4.
        assert!((force - DVec3::new(-0.388, 0.0, 0.0)).length() < 1e-12, "{force}");
        assert_eq!(REAL.on_rotor(DVec3::X, up, 0.0, 0.0), DVec3::ZERO);
    }
}
