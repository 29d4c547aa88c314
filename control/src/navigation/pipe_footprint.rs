//! Footprint of something narrow below, a pipe: its place by the range step at its edge, and the share of the flow's
//! view that it fills.

use crate::maths::scalar;
use crate::maths::vector::Vec3;

/// Width of the flow's view at a distance of 1 m (42° across).
const VIEW: f32 = 0.77;
/// Deviation of the footprint's place, m.
const PLACE: f32 = 0.04;
/// Rays that sample the view, and the least distance of one, m.
const RAYS: u32 = 9;
const NEAREST: f32 = 0.05;
/// Tolerance between a range hit and the footprint, m: the width of the range's beam.
const SLACK: f32 = 0.02;
/// Share of the half width beyond which the round back does not drop further: there the drop grows with the error of
/// the place.
const EDGE: f32 = 0.9;
/// Ratio of forward to sideways speed beyond which an edge lies across the motion: the nose is along a pipe.
const AHEAD: f32 = 2.0;

/// Effective distance of the flow's scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// Harmonic mean of the distance, weighted by texture, m.
    pub distance: f32,
    /// Change of its inverse for a [weight](crate::navigation::texture::Texture) of the pipe of one more, 1/m.
    pub by_weight: f32,
    /// Relative uncertainty of it by the place of the footprint.
    pub doubt: f32,
    /// Horizontal offset of the near part within the view, in the estimate's axes, 1: as that part comes nearer it
    /// seems to move this way.
    pub lean: Vec3,
}

/// A band along the vehicle, or across it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PipeFootprint {
    /// Point on its centre line, and the horizontal direction across it, in the estimate's axes.
    middle: Vec3,
    across: Vec3,
    /// Half its width, m.
    radius: f32,
    /// Its height along the down axis, m.
    pub top: f32,
    /// Every hit since an edge was seen agrees with its width: it is narrow.
    sure: bool,
    /// Sum of the shifts by ground hits inside it since then, m.
    pushed: f32,
}

impl PipeFootprint {
    /// The band whose edge is at `surface_point`. The beam has come `onto` it or off it, moving by `displacement`, of a
    /// vehicle at `heading`, rad; the main direction of motion, forward or sideways, leads across the band. If the
    /// place `known` before identifies the edge, that decides which of the two it is, and a gust to the other side does
    /// not.
    pub fn at_edge(known: Self, surface_point: Vec3, onto: bool, displacement: Vec3, heading: f32) -> Self {
        let (ahead, right) = ahead_and_right(heading);
        let (forward, sideways) = (displacement.dot(ahead), displacement.dot(right));
        let (across, speed) = if forward.abs() > AHEAD * sideways.abs() {
            (ahead, forward)
        } else {
            (right, sideways)
        };
        let side = known.side(surface_point);
        let same = across.dot(known.across) > 0.9 && side.abs() > 0.5 * known.radius;
        let before = if same { side < 0.0 } else { (speed > 0.0) == onto };
        let half = if before { known.radius } else { -known.radius };
        Self {
            middle: surface_point + across * half,
            across,
            sure: true,
            pushed: 0.0,
            ..known
        }
    }

    /// A band below without a known edge: its centre line passes `surface_point` along `heading`, rad, its width is
    /// twice `radius`, m, its height `top`, m.
    pub fn below(surface_point: Vec3, heading: f32, radius: f32, top: f32) -> Self {
        Self {
            middle: surface_point,
            across: ahead_and_right(heading).1,
            radius,
            top,
            sure: false,
            pushed: 0.0,
        }
    }

    /// Shifts the band so that it agrees with a hit at `surface_point` on the raised surface (`raised`) or on the
    /// ground. A raised hit outside shows that it may be wide.
    pub fn bounded(self, surface_point: Vec3, raised: bool) -> Self {
        let side = self.side(surface_point);
        let sign = if side < 0.0 { -1.0 } else { 1.0 };
        let over = if raised {
            (side.abs() - self.radius - SLACK).max(0.0)
        } else {
            (side.abs() - self.radius + SLACK).min(0.0)
        };
        Self {
            middle: self.middle + self.across * (over * sign),
            sure: self.sure && over <= 0.0,
            pushed: self.pushed + (-over).max(0.0),
            ..self
        }
    }

    /// Ground hits have shifted it by more than its width: it lies on the other side of the edge.
    pub fn is_mistaken(&self) -> bool {
        self.pushed > 2.0 * self.radius
    }

    /// Drop of its back at `surface_point` below its top, m, and the uncertainty of that by the place and by a beam that
    /// reaches `beside` m to each side, m. A band that may be wide is flat.
    pub fn drop(&self, surface_point: Vec3, beside: f32) -> (f32, f32) {
        if !self.sure {
            return (0.0, PLACE);
        }
        let side = self.side(surface_point).abs().min(EDGE * self.radius);
        let drop = self.fallen(side);
        (drop, self.fallen(side + PLACE + beside) - drop)
    }

    /// Drop of its round back `off` m beside its crown, m; farther out, that of its edge.
    fn fallen(&self, off: f32) -> f32 {
        let square = self.radius * self.radius - off * off;
        if square > 0.0 {
            self.radius - square * scalar::inv_sqrt(square)
        } else {
            self.radius
        }
    }

    /// Offset of its centre line from `place`, in its direction across, m.
    pub fn aside(&self, place: Vec3) -> f32 {
        -self.side(place)
    }

    /// Offset of `place` from its centre line, in its direction across, m.
    fn side(&self, place: Vec3) -> f32 {
        (place - self.middle).dot(self.across)
    }

    /// Scene of the view from `place` with its centre at `surface_point`: rays across the round band, and the ground
    /// beside it, `far` m away. The band's texture has this `weight`, 0 to 1, the ground's the rest.
    pub fn depth(&self, place: Vec3, surface_point: Vec3, far: f32, weight: f32) -> Depth {
        let side = self.side(place);
        let slope = (surface_point - place).dot(self.across)
            / scalar::clamp(surface_point.z - place.z, NEAREST, 100.0);
        let near = scalar::clamp(self.top - place.z, NEAREST, far);
        let of = |side: f32| self.seen_from(side, slope, near, far).weighted(weight);
        let ([mean, moment, by_weight], [left, ..], [right, ..]) =
            (of(side), of(side - PLACE), of(side + PLACE));
        Depth {
            distance: 1.0 / mean,
            by_weight,
            doubt: (left - mean).abs().max((right - mean).abs()) / mean,
            lean: self.across * (moment / mean),
        }
    }

    /// Rays of a view that is `side` m beside the centre line, `near` m over the top, and tilted by `slope`.
    fn seen_from(&self, side: f32, slope: f32, near: f32, far: f32) -> Rays {
        let deep = near + self.radius;
        let mut rays = Rays::default();
        for ray in 0..RAYS {
            let off = VIEW * ((ray as f32 + 0.5) / RAYS as f32 - 0.5);
            let t = slope + off;
            // Where the ray (side + t z, z) meets the circle about (0, deep).
            let (a, b) = (1.0 + t * t, deep - side * t);
            let square = b * b - a * (side * side + deep * deep - self.radius * self.radius);
            let root = square * scalar::inv_sqrt(square);
            let (of, z) = if square >= 0.0 {
                (&mut rays.pipe, (b - root) / a)
            } else {
                (&mut rays.ground, far)
            };
            let per = 1.0 / scalar::clamp(z, NEAREST, far);
            let [count, sum, moment] = of;
            *count += 1.0;
            *sum += per;
            *moment += off * per;
        }
        rays
    }
}

/// Rays that meet the pipe and the ground: their number, the sum of 1/distance, 1/m, and its moment about the centre of the
/// view.
#[derive(Clone, Copy, Debug, Default)]
struct Rays {
    pipe: [f32; 3],
    ground: [f32; 3],
}

impl Rays {
    /// Mean of 1/distance with this `weight` of the pipe, its moment, and its derivative by the weight.
    fn weighted(&self, weight: f32) -> [f32; 3] {
        let ([p, pipe, right], [g, ground, left]) = (self.pipe, self.ground);
        let rest = 1.0 - weight;
        let per = 1.0 / (weight * p + rest * g);
        let mean = (weight * pipe + rest * ground) * per;
        [
            mean,
            (weight * right + rest * left) * per,
            (pipe - ground - mean * (p - g)) * per,
        ]
    }
}

/// Horizontal directions along `heading`, rad, and to the right of it.
fn ahead_and_right(heading: f32) -> (Vec3, Vec3) {
    let (sin, cos) = (scalar::sin(heading), scalar::cos(heading));
    (Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIGHT: Vec3 = Vec3::new(0.0, 0.3, 0.0);

    /// One of 0.3 m along a heading of 0, whose middle is at 1 m to the right and its top at 1.5 m.
    fn band() -> PipeFootprint {
        PipeFootprint::below(Vec3::new(2.0, 1.0, 0.0), 0.0, 0.15, -1.5)
    }

    fn surface_point(y: f32) -> Vec3 {
        Vec3::new(0.0, y, 0.0)
    }

    #[test]
    fn the_view_is_as_near_as_what_fills_it() {
        // Its middle is at 1 m, the ground 1.9 m below the vehicle.
        let seen = |y: f32, z: f32, slope: f32| {
            band().depth(Vec3::new(0.0, y, z), surface_point(y - slope * z), -z, 0.5)
        };
        let depth = |y: f32, z: f32, slope: f32| seen(y, z, slope).distance;
        // From 0.4 m its tangents, 15.8° to each side, are 74 % of the view; from 0.7 m 47 %.
        let over = depth(1.0, -1.9, 0.0);
        assert!((over - 1.0 / (0.74 / 0.43 + 0.26 / 1.9)).abs() < 0.06, "{over}");
        let higher = depth(1.0, -2.2, 0.0);
        assert!(
            (higher - 1.0 / (0.47 / 0.73 + 0.53 / 2.2)).abs() < 0.15,
            "{higher}"
        );
        // Far beside it there is the ground alone, and near it the flank of the band is in the view.
        assert!((depth(1.8, -1.9, 0.0) - 1.9).abs() < 1e-3);
        let beside = depth(1.28, -1.9, 0.0);
        assert!((1.0..1.6).contains(&beside), "{beside}");
        // A view that leans to it sees more of it.
        assert!(depth(1.28, -1.9, -0.2) < beside && depth(0.72, -1.9, 0.2) < beside);
        // Where its edge moves through the view its place matters, far from it not.
        let doubt = |y: f32| seen(y, -1.9, 0.0).doubt;
        assert!(
            doubt(1.8) < 1e-3 && doubt(1.2) > 0.1 && doubt(1.0) < doubt(1.2),
            "{} {}",
            doubt(1.0),
            doubt(1.2)
        );
        // By the texture: between the pipe, the ground, and the mean of both; without the other surface it says nothing.
        let by = |weight: f32| band().depth(Vec3::new(0.0, 1.0, -1.9), surface_point(1.0), 1.9, weight);
        let [painted, rusty] = [0.02, 0.98].map(|weight| by(weight).distance);
        assert!(painted > 1.5 && (0.4..0.45).contains(&rusty), "{painted} {rusty}");
        let slope = (1.0 / by(0.51).distance - 1.0 / by(0.49).distance) / 0.02;
        assert!((by(0.5).by_weight - slope).abs() < 1e-2 * slope, "{slope}");
        assert!(seen(1.8, -1.9, 0.0).by_weight.abs() < 1e-6);
        // From the right of it what is near lies to the left; above its middle, and beyond the view, on neither side.
        let lean = |y: f32| seen(y, -1.9, 0.0).lean.y;
        assert!(
            lean(1.12) < -0.05 && (lean(1.12) + lean(0.88)).abs() < 1e-4,
            "{}",
            lean(1.12)
        );
        assert!(lean(1.0).abs() < 1e-4 && lean(1.8).abs() < 1e-4);
    }

    /// The two edges, from either side, of pipes of 0.2 and 0.4 m about 1 m.
    #[test]
    fn either_edge_from_either_side_gives_the_same_band() {
        for radius in [0.1, 0.2] {
            // Only that something is below is known, somewhere else along the way.
            let below = PipeFootprint::below(surface_point(1.0), 0.0, radius, -1.5);
            for (side, onto, speed) in [
                (-1.0, true, 0.3),
                (1.0, true, -0.3),
                (1.0, false, 0.3),
                (-1.0, false, -0.3),
            ] {
                let edge = Vec3::new(5.0, 1.0 + side * radius, 0.0);
                let band = PipeFootprint::at_edge(below, edge, onto, Vec3::new(0.1, speed, 0.0), 0.0);
                for y in [0.7, 0.9, 1.0, 1.2] {
                    let off = band.side(surface_point(y)) - (y - 1.0);
                    assert!(off.abs() < 1e-6, "{radius} {side} {onto} {speed}");
                }
                // On its crown, half way to its edge and at a fifth of its diameter beneath it.
                let (drop, _) = band.drop(surface_point(1.0), 0.0);
                assert!(drop < 1e-6, "{drop}");
                let (drop, doubt) = band.drop(surface_point(1.0 + 0.6 * radius), 0.0);
                assert!(
                    (drop - 0.2 * radius).abs() < 1e-4 && doubt > 0.015,
                    "{drop} {doubt}"
                );
            }
        }
    }

    #[test]
    fn a_gust_to_the_other_side_does_not_mistake_one_edge_for_the_other() {
        // Its right edge is crossed outwards while the vehicle is taken to drift to the left, or mostly ahead.
        for displacement in [Vec3::new(0.0, -0.1, 0.0), Vec3::new(0.15, -0.1, 0.0)] {
            let moved = PipeFootprint::at_edge(band(), surface_point(1.17), false, displacement, 0.0);
            assert!(moved.side(surface_point(1.02)).abs() < 1e-6, "{moved:?}");
        }
        // Far ahead of sideways it is the pipe's end.
        let end = PipeFootprint::at_edge(band(), surface_point(1.0), false, Vec3::new(0.3, 0.1, 0.0), 0.0);
        assert!(end.side(Vec3::new(-0.15, 1.0, 0.0)).abs() < 1e-6, "{end:?}");
        // By its heading, not the axes'.
        let turned = PipeFootprint::below(surface_point(1.0), core::f32::consts::FRAC_PI_2, 0.15, -1.5);
        assert!((turned.side(Vec3::new(-0.1, 1.0, 0.0)) - 0.1).abs() < 1e-6);
        assert!(RIGHT.dot(turned.across).abs() < 1e-6);
    }

    /// In a throw off the pipe the beam leans against the way: the edge was taken for the other one, and the band,
    /// pushed ahead of the vehicle, halved its speed for as long as it moved on.
    #[test]
    fn a_band_that_the_ground_pushes_by_more_than_its_width_is_mistaken() {
        let pushed = |displacement: f32| {
            let steps = (displacement * 100.0) as u8;
            (0..=steps).fold(band(), |band, i| {
                band.bounded(surface_point(0.9 + 0.01 * f32::from(i)), false)
            })
        };
        assert!(!pushed(0.2).is_mistaken() && pushed(0.5).is_mistaken());
        // An edge that is seen says where it is.
        assert!(!PipeFootprint::at_edge(pushed(0.5), surface_point(1.5), true, RIGHT, 0.0).is_mistaken());
    }

    #[test]
    fn where_the_beam_meets_it_or_the_ground_bounds_its_place() {
        for y in [0.6, 0.95, 1.1, 1.5] {
            let on = band().bounded(surface_point(y), true).side(surface_point(y));
            assert!(on.abs() < 0.15 + SLACK + 1e-6, "{y}: {on}");
            let beside = band().bounded(surface_point(y), false).side(surface_point(y));
            assert!(beside.abs() > 0.15 - SLACK - 1e-6, "{y}: {beside}");
        }
        // What is met beside it is wide, or it is elsewhere: flat, as far as is known.
        let table = PipeFootprint::at_edge(band(), surface_point(1.15), false, RIGHT, 0.0);
        assert!(table.drop(surface_point(1.1), 0.0).0 > 0.02);
        assert!(
            table
                .bounded(surface_point(1.3), true)
                .drop(surface_point(1.25), 0.0)
                .0
                < 1e-6
        );
        // What agrees moves nothing.
        assert_eq!(band().bounded(surface_point(1.1), true), band());
        assert_eq!(band().bounded(surface_point(1.3), false), band());
    }
}
