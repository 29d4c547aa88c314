//! The plant of a scenario: its vehicle as built, on its day, at its pipe.

use super::Scenario;
use crate::plant::air::Air;
use crate::plant::battery::Battery;
use crate::plant::beam::{BeamSpec, Masses};
use crate::plant::contact::Pipe;
use crate::plant::contact::pipe::Vibration;
use crate::plant::gust::Gust;
use crate::plant::hinged::link::{ArmPrint, ArmSpec};
use crate::plant::tendon::Tendon;
use crate::plant::{Parts, Plant};

impl Scenario {
    /// Arm `arm` (0 to 3) as built, at the day's temperature.
    #[must_use]
    pub fn arm_spec(&self, arm: usize) -> ArmSpec {
        let v = &self.vehicle;
        ArmSpec::of(&ArmPrint {
            coefficients: v.arm_coefficients,
            infill: v.infill,
            gain_k: v.gain_k,
            gain: self.arm_softness(arm),
            offset: v.arm_offset[arm],
            zeta: v.arm_damping,
        })
        .level_at(v.arm_level_thrust())
    }

    /// The beam of arm `arm` (0 to 3) as built.
    #[must_use]
    pub fn beam_spec(&self, arm: usize) -> BeamSpec {
        let v = &self.vehicle;
        BeamSpec::tapered(
            &self.arm_spec(arm),
            Masses::of(&v.body),
            v.arm_damping,
            v.arm_taper,
        )
        .twisting(v.arm_torsion)
    }

    /// The vehicle at rest on the ground at the origin, nose north, in its world.
    #[must_use]
    pub fn plant(&self) -> Plant {
        let (v, w) = (&self.vehicle, &self.world);
        let radius = 0.5 * w.pipe_diameter;
        Plant::new(Parts {
            chi: f64::from(v.configuration.chi()),
            bending: v.arm_bending,
            hinges: std::array::from_fn(|arm| self.arm_spec(arm)),
            beams: std::array::from_fn(|arm| self.beam_spec(arm)),
            material: v.arm_material,
            in_plane: v.in_plane(),
            body: v.body,
            coupled: v.coupled_arms,
            rotor: v.rotor,
            rotor_thrust: v.rotor_thrust,
            density: w.air.density,
            tendons: std::array::from_fn(|arm| {
                Tendon::new(self.servo_on(arm), self.tendon_on(arm))
                    .breaking(self.faults.tendon[arm], self.faults.at)
            }),
            battery: Battery::new(v.battery_charge).aged(v.battery_age, v.battery_sag),
            servo_battery: Battery::of_servos(v.servo_capacity, v.servo_charge),
            air: Air::new(v.air, self.air(), v.hover_speed(), self.streams()),
            gust: Gust::new(w.gust_force, w.gust_moment, self.streams())
                .in_wind(w.steady_wind, self.wind_from()),
            pipe: Pipe {
                north: w.pipe_position[0],
                half_length: 0.5 * w.pipe_length,
                east: w.pipe_position[1],
                down: -w.pipe_top + radius,
                radius,
                friction: w.pipe_friction,
                shape: w.pipe_shape,
            },
            vibration: Vibration::new(w.pipe_vibration, w.pipe_vibration_rate),
            restitution: v.pad_restitution,
        })
    }
}
