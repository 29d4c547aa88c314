//! Air around the vehicle: wind, drag, inflow of the rotors, ground effect, wash on the arms.
//!
//! Everything here is still by default except the linear drag at the centre of mass.

pub mod drag;
pub mod ground_effect;
pub mod inflow;
pub mod shedding;
pub mod wash;
pub mod wind;

use glam::DVec3;
use sophie_control::allocation::wrench::PerArm;

use self::drag::DragSpec;
use self::wash::{Wash, WashSpec};
use self::wind::{Wind, WindSpec};
use super::contact::{ARM_LENGTH, ArmSkin, Pipe, Pose};
use super::load::Load;
use super::propeller::HEIGHT;
use super::rotor::Rotor;
use crate::streams::Streams;

/// The vehicle's shape in the air.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AirframeSpec {
    /// Drag.
    pub drag: DragSpec,
    /// Share of the measured change of thrust by air along a rotor's axis; 0: none.
    pub inflow: f64,
    /// Wash on the arms.
    pub wash: WashSpec,
}

/// The air of a place and a day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirSpec {
    /// Density, kg/m³.
    pub density: f64,
    /// Wind.
    pub wind: WindSpec,
    /// Share of the floor's ground effect; 0: none.
    pub ground_effect: f64,
    /// Share of the pipe's ground effect; 0: none.
    pub pipe_ground_effect: f64,
}

/// The air around the vehicle.
#[derive(Clone, Debug)]
pub struct Air {
    frame: AirframeSpec,
    spec: AirSpec,
    /// Speed of a rotor in hover, rad/s.
    hover_speed: f64,
    /// `None`: still air.
    wind: Option<Wind>,
    /// `None`: no wash.
    wash: Option<Wash>,
}

impl Air {
    /// The air of `spec` around the vehicle of `frame`, whose rotors hover at `hover_speed` rad/s.
    #[must_use]
    pub fn new(frame: AirframeSpec, spec: AirSpec, hover_speed: f64, streams: Streams) -> Self {
        Self {
            frame,
            spec,
            hover_speed,
            wind: (!spec.wind.is_calm()).then(|| Wind::new(&spec.wind, streams)),
            wash: (frame.wash != WashSpec::default()).then(|| Wash::new(frame.wash, streams)),
        }
    }

    /// Advances by `dt` s.
    pub fn step(&mut self, dt: f64, pipe: &Pipe) {
        if let Some(wind) = &mut self.wind {
            wind.step(dt, pipe);
        }
        if let Some(wash) = &mut self.wash {
            wash.step(dt);
        }
    }

    /// Velocity of the air at `point` (m, NED), m/s, NED.
    fn velocity(&self, point: DVec3, pipe: &Pipe) -> DVec3 {
        self.wind
            .as_ref()
            .map_or(DVec3::ZERO, |wind| wind.at(point, pipe))
    }

    /// Force on the body at its centre of mass, N, NED.
    #[must_use]
    pub fn on_body(&self, pose: &Pose, pipe: &Pipe) -> DVec3 {
        let relative = pose.velocity - self.velocity(pose.position, pipe);
        self.frame.drag.on_body(relative, self.spec.density)
    }

    /// Factor on each rotor's static thrust with the arms at `tilt`, rad; adds the rotors' drag to `load`.
    pub fn on_rotors(
        &self,
        pose: &Pose,
        tilt: PerArm<f64>,
        rotors: PerArm<&Rotor>,
        pipe: &Pipe,
        load: &mut Load,
    ) -> PerArm<f64> {
        let mut factors = self.wash.as_ref().map_or([1.0; 4], Wash::factors);
        let AirSpec {
            ground_effect,
            pipe_ground_effect,
            ..
        } = self.spec;
        let drag = &self.frame.drag;
        if self.frame.inflow == 0.0 && ground_effect == 0.0 && pipe_ground_effect == 0.0 && !drag.at_hubs() {
            return factors;
        }
        for (arm, factor) in factors.iter_mut().enumerate() {
            let hub = Hub::new(arm, tilt[arm]);
            let point = pose.point(hub.place);
            if ground_effect > 0.0 {
                *factor *= 1.0 + ground_effect * (ground_effect::over_floor(-point.z) - 1.0);
            }
            if pipe_ground_effect > 0.0 {
                *factor *= 1.0 + pipe_ground_effect * (ground_effect::over_pipe(point, pipe) - 1.0);
            }
            let moving = pose.point_velocity(hub.place, DVec3::ZERO);
            let relative = pose.to_body(moving - self.velocity(point, pipe));
            let speed = rotors[arm].speed();
            if self.frame.inflow > 0.0 {
                let change = inflow::factor(relative.dot(hub.axis), speed) - 1.0;
                *factor *= (1.0 + self.frame.inflow * change).max(0.0);
            }
            if drag.at_hubs() {
                let thrust = *factor * rotors[arm].thrust();
                let force = drag.on_rotor(relative, hub.axis, thrust, speed / self.hover_speed);
                load.add(force, hub.place.cross(force));
            }
        }
        factors
    }
}

/// Hub of a rotor on its bent arm.
struct Hub {
    /// m, body.
    place: DVec3,
    /// Along the thrust, body.
    axis: DVec3,
}

impl Hub {
    fn new(arm: usize, tilt: f64) -> Self {
        let (tip, _) = ArmSkin::new(arm).point(tilt, ARM_LENGTH);
        let (sin, cos) = libm::sincos(tilt);
        let axis = DVec3::new(0.0, -tip.y.signum() * sin, -cos);
        Self {
            place: tip + HEIGHT * axis,
            axis,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;
    use sophie_control::allocation::wrench::Configuration;

    use super::super::contact::PipeShape;
    use super::super::rotor::RotorSpec;
    use super::*;

    /// Pipe of the default mission.
    pub fn pipe() -> Pipe {
        Pipe {
            north: 3.0,
            half_length: 1.0,
            east: 0.0,
            down: -1.35,
            radius: 0.15,
            friction: 0.6,
            shape: PipeShape::STRAIGHT,
        }
    }

    fn air(change: impl Fn(&mut AirframeSpec, &mut AirSpec)) -> (Air, [Rotor; 4], f64) {
        let (mut frame, mut spec) = (AirframeSpec::default(), crate::scenario::World::default().air);
        change(&mut frame, &mut spec);
        let chi = f64::from(Configuration::B.chi());
        let rotors = std::array::from_fn(|arm| Rotor::turning(arm, chi, RotorSpec::default(), 4.43));
        let hover = rotors[0].speed();
        (Air::new(frame, spec, hover, Streams::new(1)), rotors, hover)
    }

    fn pose(velocity: DVec3) -> Pose {
        Pose {
            position: DVec3::new(0.0, 0.0, -5.0),
            attitude: DQuat::IDENTITY,
            velocity,
            omega: DVec3::ZERO,
        }
    }

    #[test]
    fn still_air_drags_at_the_centre_of_mass_and_leaves_the_thrust() {
        let (air, rotors, _) = air(|_, _| ());
        let (pose, mut load) = (pose(DVec3::new(1.0, 2.0, -3.0)), Load::default());
        let factors = air.on_rotors(&pose, [0.2; 4], rotors.each_ref(), &pipe(), &mut load);
        assert_eq!((factors, load), ([1.0; 4], Load::default()));
        assert!((air.on_body(&pose, &pipe()) - DVec3::new(-0.3, -0.6, 0.9)).length() < 1e-12);
    }

    /// A vehicle that drifts with the wind meets still air; a wind from ahead pushes back and pitches up.
    #[test]
    fn drag_is_that_of_the_motion_against_the_air() {
        let (air, rotors, _) = air(|frame, spec| {
            frame.drag.on_rotors = true;
            frame.drag.area = 0.04;
            spec.wind.speed = 5.0;
        });
        let at = |velocity: DVec3| {
            let mut load = Load::default();
            let pose = pose(velocity);
            air.on_rotors(&pose, [0.0; 4], rotors.each_ref(), &pipe(), &mut load);
            load.force += pose.to_body(air.on_body(&pose, &pipe()));
            load
        };
        let drifting = at(DVec3::new(-5.0, 0.0, 0.0));
        assert!(drifting.force.length() < 1e-12 && drifting.moment.length() < 1e-12);
        let standing = at(DVec3::ZERO);
        // 0.3 · 5 and ½ · 1.225 · 0.04 · 25.
        assert!(
            (standing.force.x + 1.5 + 0.6125).abs() < 1e-9,
            "{}",
            standing.force
        );
        // Hubs 26 mm above the centre of mass: the force at them pitches the nose up.
        assert!(
            (standing.moment.y - 1.5 * (HEIGHT - 0.035)).abs() < 1e-9,
            "{}",
            standing.moment
        );
    }

    #[test]
    fn sinking_and_rolling_are_damped() {
        let (air, rotors, _) = air(|frame, _| frame.inflow = 1.0);
        let factors = |velocity, omega| {
            let pose = Pose {
                omega,
                ..pose(velocity)
            };
            air.on_rotors(&pose, [0.0; 4], rotors.each_ref(), &pipe(), &mut Load::default())
        };
        let sinking = factors(DVec3::new(0.0, 0.0, 1.0), DVec3::ZERO);
        let more = sinking.map(|factor| 4.43 * (factor - 1.0)).iter().sum::<f64>();
        assert!((more - 0.9).abs() < 0.05, "{more}");
        // Rolling to the right, the right rotors sink and pull more.
        let rolling = factors(DVec3::ZERO, DVec3::new(1.0, 0.0, 0.0));
        for (arm, factor) in rolling.iter().enumerate() {
            let right = ArmSkin::new(arm).point(0.0, 0.1).0.y > 0.0;
            assert_eq!(*factor > 1.0, right, "{rolling:?}");
        }
    }

    #[test]
    fn the_floor_lifts_a_low_vehicle() {
        let (air, rotors, _) = air(|_, spec| spec.ground_effect = 1.0);
        let mut low = pose(DVec3::ZERO);
        low.position.z = -0.2;
        let factors =
            |pose: &Pose| air.on_rotors(pose, [0.0; 4], rotors.each_ref(), &pipe(), &mut Load::default());
        assert!(factors(&low).iter().all(|factor| (1.05..1.2).contains(factor)));
        assert!(
            factors(&pose(DVec3::ZERO))
                .iter()
                .all(|factor| (factor - 1.0).abs() < 1e-3)
        );
    }
}
