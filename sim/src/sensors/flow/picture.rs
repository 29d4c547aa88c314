//! The correlator: one displacement for the whole picture.
//!
//! The displacement that makes two pictures differ least weights each part of them with the square of its gradient (Lucas
//! and Kanade, 1981): of a painted pipe over gravel it follows the gravel. With contrast c of a ray's surface its weight is
//! c²; of one contrast everywhere that is the geometric share alone.

use glam::{DQuat, DVec3};

use super::optics::Optics;
use crate::plant::contact::Pipe;

/// Counts of an angle, 1/rad.
pub const COUNTS: f64 = 10.5 * 180.0 / std::f64::consts::PI;
/// Half the field of view, rad, and the rays along each of its sides.
const HALF_VIEW: f64 = 21.0 / 180.0 * std::f64::consts::PI;
const RAYS: i32 = 9;
/// Least distance of a picture in focus, m, and fastest flow, rad/s.
const NEAREST: f64 = 0.08;
const FASTEST: f64 = 7.4;
/// Mean square of the contrast below which nothing is followed (assumed).
const BARE: f64 = 1e-3;

/// Flow between two pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picture {
    /// About the axes right and forward, rad, in the units of a pure rotation.
    pub flow: [f64; 2],
    /// Mean contrast of the view.
    pub contrast: f64,
}

/// Flow between two poses of the lens, `ms` apart; `None` if the lens is too near, too fast, or sees mostly sky or no
/// texture.
pub fn between(
    pipe: &Pipe,
    optics: &Optics,
    from: (DVec3, DQuat),
    to: (DVec3, DQuat),
    ms: u64,
) -> Option<Picture> {
    let (mut sum, mut weight) = ([0.0; 2], [0.0; 2]);
    let (mut rays, mut contrast, mut square) = (0.0, 0.0, 0.0);
    for i in 0..RAYS {
        for j in 0..RAYS {
            // Rays through the centres of equal parts of the view.
            let side = |k: i32| ((f64::from(k) + 0.5) / f64::from(RAYS) * 2.0 - 1.0) * libm::tan(HALF_VIEW);
            let (u, w) = (side(i), side(j));
            // A ray sees texture where it meets a surface; a ray into the sky sees none.
            let direction = to.1 * DVec3::new(u, w, 1.0);
            let Some(hit) = pipe.or_ground_hit(to.0, direction) else {
                continue;
            };
            if hit.way < NEAREST {
                return None;
            }
            let point = to.0 + direction * hit.way;
            let before = from.1.inverse() * (point - from.0);
            let c = optics.of(hit.pipe).contrast;
            let share = c * c;
            sum[0] += share * (w - before.y / before.z);
            sum[1] += share * (before.x / before.z - u);
            // Normalised by the picture of a pure rotation, as a calibration by rotation does.
            weight[0] += share * (1.0 + w * w);
            weight[1] += share * (1.0 + u * u);
            rays += 1.0;
            contrast += c;
            square += share;
        }
    }
    let half = f64::from(RAYS * RAYS) / 2.0;
    if rays < half || square < BARE * rays {
        return None;
    }
    let flow = [sum[0] / weight[0], sum[1] / weight[1]];
    let fast = FASTEST * ms as f64 * 1e-3;
    flow.iter().all(|f| f.abs() <= fast).then_some(Picture {
        flow,
        contrast: contrast / rays,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::contact::PipeShape;
    use crate::sensors::flow::optics::Look;

    const PIPE: Pipe = Pipe {
        north: 0.0,
        half_length: 5.0,
        east: 0.0,
        down: -2.15,
        radius: 0.15,
        friction: 0.6,
        shape: PipeShape::STRAIGHT,
    };

    /// Flow (rad/s, by moving north at 0.5 m/s) 0.3 m over the crown of a pipe 2.3 m over the ground.
    fn over(pipe: f64, ground: f64) -> Option<f64> {
        let look = |contrast| Look {
            contrast,
            ..Look::default()
        };
        let optics = Optics {
            pipe: look(pipe),
            ground: look(ground),
            light: None,
        };
        let at = |north| (DVec3::new(north, 0.0, -2.6), DQuat::IDENTITY);
        let picture = between(&PIPE, &optics, at(0.0), at(0.5 * 0.004), 4)?;
        Some(picture.flow[1] / 0.004)
    }

    /// A view of 42 degrees, 23 cm wide on the crown, sees the pipe alone; leaning aside it sees both.
    #[test]
    fn the_more_textured_surface_is_followed() {
        let aside = |pipe, ground| {
            let look = |contrast| Look {
                contrast,
                ..Look::default()
            };
            let optics = Optics {
                pipe: look(pipe),
                ground: look(ground),
                light: None,
            };
            let at = |north| (DVec3::new(north, 0.14, -2.6), DQuat::IDENTITY);
            let picture = between(&PIPE, &optics, at(0.0), at(0.5 * 0.004), 4).unwrap();
            picture.flow[1] / 0.004
        };
        let (even, bare_pipe, bare_ground) = (aside(1.0, 1.0), aside(0.1, 1.0), aside(1.0, 0.1));
        // Ground at 2.6 m: 0.19 rad/s; crown at 0.3 m: 1.7.
        assert!((bare_pipe - 0.5 / 2.6).abs() < 0.05, "{bare_pipe}");
        assert!(
            bare_ground > even && even > 2.0 * bare_pipe,
            "{bare_ground} {even} {bare_pipe}"
        );
        // One contrast everywhere: the geometric share.
        assert!((aside(0.3, 0.3) - even).abs() < 1e-12);
    }

    #[test]
    fn without_texture_nothing_is_followed() {
        assert!(over(1.0, 1.0).is_some());
        assert_eq!(over(0.02, 0.02), None);
    }
}
