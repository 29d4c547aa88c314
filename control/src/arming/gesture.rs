//! Stick gestures that arm and disarm.

use crate::pilot::rc::Sticks;

/// Time that the gesture must be held, s.
pub const GESTURE_TIME: f32 = 1.0;
/// Yaw stick of a gesture, share of its travel.
const GESTURE_STICK: f32 = 0.9;

/// A completed gesture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gesture {
    /// Arm switch on, throttle low, yaw full right for [`GESTURE_TIME`].
    Arm,
    /// Throttle low, yaw full left for [`GESTURE_TIME`].
    Disarm,
}

/// Reports each gesture once, until the stick returns.
#[derive(Clone, Copy, Debug, Default)]
pub struct GestureWatch {
    shape: Option<Gesture>,
    held: f32,
}

impl GestureWatch {
    /// One step of `dt` s; `None` (radio lost) restarts the gesture.
    pub fn step(&mut self, sticks: Option<&Sticks>, throttle_low: f32, dt: f32) -> Option<Gesture> {
        let shape = sticks.and_then(|s| {
            let low = s.throttle <= throttle_low;
            if low && s.arm_switch && s.yaw > GESTURE_STICK {
                Some(Gesture::Arm)
            } else if low && s.yaw < -GESTURE_STICK {
                Some(Gesture::Disarm)
            } else {
                None
            }
        });
        if shape != self.shape {
            *self = Self { shape, held: 0.0 };
        }
        let before = self.held;
        self.held += dt;
        shape.filter(|_| before < GESTURE_TIME && self.held >= GESTURE_TIME)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn the_gesture_needs_its_whole_time_and_fires_once() {
        let mut g = GestureWatch::default();
        let right = Sticks {
            arm_switch: true,
            yaw: 1.0,
            ..Default::default()
        };
        let fired = |g: &mut GestureWatch, s: Option<&Sticks>, steps| {
            (0..steps)
                .filter_map(|_| g.step(s, 0.05, 0.01))
                .collect::<std::vec::Vec<_>>()
        };
        assert!(fired(&mut g, Some(&right), 98).is_empty());
        assert!(fired(&mut g, None, 1).is_empty(), "a lost radio starts it over");
        assert!(fired(&mut g, Some(&right), 98).is_empty());
        assert_eq!(fired(&mut g, Some(&right), 300), [Gesture::Arm]);
        let left = Sticks {
            yaw: -1.0,
            ..Default::default()
        };
        assert_eq!(fired(&mut g, Some(&left), 300), [Gesture::Disarm]);
        for other in [
            Sticks {
                throttle: 0.1,
                ..right
            },
            Sticks {
                arm_switch: false,
                ..right
            },
            Sticks { yaw: 0.8, ..right },
        ] {
            assert!(fired(&mut g, Some(&other), 300).is_empty(), "{other:?}");
        }
    }
}
