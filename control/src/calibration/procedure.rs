//! The procedure of every calibration, step by step, whoever asks for it: the console's verbs and MAVLink run this one.
//!
//! A step measures for a fixed time. Measurements of earlier steps are kept for [`KEPT_US`]; the last step computes the
//! parameters. A step that fails keeps those before it.

#[cfg(test)]
mod tests;

use super::flow::{FlowFit, FlowTurns, Round, flow_fit};
use super::loads::{self, Loads};
use super::step::{Calibration, Step};
use super::{AccelFit, ArmFit, BIAS, Face, SCALES, Samples, Unfit, thousandths, within};
use crate::allocation::wrench::PerArm;
use crate::attitude::messages::Attitude;
use crate::attitude::mounting::{Direction, Mounting};
use crate::gripper::contact_pressure::SensorLine;
use crate::gripper::tendon::SPAN_MIN_US;
use crate::maths::scalar::to_deg;
use crate::maths::vector::Vec3;
use crate::navigation::flow_range_sample::GroundView;
use crate::params::Params;

/// Time for which the measurements of earlier steps are kept, µs: ten minutes, in which the next one is prepared.
pub const KEPT_US: u64 = 600_000_000;
/// Sides of the mounting's steps.
pub const MOUNTING_SIDES: [Face; 3] = [Face::Belly, Face::Nose, Face::Right];
/// Range of a servo's travel from release to full mark, µs: the least that is useful, and all of the parameters' range.
const TRAVEL_US: [f32; 2] = [SPAN_MIN_US, 1900.0];
/// Most parameters that one calibration sets.
pub const CHANGES: usize = 6;

const RELEASE: [&str; 4] = [
    "servo_release_1",
    "servo_release_2",
    "servo_release_3",
    "servo_release_4",
];
const TRIM: [&str; 4] = ["servo_trim_1", "servo_trim_2", "servo_trim_3", "servo_trim_4"];
const FULL: [&str; 4] = ["servo_full_1", "servo_full_2", "servo_full_3", "servo_full_4"];
const FSR: [[&str; 2]; 4] = [
    ["fsr_trim_1", "fsr_zero_1"],
    ["fsr_trim_2", "fsr_zero_2"],
    ["fsr_trim_3", "fsr_zero_3"],
    ["fsr_trim_4", "fsr_zero_4"],
];
const ARM: [[&str; 2]; 4] = [
    ["arm_sign_1", "arm_zero_1"],
    ["arm_sign_2", "arm_zero_2"],
    ["arm_sign_3", "arm_zero_3"],
    ["arm_sign_4", "arm_zero_4"],
];

/// Readings of the sensors at one time; `None` for a silent or stale sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Readings {
    /// Attitude with its time, µs.
    pub attitude: Option<(u64, Attitude)>,
    /// Voltage of the flight battery, V.
    pub battery: Option<f32>,
    /// Contact pressures, Pa.
    pub pressures: PerArm<Option<f32>>,
    /// Tilts of the arms by their own sensors, rad, tip up.
    pub tilts: PerArm<Option<f32>>,
    /// Flow and range below the vehicle.
    pub ground: GroundView,
}

/// Names and values of the parameters that a calibration sets.
pub type Changes = [Option<(&'static str, f32)>; CHANGES];

/// Outcome of a step that has passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// It is kept; another step follows.
    Taken,
    /// The calibration is complete.
    Done(Changes),
}

/// The end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// The step.
    pub step: Step,
    /// Its outcome, or the quantity that forbids it.
    pub result: Result<Outcome, Unfit>,
    /// Results beside the parameters, NaN for unused ones. Gyro: rates about x, y, z and noise, deg/s. Pressure sensor:
    /// half of the 95 % interval of the pressure at the grip pressure, Pa; half width of the hysteresis, %; reading
    /// without a load at the end, Pa. Flow: height of the turning point over the lens, m.
    pub figures: [f32; 4],
}

/// A step was asked for before the one ahead of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfOrder;

/// The calibrations of one line.
#[derive(Clone, Debug)]
pub struct Procedure {
    running: Option<Running>,
    kept: Kept,
}

/// The running step.
#[derive(Clone, Debug)]
struct Running {
    step: Step,
    begun_us: u64,
    samples: Samples,
    turns: FlowTurns,
}

/// Measurements of the steps that have passed.
#[derive(Clone, Debug)]
struct Kept {
    /// Their calibration and its part.
    of: Option<(Calibration, usize)>,
    /// Number of steps without a gap.
    steps: u8,
    /// End of their validity, µs.
    until_us: u64,
    means: [Vec3; 6],
    below: [Direction; 3],
    samples: Samples,
    loads: Loads,
    near: Option<Round>,
}

impl Default for Procedure {
    fn default() -> Self {
        Self::new()
    }
}

impl Procedure {
    /// Nothing measured.
    pub const fn new() -> Self {
        Self {
            running: None,
            kept: Kept {
                of: None,
                steps: 0,
                until_us: 0,
                means: [Vec3::ZERO; 6],
                below: [Direction::Down; 3],
                samples: Samples::NONE,
                loads: loads::NONE,
                near: None,
            },
        }
    }

    /// Begins `step` at `now_us`; a running one ends without a result.
    ///
    /// # Errors
    /// A step before it was not measured, or too long ago; nothing runs then.
    pub fn begin(&mut self, step: Step, now_us: u64) -> Result<(), OutOfOrder> {
        self.running = None;
        let of = (step.calibration, step.part);
        if step.number == 1 {
            self.kept.of = Some(of);
            self.kept.steps = 0;
        }
        let in_time = step.number == 1 || now_us <= self.kept.until_us;
        if self.kept.of != Some(of) || step.number > self.kept.steps + 1 || !in_time {
            return Err(OutOfOrder);
        }
        self.running = Some(Running {
            step,
            begun_us: now_us,
            samples: Samples::NONE,
            turns: FlowTurns::default(),
        });
        Ok(())
    }

    /// Ends the running step without a result; true if one ran.
    pub fn cancel(&mut self) -> bool {
        self.running.take().is_some()
    }

    /// Number of the step of `calibration` that comes next for `part` (0 to 3): 1, or the one after those that have
    /// passed less than [`KEPT_US`] ago.
    pub fn next(&self, calibration: Calibration, part: usize, now_us: u64) -> u8 {
        let kept = self.kept.of == Some((calibration, part)) && now_us <= self.kept.until_us;
        if kept { self.kept.steps + 1 } else { 1 }
    }

    /// The running step.
    pub fn running(&self) -> Option<&Step> {
        self.running.as_ref().map(|running| &running.step)
    }

    /// Share of the running step that is over at `now_us`, %.
    pub fn progress(&self, now_us: u64) -> u8 {
        self.running.as_ref().map_or(0, |running| {
            let time = running.step.calibration.time_us().max(1);
            (now_us.saturating_sub(running.begun_us) * 100 / time).min(100) as u8
        })
    }

    /// Takes the sensors' `readings` at `now_us`, at 50 Hz or more; returns the end of the running step. The sensors are
    /// read with the parameters `in_force`; `working` are those that will be stored.
    pub fn sample(
        &mut self,
        now_us: u64,
        readings: &Readings,
        in_force: &Params,
        working: &Params,
    ) -> Option<Finding> {
        let running = self.running.as_mut()?;
        let step = running.step;
        match step.calibration {
            Calibration::Flow => {
                if let Some((at_us, attitude)) = readings.attitude {
                    running.turns.add(at_us, attitude.q, &readings.ground);
                }
            }
            _ => {
                if let Some(sample) = sampled(&step, readings) {
                    running.samples.add(sample);
                }
            }
        }
        if now_us.saturating_sub(running.begun_us) < step.calibration.time_us() {
            return None;
        }
        let running = self.running.take()?;
        let mut figures = [f32::NAN; 4];
        let result = self.kept.end(&running, in_force, working, &mut figures);
        if result.is_ok() {
            // A sensor remembers its loads: one that is repeated wants those after it again.
            self.kept.steps = match step.calibration {
                Calibration::Fsr => step.number,
                _ => self.kept.steps.max(step.number),
            };
            self.kept.until_us = now_us.saturating_add(KEPT_US);
        }
        if matches!(result, Ok(Outcome::Done(_))) {
            self.kept.of = None;
        }
        Some(Finding {
            step,
            result,
            figures,
        })
    }
}

/// Reading of the calibrated sensor.
fn sampled(step: &Step, readings: &Readings) -> Option<Vec3> {
    let along_x = |value: f32| Vec3::new(value, 0.0, 0.0);
    let attitude = readings.attitude.map(|(_, attitude)| attitude);
    match step.calibration {
        Calibration::Gyro => attitude.map(|a| a.rate + a.gyro_bias),
        Calibration::Level | Calibration::Accel | Calibration::Mounting => attitude.map(|a| a.accel),
        Calibration::Battery => readings.battery.map(along_x),
        Calibration::Fsr => readings.pressures.get(step.part).copied().flatten().map(along_x),
        Calibration::Arm => readings.tilts.get(step.part).copied().flatten().map(along_x),
        Calibration::Servo | Calibration::Flow => None,
    }
}

impl Kept {
    /// The result of a step whose time is over.
    fn end(
        &mut self,
        running: &Running,
        in_force: &Params,
        working: &Params,
        figures: &mut [f32; 4],
    ) -> Result<Outcome, Unfit> {
        let (step, samples) = (&running.step, &running.samples);
        let done = |changes| Ok(Outcome::Done(changes));
        match step.calibration {
            Calibration::Gyro => {
                let [x, y, z] = super::rest_rate(samples)?.to_array();
                *figures = [x, y, z, samples.spread()].map(to_deg);
                done([None; CHANGES])
            }
            Calibration::Level => {
                let bias = super::level(samples, &AccelFit::of(in_force))?;
                done(changes(step, &bias.to_array()))
            }
            Calibration::Accel => self.side(step, samples, in_force),
            Calibration::Mounting => self.mounting(step, samples, in_force),
            Calibration::Battery => {
                let [meter, _] = step.values;
                let divider = super::divider(samples, in_force.battery_divider, meter)?;
                done(changes(step, &[divider]))
            }
            Calibration::Servo => marks(step, in_force, working).map(Outcome::Done),
            Calibration::Fsr => self.pressure_sensor(step, samples, in_force, figures),
            Calibration::Arm => self.arm_sensor(step, samples, in_force),
            Calibration::Flow => self.flow(step, &running.turns, in_force, figures),
        }
    }

    fn side(&mut self, step: &Step, samples: &Samples, in_force: &Params) -> Result<Outcome, Unfit> {
        let at = usize::from(step.number) - 1;
        let side = Face::ALL.get(at).copied().unwrap_or(Face::Left);
        let mean = super::face(samples, side)?;
        if let Some(kept) = self.means.get_mut(at) {
            *kept = mean;
        }
        if !step.is_last() {
            return Ok(Outcome::Taken);
        }
        let found = super::six_faces(&self.means, &AccelFit::of(in_force))?;
        let (bias, scale) = (found.bias, found.scale);
        let values = [bias.x, bias.y, bias.z, scale.x, scale.y, scale.z];
        Ok(Outcome::Done(changes(step, &values)))
    }

    fn mounting(&mut self, step: &Step, samples: &Samples, in_force: &Params) -> Result<Outcome, Unfit> {
        let found = super::below(samples)?;
        if let Some(kept) = self.below.get_mut(usize::from(step.number) - 1) {
            *kept = found;
        }
        if !step.is_last() {
            return Ok(Outcome::Taken);
        }
        let [belly, nose, right] = self.below;
        let found = Mounting { nose, right, belly };
        let both = found.after(&Mounting::from(in_force.imu_mounting));
        let value = both.and_then(|both| both.parameter());
        // Two sides that are alike or opposite, or a left-handed three.
        let handed = if value.is_some() { 1.0 } else { 0.0 };
        within("three sides of one vehicle", handed, [1.0, 1.0], "")?;
        let number = value.map_or(f32::NAN, |value| value.number());
        Ok(Outcome::Done(changes(step, &[number])))
    }

    fn pressure_sensor(
        &mut self,
        step: &Step,
        samples: &Samples,
        in_force: &Params,
        figures: &mut [f32; 4],
    ) -> Result<Outcome, Unfit> {
        let at = usize::from(step.number) - 1;
        let [load, _] = step.values;
        let load = if loads::is_empty(step.number) { 0.0 } else { load };
        let now = SensorLine::from_params(in_force, step.part);
        let loaded = loads::loaded(samples, load / in_force.fsr_area, &now)?;
        if let Some(kept) = self.loads.get_mut(at) {
            *kept = loaded;
        }
        loads::follows(&self.loads, at, in_force.grip_pressure)?;
        if !step.is_last() {
            return Ok(Outcome::Taken);
        }
        let found = loads::line(&self.loads, in_force.grip_pressure)?;
        *figures = [found.error, found.hysteresis, found.empty, f32::NAN];
        Ok(Outcome::Done(changes(step, &[found.line.trim, found.line.zero])))
    }

    fn arm_sensor(&mut self, step: &Step, samples: &Samples, in_force: &Params) -> Result<Outcome, Unfit> {
        if !step.is_last() {
            super::quiet_tilt(samples)?;
            self.samples = *samples;
            return Ok(Outcome::Taken);
        }
        let fit = super::arm_sensor(&self.samples, samples, ArmFit::of(in_force, step.part))?;
        Ok(Outcome::Done(changes(step, &[fit.sign, fit.zero])))
    }

    fn flow(
        &mut self,
        step: &Step,
        turns: &FlowTurns,
        in_force: &Params,
        figures: &mut [f32; 4],
    ) -> Result<Outcome, Unfit> {
        let round = turns.round(step.is_last())?;
        if !step.is_last() {
            self.near = Some(round);
            return Ok(Outcome::Taken);
        }
        let now = FlowFit {
            scale: in_force.flow_scale,
            mounting: in_force.flow_mounting,
        };
        let (fit, pivot) = flow_fit(self.near.as_ref().unwrap_or(&round), &round, now)?;
        *figures = [pivot, f32::NAN, f32::NAN, f32::NAN];
        let values = [fit.scale, fit.mounting.number()];
        Ok(Outcome::Done(changes(step, &values)))
    }
}

/// Marks of a servo by its pulses at release and at the full mark, without its trim.
fn marks(step: &Step, in_force: &Params, working: &Params) -> Result<Changes, Unfit> {
    let name = |names: &[&'static str; 4]| names.get(step.part).copied().unwrap_or_default();
    let (release, full) = (name(&RELEASE), name(&FULL));
    let trim = in_force.get(name(&TRIM)).unwrap_or_default();
    let pulses = step.values.map(|pulse_us| pulse_us - trim);
    let [at_release, at_full] = pulses;
    for (what, parameter, pulse_us) in [
        ("pulse at release", release, at_release),
        ("pulse at the full mark", full, at_full),
    ] {
        let range = Params::row(parameter).map_or([0.0; 2], |row| [row.min, row.max]);
        within(what, pulse_us, range, "us")?;
    }
    within("travel", (at_full - at_release).abs(), TRAVEL_US, "us")?;
    let marks = working.servo_marks.with(step.part).number();
    Ok(changes(step, &[at_release, at_full, marks]))
}

/// Names of the parameters that the calibration of part 0 to 3 sets.
pub fn parameters(calibration: Calibration, part: usize) -> [Option<&'static str>; CHANGES] {
    let one = |names: &[&'static str; 4]| names.get(part).copied();
    let two = |names: &[[&'static str; 2]; 4]| names.get(part).map_or([None; 2], |names| names.map(Some));
    let [x, y, z] = BIAS.map(Some);
    match calibration {
        Calibration::Gyro => [None; CHANGES],
        Calibration::Level => [x, y, z, None, None, None],
        Calibration::Accel => {
            let [sx, sy, sz] = SCALES.map(Some);
            [x, y, z, sx, sy, sz]
        }
        Calibration::Mounting => [Some("imu_mounting"), None, None, None, None, None],
        Calibration::Battery => [Some("battery_divider"), None, None, None, None, None],
        Calibration::Servo => [one(&RELEASE), one(&FULL), Some("servo_marks"), None, None, None],
        Calibration::Fsr => {
            let [trim, zero] = two(&FSR);
            [trim, zero, None, None, None, None]
        }
        Calibration::Arm => {
            let [sign, zero] = two(&ARM);
            [sign, zero, None, None, None, None]
        }
        Calibration::Flow => [Some("flow_scale"), Some("flow_mounting"), None, None, None, None],
    }
}

/// The parameters of `step` with `values`, rounded to a thousandth.
fn changes(step: &Step, values: &[f32]) -> Changes {
    let mut changes = [None; CHANGES];
    let names = parameters(step.calibration, step.part).into_iter().flatten();
    for (change, (name, value)) in changes.iter_mut().zip(names.zip(values)) {
        *change = Some((name, thousandths(*value)));
    }
    changes
}
