//! The step of a tendon: its servo winds the free arm in steps, a known weight hangs on the tip and is taken off, and the
//! arm's own sensor is read ([`sophie_fit::servo_steps`] has the law).

use std::time::Duration;

use mavlink_core::MessageData;
use sophie_control::gripper::tendon::{REFERENCE_TILT, Reel};
use sophie_control::params::Params;
use sophie_dialect::{MavCmd, MavMessage, SOPHIE_ARMS_DATA};
use sophie_fit::servo_steps::bench::{Given, Rest};
use sophie_fit::servo_steps::plan::{self, Next};
use sophie_fit::servo_steps::{Found, fit};

use super::actuators::{FIRST_SERVO, give_back};
use super::calibrate::typed;
use super::walk::{Stop, Verdict, Walk, understood};
use super::{Judged, Step};

/// Period of the messages with the tilt, µs, and the longest wait for one.
const PERIOD_US: f32 = 100_000.0;
const SILENT: Duration = Duration::from_secs(5);
/// Messages until an arm is at rest after a step, and those of a mean; until a servo that moves has arrived.
const SETTLES: usize = 15;
const MEAN: usize = 10;
const ARRIVES: usize = 100;
/// Difference of the reel's angle from the ordered one, rad.
const THERE: f64 = 0.01;
/// Messages between two orders that hold a servo: one order lasts 30 s.
const RENEWED: usize = 100;
/// Weights on a tip, N.
const WEIGHTS: (f32, f32) = (1.5, 6.0);
/// Name of the stiffness in the protocol, and of the parameter.
const STIFFNESS: &str = "tendon_stiffness";

/// Why an attempt ends.
enum End {
    Stop(Stop),
    Bad(String),
}

impl<E: Into<Stop>> From<E> for End {
    fn from(stop: E) -> Self {
        Self::Stop(stop.into())
    }
}

pub(super) fn tendon(walk: &mut Walk<'_>, step: &Step) -> Judged {
    walk.ready()?;
    let arm = step.number - 1;
    let params = walk.vehicle.values()?.params();
    if !params.servo_marks.has(arm) {
        let line = format!(
            "servo {0} has no marks: the step servo-{0} finds them",
            step.number
        );
        return Ok(Verdict::of(false, vec![line]));
    }
    let usual = walk.tip_weight.clone();
    let question = format!("Weight in N for the tip, 306 g are 3 N; Enter for {usual}:");
    let (text, weight) = typed(walk, &question, Some(usual))?;
    let (least, most) = WEIGHTS;
    if !(least..=most).contains(&weight) {
        let line = format!("weight {text} N: allowed are {least} to {most} N");
        return Ok(Verdict::of(false, vec![line]));
    }
    walk.tip_weight = text;
    let messages = [SOPHIE_ARMS_DATA::ID];
    walk.vehicle.stream(&messages, PERIOD_US)?;
    let mut bench = Bench {
        arm,
        reel: Reel::from_params(&params, arm),
        given: given(&params, step.number),
        range: params.servo_range.into(),
        torque: usable(&params),
        weight: weight.into(),
        hung: false,
        rests: Vec::new(),
        walk,
    };
    let found = bench.measure();
    let rests = std::mem::take(&mut bench.rests);
    if !matches!(found, Err(End::Stop(Stop::Failed(_)))) {
        give_back(walk, arm)?;
        walk.vehicle.stream(&messages, 0.0)?;
    }
    match found {
        Ok(found) => taken(walk, step, &params, &found),
        Err(End::Stop(stop)) => Err(stop),
        Err(End::Bad(line)) => {
            for rest in rests {
                walk.say(&format!(
                    "  | {:.3} rad, {:.1} N: {:.2} deg",
                    rest.reel,
                    rest.weight,
                    rest.tilt.to_degrees()
                ));
            }
            Ok(Verdict::of(false, vec![line]))
        }
    }
}

/// What the parameters say of arm `number`, 1 to 4.
fn given(params: &Params, number: usize) -> Given {
    let speed = params.get(&format!("servo_slew_{number}"));
    Given {
        reel_radius: params.reel_radius.into(),
        lever: params.tendon_lever.into(),
        length: params.arm_d.into(),
        bend: params.tendon_bend.into(),
        reference: REFERENCE_TILT.into(),
        speed: speed.unwrap_or_default().into(),
    }
}

/// Torque that the servo may take, N·m.
fn usable(params: &Params) -> f64 {
    f64::from(params.servo_torque_max.min(params.servo_stall))
}

/// One arm on the bench.
struct Bench<'a, 'w> {
    walk: &'a mut Walk<'w>,
    arm: usize,
    reel: Reel,
    given: Given,
    /// Travel and torque of the servo, rad and N·m.
    range: f64,
    torque: f64,
    /// N, and whether it hangs on the tip.
    weight: f64,
    hung: bool,
    rests: Vec<Rest>,
}

impl Bench<'_, '_> {
    fn measure(&mut self) -> Result<Found, End> {
        for next in plan::FREE {
            self.rest(next)?;
        }
        let tilt = |at: usize| self.rests.get(at).map_or(0.0, |rest| rest.tilt);
        let (free, hung) = (tilt(0), tilt(1));
        let low = plan::top_tilt(free, hung, self.weight, self.torque, &self.given);
        self.walk.say("  | up and down once, to seat the knots");
        let (mut slack, mut top) = (0.0, 0.0);
        loop {
            let tilt = self.at(top, SETTLES / 2)?;
            if tilt <= low {
                break;
            }
            if !plan::is_taut(free, tilt) {
                slack = top;
            }
            if top >= self.range {
                return Err(End::Bad(format!(
                    "wound by {top:.1} rad the arm tilts by {:.0} deg: allowed are {:.0}; a torn or long thread, or a weak \
                     servo",
                    (free - tilt).to_degrees(),
                    (free - low).to_degrees()
                )));
            }
            top = (top + plan::SEARCH).min(self.range);
        }
        self.at(0.0, SETTLES)?;
        for next in plan::rests(slack, top) {
            self.rest(next)?;
        }
        fit(&self.rests, &self.given).map_err(End::Bad)
    }

    /// Measures one rest.
    fn rest(&mut self, next: Next) -> Result<(), End> {
        if next.hung != self.hung {
            let hands = if next.hung {
                "Hang the weight on the tip, slowly, until it hangs still."
            } else {
                "Take the weight off, slowly."
            };
            self.hands(hands)?;
            self.hung = next.hung;
        }
        let tilt = self.at(next.reel, SETTLES)?;
        let weight = if next.hung { self.weight } else { 0.0 };
        self.walk.user.live(&format!(
            "  | {:.2} rad {:>4.1} N {:>7.2} deg",
            next.reel,
            weight,
            tilt.to_degrees()
        ));
        self.rests.push(Rest {
            reel: next.reel,
            weight,
            tilt,
        });
        Ok(())
    }

    /// Winds to `reel` rad; mean tilt after `settles` messages at rest.
    fn at(&mut self, reel: f64, settles: usize) -> Result<f64, End> {
        self.order(reel)?;
        let mut there = false;
        for _ in 0..ARRIVES {
            there = (self.seen()?.1 - reel).abs() < THERE;
            if there {
                break;
            }
        }
        if !there {
            return Err(End::Bad(format!(
                "servo {} does not get to {reel:.2} rad",
                self.arm + 1
            )));
        }
        for _ in 0..settles {
            self.seen()?;
        }
        let mut sum = 0.0;
        for _ in 0..MEAN {
            sum += self.seen()?.0;
        }
        Ok(sum / MEAN as f64)
    }

    fn order(&mut self, reel: f64) -> Result<(), End> {
        let pulse = self.reel.pulse_beyond(reel as f32);
        let output = (FIRST_SERVO + self.arm) as f32;
        let refused = self.walk.order(MavCmd::MAV_CMD_DO_SET_SERVO, &[output, pulse])?;
        refused.map_or(Ok(()), |line| Err(End::Bad(line)))
    }

    /// The next tilt and angle of the reel, rad.
    fn seen(&mut self) -> Result<(f64, f64), End> {
        let arm = self.arm;
        let silence = self.walk.vehicle.silence(SILENT);
        let seen = self.walk.vehicle.wait(silence, |message| match message {
            MavMessage::SOPHIE_ARMS(arms) => {
                let of = |all: &[f32; 4]| all.get(arm).copied().map_or(f64::NAN, f64::from);
                Some((of(&arms.tilt), of(&arms.reel)))
            }
            _ => None,
        })?;
        seen.filter(|(tilt, reel)| tilt.is_finite() && reel.is_finite())
            .ok_or_else(|| End::Bad(format!("the sensor of arm {} is silent", arm + 1)))
    }

    /// Holds the servo until hands have done as asked.
    fn hands(&mut self, what: &str) -> Result<(), End> {
        self.walk.say(&format!("  | {what}"));
        self.walk.say("  Enter when it is so, s leaves it out, q stops:");
        let reel = self.rests.last().map_or(0.0, |rest| rest.reel);
        for count in 0.. {
            if let Some(reply) = self.walk.user.answered() {
                understood(reply)?;
                break;
            }
            let (tilt, _) = self.seen()?;
            self.walk.user.live(&format!("  | {:.1} deg", tilt.to_degrees()));
            if count % RENEWED == RENEWED - 1 {
                self.order(reel)?;
            }
        }
        Ok(())
    }
}

/// Sets and stores the results.
fn taken(walk: &mut Walk<'_>, step: &Step, params: &Params, found: &Found) -> Judged {
    let mut figures = found.lines();
    let name = format!("servo_trim_{}", step.number);
    let (trim, length) = (
        params.get(&name).unwrap_or_default(),
        length_per_us(params, step.number),
    );
    let wanted = f64::from(trim) + found.slack.value / length;
    let most = Params::row(&name).map_or(0.0, |row| f64::from(row.max));
    if wanted.abs() > most {
        let sign = if wanted * length > 0.0 {
            "shorter"
        } else {
            "longer"
        };
        figures.push(format!(
            "{name} takes {:.1} mm: knot the thread {:.1} mm {sign}, then once more",
            1e3 * most * length.abs(),
            1e3 * found.slack.value.abs()
        ));
        return Ok(Verdict::of(false, figures));
    }
    let mut measured = walk.measured(STIFFNESS, step.id);
    measured.push(found.stiffness.value);
    let common = measured.iter().sum::<f64>() / measured.len() as f64;
    for (name, value) in [
        (STIFFNESS, common.round() as f32),
        (&*name, (10.0 * wanted).round() as f32 / 10.0),
    ] {
        match walk.set(name, value)? {
            Ok(line) => figures.push(line),
            Err(refused) => return Ok(Verdict::of(false, vec![refused])),
        }
    }
    let mut verdict = Verdict::of(true, figures);
    verdict.parameters = walk.keep()?;
    verdict.measured = [(STIFFNESS.to_owned(), found.stiffness.value.round())].into();
    Ok(verdict)
}

/// Thread that a microsecond of arm `number`'s pulse winds, m; negative of a servo mounted the other way round.
fn length_per_us(params: &Params, number: usize) -> f64 {
    let reel = Reel::from_params(params, number - 1);
    let span = f64::from(reel.pulse(params.servo_range) - reel.pulse(0.0));
    f64::from(params.reel_radius) * f64::from(params.servo_range) / span
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trim_winds_on_the_side_that_its_servo_turns_to() {
        let straight = Params::DEFAULT;
        // 4.71 rad of 15 mm in 1900 us.
        assert!((length_per_us(&straight, 1) - 3.718e-5).abs() < 1e-7);
        let mirrored = Params {
            servo_release_2: 2450.0,
            servo_full_2: 550.0,
            ..straight
        };
        assert!((length_per_us(&mirrored, 2) + 3.718e-5).abs() < 1e-7);
    }
}
