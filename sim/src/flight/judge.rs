//! Judges a flight by the plant's true state, by both rules at once; the scenario's own ends the flight.

mod holding;
mod push_test;

use glam::DVec3;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::gripper::tendon::ForceLimit;
use sophie_control::mode::Mode;

use self::holding::Holding;
use super::Snapshot;
use super::aircraft::Aircraft;
use crate::plant::Plant;
use crate::plant::contact::BELLY_Z;
use crate::record::Verdict;
use crate::scenario::{Rule, Scenario, Step};
use crate::sensors::fsr::LARGEST_ERROR;

/// Largest slip of a gripped vehicle under a push, m.
const SLIP: f64 = 0.03;
/// Largest true pressure on a closing or gripping arm, Pa: limit of tendons and skin.
const PRESSURE_MAX: f64 = 1500.0;
/// The same for bumps, Pa: an open arm that lands on the pipe; a gripping one after a reset, until the loops run again
/// (its tension, no longer opposed by thrust, presses the pipe).
const PRESSURE_BUMP: f64 = 3000.0;
/// Allowed pressure error of a settled grip by the paper's rule, Pa, beyond the sensor's own (assumed; the paper has none).
const TOLERANCE: f64 = 50.0;
/// Allowed pressure error during spool-down and push, in tolerances: the body moves on its pads and the loop is slow.
const DISTURBED: f64 = 2.0;
/// Share of the roll angle that the manoeuvre must truly reach on each side.
const ROLL_SHARE: f64 = 0.9;
/// Settling time of the pressure after the hold began or a push ended, s.
const SETTLE: f64 = 3.0;
/// Thrust of a stopped rotor, N.
const STOPPED: f64 = 0.05;
/// Time for rotors to run down, s.
const RUN_OUT: f64 = 1.0;
/// Crash speed at the ground, m/s.
const CRASH_SPEED: f64 = 2.0;

/// State of the judge.
pub struct Judge {
    chosen: PerArm<bool>,
    target: f64,
    /// Pressure below which an arm is free, Pa.
    released: f64,
    /// Largest sensor error at the target, Pa: the stack cannot correct it.
    sensor_error: f64,
    torque_max: f64,
    proven: bool,
    /// Position of a gripped vehicle at the reset of its board, until it is released.
    hanging: Option<DVec3>,
    /// Angle of the present roll manoeuvre and the largest true roll to each side, rad.
    roll: Option<(f64, [f64; 2])>,
    hold_start: Option<(f64, DVec3)>,
    /// Time of the last push, s.
    pushed: f64,
    last_step: Option<usize>,
    holding: Holding,
    /// The rule that ends the flight.
    rule: Rule,
    /// First fault of each rule.
    faults: [Option<String>; 2],
}

impl Judge {
    /// A judge of `scenario`.
    pub fn new(scenario: &Scenario) -> Self {
        let p = &scenario.params;
        let target = f64::from(p.grip_pressure);
        Self {
            chosen: scenario.arms.mask(),
            target,
            released: f64::from(p.release_pressure),
            sensor_error: target * LARGEST_ERROR,
            torque_max: f64::from(ForceLimit::from_params(p).force * p.reel_radius),
            proven: false,
            hanging: None,
            roll: None,
            hold_start: None,
            pushed: f64::NEG_INFINITY,
            last_step: None,
            holding: Holding::new(scenario),
            rule: scenario.judge,
            faults: [None, None],
        }
    }

    /// What each rule has found so far.
    pub fn verdicts(&self) -> Vec<Verdict> {
        let [paper, holding] = self.faults.clone();
        let verdict = |rule, fault| Verdict { rule, fault };
        vec![verdict(Rule::Paper, paper), verdict(Rule::Holding, holding)]
    }

    /// Checks the truth; returns the reason if the mission failed by the scenario's rule.
    pub fn step(&mut self, now: &Snapshot<'_, impl Aircraft>) -> Option<String> {
        let common = self.lost(now).or_else(|| self.badly_rolled(now));
        let common = common.or_else(|| self.after_reset(now));
        let pressed = self.pressed_badly(now);
        let (common, tolerances) = match common {
            Some(why) => (Some(why), None),
            None => self.let_go(now),
        };
        let held = tolerances.and_then(|tolerances| self.badly_held(now.plant, tolerances));
        let paper = common.clone().or(pressed).or(held);
        let holding = common.or_else(|| self.holding.step(now));
        let found = match self.rule {
            Rule::Paper => paper.clone(),
            Rule::Holding => holding.clone(),
        };
        for (first, fault) in self.faults.iter_mut().zip([paper, holding]) {
            if first.is_none() {
                *first = fault.map(|fault| format!("{fault} (at {:.1} s)", now.t()));
            }
        }
        found
    }

    /// Pressures and pulls beyond the paper's limits, and a proof that is wrong by them.
    fn pressed_badly(&mut self, now: &Snapshot<'_, impl Aircraft>) -> Option<String> {
        let overloaded = self.overloaded(now);
        let hollow = self.hollow(now);
        let grip = now.stack.grip().is_some_and(|g| g.proven);
        let just_proven = grip && !self.proven;
        self.proven = grip;
        let wrongly = || {
            let why = self.badly_held(now.plant, 1.0)?;
            Some(format!("the grip was proven wrongly: {why}"))
        };
        overloaded
            .or(hollow)
            .or_else(|| just_proven.then(wrongly).flatten())
    }

    /// A simulation that diverged, a vehicle that crashed.
    fn lost(&self, now: &Snapshot<'_, impl Aircraft>) -> Option<String> {
        let pose = now.plant.pose();
        if !pose.position.is_finite() || !pose.omega.is_finite() {
            return Some("the simulation diverged".to_owned());
        }
        if pose.position.z > -BELLY_Z && pose.velocity.z > CRASH_SPEED {
            return Some(format!("crashed into the ground at {:.1} m/s", pose.velocity.z));
        }
        None
    }

    /// A pressure or a pull beyond the paper's limits.
    fn overloaded(&self, now: &Snapshot<'_, impl Aircraft>) -> Option<String> {
        let (t, plant, stack) = (now.t(), now.plant, now.stack);
        let jolted = stack.reset().is_some_and(|r| t - r.at < SETTLE);
        let open = stack.mode() == Mode::Flight;
        let allowed = if jolted || open {
            PRESSURE_BUMP
        } else {
            PRESSURE_MAX
        };
        if let Some((arm, pressure)) = worst(plant.pressure()).filter(|(_, p)| *p > allowed) {
            let (pressure, allowed) = printed_apart(pressure, allowed);
            return Some(format!(
                "pressure on arm {arm} reached {pressure} N/m2, allowed {allowed}"
            ));
        }
        if let Some((arm, torque)) = worst(plant.servo_torque())
            && torque > self.torque_max
        {
            let (torque, allowed) = printed_apart(torque, self.torque_max);
            return Some(format!(
                "tendon {arm} pulled with {torque} N m at the servo, allowed {allowed}"
            ));
        }
        None
    }

    /// A roll that ended short.
    fn badly_rolled(&mut self, now: &Snapshot<'_, impl Aircraft>) -> Option<String> {
        let index = now.step.map(|(i, _)| i);
        if index != self.last_step {
            self.last_step = index;
            self.hold_start = None;
            if let Some((angle, [right, left])) = self.roll.take()
                && right.min(left) < ROLL_SHARE * angle
            {
                return Some(format!(
                    "rolled to {:+.1} and {:+.1} deg, wanted {:.1} on either side",
                    right.to_degrees(),
                    -left.to_degrees(),
                    angle.to_degrees()
                ));
            }
        }
        if let Some((_, Step::Roll { angle, .. })) = now.step {
            let [roll, ..] = now.plant.euler();
            let (_, [right, left]) = self.roll.get_or_insert((*angle, [0.0; 2]));
            *right = right.max(roll);
            *left = left.max(-roll);
        }
        None
    }

    /// A perch that ends during a hold; else how many tolerances the pressure may be off.
    fn let_go(&mut self, now: &Snapshot<'_, impl Aircraft>) -> (Option<String>, Option<f64>) {
        let (t, plant, stack) = (now.t(), now.plant, now.stack);
        // Holds without the radio too.
        let holds = match now.step {
            Some((_, Step::Hold { .. })) => true,
            Some((_, Step::RadioOff { .. })) => self.hold_start.is_some() || stack.mode() == Mode::Perched,
            _ => false,
        };
        if !holds {
            return (None, None);
        }
        let position = plant.pose().position;
        let (start, place) = *self.hold_start.get_or_insert((t, position));
        if stack.mode() != Mode::Perched {
            let mode = stack.mode().name();
            return (Some(format!("left the perch during the hold: mode {mode}")), None);
        }
        if plant.thrust().iter().any(|thrust| *thrust > STOPPED) && t - start > SETTLE {
            return (Some("a rotor turned during the hold".to_owned()), None);
        }
        let slip = (position - place).length();
        if slip > SLIP {
            let (slip, allowed) = (slip * 1e3, SLIP * 1e3);
            return (
                Some(format!("slipped {slip:.0} mm on the pipe, allowed {allowed:.0}")),
                None,
            );
        }
        if plant.push != DVec3::ZERO {
            self.pushed = t;
        }
        let quiet = t - start.max(self.pushed) > SETTLE;
        (None, Some(if quiet { 1.0 } else { DISTURBED }))
    }

    /// Across a reset no rotor turns before the pilot arms, and a gripped vehicle stays gripped.
    fn after_reset(&mut self, now: &Snapshot<'_, impl Aircraft>) -> Option<String> {
        let (t, step, plant, stack) = (now.t(), now.step, now.plant, now.stack);
        match step {
            Some((_, Step::Reset { .. })) => {
                let reset = stack.reset().filter(|r| Some(r.step) == step.map(|(i, _)| i));
                if let Some(reset) = reset {
                    let asked = stack.motors();
                    let turns = plant.thrust().iter().any(|thrust| *thrust > STOPPED);
                    if asked != [0.0; 4] || turns && t - reset.at > RUN_OUT {
                        return Some("a rotor turned after the reset".to_owned());
                    }
                } else if self.proven && stack.mode() == Mode::Perched {
                    self.hanging = Some(plant.pose().position);
                }
            }
            Some((_, Step::Arm | Step::Hold { .. })) => {}
            _ => self.hanging = None,
        }
        let slip = (plant.pose().position - self.hanging?).length();
        (slip > SLIP).then(|| format!("slipped {:.0} mm on the pipe after the reset", slip * 1e3))
    }

    /// An arm of a vehicle that hangs after a reset without the pressure of one that touches.
    fn hollow(&self, now: &Snapshot<'_, impl Aircraft>) -> Option<String> {
        self.hanging?;
        let plant = now.plant;
        let mut arms = plant.pressure().into_iter().zip(self.chosen).enumerate();
        // Without pulses a weak servo's gears slip down to their friction; no arm may come off.
        let (arm, (pressure, _)) = arms.find(|(_, (p, chosen))| *chosen && *p < self.released)?;
        Some(format!(
            "after the reset arm {} holds {pressure:.0} N/m2 only",
            arm + 1
        ))
    }

    /// A chosen arm with a true pressure off by more than `tolerances` tolerances plus the sensor's error.
    fn badly_held(&self, plant: &Plant, tolerances: f64) -> Option<String> {
        let allowed = tolerances * TOLERANCE + self.sensor_error;
        let mut arms = plant.pressure().into_iter().zip(self.chosen).enumerate();
        let (arm, (pressure, _)) =
            arms.find(|(_, (pressure, chosen))| *chosen && (pressure - self.target).abs() > allowed)?;
        Some(format!(
            "arm {} holds {pressure:.0} N/m2, wanted {:.0} within {allowed:.0}",
            arm + 1,
            self.target
        ))
    }
}

/// Both numbers printed with enough digits to differ, at least three significant.
fn printed_apart(value: f64, allowed: f64) -> (String, String) {
    let least = if allowed < 100.0 { 2 } else { 0 };
    let written = |digits: usize| (format!("{value:.digits$}"), format!("{allowed:.digits$}"));
    let mut digits = least..9;
    digits
        .find(|digits| written(*digits).0 != written(*digits).1)
        .map_or_else(|| written(9), written)
}

/// Largest of four values and its arm, 1 to 4.
fn worst(values: PerArm<f64>) -> Option<(usize, f64)> {
    values
        .into_iter()
        .enumerate()
        .map(|(i, v)| (i + 1, v))
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::printed_apart;

    #[test]
    fn a_value_and_its_limit_are_printed_apart() {
        for (value, allowed, words) in [
            (2.4541, 2.452, ("2.454", "2.452")),
            (3.1, 2.452, ("3.10", "2.45")),
            (1500.2, 1500.0, ("1500.2", "1500.0")),
            (1720.0, 1500.0, ("1720", "1500")),
            (2.452_000_3, 2.452, ("2.4520003", "2.4520000")),
        ] {
            assert_eq!(
                printed_apart(value, allowed),
                (words.0.to_owned(), words.1.to_owned())
            );
        }
    }
}
