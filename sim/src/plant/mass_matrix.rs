//! Mass matrix (6×6) of the body with its arms condensed into it, and its solution.

use glam::{DMat3, DVec3};

use crate::plant::load::Acceleration;
use crate::plant::load::Load;

/// Momentum of the body per unit rate of one coordinate of an arm.
#[derive(Clone, Copy, Debug, Default)]
pub struct Column {
    /// Linear momentum per rate, kg·m.
    pub linear: DVec3,
    /// Angular momentum per rate, kg·m².
    pub angular: DVec3,
}

impl Column {
    /// `a` times `self` and `b` times `other`.
    #[must_use]
    pub fn mixed(&self, a: f64, other: &Self, b: f64) -> Self {
        Self {
            linear: self.linear * a + other.linear * b,
            angular: self.angular * a + other.angular * b,
        }
    }
}

/// 6×6 mass matrix by blocks: linear `a`, coupling (rows linear, columns angular) `c`, angular `j`. Entries are written
/// out, as a tip adds to few: this takes a third of the plant's time.
#[derive(Clone, Copy, Debug)]
pub struct MassMatrix {
    mass: f64,
    ayy: f64,
    ayz: f64,
    azz: f64,
    c: [DVec3; 3],
    j: DMat3,
}

impl MassMatrix {
    /// Rigid part, centre of mass at `centre`.
    pub fn new(mass: f64, centre: DVec3, inertia: DMat3) -> Self {
        let DVec3 { x, y, z } = centre * mass;
        let c = [
            DVec3::new(0.0, z, -y),
            DVec3::new(-z, 0.0, x),
            DVec3::new(y, -x, 0.0),
        ];
        Self {
            mass,
            ayy: mass,
            ayz: 0.0,
            azz: mass,
            c,
            j: inertia,
        }
    }

    /// Adds a `tip` (kg) at `r`, held along x and the unit vector `along` in the y-z plane.
    pub fn add_tip(&mut self, tip: f64, r: DVec3, along: DVec3) {
        let (ey, ez) = (along.y, along.z);
        let lever_x = DVec3::new(0.0, r.z, -r.y);
        let lever = DVec3::new(r.y * ez - r.z * ey, -r.x * ez, r.x * ey);
        let (mx, my, mz) = (tip, tip * ey, tip * ez);
        self.mass += mx;
        self.ayy += my * ey;
        self.ayz += my * ez;
        self.azz += mz * ez;
        self.c[0] += lever_x * mx;
        self.c[1] += lever * my;
        self.c[2] += lever * mz;
        let (tx, t) = (lever_x * tip, lever * tip);
        self.j.x_axis += t * lever.x;
        self.j.y_axis += tx * lever_x.y + t * lever.y;
        self.j.z_axis += tx * lever_x.z + t * lever.z;
    }

    /// Adds a mass (kg) at `r`.
    pub fn add_point(&mut self, mass: f64, r: DVec3) {
        let DVec3 { x, y, z } = r * mass;
        self.mass += mass;
        self.ayy += mass;
        self.azz += mass;
        self.c[0] += DVec3::new(0.0, z, -y);
        self.c[1] += DVec3::new(-z, 0.0, x);
        self.c[2] += DVec3::new(y, -x, 0.0);
        self.add_inertia_about(r.length_squared() * mass, r * mass, r);
    }

    /// Adds `inertia` (kg·m²) about every axis but the unit vector `free`.
    pub fn add_inertia(&mut self, inertia: f64, free: DVec3) {
        self.add_inertia_about(inertia, free * inertia, free);
    }

    /// Adds `all` times the unit matrix less u vᵀ.
    fn add_inertia_about(&mut self, all: f64, u: DVec3, v: DVec3) {
        self.j.x_axis += DVec3::X * all - u * v.x;
        self.j.y_axis += DVec3::Y * all - u * v.y;
        self.j.z_axis += DVec3::Z * all - u * v.z;
    }

    /// Subtracts u vᵀ; the calls of one step must sum to a symmetric matrix. Neither vector has a linear part along x.
    pub fn give_way(&mut self, u: &Column, v: &Column) {
        self.ayy -= u.linear.y * v.linear.y;
        self.ayz -= u.linear.y * v.linear.z;
        self.azz -= u.linear.z * v.linear.z;
        self.c[1] -= v.angular * u.linear.y;
        self.c[2] -= v.angular * u.linear.z;
        self.j.x_axis -= u.angular * v.angular.x;
        self.j.y_axis -= u.angular * v.angular.y;
        self.j.z_axis -= u.angular * v.angular.z;
    }

    /// Accelerations under `load`.
    pub fn solve(&self, load: &Load) -> Acceleration {
        let Load { force, moment } = *load;
        let inv_x = 1.0 / self.mass;
        let inv_det = 1.0 / (self.ayy * self.azz - self.ayz * self.ayz);
        let (byy, byz, bzz) = (self.azz * inv_det, -self.ayz * inv_det, self.ayy * inv_det);
        let [cx, cy, cz] = self.c;
        // Rows of A⁻¹ C.
        let (gx, gy, gz) = (cx * inv_x, cy * byy + cz * byz, cy * byz + cz * bzz);
        let mut j = self.j;
        j.x_axis -= cx * gx.x + cy * gy.x + cz * gz.x;
        j.y_axis -= cx * gx.y + cy * gy.y + cz * gz.y;
        j.z_axis -= cx * gx.z + cy * gy.z + cz * gz.z;
        let angular = j.inverse() * (moment - gx * force.x - gy * force.y - gz * force.z);
        let rest = force - DVec3::new(cx.dot(angular), cy.dot(angular), cz.dot(angular));
        let linear = DVec3::new(
            inv_x * rest.x,
            byy * rest.y + byz * rest.z,
            byz * rest.y + bzz * rest.z,
        );
        Acceleration { linear, angular }
    }
}
