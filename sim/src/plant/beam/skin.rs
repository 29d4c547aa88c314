//! Underside and tip of a bent arm against pipe and ground: the law of [`contact`](super::super::contact), points that
//! follow the shape.

use glam::DVec3;

use super::super::contact::{
    ARM_LENGTH, ContactPoint, HINGE_Z, Pad, Pipe, PointMotion, Pose, SKIN, STATION_AREA, STATIONS, Surface,
    TIP, Touch,
};
use super::super::flexible::Nearby;
use super::shape::{Point, points, sin_cos, slope};
use super::{DEPTH, PerTerm, TERMS};
use crate::plant::load::Load;

/// Shape, motion and place of an arm.
#[derive(Clone, Copy, Debug)]
pub struct Bent {
    /// Terms of the shape, rad.
    pub q: PerTerm,
    /// Rates of the terms, rad/s.
    pub rate: PerTerm,
    /// Root of the arm, m, body.
    pub x: f64,
    /// Side of the arm: +1 right, -1 left.
    pub side: f64,
}

/// A point of the arm that may touch, body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinPoint {
    /// Position, m.
    pub place: DVec3,
    /// ∂place/∂q, m.
    pub by: [DVec3; TERMS],
}

impl Bent {
    /// The points of the underside under the stations, each square to the neutral line.
    #[must_use]
    pub fn underside(&self) -> [SkinPoint; 3] {
        let ends = STATIONS.map(|s| s / ARM_LENGTH);
        let neutral = points(&self.q, &self.rate, ends);
        let [a, b, c] = ends.map(|xi| slope(&self.q, xi));
        let ((sin, cos), (last_sin, last_cos)) = (sin_cos([a, b]), sin_cos([c, 0.0]));
        let [inner, middle, outer] = &neutral;
        [
            self.skin_point(inner, ends[0], DEPTH, (sin[0], cos[0])),
            self.skin_point(middle, ends[1], DEPTH, (sin[1], cos[1])),
            self.skin_point(outer, ends[2], DEPTH, (last_sin[0], last_cos[0])),
        ]
    }

    /// End of the neutral line.
    #[must_use]
    pub fn tip(&self) -> SkinPoint {
        let [tip] = points(&self.q, &self.rate, [1.0]);
        self.skin_point(&tip, 1.0, 0.0, (0.0, 0.0))
    }

    /// `depth` m below the neutral line's `point` at ξ, where the slope has `sin` and `cos`.
    #[inline(always)]
    fn skin_point(&self, point: &Point, xi: f64, depth: f64, (sin, cos): (f64, f64)) -> SkinPoint {
        let body = |out: f64, up: f64| DVec3::new(0.0, self.side * out, -up);
        let mut power = 1.0;
        let by = std::array::from_fn(|k| {
            power *= xi;
            body(
                point.out_by[k] + depth * cos * power,
                point.up_by[k] + depth * sin * power,
            )
        });
        let place = DVec3::new(self.x, 0.0, HINGE_Z) + body(point.out + depth * sin, point.up - depth * cos);
        SkinPoint { place, by }
    }
}

/// Contacts of an arm.
#[derive(Clone, Debug, Default)]
pub struct BeamContact {
    stations: [ContactPoint; 3],
    tip: ContactPoint,
    /// Generalised forces of the last step, N·m.
    pub forces: PerTerm,
}

impl BeamContact {
    /// Advances by `dt` s; adds the forces to `load` and returns the sensor's pressure, Pa.
    pub fn step(&mut self, dt: f64, arm: &Bent, pose: &Pose, nearby: &Nearby, load: &mut Load) -> f64 {
        self.forces = [0.0; TERMS];
        let pressure = nearby.pipe.map_or(0.0, |pipe| {
            self.on_pipe(dt, arm, pose, &pipe, nearby.rebound, load)
        });
        if nearby.ground {
            let mut tip = self.tip;
            self.press(
                dt,
                &mut tip,
                &TIP,
                &arm.tip(),
                &Touched {
                    arm,
                    pose,
                    surface: &Surface::Ground(0.0),
                },
                load,
            );
            self.tip = tip;
        }
        pressure
    }

    fn on_pipe(
        &mut self,
        dt: f64,
        arm: &Bent,
        pose: &Pose,
        pipe: &Pipe,
        rebound: f64,
        load: &mut Load,
    ) -> f64 {
        let skin = SKIN.rebounding(rebound);
        let surface = Surface::Pipe(*pipe);
        let mut normal = 0.0;
        let mut stations = self.stations;
        for (station, skin_point) in stations.iter_mut().zip(arm.underside()) {
            // The last station's remains: the sensor is there.
            normal = self.press(
                dt,
                station,
                &skin,
                &skin_point,
                &Touched {
                    arm,
                    pose,
                    surface: &surface,
                },
                load,
            );
        }
        self.stations = stations;
        normal / STATION_AREA
    }

    /// Returns the normal force, N.
    fn press(
        &mut self,
        dt: f64,
        point: &mut ContactPoint,
        pad: &Pad,
        skin_point: &SkinPoint,
        touched: &Touched<'_>,
        load: &mut Load,
    ) -> f64 {
        let Touched { arm, pose, surface } = touched;
        let moving = skin_point.by[0] * arm.rate[0] + skin_point.by[1] * arm.rate[1];
        let motion = PointMotion {
            position: pose.point(skin_point.place),
            velocity: pose.point_velocity(skin_point.place, moving),
        };
        let touch = point.force(dt, pad, motion, surface);
        if touch == Touch::default() {
            return 0.0;
        }
        let force = pose.to_body(touch.force);
        load.add(force, skin_point.place.cross(force));
        for (sum, by) in self.forces.iter_mut().zip(skin_point.by) {
            *sum += force.dot(by);
        }
        touch.normal
    }
}

struct Touched<'a> {
    arm: &'a Bent,
    pose: &'a Pose,
    surface: &'a Surface,
}
