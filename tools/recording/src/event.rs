//! A measurement: the content of a sensor's line.

use sophie_control::chain::ImuReading;
use sophie_control::maths::vector::Vec3;
use sophie_control::navigation::flow_range_sample::{Flow, Range};

use crate::lines::{number, time};

/// Bounds of recorded values: rad/s, m/s², rad, s, m and N. Wider than any sensor of a vehicle of this size.
const RATE: (f32, f32) = (-100.0, 100.0);
const FORCE: (f32, f32) = (-1_000.0, 1_000.0);
const ANGLE: (f32, f32) = (-10.0, 10.0);
const PERIOD: (f32, f32) = (1e-4, 1.0);
const DISTANCE: (f32, f32) = (-1.0, 1_000.0);
const REACH: (f32, f32) = (0.0, 1_000.0);
const LIFT: (f32, f32) = (0.0, 10_000.0);

/// One measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// Inertial sample, vehicle axes.
    Inertial(ImuReading),
    /// Optical flow.
    Flow(Flow),
    /// Range.
    Range(Range),
    /// Thrust of the rotors, N.
    Lift(f32),
}

/// The cells of a line with their names.
pub struct Cells<'a>(pub &'a dyn Fn(&'static str) -> Option<&'a str>);

impl Cells<'_> {
    fn text(&self, name: &'static str) -> Result<&str, String> {
        (self.0)(name).ok_or_else(|| format!("no {name}, allowed is a line with all its values"))
    }

    fn number(&self, name: &'static str, range: (f32, f32), unit: &str) -> Result<f32, String> {
        number(name, self.text(name)?, range, unit)
    }

    fn vector(&self, names: [&'static str; 3], range: (f32, f32), unit: &str) -> Result<Vec3, String> {
        let [x, y, z] = names;
        Ok(Vec3::new(
            self.number(x, range, unit)?,
            self.number(y, range, unit)?,
            self.number(z, range, unit)?,
        ))
    }

    /// Measurement time, µs: not after `at`, the time of receipt.
    fn measured(&self, name: &'static str, at: u64) -> Result<u64, String> {
        let measured = (self.0)(name).map_or(Ok(at), |text| time(name, text))?;
        if measured > at {
            return Err(format!("{name} {measured}, allowed 0 to {at} us, when it came"));
        }
        Ok(measured)
    }

    /// An inertial sample.
    pub fn inertial(&self) -> Result<Event, String> {
        Ok(Event::Inertial(ImuReading {
            gyro: self.vector(["gx", "gy", "gz"], RATE, "rad/s")?,
            accel: self.vector(["ax", "ay", "az"], FORCE, "m/s2")?,
        }))
    }

    /// A flow received at `at`, µs.
    pub fn flow(&self, at: u64) -> Result<Event, String> {
        Ok(Event::Flow(Flow {
            until_us: self.measured("flow_t_us", at)?,
            seconds: self.number("flow_s", PERIOD, "s")?,
            angle: [
                self.number("flow_x", ANGLE, "rad")?,
                self.number("flow_y", ANGLE, "rad")?,
            ],
            quality: self.number("flow_quality", (0.0, 255.0), "")? as u8,
        }))
    }

    /// A range received at `at`, µs; `nan` means no return.
    pub fn range(&self, at: u64) -> Result<Event, String> {
        let text = self.text("range_m")?;
        let nothing = text.eq_ignore_ascii_case("nan");
        let bound = |name, default| (self.0)(name).map_or(Ok(default), |text| number(name, text, REACH, "m"));
        Ok(Event::Range(Range {
            at_us: self.measured("range_t_us", at)?,
            distance: if nothing {
                None
            } else {
                Some(number("range_m", text, DISTANCE, "m, or nan")?)
            },
            reach: (bound("range_min_m", 0.0)?, bound("range_max_m", 100.0)?),
        }))
    }

    /// The rotors' thrust.
    pub fn lift(&self) -> Result<Event, String> {
        Ok(Event::Lift(self.number("lift_n", LIFT, "N")?))
    }
}
