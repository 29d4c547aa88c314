//! What a time-of-flight sensor makes of all that its beam meets.
//!
//! Of a patch of diffuse reflectivity ρ at r, met at the incidence i, the sensor collects ρ cos i / r². Sunlight that the
//! same patches scatter adds shot noise, so that the least signal grows with the root of 1 + ρ L / L₀, and the reach is
//!
//! r_max = R · √(ρ cos i / 0.9) · (1 + ρ L / (0.9 L₀))^-1/4.
//!
//! | | | source |
//! |---|---|---|
//! | reach R in the dark, ρ 0.9 | 2.5 m, or 8 m | the makers' tables of the MTF-02 and the MTF-01: 90 %, 600 lux (2.4 m here) |
//! | L₀ | 3,900 lux | 1.1 m at 100,000 lux: 1.0 to 1.2 m in the sun (INAV, issues 10487 and 7622) |
//! | share of returns | 1 at 0.9 of the reach, 0 at 1.1 | assumed |
//! | gloss | beyond 12° of incidence its share follows the mirrored ray | 10 to 15° (assumed); glossy black reads 1 to 10 m at centimetres |
//! | two targets | the mean, each with its signal's weight | users of ST's sensors; without mixed pixels the weighted median |
//!
//! The mirrored ray's target is as far as both ways together; into the sky it has no return.

use glam::{DQuat, DVec3};

use super::optics::Optics;
use super::range_beam::HALF_BEAM;
use crate::plant::contact::Pipe;

/// Reflectivity that the reach is stated for.
const REACH_REFLECTIVITY: f64 = 0.9;
/// Light at which the sun's shot noise equals the sensor's own, lux.
const HALF_LIGHT: f64 = 3.9e3;
/// Incidence within which a mirror returns the beam to the sensor: its cosine.
const LOBE: f64 = 0.978;
/// Rays along each side of the beam's square, of which those in the circle count.
const RAYS: i32 = 7;
/// Shares of the reach from which returns begin to be missing, and at which the last one is.
const FADES: (f64, f64) = (0.9, 1.1);

/// The return of one beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Echo {
    /// Range, m.
    pub range: f64,
    /// Over a white surface in the dark, the range that has as strong a signal over the noise, m.
    pub as_white: f64,
}

impl Echo {
    /// Probability that a sensor that reaches `reach` m over a white surface in the dark has a return.
    #[must_use]
    pub fn probability(&self, reach: f64) -> f64 {
        ((FADES.1 - self.as_white / reach) / (FADES.1 - FADES.0)).clamp(0.0, 1.0)
    }
}

struct Return {
    range: f64,
    signal: f64,
}

/// The beam's return; `None` if nothing comes back. `mixed` takes the mean of all targets instead of their median.
#[must_use]
pub fn of(pipe: &Pipe, optics: &Optics, (from, attitude): (DVec3, DQuat), mixed: bool) -> Option<Echo> {
    let mut returns = Vec::new();
    let (mut rays, mut ambient) = (0.0, 0.0);
    let light = optics.light.unwrap_or(0.0);
    for i in 0..RAYS {
        for j in 0..RAYS {
            let side = |k: i32| (f64::from(k) + 0.5) / f64::from(RAYS) * 2.0 - 1.0;
            let (u, w) = (side(i), side(j));
            if u * u + w * w > 1.0 {
                continue;
            }
            rays += 1.0;
            let scale = libm::tan(HALF_BEAM);
            let direction = attitude * DVec3::new(u * scale, w * scale, 1.0).normalize();
            let Some(hit) = pipe.or_ground_hit(from, direction) else {
                continue;
            };
            let look = optics.of(hit.pipe);
            ambient += look.reflectivity * light;
            let point = from + direction * hit.way;
            let n = if hit.pipe {
                pipe.normal(point)
            } else {
                DVec3::NEG_Z
            };
            let cos = -direction.dot(n);
            let diffuse = (1.0 - look.gloss) * look.reflectivity * cos.max(0.0);
            let back = if cos > LOBE { look.gloss } else { 0.0 };
            returns.push(Return {
                range: hit.way,
                signal: (diffuse + back) / (hit.way * hit.way),
            });
            if back == 0.0 && look.gloss > 0.0 {
                returns.extend(mirrored(pipe, optics, point, direction, n, hit.way));
            }
        }
    }
    let signal: f64 = returns.iter().map(|r| r.signal).sum();
    if signal <= 0.0 {
        return None;
    }
    let noise = (1.0 + ambient / rays / (REACH_REFLECTIVITY * HALF_LIGHT)).sqrt();
    let range = if mixed {
        returns.iter().map(|r| r.range * r.signal).sum::<f64>() / signal
    } else {
        median(&mut returns, 0.5 * signal)
    };
    Some(Echo {
        range,
        as_white: (REACH_REFLECTIVITY * noise * rays / signal).sqrt(),
    })
}

/// The return by way of a glossy pipe that `direction` meets at `point`, `way` m from the sensor.
fn mirrored(
    pipe: &Pipe,
    optics: &Optics,
    point: DVec3,
    direction: DVec3,
    n: DVec3,
    way: f64,
) -> Option<Return> {
    let out = direction - n * (2.0 * direction.dot(n));
    // Off the surface, not to meet it again.
    let hit = pipe.or_ground_hit(point + n * 1e-6, out)?;
    let (range, look) = (way + hit.way, optics.of(hit.pipe));
    let second = point + out * hit.way;
    let facing = if hit.pipe {
        pipe.normal(second)
    } else {
        DVec3::NEG_Z
    };
    let cos = (-out.dot(facing)).max(0.0);
    Some(Return {
        range,
        signal: optics.pipe.gloss * look.reflectivity * cos / (range * range),
    })
}

/// The range at which the nearer returns have `half` of the signal.
fn median(returns: &mut [Return], half: f64) -> f64 {
    returns.sort_by(|a, b| a.range.total_cmp(&b.range));
    let mut nearer = 0.0;
    let found = returns.iter().find(|r| {
        nearer += r.signal;
        nearer >= half
    });
    found.map_or(f64::INFINITY, |r| r.range)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::contact::PipeShape;
    use crate::sensors::flow::REACH;
    use crate::sensors::flow::optics::Look;

    const PIPE: Pipe = Pipe {
        north: 0.0,
        half_length: 5.0,
        east: 0.0,
        down: -1.85,
        radius: 0.15,
        friction: 0.6,
        shape: PipeShape::STRAIGHT,
    };

    fn look(reflectivity: f64, gloss: f64) -> Look {
        Look {
            reflectivity,
            gloss,
            ..Look::default()
        }
    }

    fn seen(east: f64, height: f64, optics: &Optics, mixed: bool) -> Option<Echo> {
        of(
            &PIPE,
            optics,
            (DVec3::new(0.0, east, -height), DQuat::IDENTITY),
            mixed,
        )
    }

    /// Height over bare ground at which half of the returns are missing, m.
    fn reach(reflectivity: f64, light: f64) -> f64 {
        let optics = Optics {
            ground: look(reflectivity, 0.0),
            light: Some(light),
            ..Optics::default()
        };
        let mut height = 0.1;
        while seen(3.0, height, &optics, false).unwrap().probability(REACH) > 0.5 {
            height += 0.01;
        }
        height
    }

    #[test]
    fn the_reach_is_the_makers_indoors_and_the_users_in_the_sun() {
        for (reflectivity, light, wanted) in [
            (0.9, 0.0, 2.5),
            (0.9, 600.0, 2.41),
            (0.9, 100e3, 1.1),
            // A quarter of the signal: half of the reach.
            (0.225, 0.0, 1.25),
        ] {
            let reach = reach(reflectivity, light);
            assert!(
                (reach - wanted).abs() < 0.02,
                "{reflectivity}, {light} lux: {reach}"
            );
        }
        assert!(reach(0.1, 100e3) < 0.7);
    }

    #[test]
    fn at_an_edge_the_mean_is_between_both_targets_and_the_median_is_one_of_them() {
        let optics = Optics::default();
        // A beam of 1.3 m over the flank: 7 cm wide.
        let mut between = 0;
        for mm in 100..200 {
            let east = f64::from(mm) * 1e-3;
            let range = |mixed| seen(east, 3.0, &optics, mixed).unwrap().range;
            let (mean, median) = (range(true), range(false));
            assert!(!(1.16..2.99).contains(&median), "{east}: {median}");
            between += u32::from(mean > 1.25 && mean < 2.9);
        }
        assert!((20..80).contains(&between), "{between}");
        // Away from edges both are the distance.
        for mixed in [true, false] {
            assert!((seen(2.0, 1.5, &optics, mixed).unwrap().range - 1.5).abs() < 2e-3);
        }
    }

    #[test]
    fn a_glossy_flank_has_no_return_and_a_glossy_crown_has_one() {
        let glossy = Optics {
            pipe: look(0.5, 1.0),
            ..Optics::default()
        };
        // Met at 23 to 37 degrees of incidence: the mirrored ray rises to the sky.
        assert_eq!(seen(0.075, 2.3, &glossy, true), None);
        let crown = seen(0.0, 3.0, &glossy, true).unwrap();
        assert!(
            (crown.range - 1.0).abs() < 0.01 && crown.as_white < REACH,
            "{crown:?}"
        );
        // Met at 45 to 70 degrees it falls to the ground farther off.
        let flank = seen(0.123, 2.3, &glossy, true).unwrap();
        assert!(flank.range > 2.3, "{flank:?}");
        let matt = Optics {
            pipe: look(0.5, 0.0),
            ..Optics::default()
        };
        assert!((seen(0.075, 2.3, &matt, false).unwrap().range - 0.32).abs() < 0.02);
    }
}
