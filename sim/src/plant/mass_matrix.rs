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

/// A symmetric matrix, 3×3.
#[derive(Clone, Copy, Debug)]
struct Symmetric {
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    zz: f64,
}

impl Symmetric {
    /// m⁻¹ times `v`, by cofactors.
    fn solve(&self, v: DVec3) -> DVec3 {
        let Self {
            xx,
            xy,
            xz,
            yy,
            yz,
            zz,
        } = *self;
        let x = DVec3::new(yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
        let y = DVec3::new(x.y, xx * zz - xz * xz, xy * xz - xx * yz);
        let z = DVec3::new(x.z, y.z, xx * yy - xy * xy);
        DVec3::new(x.dot(v), y.dot(v), z.dot(v)) / (xx * x.x + xy * x.y + xz * x.z)
    }
}

/// 6×6 mass matrix by blocks: linear `a`, coupling (rows linear, columns angular) C, angular `j`. Entries are written
/// out, as an arm adds to few.
#[derive(Clone, Copy, Debug)]
pub struct MassMatrix {
    mass: f64,
    ayy: f64,
    ayz: f64,
    azz: f64,
    /// Σ m r of the point masses: C is its skew matrix and `c`.
    moment: DVec3,
    c: [DVec3; 3],
    j: Symmetric,
}

impl MassMatrix {
    /// Rigid part, centre of mass at `centre`; `inertia` is symmetric.
    pub fn new(mass: f64, centre: DVec3, inertia: DMat3) -> Self {
        let DMat3 {
            x_axis,
            y_axis,
            z_axis,
        } = inertia;
        Self {
            mass,
            ayy: mass,
            ayz: 0.0,
            azz: mass,
            moment: centre * mass,
            c: [DVec3::ZERO; 3],
            j: Symmetric {
                xx: x_axis.x,
                xy: y_axis.x,
                xz: z_axis.x,
                yy: y_axis.y,
                yz: z_axis.y,
                zz: z_axis.z,
            },
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
        self.j.xx += t.x * lever.x;
        self.j.xy += t.x * lever.y;
        self.j.xz += t.x * lever.z;
        self.j.yy += tx.y * lever_x.y + t.y * lever.y;
        self.j.yz += tx.y * lever_x.z + t.y * lever.z;
        self.j.zz += tx.z * lever_x.z + t.z * lever.z;
    }

    /// Adds a mass (kg) at `r`.
    pub fn add_point(&mut self, mass: f64, r: DVec3) {
        let moment = r * mass;
        self.mass += mass;
        self.ayy += mass;
        self.azz += mass;
        self.moment += moment;
        self.add_inertia_about(moment, r);
    }

    /// Adds `inertia` (kg·m²) about every axis but the unit vector `free`.
    pub fn add_inertia(&mut self, inertia: f64, free: DVec3) {
        self.add_inertia_about(free * inertia, free);
    }

    /// Adds u·v times the unit matrix less u vᵀ, for parallel vectors.
    fn add_inertia_about(&mut self, u: DVec3, v: DVec3) {
        let (xx, yy, zz) = (u.x * v.x, u.y * v.y, u.z * v.z);
        self.j.xx += yy + zz;
        self.j.yy += xx + zz;
        self.j.zz += xx + yy;
        self.j.xy -= u.x * v.y;
        self.j.xz -= u.x * v.z;
        self.j.yz -= u.y * v.z;
    }

    /// Subtracts what the two coordinates of an arm give way: Cᵀ A⁻¹ C of its `columns` C and the
    /// symmetric `inverse` of its own matrix A. No column has a linear part along x.
    pub fn give_way(&mut self, columns: &[Column; 2], inverse: &[[f64; 2]; 2]) {
        let ([p, q], [[aa, ab], [_, bb]]) = (columns, inverse);
        // p uᵀ + q vᵀ is symmetric.
        let (ly, lz) = (
            [
                aa * p.linear.y + ab * q.linear.y,
                ab * p.linear.y + bb * q.linear.y,
            ],
            [
                aa * p.linear.z + ab * q.linear.z,
                ab * p.linear.z + bb * q.linear.z,
            ],
        );
        let (u, v) = (
            p.angular * *aa + q.angular * *ab,
            p.angular * *ab + q.angular * *bb,
        );
        self.ayy -= p.linear.y * ly[0] + q.linear.y * ly[1];
        self.ayz -= p.linear.y * lz[0] + q.linear.y * lz[1];
        self.azz -= p.linear.z * lz[0] + q.linear.z * lz[1];
        self.c[1] -= u * p.linear.y + v * q.linear.y;
        self.c[2] -= u * p.linear.z + v * q.linear.z;
        self.j.xx -= p.angular.x * u.x + q.angular.x * v.x;
        self.j.xy -= p.angular.x * u.y + q.angular.x * v.y;
        self.j.xz -= p.angular.x * u.z + q.angular.x * v.z;
        self.j.yy -= p.angular.y * u.y + q.angular.y * v.y;
        self.j.yz -= p.angular.y * u.z + q.angular.y * v.z;
        self.j.zz -= p.angular.z * u.z + q.angular.z * v.z;
    }

    /// Subtracts a `mass` (kg) at `r` that gives way along x alone, with its inertia about the other axes.
    pub fn give_way_along_x(&mut self, mass: f64, r: DVec3) {
        let lever = DVec3::new(0.0, r.z, -r.y);
        self.mass -= mass;
        self.c[0] -= lever * mass;
        self.j.yy -= mass * lever.y * lever.y;
        self.j.yz -= mass * lever.y * lever.z;
        self.j.zz -= mass * lever.z * lever.z;
    }

    /// Accelerations under `load`.
    pub fn solve(&self, load: &Load) -> Acceleration {
        let Load { force, moment } = *load;
        let inv_x = 1.0 / self.mass;
        let inv_det = 1.0 / (self.ayy * self.azz - self.ayz * self.ayz);
        let (byy, byz, bzz) = (self.azz * inv_det, -self.ayz * inv_det, self.ayy * inv_det);
        let DVec3 { x, y, z } = self.moment;
        let cx = self.c[0] + DVec3::new(0.0, z, -y);
        let cy = self.c[1] + DVec3::new(-z, 0.0, x);
        let cz = self.c[2] + DVec3::new(y, -x, 0.0);
        // Rows of A⁻¹ C.
        let (gx, gy, gz) = (cx * inv_x, cy * byy + cz * byz, cy * byz + cz * bzz);
        // J - Cᵀ A⁻¹ C.
        let less = |a: f64, at: fn(DVec3) -> f64, by: fn(DVec3) -> f64| {
            a - (at(cx) * by(gx) + at(cy) * by(gy) + at(cz) * by(gz))
        };
        let j = Symmetric {
            xx: less(self.j.xx, |v| v.x, |v| v.x),
            xy: less(self.j.xy, |v| v.x, |v| v.y),
            xz: less(self.j.xz, |v| v.x, |v| v.z),
            yy: less(self.j.yy, |v| v.y, |v| v.y),
            yz: less(self.j.yz, |v| v.y, |v| v.z),
            zz: less(self.j.zz, |v| v.z, |v| v.z),
        };
        let angular = j.solve(moment - gx * force.x - gy * force.y - gz * force.z);
        let rest = force - DVec3::new(cx.dot(angular), cy.dot(angular), cz.dot(angular));
        let linear = DVec3::new(
            inv_x * rest.x,
            byy * rest.y + byz * rest.z,
            byz * rest.y + bzz * rest.z,
        );
        Acceleration { linear, angular }
    }
}
