//! Samples of a module below the vehicle: optical flow, and range along the body's down axis.

/// Bounds of the interval of a flow, s: no module is faster, and a slower one is not useful.
const INTERVAL: (f32, f32) = (1e-3, 0.25);
/// Fastest flow, rad/s: modules measure 7.4 at most.
const RATE_MAX: f32 = 10.0;
/// Farthest range, m.
const RANGE_MAX: f32 = 100.0;

/// Optical flow over an interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flow {
    /// End of the interval, µs.
    pub until_us: u64,
    /// Its length, s.
    pub seconds: f32,
    /// Apparent rotation of the scene, rad: over still ground, the rotation of the body about its forward and its
    /// right axis. Motion to the right makes the first negative, motion forward makes the second positive.
    pub angle: [f32; 2],
    /// Quality, 0 for none to 255 for the best.
    pub quality: u8,
}

impl Flow {
    /// The flow; `None` if a value is not finite or out of bounds.
    pub fn checked(self) -> Option<Self> {
        let (least, most) = INTERVAL;
        let fast = |angle: &f32| angle.abs() <= RATE_MAX * self.seconds;
        let sound = (least..=most).contains(&self.seconds) && self.angle.iter().all(fast);
        sound.then_some(self)
    }
}

/// Range along the body's down axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Range {
    /// When it was measured, µs.
    pub at_us: u64,
    /// Distance, m; `None` with no target in reach.
    pub distance: Option<f32>,
    /// Shortest and longest distance that the module measures, m.
    pub reach: (f32, f32),
}

impl Range {
    /// The range, without a distance if that is out of reach; `None` if a value is not finite or `reach` is invalid.
    pub fn checked(self) -> Option<Self> {
        let (near, far) = self.reach;
        if !(0.0..=RANGE_MAX).contains(&near) || !(near..=RANGE_MAX).contains(&far) {
            return None;
        }
        if self.distance.is_some_and(|d| !d.is_finite()) {
            return None;
        }
        let distance = self.distance.filter(|d| (near..=far).contains(d));
        Some(Self { distance, ..self })
    }
}

/// The newest flow and the newest range, each with its own time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroundView {
    /// Optical flow.
    pub flow: Option<Flow>,
    /// Range.
    pub range: Option<Range>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_or_cannot_be_is_no_flow() {
        let flow = Flow {
            until_us: 1,
            seconds: 0.02,
            angle: [0.1, -0.19],
            quality: 9,
        };
        assert_eq!(flow.checked(), Some(flow));
        for angle in [[f32::NAN, 0.0], [0.0, f32::INFINITY], [0.21, 0.0]] {
            assert_eq!(Flow { angle, ..flow }.checked(), None);
        }
        for seconds in [f32::NAN, 0.0, -0.02, 0.3] {
            assert_eq!(Flow { seconds, ..flow }.checked(), None);
        }
    }

    #[test]
    fn a_range_beyond_reach_has_no_distance_and_one_that_is_no_number_is_none() {
        let range = Range {
            at_us: 1,
            distance: Some(1.0),
            reach: (0.02, 2.5),
        };
        assert_eq!(range.checked(), Some(range));
        for beyond in [0.01, 2.6, -1.0] {
            let distance = Some(beyond);
            assert_eq!(Range { distance, ..range }.checked().unwrap().distance, None);
        }
        let broken = [
            Range {
                distance: Some(f32::NAN),
                ..range
            },
            Range {
                reach: (f32::NAN, 2.5),
                ..range
            },
            Range {
                reach: (3.0, 2.5),
                ..range
            },
        ];
        assert!(broken.iter().all(|range| range.checked().is_none()));
    }
}
