//! Laws of an arm on the bench that its servo winds in steps, with a weight on its tip or without.
//!
//! With the reel at Θ and the weight W on the tip the tilt α is where three laws meet:
//!
//! * arm: α = α0 − c (h T̄ + W g L/b), c the tilt per moment, b `tendon_bend`, L the arm's length. g = 2 ∫ ξ cos θ(ξ) dξ is
//!   the lever of a weight on the bent arm over that on a straight one (1 for θ = 0, 0.81 for an arc of 0.9 rad)
//! * thread: T = k (r Θ − h (α_ref − α) − s), never negative; s is the slack
//! * channel: T̄ is the mean of the capstan's tension over the bend |α|, T (1 − exp(−μ|α|))/(μ|α|) while the reel winds;
//!   each piece keeps its tension between both bounds, so the order of the steps matters
//!
//! The servo moves before the arm does, and pulls at its full speed: the thread's loss adds to the tension then, and takes
//! from it while the reel eases. Left out, μ comes out 0.1 too small.

/// A rest of the arm between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Angle of the reel from its release mark, as ordered, rad.
    pub reel: f64,
    /// On the tip, N.
    pub weight: f64,
    /// Tilt, tip up positive, rad.
    pub tilt: f64,
}

/// What the fit takes as given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// Radius of the reel, m.
    pub reel_radius: f64,
    /// Tendon to neutral line, m.
    pub lever: f64,
    /// Length of the arm, m.
    pub length: f64,
    /// `tendon_bend`: tilt by a tendon over that by a tip's load of the same moment.
    pub bend: f64,
    /// Tilt at which a thread of the right length is just taut at the release mark, rad.
    pub reference: f64,
    /// Speed of the servo, rad/s.
    pub speed: f64,
}

/// Unknowns of one arm.
pub const UNKNOWNS: usize = 7;
/// Tilt without load (rad), tilt per moment (rad/(N·m)), thread's length per force (m/N), slack (m), friction, play of
/// the servo to either side (rad), share of the lever.
pub type Unknowns = [f64; UNKNOWNS];

/// Pieces of the channel.
const PIECES: usize = 8;
/// Parts of the way from one rest to the next.
const PARTS: u32 = 3;
/// Last move of the servo, rad: what an ordered pulse moves in a frame of 20 ms.
const MOVE: f64 = 0.02;
/// Loss of the thread, N·s/m (docs/design/physics.md, assumed: loss factor 0.1 at 8 Hz).
const LOSS: f64 = 16.0;
/// Deepest tilt, rad.
const DEEPEST: f64 = -2.5;
/// Gauss's three points on 0..1 and their weights.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Tilts at all `rests` by the laws; `errors` (rad) of the servo at each.
#[must_use]
pub fn tilts(rests: &[Rest], errors: &[f64], x: &Unknowns, given: &Given) -> Vec<f64> {
    let [rest, softness, give, slack, friction, play, share] = *x;
    let mut arm = Arm {
        rest,
        softness,
        stiffness: 1.0 / give,
        lever: given.lever * share,
        slack,
        friction,
        given: *given,
        tilt: rest,
        reel: 0.0,
        weight: 0.0,
        ends: [0.0; PIECES],
    };
    let (mut ordered, mut way) = (0.0, 0.0);
    let at = rests.iter().zip(errors).map(|(next, error)| {
        if next.reel != ordered {
            way = (next.reel - ordered).signum();
        }
        ordered = next.reel;
        let reel = if ordered > 0.0 {
            ordered - way * play + error
        } else {
            0.0
        };
        arm.go(reel, next.weight);
        arm.tilt
    });
    at.collect()
}

struct Arm {
    rest: f64,
    softness: f64,
    stiffness: f64,
    lever: f64,
    slack: f64,
    friction: f64,
    given: Given,
    tilt: f64,
    reel: f64,
    weight: f64,
    /// Tension at the far end of each piece, N, from the entry on.
    ends: [f64; PIECES],
}

impl Arm {
    /// Winds to `reel` and changes the weight, slowly but for the servo's last move.
    fn go(&mut self, reel: f64, weight: f64) {
        let (from, hung) = (self.reel, self.weight);
        let last = (reel - from).clamp(-MOVE, MOVE);
        for part in 1..=PARTS {
            let share = f64::from(part) / f64::from(PARTS);
            self.reel = from + share * (reel - last - from);
            self.weight = hung + share * (weight - hung);
            self.settle();
        }
        if last != 0.0 {
            self.reel = reel;
            let pulled = self.entry(self.tilt);
            if pulled > 0.0 {
                let loss = LOSS * self.given.reel_radius * self.given.speed * last.signum();
                slide(
                    &mut self.ends,
                    (pulled + loss).max(0.0),
                    0.0,
                    self.friction * self.tilt,
                );
            }
            self.settle();
        }
    }

    /// Tension at the channel's entry, N.
    fn entry(&self, tilt: f64) -> f64 {
        let Given {
            reel_radius,
            reference,
            ..
        } = self.given;
        let stretch = reel_radius * self.reel - self.slack - self.lever * (reference - tilt);
        (self.stiffness * stretch).max(0.0)
    }

    /// Moment of the weight on the tilt, N·m.
    fn load(&self, tilt: f64) -> f64 {
        if self.weight == 0.0 {
            return 0.0;
        }
        let straight = self.weight * self.given.length / self.given.bend;
        // Of the tilt the weight's part is bent most at the root.
        let (mut moment, mut hung) = (straight, 0.0);
        for _ in 0..3 {
            let lever = |(xi, weight): (f64, f64)| {
                let slope = (tilt - hung) * xi + hung * (2.0 - xi) * xi;
                2.0 * weight * xi * slope.cos()
            };
            moment = straight * GAUSS.into_iter().map(lever).sum::<f64>();
            hung = -self.softness * moment;
        }
        moment
    }

    /// How far `tilt` is above equilibrium, rad.
    fn beyond(&self, tilt: f64) -> f64 {
        let mut ends = self.ends;
        let stretched = self.stiffness * self.lever * (tilt - self.tilt);
        let mean = slide(&mut ends, self.entry(tilt), stretched, self.friction * tilt);
        tilt - self.rest + self.softness * (self.lever * mean + self.load(tilt))
    }

    /// Moves the arm to its equilibrium: regula falsi after Illinois.
    fn settle(&mut self) {
        let (mut low, mut high) = (DEEPEST, self.rest + 0.5);
        let (mut below, mut above) = (self.beyond(low), self.beyond(high));
        let mut tilt = self.tilt;
        for _ in 0..60 {
            if above <= below {
                break;
            }
            tilt = (low * above - high * below) / (above - below);
            let beyond = self.beyond(tilt);
            if beyond.abs() < 1e-11 {
                break;
            }
            if beyond > 0.0 {
                (high, above) = (tilt, beyond);
                below *= 0.5;
            } else {
                (low, below) = (tilt, beyond);
                above *= 0.5;
            }
        }
        let stretched = self.stiffness * self.lever * (tilt - self.tilt);
        let entry = self.entry(tilt);
        slide(&mut self.ends, entry, stretched, self.friction * tilt);
        self.tilt = tilt;
    }
}

/// Mean tension (N) under `entry` N, after the arm's motion has stretched the pieces by `stretched` N; `turn` is μα.
fn slide(ends: &mut [f64; PIECES], entry: f64, stretched: f64, turn: f64) -> f64 {
    let loss = (turn.abs() / PIECES as f64).exp();
    let (mut tension, mut sum) = (entry, 0.0);
    for end in ends {
        // Not `clamp`: a search may come by numbers that are not finite.
        *end = (*end + stretched).max(tension / loss).min(tension * loss);
        sum += 0.5 * (tension + *end);
        tension = *end;
    }
    sum / PIECES as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const GIVEN: Given = Given {
        reel_radius: 0.015,
        lever: 0.015,
        length: 0.178,
        bend: 2.0,
        reference: 0.4,
        speed: 6.16,
    };

    fn tilt(reel: f64, weight: f64, friction: f64) -> f64 {
        let rest = Rest {
            reel,
            weight,
            tilt: 0.0,
        };
        tilts(
            &[rest],
            &[0.0],
            &[-0.5, 1.5, 1.0 / 4000.0, 0.0, friction, 0.0, 1.0],
            &GIVEN,
        )[0]
    }

    #[test]
    fn a_smooth_thread_by_hand() {
        // 1.5 rad of reel are 22.5 mm, 13.5 mm of them slack at -0.5 rad: 9 mm of 4 kN/m against k h = 60 N/rad and
        // 1/(c h) = 44.4 N/rad: 36 N/104.4 N/rad = 0.3448 rad.
        assert!(
            (tilt(1.5, 0.0, 0.0) + 0.8448).abs() < 1e-3,
            "{}",
            tilt(1.5, 0.0, 0.0)
        );
        // Slack: 2 N · 89 mm · 1.5 rad/(N·m) = 0.267 rad, by the lever of an arm bent to 0.73 rad, 0.87 and a little less.
        let hung = -0.5 - tilt(0.0, 2.0, 0.0);
        assert!((0.22..0.234).contains(&hung), "{hung}");
        // A rubbing one bends it less: by 0.024 rad, of which the pull at the servo's speed leaves 0.014.
        assert!(tilt(1.5, 0.0, 0.4) > tilt(1.5, 0.0, 0.0) + 0.01);
    }

    #[test]
    fn the_weight_on_a_taut_thread_tilts_less_by_its_stiffness() {
        // 1 + k h² c = 2.35, with the levers of both bends, 0.94 and 0.83.
        let (slack, taut) = (
            tilt(0.0, 0.2, 0.0) + 0.5,
            tilt(1.5, 0.2, 0.0) - tilt(1.5, 0.0, 0.0),
        );
        assert!(
            (slack / taut / (2.35 * 0.94 / 0.83) - 1.0).abs() < 0.03,
            "{slack} {taut}"
        );
    }
}
