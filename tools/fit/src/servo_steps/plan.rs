//! Which rests are measured: the arm free and with its weight, then wound up to a tilt that every tendon reaches at a
//! force of a closing, with the weight half way and at the top, and eased again.
//!
//! The first way up and down is not measured: it seats knots, and bends a new arm once.

use super::bench::Given;

/// Move of the servo while the top is searched for, rad: 2.3 mm of thread.
pub const SEARCH: f64 = 0.15;
/// Tilt of the top below the free arm's, rad: 35°, 15 to 50 N.
const DROP: f64 = 0.61;
/// Tilt that shows a taut thread, rad.
const TAUT: f64 = 0.026;
/// Moves from the taut thread to the top, and the one half way.
const MOVES: usize = 6;
const HALF: usize = 3;
/// Share of the usable torque that the top may take.
const TORQUE_SHARE: f64 = 0.6;
/// Share of the reel's tension that bends the arm, at the friction of bare TPU.
const RUBBED: f64 = 0.75;

/// One rest to be measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Next {
    /// Angle of the reel, rad.
    pub reel: f64,
    /// The weight hangs on the tip.
    pub hung: bool,
}

/// At the release mark: without the weight, with it, without it.
pub const FREE: [Next; 3] = [
    Next {
        reel: 0.0,
        hung: false,
    },
    Next {
        reel: 0.0,
        hung: true,
    },
    Next {
        reel: 0.0,
        hung: false,
    },
];

/// Tilt at which the search has its top, for an arm that is at `free` rad, and at `hung` rad with `weight` N, by a servo
/// of usable `torque` N·m.
#[must_use]
pub fn top_tilt(free: f64, hung: f64, weight: f64, torque: f64, given: &Given) -> f64 {
    let softness = (free - hung).max(0.0) / (weight * given.length / given.bend);
    let force = TORQUE_SHARE * torque / given.reel_radius;
    free - DROP.min(softness * given.lever * RUBBED * force)
}

/// Whether an arm that is at `free` rad without its tendon feels it at `tilt` rad.
#[must_use]
pub fn is_taut(free: f64, tilt: f64) -> bool {
    free - tilt > TAUT
}

/// The rests after those of [`FREE`], for a thread that is slack up to `slack` rad of the reel and has its top at `top`.
#[must_use]
pub fn rests(slack: f64, top: f64) -> Vec<Next> {
    let at = |step: usize, hung: bool| Next {
        reel: slack + (top - slack) * step as f64 / MOVES as f64,
        hung,
    };
    let mut rests = vec![];
    for step in 1..=MOVES {
        rests.push(at(step, false));
        let times = match step {
            HALF => 1,
            MOVES => 2,
            _ => 0,
        };
        for _ in 0..times {
            rests.extend([at(step, true), at(step, false)]);
        }
    }
    rests.extend((0..MOVES).rev().map(|step| at(step, false)));
    rests.push(Next {
        reel: 0.0,
        hung: false,
    });
    rests
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weak_servo_has_a_lower_top() {
        let given = Given {
            reel_radius: 0.015,
            lever: 0.015,
            length: 0.178,
            bend: 2.0,
            reference: 0.4,
            speed: 6.16,
        };
        // 3 N tilt by 0.4 rad: 1.5 rad/(N·m).
        let top = |torque| top_tilt(-0.5, -0.9, 3.0, torque, &given);
        assert_eq!(top(2.452), -0.5 - DROP);
        // 0.5 N·m: 20 N, of which 15 bend by 0.337 rad.
        assert!((top(0.5) + 0.837).abs() < 0.002, "{}", top(0.5));
    }

    #[test]
    fn the_weight_hangs_only_while_the_servo_stands() {
        let rests = rests(0.8, 2.0);
        for pair in rests.windows(2) {
            assert!(!(pair[0].hung || pair[1].hung) || pair[0].reel == pair[1].reel);
        }
        assert_eq!(rests.iter().filter(|rest| rest.hung).count(), 3);
        assert!(rests.first().is_some_and(|rest| !rest.hung) && rests.iter().all(|rest| rest.reel <= 2.0));
    }
}
