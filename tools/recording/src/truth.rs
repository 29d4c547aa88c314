//! Truth by motion capture: a table of places, velocities and attitudes, and an estimate's error against it.

use std::path::Path;

use sophie_control::maths::frames::about_down;
use sophie_control::maths::scalar;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::navigation::estimate::Estimate;

use crate::lines::{Lines, number, time};
use crate::table::head;

/// Columns of a place, of a velocity and of an attitude: each group may be missing.
const PLACE: [&str; 3] = ["north", "east", "down"];
const VELOCITY: [&str; 3] = ["vn", "ve", "vd"];
const ATTITUDE: [&str; 3] = ["roll_deg", "pitch_deg", "yaw_deg"];
/// Bounds of their values: m, m/s, degrees.
const FAR: (f32, f32) = (-10_000.0, 10_000.0);
const FAST: (f32, f32) = (-100.0, 100.0);
const TURNED: (f32, f32) = (-720.0, 720.0);
/// Longest interpolated gap between two rows, µs.
const GAP: u64 = 100_000;
/// Most rows: five hours at 200 Hz.
const ROWS_MAX: usize = 4_000_000;

/// The truth at one time; `None` for a value that the file lacks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    at_us: u64,
    place: Option<Vec3>,
    velocity: Option<Vec3>,
    /// Roll, pitch, yaw, rad.
    attitude: Option<Vec3>,
}

/// The whole.
#[derive(Clone, Debug, Default)]
pub struct Truth {
    rows: Vec<Row>,
    /// The row that was looked at last: later calls ask for later times.
    next: usize,
}

impl Truth {
    /// Reads a file.
    ///
    /// # Errors
    /// One line: place, value, allowed values.
    pub fn read(path: &Path) -> Result<Self, String> {
        let mut lines = Lines::open(path)?;
        let head = head(&mut lines)?;
        head.require(&["t_us"]).map_err(|why| lines.bad(&why))?;
        let groups = [PLACE, VELOCITY, ATTITUDE].map(|names| names.iter().any(|name| head.has(name)));
        for (names, any) in [PLACE, VELOCITY, ATTITUDE].iter().zip(groups) {
            if any {
                head.require(names).map_err(|why| lines.bad(&why))?;
            }
        }
        if !groups.contains(&true) {
            let wanted = [PLACE, VELOCITY, ATTITUDE]
                .map(|names| names.join(", "))
                .join("; ");
            return Err(lines.bad(&format!("no truth, allowed is a table with t_us and {wanted}")));
        }
        let mut rows: Vec<Row> = vec![];
        while let Some(line) = lines.next()? {
            let read = || -> Result<Row, String> {
                let cells = head.cells(line)?;
                let cell = |name: &'static str| head.cell(&cells, name).unwrap_or_default();
                let vector =
                    |any: bool, names: [&'static str; 3], range, unit| -> Result<Option<Vec3>, String> {
                        // A row may lack values: the camera sees the vehicle only in part of its volume.
                        if !any || names.iter().all(|name| cell(name).is_empty()) {
                            return Ok(None);
                        }
                        let [x, y, z] = names.map(|name| number(name, cell(name), range, unit));
                        Ok(Some(Vec3::new(x?, y?, z?)))
                    };
                Ok(Row {
                    at_us: time("t_us", cell("t_us"))?,
                    place: vector(groups[0], PLACE, FAR, "m")?,
                    velocity: vector(groups[1], VELOCITY, FAST, "m/s")?,
                    attitude: vector(groups[2], ATTITUDE, TURNED, "degrees")?.map(|v| v.map(f32::to_radians)),
                })
            };
            let row = read().map_err(|why| lines.bad(&why))?;
            if let Some(last) = rows.last().filter(|last| row.at_us <= last.at_us) {
                let why = format!(
                    "t_us {}, allowed is after {}, the line before it",
                    row.at_us, last.at_us
                );
                return Err(lines.bad(&why));
            }
            if rows.len() >= ROWS_MAX {
                return Err(lines.bad(&format!("more than {ROWS_MAX} rows, allowed are as many")));
            }
            rows.push(row);
        }
        Ok(Self { rows, next: 0 })
    }

    /// The truth at `at_us`, µs, which never decreases from call to call; `None` before the first row, after the last
    /// and in gaps.
    pub fn at(&mut self, at_us: u64) -> Row {
        while self.rows.get(self.next + 1).is_some_and(|row| row.at_us <= at_us) {
            self.next += 1;
        }
        let (Some(a), Some(b)) = (self.rows.get(self.next), self.rows.get(self.next + 1)) else {
            return Row::default();
        };
        if at_us < a.at_us || at_us > b.at_us || b.at_us - a.at_us > GAP {
            return Row::default();
        }
        let share = (at_us - a.at_us) as f32 / (b.at_us - a.at_us) as f32;
        let between = |a: Option<Vec3>, b: Option<Vec3>| Some(a? + (b? - a?) * share);
        let turned = |a: Option<Vec3>, b: Option<Vec3>| Some(a? + (b? - a?).map(scalar::wrap_pi) * share);
        Row {
            at_us,
            place: between(a.place, b.place),
            velocity: between(a.velocity, b.velocity),
            attitude: turned(a.attitude, b.attitude),
        }
    }
}

/// A mean of squares, about the mean of the values or not.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    count: u32,
    sum: f64,
    squares: f64,
}

impl Spread {
    fn add(&mut self, x: f32) {
        self.count += 1;
        self.sum += f64::from(x);
        self.squares += f64::from(x) * f64::from(x);
    }

    fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / f64::from(self.count))
    }

    fn rms(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.squares / f64::from(self.count)).sqrt())
    }

    fn rms_about_mean(&self) -> Option<f64> {
        let (mean, rms) = (self.mean()?, self.rms()?);
        Some((rms * rms - mean * mean).max(0.0).sqrt())
    }
}

/// Errors of estimate and attitude.
///
/// The estimate has its own axes: they are aligned with the truth's where each estimate begins, by heading and place.
/// The constant difference of roll and pitch belongs to the set-up (sensor against markers); it is subtracted and
/// reported.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    /// Turn from the estimate's axes to the truth's, rad, and its origin there, m; `None` before the first estimate.
    laid: Option<(f32, Vec3)>,
    velocity: Spread,
    height: Spread,
    place_end: Option<f64>,
    roll: Spread,
    pitch: Spread,
}

impl Errors {
    /// Compares an attitude, and an estimate if there is one.
    pub fn take(&mut self, truth: &Row, q: Option<Quat>, estimate: Option<&Estimate>) {
        let Some(q) = q else {
            return;
        };
        let (roll, pitch, yaw) = q.to_euler();
        if let Some(attitude) = truth.attitude {
            self.roll.add(scalar::wrap_pi(roll - attitude.x));
            self.pitch.add(scalar::wrap_pi(pitch - attitude.y));
        }
        let Some(e) = estimate else {
            self.laid = None;
            return;
        };
        if self.laid.is_none() {
            let turn = truth.attitude.map(|a| scalar::wrap_pi(a.z - yaw - e.yaw_offset));
            self.laid = turn.map(|turn| {
                let place = truth.place.unwrap_or_default();
                (turn, place - about_down(e.position, turn))
            });
        }
        let Some((turn, origin)) = self.laid else {
            return;
        };
        if let Some(velocity) = truth.velocity {
            let off = about_down(e.velocity, turn) - velocity;
            self.velocity.add(Vec3::new(off.x, off.y, 0.0).norm());
        }
        if let Some(place) = truth.place {
            self.height.add(e.position.z - place.z);
            let off = about_down(e.position, turn) + origin - place;
            self.place_end = Some(f64::from(Vec3::new(off.x, off.y, 0.0).norm()));
        }
    }

    /// Of the level velocity, m/s RMS.
    pub fn velocity(&self) -> Option<f64> {
        self.velocity.rms()
    }

    /// Of the height above the ground, m RMS.
    pub fn height(&self) -> Option<f64> {
        self.height.rms()
    }

    /// Level, at the end of the last estimate, m.
    pub fn place_end(&self) -> Option<f64> {
        self.place_end
    }

    /// Roll and pitch, degrees RMS, and the subtracted constants, degrees.
    pub fn attitude(&self) -> Option<([f64; 2], [f64; 2])> {
        let both = [self.roll, self.pitch];
        let [roll, pitch] = both.map(|s| s.rms_about_mean().map(f64::to_degrees));
        let [roll_mean, pitch_mean] = both.map(|s| s.mean().map(f64::to_degrees));
        Some(([roll?, pitch?], [roll_mean?, pitch_mean?]))
    }
}
