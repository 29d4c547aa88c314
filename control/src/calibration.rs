//! Calibration on the table: turns samples at rest into a parameter's value, or into the number that forbids it.
//!
//! The functions neither store nor apply the result: the console shows it and `save` stores it, and MAVLink stores it
//! as a parameter that was set.

pub mod flow;
pub mod loads;
pub mod procedure;
pub mod step;

use core::fmt;

use crate::attitude::mounting::{Direction, Mounting};
use crate::maths::decimal::Decimal;
use crate::maths::scalar::{GRAVITY, clamp, deg, sin, sqrt};
use crate::maths::vector::Vec3;
use crate::params::Params;

/// Least samples of a mean.
pub const SAMPLES_MIN: u16 = 100;
/// Largest spread (standard deviation) of the specific force at rest, m/s²: touching the table exceeds it.
pub const FORCE_SPREAD_MAX: f32 = 0.15;
/// Largest spread of the gyro at rest, rad/s (0.57 deg/s).
pub const RATE_SPREAD_MAX: f32 = 0.01;
/// Largest bias of an accelerometer, m/s²: 60 mg, the range of the parameters.
pub const BIAS_MAX: f32 = 0.6;
/// Largest lean of a face from the vertical, rad (8°): it reduces the gravity that this face reads by 1 %, half of
/// which goes into the bias (0.05 m/s²).
pub const FACE_LEAN_MAX: f32 = deg(8.0);
/// Allowed reading of gravity along the side that lies below, share of gravity: covers the largest bias with the one
/// already subtracted (0.6 m/s² and half of it), the scale and the lean.
pub const SIDE_SHARE: [f32; 2] = [0.8, 1.2];
/// Scale of an accelerometer's axis that can be corrected, the range of its parameter: beyond it the part is broken.
pub const SCALE: [f32; 2] = [0.9, 1.1];
/// Largest spread of the battery's voltage, share of it.
pub const VOLTAGE_SPREAD_MAX: f32 = 0.01;
/// Plausible battery voltages of a meter, V.
pub const METER: [f32; 2] = [3.0, 60.0];
/// Range of the battery's divider, that of its parameter.
pub const DIVIDER: [f32; 2] = [1.0, 60.0];

/// Largest spread of an arm's tilt at rest, rad.
pub const TILT_SPREAD_MAX: f32 = 0.02;
/// Rotation of an arm that is bent up by hand, rad: the lower bound suffices for its sign, the upper one excludes other
/// motions.
pub const TURN: [f32; 2] = [0.1, 1.5];
/// Largest tilt that the sensor of a straight arm may show, rad, that of its parameter.
pub const ARM_ZERO_MAX: f32 = 0.6;

/// Parameters that hold the bias of the accelerometer's axes.
pub const BIAS: [&str; 3] = ["accel_bias_x", "accel_bias_y", "accel_bias_z"];
/// Parameters that hold their scale.
pub const SCALES: [&str; 3] = ["accel_scale_x", "accel_scale_y", "accel_scale_z"];

/// Rounds the value to a thousandth: no calibration is more precise.
pub fn thousandths(value: f32) -> f32 {
    let half = if value < 0.0 { -0.5 } else { 0.5 };
    (value * 1000.0 + half) as i32 as f32 / 1000.0
}

/// Reason for which samples are unfit: the quantity, its value and its limits; as text, a sentence on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unfit<T = &'static str> {
    /// Name of the quantity.
    pub what: T,
    /// Measured value.
    pub value: f32,
    /// Least and largest allowed value.
    pub allowed: [f32; 2],
    /// Unit of the value and both limits.
    pub unit: T,
}

impl fmt::Display for Unfit<&str> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [value, least, most] = [self.value, self.allowed[0], self.allowed[1]].map(Decimal);
        let space = if self.unit.is_empty() { "" } else { " " };
        write!(
            f,
            "{} is {value:.2}; {least:.2} to {most:.2}{space}{} allowed",
            self.what, self.unit
        )
    }
}

/// `Ok` for a value within `allowed`; NaN is not.
pub(crate) fn within(
    what: &'static str,
    value: f32,
    allowed: [f32; 2],
    unit: &'static str,
) -> Result<(), Unfit> {
    let [least, most] = allowed;
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(Unfit {
            what,
            value,
            allowed,
            unit,
        })
    }
}

/// Mean and spread of vectors, sample by sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Samples {
    count: u16,
    mean: Vec3,
    /// Sum of the squared distances to the mean.
    squares: Vec3,
}

impl Samples {
    /// No sample.
    pub const NONE: Self = Self {
        count: 0,
        mean: Vec3::ZERO,
        squares: Vec3::ZERO,
    };

    /// Takes one sample; ignores samples after 65,535. A sample that is not finite spoils the set.
    pub fn add(&mut self, sample: Vec3) {
        if self.count < u16::MAX {
            self.count += 1;
            let before = sample - self.mean;
            self.mean += before * (1.0 / f32::from(self.count));
            self.squares += before.scale_by(sample - self.mean);
        }
    }

    /// The mean.
    pub const fn mean(&self) -> Vec3 {
        self.mean
    }

    /// Largest standard deviation of an axis.
    pub fn spread(&self) -> f32 {
        let [x, y, z] = self.squares.to_array();
        let widest = if x > y { x } else { y };
        let widest = if widest > z { widest } else { z };
        sqrt(widest / f32::from(self.count.max(1)))
    }

    /// The mean, if the samples are enough and quiet: spread at most `most` in `unit`.
    fn quiet_mean(&self, most: f32, unit: &'static str) -> Result<Vec3, Unfit> {
        let enough = [f32::from(SAMPLES_MIN), f32::from(u16::MAX)];
        within("samples", f32::from(self.count), enough, "")?;
        let sum = self.mean.x + self.mean.y + self.mean.z;
        within("mean", sum, [f32::MIN, f32::MAX], unit)?;
        within("noise", self.spread(), [0.0, most], unit)?;
        Ok(self.mean)
    }
}

/// Gyro reading at rest, rad/s.
///
/// # Errors
/// Samples are too few or too noisy.
pub fn rest_rate(samples: &Samples) -> Result<Vec3, Unfit> {
    samples.quiet_mean(RATE_SPREAD_MAX, "rad/s")
}

/// Correction that the inertial sensor's readings already contain; a new result adds to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccelFit {
    /// Bias of each axis of the board, m/s².
    pub bias: Vec3,
    /// Reading of each axis of the board over the true value.
    pub scale: Vec3,
    /// Rotation from the board's axes to the vehicle's.
    pub mounting: Mounting,
}

impl AccelFit {
    /// The correction by the parameters.
    pub fn of(p: &Params) -> Self {
        Self {
            bias: Vec3::new(p.accel_bias_x, p.accel_bias_y, p.accel_bias_z),
            scale: Vec3::new(p.accel_scale_x, p.accel_scale_y, p.accel_scale_z),
            mounting: Mounting::from(p.imu_mounting),
        }
    }

    /// The bias with `error` (m/s², vehicle) subtracted as well.
    fn beyond(&self, error: Vec3) -> Vec3 {
        self.bias + self.mounting.to_board(error).scale_by(self.scale)
    }
}

/// Accelerometer bias from one rest on a level table, m/s², board axes; the samples were read with the correction
/// `now`.
///
/// A table that leans by 1° adds 0.17 m/s² to x and y, and an error of the scale goes into z.
///
/// # Errors
/// Samples are too few or too noisy, or the bias is impossible for a sound part on a level table.
pub fn level(samples: &Samples, now: &AccelFit) -> Result<Vec3, Unfit> {
    let mean = samples.quiet_mean(FORCE_SPREAD_MAX, "m/s2")?;
    checked_bias(now.beyond(mean + Vec3::new(0.0, 0.0, GRAVITY)))
}

fn checked_bias(bias: Vec3) -> Result<Vec3, Unfit> {
    let names = ["bias along x", "bias along y", "bias along z"];
    for (name, value) in names.into_iter().zip(bias.to_array()) {
        within(name, value, [-BIAS_MAX, BIAS_MAX], "m/s2")?;
    }
    Ok(bias)
}

/// Side of the vehicle that lies below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Belly down: level.
    Belly,
    /// On its back.
    Back,
    /// Nose down.
    Nose,
    /// Tail down.
    Tail,
    /// Right side down.
    Right,
    /// Left side down.
    Left,
}

impl Face {
    /// All six, in the order of the procedure.
    pub const ALL: [Self; 6] = [
        Self::Belly,
        Self::Back,
        Self::Nose,
        Self::Tail,
        Self::Right,
        Self::Left,
    ];

    /// The side that lies below, in a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Belly => "belly",
            Self::Back => "back",
            Self::Nose => "nose",
            Self::Tail => "tail",
            Self::Right => "right",
            Self::Left => "left",
        }
    }

    /// Orientation of the vehicle, in words.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Belly => "level, belly down",
            Self::Back => "on its back",
            Self::Nose => "nose down",
            Self::Tail => "tail down",
            Self::Right => "right side down",
            Self::Left => "left side down",
        }
    }

    /// Specific force with this side down, m/s², body.
    pub const fn force(self) -> Vec3 {
        match self {
            Self::Belly => Vec3::new(0.0, 0.0, -GRAVITY),
            Self::Back => Vec3::new(0.0, 0.0, GRAVITY),
            Self::Nose => Vec3::new(-GRAVITY, 0.0, 0.0),
            Self::Tail => Vec3::new(GRAVITY, 0.0, 0.0),
            Self::Right => Vec3::new(0.0, -GRAVITY, 0.0),
            Self::Left => Vec3::new(0.0, GRAVITY, 0.0),
        }
    }
}

/// Bias and scale by six faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SixFaces {
    /// Bias of each axis of the board, m/s².
    pub bias: Vec3,
    /// Reading of each axis of the board over the true value.
    pub scale: Vec3,
}

/// The mean over one rest with `face` down, m/s².
///
/// # Errors
/// Samples are too few or too noisy, another side lies below, or the vehicle leans.
pub fn face(samples: &Samples, face: Face) -> Result<Vec3, Unfit> {
    let mean = samples.quiet_mean(FORCE_SPREAD_MAX, "m/s2")?;
    let expected = face.force();
    let along = mean.dot(expected) / GRAVITY;
    let allowed = SIDE_SHARE.map(|share| share * GRAVITY);
    within("gravity on this side", along, allowed, "m/s2")?;
    let across = mean - expected * (along / GRAVITY);
    let most = GRAVITY * sin(FACE_LEAN_MAX) + BIAS_MAX;
    within("lean of this side", across.norm(), [0.0, most], "m/s2")?;
    Ok(mean)
}

/// Bias and scale from the means with each side down, in the order of [`Face::ALL`], read with the correction `now`. A
/// leaning table does no harm: each axis uses only the two faces in which it is vertical.
///
/// # Errors
/// A bias or a scale that is impossible for a sound part.
pub fn six_faces(means: &[Vec3; 6], now: &AccelFit) -> Result<SixFaces, Unfit> {
    let [belly, back, nose, tail, right, left] = means;
    let centre = Vec3::new(tail.x + nose.x, left.y + right.y, back.z + belly.z) * 0.5;
    let span = Vec3::new(tail.x - nose.x, left.y - right.y, back.z - belly.z);
    // The scale is the same for both directions of an axis.
    let share = now.mounting.to_board(span * (0.5 / GRAVITY)).map(f32::abs);
    let scale = share.scale_by(now.scale);
    for (name, value) in ["scale of x", "scale of y", "scale of z"]
        .into_iter()
        .zip(scale.to_array())
    {
        within(name, value, SCALE, "")?;
    }
    Ok(SixFaces {
        bias: checked_bias(now.beyond(centre))?,
        scale,
    })
}

/// Axis of the vehicle that points down in this rest, as the firmware reads it.
///
/// # Errors
/// Samples are too few or too noisy, or gravity lies along none of the axes.
pub fn below(samples: &Samples) -> Result<Direction, Unfit> {
    let [x, y, z] = samples.quiet_mean(FORCE_SPREAD_MAX, "m/s2")?.to_array();
    // Specific force points up.
    let (positive, negative, force) = if x.abs() > y.abs() && x.abs() > z.abs() {
        (Direction::Back, Direction::Forward, x)
    } else if y.abs() > z.abs() {
        (Direction::Left, Direction::Right, y)
    } else {
        (Direction::Up, Direction::Down, z)
    };
    let allowed = SIDE_SHARE.map(|share| share * GRAVITY);
    within("gravity along one axis", force.abs(), allowed, "m/s2")?;
    Ok(if force > 0.0 { positive } else { negative })
}

/// Divider that makes the battery's reading equal to a meter's, `meter` V; with `divider` the battery reads the mean of
/// `samples` (V, along x).
///
/// # Errors
/// Samples are too few or too noisy, the meter's reading is implausible, or the divider is out of its range.
pub fn divider(samples: &Samples, divider: f32, meter: f32) -> Result<f32, Unfit> {
    within("the meter's reading", meter, METER, "V")?;
    let most = VOLTAGE_SPREAD_MAX * clamp(samples.mean().x.abs(), 1.0, 100.0);
    let volts = samples.quiet_mean(most, "V")?.x;
    within("the board's reading", volts, [0.5, 100.0], "V")?;
    let new = divider * meter / volts;
    within("the divider", new, DIVIDER, "")?;
    Ok(new)
}

/// Tilt of an arm that is held still, rad.
///
/// # Errors
/// Samples are too few or too noisy.
pub fn quiet_tilt(samples: &Samples) -> Result<f32, Unfit> {
    Ok(samples.quiet_mean(TILT_SPREAD_MAX, "rad")?.x)
}

/// Correction of an arm's tilt sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmFit {
    /// 1, or -1 for a sensor that is mounted in reverse.
    pub sign: f32,
    /// Reading of a straight arm after the sign, rad.
    pub zero: f32,
}

impl ArmFit {
    /// The correction of arm `arm`, 0 to 3, by the parameters.
    pub fn of(p: &Params, arm: usize) -> Self {
        let (sign, zero) = match arm {
            0 => (p.arm_sign_1, p.arm_zero_1),
            1 => (p.arm_sign_2, p.arm_zero_2),
            2 => (p.arm_sign_3, p.arm_zero_3),
            _ => (p.arm_sign_4, p.arm_zero_4),
        };
        Self {
            sign: sign.number(),
            zero,
        }
    }

    /// Tilt of an arm whose sensor reads `shown`, rad.
    pub fn tilt(&self, shown: f32) -> f32 {
        self.sign * shown - self.zero
    }
}

/// Correction of the sensor of an arm that was held straight and then bent up; the tilts (rad, along x) were read with
/// the correction `now`.
///
/// # Errors
/// Samples are too few or too noisy, the arm was hardly bent, or the zero is out of its range.
pub fn arm_sensor(straight: &Samples, up: &Samples, now: ArmFit) -> Result<ArmFit, Unfit> {
    let [straight, up] = [quiet_tilt(straight)?, quiet_tilt(up)?];
    within("turn of the arm", (up - straight).abs(), TURN, "rad")?;
    let shown = (straight + now.zero) * now.sign;
    let sign = if up > straight { now.sign } else { -now.sign };
    let zero = shown * sign;
    within(
        "tilt of the straight arm",
        zero,
        [-ARM_ZERO_MAX, ARM_ZERO_MAX],
        "rad",
    )?;
    Ok(ArmFit { sign, zero })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;

    /// Noise of up to `size` about zero, by a fixed generator: its mean over 200 samples is below a tenth of it.
    fn noise(size: f32) -> impl FnMut() -> Vec3 {
        let mut state = 1u32;
        move || {
            let mut next = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                ((state >> 8) as f32 / 16_777_216.0 - 0.5) * 2.0 * size
            };
            Vec3::new(next(), next(), next())
        }
    }

    fn samples(mean: Vec3, size: f32) -> Samples {
        let (mut samples, mut noise) = (Samples::default(), noise(size));
        for _ in 0..200 {
            samples.add(mean + noise());
        }
        samples
    }

    /// A fit that takes off `bias`, on a board that sits as its file has it.
    fn taking(bias: Vec3) -> AccelFit {
        AccelFit {
            bias,
            ..AccelFit::of(&Params::DEFAULT)
        }
    }

    fn vector(size: f32) -> impl Strategy<Value = Vec3> {
        (-size..size, -size..size, -size..size).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn a_level_rest_gives_the_bias(bias in vector(0.5), taken in vector(0.3)) {
            let reads = Face::Belly.force() + bias - taken;
            let found = level(&samples(reads, 0.2), &taking(taken)).unwrap();
            prop_assert!((found - bias).norm() < 0.04, "{found:?}");
        }

        /// On a table that leans by up to 5°, with an error of the scale: within 0.05 m/s² and 0.5 %.
        #[test]
        fn six_faces_give_bias_and_scale_on_a_table_that_leans(
            bias in vector(0.5), taken in vector(0.3), error in vector(0.02), lean in vector(0.08),
        ) {
            let scale = Vec3::new(1.0, 1.0, 1.0) + error;
            let mut means = Vec::new();
            for (i, side) in Face::ALL.into_iter().enumerate() {
                let lean = crate::maths::vector::Quat::from_euler(lean.x, lean.y * f32::from(i as u8 % 2), 0.0);
                let turned = lean.rotate(side.force());
                let reads = turned.scale_by(scale) + bias - taken;
                means.push(face(&samples(reads, 0.2), side).unwrap());
            }
            let found = six_faces(means.as_slice().try_into().unwrap(), &taking(taken)).unwrap();
            prop_assert!((found.bias - bias).norm() < 0.07, "{:?}", found.bias);
            prop_assert!((found.scale - scale).norm() < 0.012, "{:?}", found.scale);
        }

        #[test]
        fn the_divider_is_found(volts in 6.0f32..50.0, wrong in 0.6f32..1.6) {
            // The board reads `wrong` times what there is.
            let read = samples(Vec3::new(volts * wrong, 0.0, 0.0), 0.02);
            let found = divider(&read, 11.0, volts).unwrap();
            prop_assert!((found - 11.0 / wrong).abs() < 0.01 * found);
        }

        /// Within 0.01 rad, under noise of 0.03 rad.
        #[test]
        fn an_arms_zero_and_sign_are_found(
            reversed in any::<bool>(), was_reversed in any::<bool>(),
            zero in -0.5f32..0.5, old_zero in -0.3f32..0.3, up in 0.15f32..0.8,
        ) {
            let sign = |reversed| if reversed { -1.0 } else { 1.0 };
            let truth = ArmFit { sign: sign(reversed), zero };
            let now = ArmFit { sign: sign(was_reversed), zero: old_zero };
            // What the sensor shows of a tilt, and what is made of it with the old fit.
            let read = |tilt: f32| Vec3::new(now.tilt((tilt + truth.zero) * truth.sign), 0.0, 0.0);
            let found = arm_sensor(&samples(read(0.0), 0.03), &samples(read(up), 0.03), now).unwrap();
            prop_assert!(found.sign == truth.sign && (found.zero - truth.zero).abs() < 0.01, "{found:?}");
        }

        #[test]
        fn no_samples_make_a_result_that_is_no_number(values in prop::collection::vec(
            (prop::num::f32::ANY, prop::num::f32::ANY, prop::num::f32::ANY), 0..130))
        {
            let mut samples = Samples::default();
            for (x, y, z) in values {
                samples.add(Vec3::new(x, y, z));
            }
            let found = level(&samples, &taking(Vec3::ZERO));
            prop_assert!(found.is_ok_and(Vec3::is_finite) || found.is_err());
            prop_assert!(divider(&samples, 11.0, 15.0).is_ok_and(f32::is_finite) || divider(&samples, 11.0, 15.0).is_err());
        }
    }

    #[test]
    fn mean_and_spread_by_hand() {
        let mut samples = Samples::default();
        for x in [1.0, 3.0, 1.0, 3.0] {
            samples.add(Vec3::new(x, 5.0, 0.0));
        }
        assert_eq!(samples.mean(), Vec3::new(2.0, 5.0, 0.0));
        assert!((samples.spread() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_number() {
        let rest = Face::Belly.force();
        let what = |result: Result<Vec3, Unfit>| result.unwrap_err().what;
        assert_eq!(what(level(&Samples::default(), &taking(Vec3::ZERO))), "samples");
        assert_eq!(what(level(&samples(rest, 0.5), &taking(Vec3::ZERO))), "noise");
        let leans = rest + Vec3::new(0.0, 0.7, 0.0);
        let unfit = level(&samples(leans, 0.01), &taking(Vec3::ZERO)).unwrap_err();
        assert_eq!((unfit.what, unfit.allowed), ("bias along y", [-0.6, 0.6]));
        assert!((unfit.value - 0.7).abs() < 0.01);
        assert_eq!(
            what(level(
                &samples(Vec3::new(f32::NAN, 0.0, 0.0), 0.1),
                &taking(Vec3::ZERO)
            )),
            "mean"
        );
        // Another side below, and one that leans by 20°.
        assert_eq!(
            what(face(&samples(rest, 0.01), Face::Nose)),
            "gravity on this side"
        );
        let leaning = Vec3::new(0.0, -3.35, -9.22);
        assert_eq!(
            what(face(&samples(leaning, 0.01), Face::Belly)),
            "lean of this side"
        );
        assert_eq!(what(rest_rate(&samples(Vec3::ZERO, 0.1))), "noise");
        let volts = samples(Vec3::new(15.0, 0.0, 0.0), 0.01);
        for (read, meter, name) in [
            (&volts, 2.0, "the meter's reading"),
            (&volts, f32::NAN, "the meter's reading"),
            (&samples(Vec3::ZERO, 0.01), 15.0, "the board's reading"),
            (&samples(Vec3::new(15.0, 0.0, 0.0), 0.6), 15.0, "noise"),
            (&samples(Vec3::new(1.0, 0.0, 0.0), 0.01), 15.0, "the divider"),
        ] {
            assert_eq!(divider(read, 11.0, meter).unwrap_err().what, name);
        }
        let mut means = Face::ALL.map(Face::force);
        means[5] = means[5] * 1.25;
        assert_eq!(
            six_faces(&means, &taking(Vec3::ZERO)).unwrap_err().what,
            "scale of y"
        );
    }

    #[test]
    fn an_arm_that_is_not_bent_is_refused() {
        let at = |value| samples(Vec3::new(value, 0.0, 0.0), 0.001);
        let now = ArmFit { sign: 1.0, zero: 0.0 };
        for (straight, up, what) in [
            (0.0, 0.05, "turn of the arm"),
            (0.7, 1.0, "tilt of the straight arm"),
        ] {
            assert_eq!(arm_sensor(&at(straight), &at(up), now).unwrap_err().what, what);
        }
    }

    #[test]
    fn a_turned_sensor_shows_which_way_it_is_turned() {
        for down in Direction::ALL {
            // 10° beside it, with a bias.
            let leans = (down.unit() + Vec3::new(0.1, -0.1, 0.1)) * -GRAVITY;
            assert_eq!(below(&samples(leans, 0.1)), Ok(down));
        }
        let askew = Vec3::new(0.0, -7.0, -7.0);
        assert_eq!(
            below(&samples(askew, 0.1)).unwrap_err().what,
            "gravity along one axis"
        );
        assert!(below(&samples(Vec3::ZERO, 0.1)).is_err());
        let mut ways = 0;
        for nose in Direction::ALL {
            for right in Direction::ALL {
                for belly in Direction::ALL {
                    ways += i32::from(Mounting { nose, right, belly }.fits());
                }
            }
        }
        assert_eq!(ways, 24);
    }

    /// However the sensor sits and whatever is in force: level and six faces find the part's own bias and scale.
    #[test]
    fn bias_and_scale_are_those_of_the_boards_axes() {
        let (bias, scale) = (Vec3::new(0.2, -0.3, 0.4), Vec3::new(1.03, 0.95, 0.98));
        let in_force = [
            (Vec3::ZERO, Vec3::new(1.0, 1.0, 1.0)),
            (Vec3::new(-0.1, 0.2, 0.3), Vec3::new(0.98, 1.02, 1.05)),
        ];
        for mounting in crate::params::ImuMounting::ALL.iter().map(|m| Mounting::from(*m)) {
            for (taken, gain) in in_force {
                let now = AccelFit {
                    bias: taken,
                    scale: gain,
                    mounting,
                };
                let reads = |side: Face| {
                    let part = mounting.to_board(side.force()).scale_by(scale) + bias;
                    let over = gain.map(|gain| 1.0 / gain);
                    mounting.to_vehicle((part - taken).scale_by(over))
                };
                let found = six_faces(&Face::ALL.map(reads), &now).unwrap();
                assert!((found.bias - bias).norm() < 1e-4, "{mounting:?} {found:?}");
                assert!((found.scale - scale).norm() < 1e-5, "{mounting:?} {found:?}");
                let exact = AccelFit { scale, ..now };
                let rest = mounting.to_vehicle(
                    (mounting.to_board(Face::Belly.force()).scale_by(scale) + bias - taken)
                        .scale_by(scale.map(|scale| 1.0 / scale)),
                );
                let found = level(&samples(rest, 0.0), &exact).unwrap();
                assert!((found - bias).norm() < 1e-3, "{mounting:?} {found:?}");
            }
        }
    }

    #[test]
    fn each_side_is_the_opposite_of_the_next() {
        for pair in Face::ALL.chunks(2) {
            assert_eq!(pair[0].force() + pair[1].force(), Vec3::ZERO);
        }
    }
}
