//! Line of a pressure sensor in its mounted arm, by known loads up and down on a segment of the pipe.
//!
//! A sensor conducts by the force that it has followed: the contact's, F, less its hysteresis h as the load rises, plus h
//! as it falls. With preload F_p and turn-on force F_0 ([`SensorLine`]) the conductance over the common gain is
//!
//!   rising  G = g ((1 - h) F + F_p - F_0),   falling  G = g ((1 + h) F + F_p - F_0),
//!
//! two lines with one intercept: y = a x + b on the three loads up, y = d x + b on those down, by least squares. A grip
//! is proven on rising pressure, and held on falling: the loop takes back its overshoot, and the rotors stop. So the line
//! of the parameters is the one between: trim = (a + d) / 2, zero = b / trim; the reading is h too low at the proof and h
//! too high in the hold, h = (d - a) / (d + a). With the rising line arms held 737 to 883 Pa instead of 950, with this
//! one 796 to 967 (h of 7 %, drift of 4 % per decade). The loads lie about the grip pressure, where the line is used.

use super::{Samples, Unfit, within};
use crate::gripper::contact_pressure::SensorLine;
use crate::maths::scalar::{clamp, sqrt};

/// Steps: empty, three loads up, two down, empty.
pub const STEPS: usize = 7;
/// Loads up; the largest is the last.
const UP: usize = 3;

/// Largest spread of a pressure at rest, Pa.
const SPREAD_MAX: f32 = 30.0;
/// Smallest and largest pressure of the loads over the grip pressure, of the first and the third: they enclose it.
const FIRST: [f32; 2] = [0.3, 1.0];
const THIRD: [f32; 2] = [1.0, 2.5];
/// Least difference of a load to the one before, share of the grip pressure: more than twice the widest hysteresis's
/// part that the reading needs to turn round on the middle load.
const STEP_MIN: f32 = 0.15;
/// Least change of the reading between two loads, share of the load's: a weight that lies beside the pad changes
/// nothing.
const FOLLOWS: [f32; 2] = [0.05, 20.0];
/// Range of a sensor's conductance relative to the common one, that of its parameter.
const TRIM: [f32; 2] = [0.2, 5.0];
/// Range of a sensor's zero, Pa, that of its parameter.
const ZERO: [f32; 2] = [-650.0, 300.0];
/// Half width of the hysteresis, %. At 15 % a grip that is proven at 950 Pa reads 1280 Pa as its load falls back to
/// 950 Pa. Falling loads that read less than rising ones are no hysteresis.
const HYSTERESIS: [f32; 2] = [-3.0, 15.0];
/// Largest reading without a load, Pa, at the beginning and at the end, and largest change between both. A preload of
/// 0.3 N per radian, 250 Pa on the bent arm, comes back with 50 Pa more by a hysteresis of 10 %, and some by its drift;
/// it goes with the bend of an arm that opens.
const EMPTY_MAX: f32 = 120.0;
/// Largest error of the line at the grip pressure, share of it: three tolerances of a grip.
const ERROR_MAX: f32 = 0.15;
/// Student's t of 95 % with two degrees of freedom: five loads, three numbers.
const STUDENT: f32 = 4.303;
/// What the scatter about the lines does not show, share of the pressure, 95 %: a kitchen scale's 1 g of 140 g, and the
/// drift between the time under a load here and in a closing arm (3 to 5 % per decade of time), which is one-sided.
const UNSEEN: f32 = 0.05;

/// One load and what the sensor makes of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loaded {
    /// Load over the sensor's area, Pa.
    pub pressure: f32,
    /// Conductance as a pressure by the common model, Pa.
    pub reading: f32,
}

/// All of them, in the order of the steps.
pub type Loads = [Loaded; STEPS];

/// None taken.
pub const NONE: Loads = [Loaded {
    pressure: 0.0,
    reading: 0.0,
}; STEPS];

/// True for the step `number`, from 1, of a pad without a load.
pub const fn is_empty(number: u8) -> bool {
    number <= 1 || number as usize >= STEPS
}

/// Result of the loads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Line between rising and falling pressure.
    pub line: SensorLine,
    /// Half of the 95 % interval of the line at the grip pressure, Pa; the hysteresis is beside it.
    pub error: f32,
    /// Half width of the hysteresis, %.
    pub hysteresis: f32,
    /// Reading without a load at the end, by the line, Pa.
    pub empty: f32,
}

/// Takes one step's `samples` (Pa, along x), read with the line `now`, at the load `pressure` (Pa).
///
/// # Errors
/// Samples are too few or too noisy.
pub fn loaded(samples: &Samples, pressure: f32, now: &SensorLine) -> Result<Loaded, Unfit> {
    let shown = samples.quiet_mean(SPREAD_MAX, "Pa")?.x;
    Ok(Loaded {
        pressure,
        reading: now.conductance(shown),
    })
}

/// Judges the load of the step with index `at` by the one before, for a grip of `grip` Pa.
///
/// # Errors
/// A load out of order, or a reading that does not follow it.
pub fn follows(loads: &Loads, at: usize, grip: f32) -> Result<(), Unfit> {
    let of = |at: usize| loads.get(at).copied().unwrap_or_default();
    if is_empty(at as u8 + 1) {
        return Ok(());
    }
    let (before, now) = (of(at - 1), of(at));
    let range = match at {
        1 => FIRST,
        UP => THIRD,
        _ => [FIRST[0], THIRD[1]],
    };
    within(
        "pressure of the load",
        now.pressure,
        range.map(|share| share * grip),
        "Pa",
    )?;
    if at == 1 {
        return within(
            "reading of the load",
            now.reading,
            [FOLLOWS[0] * now.pressure, f32::MAX],
            "Pa",
        );
    }
    let (what, way) = if at > UP {
        ("load under the last", -1.0)
    } else {
        ("load over the last", 1.0)
    };
    let step = way * (now.pressure - before.pressure);
    within(what, step, [STEP_MIN, THIRD[1]].map(|share| share * grip), "Pa")?;
    let change = way * (now.reading - before.reading) / step;
    within("reading's change per load", change, FOLLOWS, "")
}

/// Sums of the points of one branch, in units of the grip pressure.
#[derive(Clone, Copy, Default)]
struct Branch {
    x: f32,
    xx: f32,
    xy: f32,
}

impl Branch {
    fn of(points: &[Loaded], grip: f32) -> Self {
        let mut sums = Self::default();
        for point in points {
            let (x, y) = (point.pressure / grip, point.reading / grip);
            sums.x += x;
            sums.xx += x * x;
            sums.xy += x * y;
        }
        sums
    }

    /// Slope with the intercept `b`.
    fn slope(&self, b: f32) -> f32 {
        (self.xy - b * self.x) / self.xx
    }

    /// What the slope leaves at (x, y) without an intercept, and what an intercept of 1 leaves there.
    fn left(&self, x: f32, y: f32) -> [f32; 2] {
        [y - x * self.xy / self.xx, 1.0 - x * self.x / self.xx]
    }
}

/// Line by all loads, for a grip of `grip` Pa.
///
/// # Errors
/// A line that no sound sensor has: too wide a hysteresis, a drift, a scatter, or parameters out of their range.
pub fn line(loads: &Loads, grip: f32) -> Result<Found, Unfit> {
    let [first, up @ .., fourth, fifth, last] = loads;
    let branches = [up.as_slice(), &[*fourth, *fifth]].map(|points| (points.len(), Branch::of(points, grip)));
    let [(_, rising), (_, falling)] = branches;
    // By the residuals of both branches: b = sum(u v) / sum(v v).
    let points = up
        .iter()
        .map(|p| (rising, p))
        .chain([(falling, fourth), (falling, fifth)]);
    let [mut uv, mut vv, mut uu] = [0.0; 3];
    for (branch, point) in points {
        let [u, v] = branch.left(point.pressure / grip, point.reading / grip);
        uv += u * v;
        vv += v * v;
        uu += u * u;
    }
    let b = uv / vv;
    let [a, d] = [rising, falling].map(|branch| branch.slope(b));
    let trim = 0.5 * (a + d);
    within("conductance over fsr_gain", trim, TRIM, "")?;
    let line = SensorLine {
        trim,
        zero: b / trim * grip,
    };
    within("pressure without a load", line.zero, ZERO, "Pa")?;
    let hysteresis = 100.0 * (d - a) / (d + a);
    within("half width of hysteresis", hysteresis, HYSTERESIS, "%")?;
    let [begin, end] = [first, last].map(|empty| line.pressure(empty.reading / trim));
    within("empty before the loads", begin, [ZERO[0], EMPTY_MAX], "Pa")?;
    within("empty after the loads", end, [ZERO[0], EMPTY_MAX], "Pa")?;
    within(
        "drift of the empty pad",
        end - begin,
        [-EMPTY_MAX, EMPTY_MAX],
        "Pa",
    )?;
    // Variance of the line at the grip pressure: both slopes' without an intercept, and the intercept's.
    let degrees = (UP + 2 - 3) as f32;
    let scatter = clamp(uu - b * uv, 0.0, 1e6) / degrees;
    let [[_, up], [_, down]] = [rising, falling].map(|branch| branch.left(1.0, 0.0));
    let v = 0.5 * (up + down);
    let slopes = 0.25 * (1.0 / rising.xx + 1.0 / falling.xx);
    let seen = STUDENT * sqrt(scatter * (slopes + v * v / vv)) / trim;
    let error = grip * sqrt(seen * seen + UNSEEN * UNSEEN);
    within("error at the grip pressure", error, [0.0, ERROR_MAX * grip], "Pa")?;
    Ok(Found {
        line,
        error,
        hysteresis,
        empty: end,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRIP: f32 = 950.0;
    const PRESSURES: [f32; STEPS] = [0.0, 650.0, 950.0, 1350.0, 950.0, 650.0, 0.0];

    /// A sensor of `trim` times the common conductance, with zero (Pa) and hysteresis, at each pressure.
    fn sensor(trim: f32, zero: f32, hysteresis: f32) -> Loads {
        let mut loads = NONE;
        for (at, (load, pressure)) in loads.iter_mut().zip(PRESSURES).enumerate() {
            let side = if at <= UP {
                1.0 - hysteresis
            } else {
                1.0 + hysteresis
            };
            let above = side * pressure + zero;
            *load = Loaded {
                pressure,
                reading: trim * if above > 0.0 { above } else { 0.0 },
            };
        }
        loads
    }

    #[test]
    fn the_line_is_the_one_between_rising_and_falling_pressure() {
        for (trim, zero, hysteresis) in [
            (1.0, 0.0, 0.0),
            (0.7, -400.0, 0.1),
            (1.3, 80.0, 0.05),
            (2.0, -150.0, 0.02),
        ] {
            let loads = sensor(trim, zero, hysteresis);
            for at in 0..STEPS {
                follows(&loads, at, GRIP).unwrap();
            }
            let found = line(&loads, GRIP).unwrap();
            assert!((found.line.trim / trim - 1.0).abs() < 1e-3, "{found:?}");
            assert!((found.line.zero - zero).abs() < 0.5, "{found:?}");
            assert!((found.hysteresis - 100.0 * hysteresis).abs() < 0.01, "{found:?}");
            let of = |at: usize| found.line.pressure(loads[at].reading / found.line.trim);
            assert!((0.5 * (of(2) + of(4)) - GRIP).abs() < 0.5, "{} {}", of(2), of(4));
        }
    }

    #[test]
    fn a_scatter_about_the_lines_widens_the_interval_as_by_hand() {
        // The middle load up reads 10 Pa more, the others by the line y = x: residuals of five points and three
        // numbers. In units of the grip: rising x 0.684, 1, 1.421, falling 1, 0.684.
        let mut loads = sensor(1.0, 0.0, 0.0);
        loads[2].reading += 10.0;
        let found = line(&loads, GRIP).unwrap();
        // Normal equations solved by hand: a 0.999628, d 0.995632, sum of squares 7.4639e-5, variance of their mean at 1
        // 0.24313.
        assert!((found.line.trim - 0.997_630).abs() < 1e-4, "{found:?}");
        let seen = 4.303 * (7.463_9e-5f32 / 2.0 * 0.243_13).sqrt() / 0.997_630;
        let error = GRIP * (seen * seen + UNSEEN * UNSEEN).sqrt();
        assert!((found.error - error).abs() < 0.5, "{} {error}", found.error);
    }

    #[test]
    fn what_is_unfit_is_named_with_its_number() {
        let judged = |change: &dyn Fn(&mut Loads)| {
            let mut loads = sensor(1.0, -100.0, 0.05);
            change(&mut loads);
            let steps = (0..STEPS).find_map(|at| follows(&loads, at, GRIP).err());
            steps.or_else(|| line(&loads, GRIP).err()).unwrap().what
        };
        let at = |at: usize, pressure: f32| move |loads: &mut Loads| loads[at].pressure = pressure;
        assert_eq!(judged(&at(1, 200.0)), "pressure of the load");
        assert_eq!(judged(&at(3, 900.0)), "pressure of the load");
        assert_eq!(judged(&at(2, 700.0)), "load over the last");
        assert_eq!(judged(&at(4, 1300.0)), "load under the last");
        assert_eq!(judged(&|l| l[1].reading = 0.0), "reading of the load");
        assert_eq!(
            judged(&|l| l[2].reading = l[1].reading),
            "reading's change per load"
        );
        assert_eq!(
            judged(&|l| l[4].reading = l[3].reading),
            "reading's change per load"
        );
        assert_eq!(
            judged(&|l| *l = sensor(0.1, 0.0, 0.0)),
            "conductance over fsr_gain"
        );
        assert_eq!(
            judged(&|l| *l = sensor(1.0, 400.0, 0.0)),
            "pressure without a load"
        );
        assert_eq!(
            judged(&|l| *l = sensor(1.0, 0.0, 0.16)),
            "half width of hysteresis"
        );
        assert_eq!(judged(&|l| l[0].reading = 100.0), "empty before the loads");
        assert_eq!(judged(&|l| l[6].reading = 100.0), "empty after the loads");
        assert_eq!(judged(&|l| l[2].reading += 120.0), "error at the grip pressure");
        assert_eq!(judged(&|l| l[2].reading = f32::NAN), "reading's change per load");
    }
}
