//! Verdict on the self-test of an InvenSense part, whose sensors are actuated electrically.
//!
//! Procedure and limits of TDK's ICM-426xx driver and of application note AN-000029 (older register map): 200 samples
//! averaged at rest and actuated, at 250 °/s and 2 g.

use crate::fault::{Fault, Sensor};

/// Samples averaged per stage.
pub const SAMPLES: u16 = 200;
/// Counts per °/s at 250 °/s.
pub const COUNTS_PER_DPS: f32 = 32768.0 / 250.0;
/// Counts per g at 2 g.
pub const COUNTS_PER_G: f32 = 32768.0 / 2.0;
/// Response of factory code 1, counts; each further code adds 1 %.
const CODE_BASE: f32 = 2620.0;
/// Least ratio of response to factory response.
const RATIO_MIN: f32 = 0.5;

/// Actuated sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// None: the offsets.
    Rest,
    /// Gyroscope.
    Gyro,
    /// Accelerometer.
    Accel,
}

/// Limits for a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Greatest gyroscope response over the factory's.
    pub gyro_ratio_max: f32,
    /// Greatest accelerometer response over the factory's.
    pub accel_ratio_max: f32,
    /// Least gyroscope response without a factory code, °/s.
    pub gyro_min_dps: f32,
    /// Least and greatest accelerometer response without a factory code, g.
    pub accel_g: [f32; 2],
    /// Greatest gyroscope output at rest, °/s.
    pub gyro_offset_dps: f32,
}

/// Mean outputs and factory codes of a sensor's axes, counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// Mean output at rest.
    pub rest: [f32; 3],
    /// Mean output while actuated.
    pub actuated: [f32; 3],
    /// Factory codes; 0: none.
    pub codes: [u8; 3],
}

/// Measurements of one part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// Gyroscope.
    pub gyro: Response,
    /// Accelerometer.
    pub accel: Response,
}

/// Responses of a passed part, % of the factory's, or of the least allowed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SelfTest {
    /// Gyroscope x, y, z, %.
    pub gyro: [u16; 3],
    /// Accelerometer x, y, z, %.
    pub accel: [u16; 3],
}

/// Judges a part.
///
/// # Errors
/// The first axis with a wrong response, or whose gyroscope is too far from zero at rest.
pub fn judge(m: &Measured, limits: &Limits) -> Result<SelfTest, Fault> {
    for (axis, rest) in (0u8..).zip(m.gyro.rest) {
        let limit = limits.gyro_offset_dps * COUNTS_PER_DPS;
        if !(-limit..=limit).contains(&rest) {
            return Err(Fault::Offset { axis });
        }
    }
    let gyro_absolute = [limits.gyro_min_dps * COUNTS_PER_DPS, f32::INFINITY];
    let accel_absolute = limits.accel_g.map(|g| g * COUNTS_PER_G);
    Ok(SelfTest {
        gyro: sensor(Sensor::Gyro, &m.gyro, limits.gyro_ratio_max, gyro_absolute)?,
        accel: sensor(Sensor::Accel, &m.accel, limits.accel_ratio_max, accel_absolute)?,
    })
}

/// Judges one sensor; `absolute`: limits without factory codes, counts.
fn sensor(
    sensor: Sensor,
    measured: &Response,
    ratio_max: f32,
    absolute: [f32; 2],
) -> Result<[u16; 3], Fault> {
    let &Response {
        rest,
        actuated,
        codes,
    } = measured;
    // By the maker, one missing code means none.
    let coded = codes.iter().all(|&c| c != 0);
    let [least, greatest] = absolute;
    let mut percents = [0; 3];
    let axes = rest.into_iter().zip(actuated).zip(codes);
    for ((axis, ((rest, actuated), code)), out) in (0u8..).zip(axes).zip(percents.iter_mut()) {
        let response = (actuated - rest).abs();
        let ratio = response / if coded { factory_response(code) } else { least };
        let percent = (ratio * 100.0) as u16;
        let passed = if coded {
            ratio > RATIO_MIN && ratio < ratio_max
        } else {
            ratio >= 1.0 && response <= greatest
        };
        if !passed {
            return Err(Fault::SelfTest {
                sensor,
                axis,
                percent,
            });
        }
        *out = percent;
    }
    Ok(percents)
}

/// Counts at the test's range.
fn factory_response(code: u8) -> f32 {
    (1..code).fold(CODE_BASE, |counts, _| counts * 1.01)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        gyro_ratio_max: 1.5,
        accel_ratio_max: 1.5,
        gyro_min_dps: 60.0,
        accel_g: [0.05, 1.2],
        gyro_offset_dps: 20.0,
    };

    fn good() -> Measured {
        let gyro = factory_response(100);
        let accel = factory_response(120);
        Measured {
            gyro: Response {
                rest: [50.0, -30.0, 10.0],
                actuated: [50.0 + gyro, -30.0 - gyro, 10.0 + 0.9 * gyro],
                codes: [100; 3],
            },
            accel: Response {
                rest: [0.0, 100.0, 16384.0],
                actuated: [accel, 100.0 + accel, 16384.0 + accel],
                codes: [120; 3],
            },
        }
    }

    #[test]
    fn the_factory_response_grows_by_one_percent_a_code() {
        assert!((factory_response(1) - 2620.0).abs() < 1e-3);
        assert!((factory_response(2) - 2646.2).abs() < 1e-3);
        // 1.01^254 is 12.5.
        assert!((factory_response(255) / 2620.0 - 12.52).abs() < 0.02);
    }

    #[test]
    fn a_good_part_passes() {
        let report = judge(&good(), &LIMITS).unwrap();
        assert!(
            report
                .gyro
                .into_iter()
                .zip([100, 100, 90])
                .all(|(a, b): (u16, u16)| a.abs_diff(b) <= 1),
            "{report:?}"
        );
    }

    #[test]
    fn a_dead_axis_is_named() {
        let mut m = good();
        m.accel.actuated[1] = m.accel.rest[1] + 5.0;
        let fault = judge(&m, &LIMITS).unwrap_err();
        assert_eq!(
            fault,
            Fault::SelfTest {
                sensor: Sensor::Accel,
                axis: 1,
                percent: 0
            }
        );
        let mut m = good();
        m.gyro.actuated[0] = f32::NAN;
        assert!(judge(&m, &LIMITS).is_err());
        let mut m = good();
        m.gyro.rest[2] = 21.0 * COUNTS_PER_DPS;
        assert_eq!(judge(&m, &LIMITS).unwrap_err(), Fault::Offset { axis: 2 });
    }

    #[test]
    fn without_codes_absolute_limits_hold() {
        let mut m = good();
        m.gyro.codes[1] = 0;
        m.accel.codes = [0; 3];
        for axis in 0..3 {
            m.gyro.actuated[axis] = m.gyro.rest[axis] + 61.0 * COUNTS_PER_DPS;
            m.accel.actuated[axis] = m.accel.rest[axis] + 0.3 * COUNTS_PER_G;
        }
        assert!(judge(&m, &LIMITS).is_ok());
        m.gyro.actuated[0] = m.gyro.rest[0] + 59.0 * COUNTS_PER_DPS;
        assert!(judge(&m, &LIMITS).is_err());
    }
}
