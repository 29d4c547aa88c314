//! Underside and tip of the arm of one hinge; a beam has its own in `beam/skin.rs`.

use glam::DVec3;
use sophie_control::allocation::wrench::{FORE, SIDE};

use super::{
    ARM_LENGTH, ARM_X, ContactPoint, HINGE_Z, Pipe, PointMotion, Pose, SKIN, STATION_AREA, STATIONS, Surface,
    TIP, UNDERSIDE_Z,
};

/// Load of an arm's contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkinLoad {
    /// Force on the vehicle, N, body.
    pub force_body: DVec3,
    /// Moment about the centre of mass, N·m, body.
    pub moment_body: DVec3,
    /// Moment on the arm's tilt, N·m: force · ∂r/∂α.
    pub moment_alpha: f64,
    /// Sensor pressure, Pa.
    pub pressure: f64,
}

/// Underside of one arm on the pipe.
#[derive(Clone, Debug)]
pub struct ArmSkin {
    side: f64,
    x: f64,
    stations: [ContactPoint; 3],
}

impl ArmSkin {
    /// Skin of arm `arm`, 0 to 3.
    ///
    /// # Panics
    /// Beyond 3.
    pub fn new(arm: usize) -> Self {
        Self {
            side: -f64::from(SIDE[arm]),
            x: ARM_X * f64::from(FORE[arm]),
            stations: Default::default(),
        }
    }

    /// Body position (m) of the point `s` m along the underside at tilt `alpha` rad, and its derivative by α (m/rad),
    /// on an arc of constant curvature, level at its root, at α at its end.
    pub fn point(&self, alpha: f64, s: f64) -> (DVec3, DVec3) {
        let u = alpha * s / ARM_LENGTH;
        let (y, z, dy, dz) = if u.abs() < 1e-3 {
            // Series of the expressions below, which lose digits near a straight arm.
            let q = s * s / ARM_LENGTH;
            (
                s * (1.0 - u * u / 6.0),
                0.5 * s * u,
                -q * u / 3.0,
                q * (0.5 - u * u / 8.0),
            )
        } else {
            let (sin, cos) = libm::sincos(u);
            let radius = ARM_LENGTH / alpha;
            (
                radius * sin,
                radius * (1.0 - cos),
                (s * cos - radius * sin) / alpha,
                (s * sin - radius * (1.0 - cos)) / alpha,
            )
        };
        (
            DVec3::new(self.x, self.side * y, UNDERSIDE_Z - z),
            DVec3::new(0.0, self.side * dy, -dz),
        )
    }

    /// Advances by `dt` s at tilt (rad) and rate (rad/s).
    pub fn step(&mut self, dt: f64, alpha: f64, alpha_rate: f64, pose: &Pose, pipe: &Pipe) -> SkinLoad {
        let mut load = SkinLoad::default();
        let mut stations = self.stations;
        for (station, s) in stations.iter_mut().zip(STATIONS) {
            let (r, by_alpha) = self.point(alpha, s);
            let velocity = pose.point_velocity(r, by_alpha * alpha_rate);
            let touch = station.force(
                dt,
                &SKIN,
                PointMotion {
                    position: pose.point(r),
                    velocity,
                },
                &Surface::Pipe(*pipe),
            );
            let force = pose.to_body(touch.force);
            load.force_body += force;
            load.moment_body += r.cross(force);
            load.moment_alpha += force.dot(by_alpha);
            // The last station's remains: the sensor is there.
            load.pressure = touch.normal / STATION_AREA;
        }
        self.stations = stations;
        load
    }
}

/// Tip of one arm on the ground, without friction.
#[derive(Clone, Debug)]
pub struct ArmTip {
    side: f64,
    x: f64,
    point: ContactPoint,
}

impl ArmTip {
    /// Tip of arm `arm`, 0 to 3.
    ///
    /// # Panics
    /// Beyond 3.
    pub fn new(arm: usize) -> Self {
        let ArmSkin { side, x, .. } = ArmSkin::new(arm);
        Self {
            side,
            x,
            point: ContactPoint::default(),
        }
    }

    /// Advances by `dt` s; the load's pressure is 0.
    pub fn step(&mut self, dt: f64, alpha: f64, alpha_rate: f64, pose: &Pose) -> SkinLoad {
        let (sin, cos) = libm::sincos(alpha);
        let r = DVec3::new(self.x, self.side * ARM_LENGTH * cos, HINGE_Z - ARM_LENGTH * sin);
        let by_alpha = DVec3::new(0.0, -self.side * ARM_LENGTH * sin, -ARM_LENGTH * cos);
        let velocity = pose.point_velocity(r, by_alpha * alpha_rate);
        let touch = self.point.force(
            dt,
            &TIP,
            PointMotion {
                position: pose.point(r),
                velocity,
            },
            &Surface::Ground(0.0),
        );
        let force = pose.to_body(touch.force);
        SkinLoad {
            force_body: force,
            moment_body: r.cross(force),
            moment_alpha: force.dot(by_alpha),
            pressure: 0.0,
        }
    }
}
