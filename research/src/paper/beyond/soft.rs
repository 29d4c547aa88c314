//! How soft the airframe can be.

use crate::study::rig::{Flown, fly};
use sophie_control::allocation::wrench::Configuration;
use sophie_control::gripper::tendon::REFERENCE_TILT;
use sophie_control::params::Params;
use sophie_sim::mixers::Variant;
use sophie_sim::parallel;

use super::super::arm::literal;
use super::super::flights::{error, in_gusts, lost_when, or_lost, vehicle};
use super::super::printed::Printed;
use super::programme;
use crate::results::model::{Cell, Section, Table, num};

#[derive(Clone, Copy)]
struct Soft {
    name: &'static str,
    infill: f64,
    zeta: f64,
    notch: bool,
    yaw_gain: f32,
    /// Thrust of level arms over the largest.
    level_share: f64,
}

/// Indices in [`cases`]: soft arms, high yaw gain, with and without notch.
const FAST: usize = 6;
const FAST_BARE: usize = 7;

fn cases() -> [Soft; 12] {
    let default = Params::default();
    let usual = Soft {
        name: "level at half throttle",
        infill: 4.0,
        zeta: 0.15,
        notch: true,
        yaw_gain: default.rate_yaw_p,
        level_share: f64::from(default.arm_level_share),
    };
    let springy = Soft {
        name: "ζ 0.05",
        zeta: 0.05,
        ..usual
    };
    let at = |soft: Soft, infill: f64| Soft { infill, ..soft };
    let printed_level = Soft {
        name: "level without thrust (α0 = 0)",
        level_share: 0.0,
        ..usual
    };
    let fast = Soft {
        name: "ζ 0.05, yaw gain 10",
        yaw_gain: 10.0,
        ..springy
    };
    let bare = |name, soft: Soft| Soft {
        name,
        notch: false,
        ..soft
    };
    [
        at(usual, 6.0),
        at(usual, 5.0),
        usual,
        at(usual, 3.0),
        springy,
        bare("ζ 0.05, no notch", springy),
        fast,
        bare("ζ 0.05, yaw gain 10, no notch", fast),
        at(printed_level, 8.0),
        at(printed_level, 6.0),
        at(printed_level, 5.0),
        printed_level,
    ]
}

impl Soft {
    fn fly(&self, k: f64) -> Flown {
        let mut v = in_gusts(vehicle(Configuration::B, k, self.infill, Variant::Flexible));
        v.vehicle.arm_damping = self.zeta;
        v.vehicle.arm_level_share = self.level_share;
        v.params.arm_level_share = self.level_share as f32;
        v.params.rate_yaw_p = self.yaw_gain;
        if !self.notch {
            // Zeros on the poles: the notch passes everything.
            v.params.notch_zeta_zero = v.params.notch_zeta_pole;
        }
        fly(&v, None, 20.0, programme)
    }
}

struct Outcome {
    /// RMS errors, degrees; `None` if lost.
    roll: Option<f64>,
    yaw: Option<f64>,
    tilt: f64,
    sink: f64,
    lost: Cell,
}

impl Outcome {
    fn of(f: &Flown) -> Self {
        let tilts = f.moments.iter().flat_map(|m| m.tilt);
        let tilt = tilts.fold(f64::NAN, |w: f64, a| w.max(a.abs()));
        Self {
            roll: error(f, 0),
            yaw: error(f, 2),
            tilt: tilt.to_degrees(),
            sink: f.moments.iter().fold(f64::NAN, |w: f64, m| w.max(m.velocity.z)),
            lost: lost_when(f),
        }
    }
}

/// Flies ever softer airframes.
pub fn explore(s: &mut Section, p: &Printed, k: f64) {
    let cases = cases();
    let outcomes = parallel::each(&cases, |soft| Outcome::of(&soft.fly(k)));
    s.table(table(&cases, &outcomes));
    let bent = |i: usize| outcomes.get(i).map_or(f64::NAN, |f| f.tilt);
    let lift = |infill| largest_lift(p, k, infill);
    s.text(format!(
        "The paper stops at 6 % and hands everything below 5 % to machine learning. With arms that are level at half throttle \
         nothing in this model stops at 5 or 4 %: an allocation that knows Eq. 1 flies them. The notch at the arms' mode is \
         what lets the gain rise: with a yaw gain of 10 on springy arms (ζ 0.05) they tilt by {:.1}° with it and by {:.1}° \
         without. The limit that does appear is lift, if the arms are level without thrust and all bend up: largest lift \
         over weight {:.2}, {:.2}, {:.2} and {:.2} at ρ 6.9, 6, 5 and 4 %, at tilts beyond the {}° up to which the paper's \
         statics are said to hold. The last rows of the table fly such arms: from {:.0}° on the released tendons are taut and \
         hold them, which saves the lift and the flight but is no part of Eq. 1: the learnt bias goes to its limit. \
         Algorithm 1's own rule, which sets α to 0 beyond 40°, is a jump of 40° in the mixer that a softer arm meets first.",
        bent(FAST),
        bent(FAST_BARE),
        lift(6.9),
        lift(6.0),
        lift(5.0),
        lift(4.0),
        p.eq_1.valid_tilt_deg,
        f64::from(REFERENCE_TILT).to_degrees()
    ));
}

fn table(cases: &[Soft], outcomes: &[Outcome]) -> Table {
    let mut t = Table::new(
        "How soft it can be: configuration B, flexible mixer, the programme above",
        &[
            "arms",
            "ρ %",
            "roll RMS °",
            "yaw RMS °",
            "largest |α| °",
            "fastest sink m/s",
            "lost",
        ],
    );
    for (soft, f) in cases.iter().zip(outcomes) {
        t.row([
            soft.name.into(),
            num(soft.infill, 0),
            or_lost(f.roll, 2),
            or_lost(f.yaw, 2),
            num(f.tilt, 1),
            num(f.sink, 2),
            f.lost.clone(),
        ]);
    }
    t
}

/// Largest T cos α over the weight, α0 = 0.
fn largest_lift(p: &Printed, k: f64, infill: f64) -> f64 {
    let top = f64::from(Params::default().thrust_max);
    let (a, b) = literal(&p.table_1, infill);
    let weight = p.mass() * sophie_sim::plant::GRAVITY / 4.0;
    (1..=400)
        .map(|i| top * f64::from(i) / 400.0)
        .map(|t| t * (k * (a + b * t) * t).to_radians().cos() / weight)
        .fold(0.0, f64::max)
}
