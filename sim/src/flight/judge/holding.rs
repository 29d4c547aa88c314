//! The rule of holding: a proven grip holds against a push and a gust from any side, at its proof and after a time on the
//! pipe, whatever pressure its sensors show; nothing is pressed or pulled beyond what it bears.

use super::super::Snapshot;
use super::super::aircraft::Aircraft;
use super::push_test::slips;
use super::{SLIP, STOPPED, worst};
use crate::check::wind;
use crate::scenario::{Scenario, Step};

/// Pressure that skin and pipe bear, Pa: at 6 mm the foam of the patch lies flat (assumed).
const PRESSURE_BORNE: f64 = 3000.0;
/// Push that a grip must hold over that of the mission.
const MARGIN: f64 = 2.0;
/// Breaking load of the thread over a knot, N: 1 mm of drawn nylon, 600 MPa over 0.8 mm², a knot leaves half of 470 N (handbooks).
const TENSION_BORNE: f64 = 235.0;

/// State of the rule.
pub struct Holding {
    /// Push to hold, N.
    force: f64,
    /// The present grip has been pushed since its proof.
    pushed: bool,
    /// The present hold has been pushed at its end.
    pushed_late: bool,
}

impl Holding {
    /// The rule for `scenario`: twice the mission's push, and its wind with three times the RMS of its gusts.
    pub fn new(scenario: &Scenario) -> Self {
        let pushes = scenario.steps.iter().map(|step| match step {
            Step::Hold { push, .. } | Step::Reset { push, .. } => MARGIN * push,
            _ => 0.0,
        });
        Self {
            force: pushes.fold(wind::on_pipe(scenario), f64::max),
            pushed: false,
            pushed_late: false,
        }
    }

    /// The fault, if there is one.
    pub fn step(&mut self, now: &Snapshot<'_, impl Aircraft>) -> Option<String> {
        let plant = now.plant;
        if let Some((arm, pressure)) = worst(plant.pressure()).filter(|(_, p)| *p > PRESSURE_BORNE) {
            return Some(format!(
                "pressure on arm {arm} reached {pressure:.0} N/m2, skin and pipe bear {PRESSURE_BORNE:.0}"
            ));
        }
        if let Some((arm, tension)) = worst(plant.tension()).filter(|(_, t)| *t > TENSION_BORNE) {
            return Some(format!(
                "tendon {arm} pulled with {tension:.0} N, it bears {TENSION_BORNE:.0}"
            ));
        }
        let proven = now.stack.grip().is_some_and(|grip| grip.proven);
        let hangs = proven && plant.thrust().iter().all(|thrust| *thrust < STOPPED);
        if !proven {
            (self.pushed, self.pushed_late) = (false, false);
        }
        if hangs && !self.pushed {
            self.pushed = true;
            return self.push(now, "");
        }
        if hangs && !self.pushed_late && now.lapse_ends {
            self.pushed_late = true;
            return self.push(now, " after its time on the pipe");
        }
        None
    }

    fn push(&self, now: &Snapshot<'_, impl Aircraft>, when: &str) -> Option<String> {
        let slipped = slips(now.plant, self.force, SLIP)?;
        Some(format!(
            "the proven grip does not hold{when}: {:.1} N towards {} move it by more than {:.0} mm",
            self.force,
            slipped.towards,
            SLIP * 1e3
        ))
    }
}
