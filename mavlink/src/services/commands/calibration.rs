//! Calibration by command, with the console's laws ([`sophie_control::calibration`]) and texts that guide the user.
//!
//! A result is set as a parameter: stored a second later, in force after a restart.

use sophie_control::calibration::{
    self, AccelFit, BIAS, Face, SCALES, Samples, Unfit, rest_rate, six_faces, thousandths,
};
use sophie_control::maths::decimal::Decimal;
use sophie_control::maths::vector::Vec3;

use super::{or_zero, whole};
use crate::services::Services;
use crate::services::answer::Answer;
use crate::vehicle::Vehicle;
use crate::wire::requests::{Command, Peer};
use sophie_dialect::*;

/// Length of one rest, µs: 125 samples at the rate of the task.
const REST: u64 = 2_500_000;
/// Time to turn the vehicle to the next side, µs.
const PATIENCE: u64 = 60_000_000;

/// The sensor under calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Gyro,
    Level,
    SixSides,
}

/// A running calibration.
#[derive(Clone, Debug)]
pub struct Calibration {
    kind: Kind,
    /// Samples of the present rest.
    samples: Samples,
    /// Start of the present rest, µs.
    rest: u64,
    /// Time of the request for the present side, µs.
    asked: u64,
    /// Means of the finished sides, m/s².
    means: heapless::Vec<Vec3, 6>,
}

/// Result of a rest.
enum RestResult {
    /// Another rest, on the same side or the next.
    More,
    /// The gyro is at rest: the calibration ends.
    Gyro,
    /// Bias, and scale after six sides.
    Accel(Vec3, Option<Vec3>),
}

impl Services {
    /// Begins a calibration or cancels the running one; `None` if the acknowledgement comes later.
    pub(super) fn calibrate(
        &mut self,
        command: &Command,
        from: Peer,
        now: u64,
        vehicle: &Vehicle,
    ) -> Option<MavResult> {
        let kind = match command.params.map(or_zero).map(whole) {
            [Some(0), Some(0), Some(0), Some(0), Some(0), Some(0), Some(0)] => {
                if self.calibration.take().is_some() {
                    self.settle(MavResult::MAV_RESULT_CANCELLED);
                }
                return Some(MavResult::MAV_RESULT_ACCEPTED);
            }
            [Some(1), Some(0), Some(0), Some(0), Some(0), Some(0), Some(0)] => Kind::Gyro,
            [Some(0), Some(0), Some(0), Some(0), Some(1), Some(0), Some(0)] => Kind::SixSides,
            [Some(0), Some(0), Some(0), Some(0), Some(2 | 4), Some(0), Some(0)] => Kind::Level,
            _ => return Some(self.unsupported("others calibrate at the console")),
        };
        if !vehicle.at_rest() {
            return Some(self.refuse_armed());
        }
        if let Err(answer) = self.begin(command.number, from, now) {
            return answer;
        }
        self.calibration = Some(Calibration {
            kind,
            samples: Samples::default(),
            rest: now,
            asked: now,
            means: heapless::Vec::new(),
        });
        self.progress(0);
        let text = match kind {
            Kind::Gyro => "leave the vehicle at rest",
            Kind::Level => "put the vehicle on a level table",
            Kind::SixSides => Face::Belly.text(),
        };
        self.guide(text);
        None
    }

    fn guide(&mut self, text: &str) {
        self.texts.say(
            MavSeverity::MAV_SEVERITY_INFO,
            format_args!("calibration: {text}"),
        );
    }

    /// One step of the running calibration.
    pub(crate) fn continue_calibration(&mut self, now: u64, vehicle: &Vehicle) {
        let Some(calibration) = &mut self.calibration else {
            return;
        };
        if !vehicle.at_rest() {
            self.calibration = None;
            let result = self.refuse_armed();
            return self.settle(result);
        }
        match calibration.step(now, vehicle) {
            None => (),
            Some(Ok(RestResult::More)) => {
                let done = calibration.means.len();
                if let (Some(side), true) = (Face::ALL.get(done), calibration.asked == now) {
                    self.progress((done * 100 / Face::ALL.len()) as u8);
                    self.guide(side.text());
                }
            }
            Some(Ok(found)) => {
                self.calibration = None;
                if let RestResult::Accel(bias, scale) = found {
                    self.put(BIAS, bias, now);
                    if let Some(scale) = scale {
                        self.put(SCALES, scale, now);
                    }
                }
                self.guide("done");
                self.settle(MavResult::MAV_RESULT_ACCEPTED);
            }
            Some(Err(unfit)) => {
                self.calibration = None;
                let Unfit {
                    what, value, unit, ..
                } = unfit;
                let [value, least, most] = [value, unfit.allowed[0], unfit.allowed[1]].map(Decimal);
                self.texts.say(
                    MavSeverity::MAV_SEVERITY_WARNING,
                    format_args!("{what} {value:.2} not in {least:.2}..{most:.2} {unit}"),
                );
                self.settle(MavResult::MAV_RESULT_FAILED);
            }
        }
    }

    fn put(&mut self, names: [&str; 3], values: Vec3, now: u64) {
        for (name, value) in names.into_iter().zip(values.to_array()) {
            if let Some(place) = self.parameters.put(name, thousandths(value), now) {
                self.answer(Answer::Parameter(place));
            }
        }
    }
}

impl Calibration {
    /// Takes a sample; at the end of a rest returns its result.
    fn step(&mut self, now: u64, vehicle: &Vehicle) -> Option<Result<RestResult, Unfit>> {
        if let Some(attitude) = vehicle.attitude {
            self.samples.add(match self.kind {
                Kind::Gyro => attitude.rate + attitude.gyro_bias,
                Kind::Level | Kind::SixSides => attitude.accel,
            });
        }
        if now.saturating_sub(self.rest) < REST {
            return None;
        }
        self.rest = now;
        let samples = core::mem::take(&mut self.samples);
        Some(match self.kind {
            Kind::Gyro => rest_rate(&samples).map(|_| RestResult::Gyro),
            Kind::Level => {
                calibration::level(&samples, &vehicle.accel_fit).map(|bias| RestResult::Accel(bias, None))
            }
            Kind::SixSides => self.take_side(&samples, now, &vehicle.accel_fit),
        })
    }

    /// Takes a side that lies still in the requested position; waits for it up to `PATIENCE`.
    fn take_side(&mut self, samples: &Samples, now: u64, fit: &AccelFit) -> Result<RestResult, Unfit> {
        let side = Face::ALL.get(self.means.len()).copied().unwrap_or(Face::Left);
        match calibration::face(samples, side) {
            Ok(mean) => {
                let _ = self.means.push(mean);
                self.asked = now;
            }
            Err(unfit) if now.saturating_sub(self.asked) >= PATIENCE => return Err(unfit),
            Err(_) => (),
        }
        match <&[Vec3; 6]>::try_from(self.means.as_slice()) {
            Ok(means) => six_faces(means, fit).map(|found| RestResult::Accel(found.bias, Some(found.scale))),
            Err(_) => Ok(RestResult::More),
        }
    }
}
