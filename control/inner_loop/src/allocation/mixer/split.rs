//! A wrench split into patterns of thrust to be given up in turn.

use crate::allocation::desaturation::Patterns;
use crate::allocation::effectiveness::{Geometry, Inverse, Load};
use crate::allocation::wrench::{FORE, PerArm, SIDE, Wrench, YAW};
use crate::maths::scalar;

/// Patterns of a wrench and its yaw's authority.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// Thrusts of collective, roll and pitch, and yaw, N.
    pub patterns: Patterns,
    /// Share of the yaw pattern that has authority, 0..1.
    pub fade: f32,
}

/// Moments of `w` as patterns, with the thrusts per newton of collective but without it.
#[inline(always)]
pub fn moment_patterns(geometry: &Geometry, inverse: &Inverse, w: Wrench) -> Patterns {
    // Adding -0 leaves the other number, without an instruction.
    let moments = Load::of(
        geometry,
        Wrench {
            thrust: -0.0,
            yaw: -0.0,
            ..w
        },
    );
    Patterns {
        collective: [0.0; 4],
        shift: inverse.solve(Load {
            front: 0.5,
            rear: 0.5,
            roll: -0.0,
            yaw: -0.0,
        }),
        roll_pitch: inverse.solve(moments),
        yaw: inverse.solve_yaw(w.yaw),
    }
}

/// The printed matrix: stiff levers for roll, pitch and yaw, the cosine of `tilt` (rad) only in the thrust row.
pub fn stiff(geometry: &Geometry, w: Wrench, tilt: PerArm<f32>) -> Split {
    let roll = 0.25 * w.roll / geometry.d;
    let pitch = 0.25 * w.pitch / geometry.b;
    let yaw = 0.25 * w.yaw / geometry.drag;
    let lift = tilt.map(scalar::cos);
    let mut p = Patterns::default();
    let mut moments_lift = 0.0;
    for ((rp, y), (s, (f, (n, l)))) in p
        .roll_pitch
        .iter_mut()
        .zip(&mut p.yaw)
        .zip(SIDE.iter().zip(FORE.iter().zip(YAW.iter().zip(&lift))))
    {
        *rp = s * roll + f * pitch;
        *y = n * yaw;
        moments_lift += l * (*rp + *y);
    }
    let inv_lift = 1.0 / lift.iter().sum::<f32>();
    p.collective = [(w.thrust - moments_lift) * inv_lift; 4];
    p.shift = [inv_lift; 4];
    Split {
        patterns: p,
        fade: 1.0,
    }
}
