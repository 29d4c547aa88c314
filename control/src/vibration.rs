//! Vibration at the inertial sensor: RMS of the high-passed specific force, and readings at full scale.
//!
//! The flight level keeps one raw reading a step, 1 kHz; the commander sums them up. The measure is ArduPilot's (high pass
//! at 5 Hz, square, mean, root), over each second instead of through a low pass. Rotors turn at 50 to 120 Hz, their blades
//! pass at twice that; parts above 500 Hz are folded down and count in full.

use crate::attitude::mounting::Mounting;
use crate::maths::scalar::{self, GRAVITY};
use crate::maths::vector::Vec3;
use crate::params::Params;

/// Share of the way that the mean moves with each reading: 5 Hz at 1 kHz, 1 - exp(-2π·5/1000).
const FLOOR_GAIN: f32 = 0.030_93;
/// Readings of a second.
const WINDOW: u32 = 1000;
/// Share of full scale at which an axis clips, as in [`crate::chain::Sensing`].
const CLIPS: f32 = 0.999;
/// Seconds of flight over which the warning averages the squares: four rotors beat against each other.
const AVERAGED: f32 = 6.0;
/// A warning ends below this share of [`MARK`].
const ENDS: f32 = 0.8;

/// Largest sound RMS of an axis in flight, m/s²: at 8 one vehicle in ten no longer holds its place by flow in gusts, at 14
/// four; the attitude bears 14 (docs/design/inertial-sensor.md). ArduPilot calls up to 15 normal.
pub const MARK: f32 = 7.0;

/// A second's vibration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vibration {
    /// RMS of the specific force above 5 Hz, m/s², body axes.
    pub rms: Vec3,
    /// Readings at full scale since the start, of one looked at each millisecond.
    pub clipped: u32,
}

impl Vibration {
    /// RMS of the worst axis, m/s².
    pub fn worst(&self) -> f32 {
        let Vec3 { x, y, z } = self.rms;
        x.max(y).max(z)
    }
}

/// Sums up raw readings.
#[derive(Clone, Copy, Debug)]
pub struct VibrationMeter {
    mounting: Mounting,
    /// Specific force that clips, m/s².
    clips_at: f32,
    /// Low-passed force at 5 Hz, m/s²; `None` before the first reading.
    floor: Option<Vec3>,
    /// Sum of squares, (m/s²)².
    squares: Vec3,
    readings: u32,
    clipped: u32,
}

impl VibrationMeter {
    /// Before the first reading.
    pub fn new(p: &Params) -> Self {
        Self {
            mounting: Mounting::from(p.imu_mounting),
            clips_at: CLIPS * GRAVITY * p.imu_accel_range.number(),
            floor: None,
            squares: Vec3::ZERO,
            readings: 0,
            clipped: 0,
        }
    }

    /// Takes the next millisecond's reading, m/s², board axes; a second's vibration with the last of it. A reading that is
    /// not finite does not count.
    pub fn take(&mut self, force: Vec3) -> Option<Vibration> {
        if !force.is_finite() {
            return None;
        }
        let floor = self.floor.unwrap_or(force);
        let shake = force - floor;
        self.floor = Some(floor + shake * FLOOR_GAIN);
        self.squares += shake.scale_by(shake);
        if force.to_array().iter().any(|axis| axis.abs() >= self.clips_at) {
            self.clipped = self.clipped.saturating_add(1);
        }
        self.readings += 1;
        if self.readings < WINDOW {
            return None;
        }
        let mean = self.squares * (1.0 / WINDOW as f32);
        (self.squares, self.readings) = (Vec3::ZERO, 0);
        Some(Vibration {
            // Mountings are turns by right angles: they exchange axes.
            rms: self.mounting.to_vehicle(mean.map(scalar::sqrt)).map(f32::abs),
            clipped: self.clipped,
        })
    }
}

/// Whether the vehicle vibrates more than [`MARK`]: by the seconds of flight alone, so that it still shows after landing,
/// before the next arming.
#[derive(Clone, Copy, Debug, Default)]
pub struct VibrationWatch {
    /// Some of the present second is not flown.
    stood: bool,
    /// Mean square of the worst axis, (m/s²)².
    square: f32,
    strong: bool,
}

impl VibrationWatch {
    /// Notes with each step of its owner whether the vehicle flies; `second` at its end.
    pub fn step(&mut self, flies: bool, second: Option<&Vibration>) {
        self.stood |= !flies;
        let Some(second) = second else {
            return;
        };
        if !core::mem::take(&mut self.stood) {
            let worst = second.worst();
            self.square += (worst * worst - self.square) / AVERAGED;
            let most = if self.strong { ENDS * MARK } else { MARK };
            self.strong = self.square > most * most;
        }
    }

    /// It did, when last it flew.
    pub const fn strong(&self) -> bool {
        self.strong
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::params::{ImuAccelRange, ImuMounting};

    /// Vibration of the second second of `force`, m/s², a function of the time, s.
    fn measure(p: &Params, force: impl Fn(f64) -> Vec3) -> Vibration {
        let mut meter = VibrationMeter::new(p);
        let mut seconds = (0..2000).filter_map(|i| meter.take(force(1e-3 * f64::from(i))));
        let _settling = seconds.next();
        seconds.next().unwrap()
    }

    fn sine(t: f64, hz: f64, size: f64) -> f32 {
        (size * f64::sin(core::f64::consts::TAU * hz * t)) as f32
    }

    #[test]
    fn a_rotors_sine_counts_by_its_rms_and_gravity_does_not() {
        let found = measure(&Params::DEFAULT, |t| {
            Vec3::new(
                sine(t, 86.0, 10.0),
                sine(t, 172.0, 4.0),
                sine(t, 900.0, 2.0) - GRAVITY,
            )
        });
        let Vec3 { x, y, z } = found.rms;
        // A first difference over a leak adds half its gain, 1.6 %, at most.
        for (axis, size) in [(x, 10.0), (y, 4.0), (z, 2.0)] {
            let rms = size / 2f32.sqrt();
            assert!((axis / rms - 1.0).abs() < 0.02, "{found:?}");
        }
        assert_eq!((found.clipped, found.worst()), (0, x));
        // At rest nothing is left, of a lean to both sides within 3 s hardly anything.
        let rest = measure(&Params::DEFAULT, |_| Vec3::new(1.0, 2.0, -GRAVITY));
        assert_eq!(rest.worst(), 0.0);
        let leans = measure(&Params::DEFAULT, |t| Vec3::new(sine(t, 0.3, 3.0), 0.0, -GRAVITY));
        assert!(leans.worst() < 0.2, "{leans:?}");
        // -3 dB at 5 Hz.
        let edge = measure(&Params::DEFAULT, |t| Vec3::new(sine(t, 5.0, 2.0), 0.0, 0.0));
        assert!((edge.worst() - 1.0).abs() < 0.03, "{edge:?}");
    }

    #[test]
    fn full_scale_is_counted_on_any_axis_and_each_axis_has_its_vehicles_name() {
        let p = Params {
            imu_accel_range: ImuAccelRange::G2,
            imu_mounting: ImuMounting::ALL[1],
            ..Params::DEFAULT
        };
        let mounting = Mounting::from(p.imu_mounting);
        assert_ne!(mounting, Mounting::AS_BUILT);
        let found = measure(&p, |t| {
            let body = Vec3::new(sine(t, 86.0, 9.0), sine(t, 90.0, 6.0), sine(t, 94.0, 3.0));
            mounting.to_board(body)
        });
        let rms = found.rms;
        assert!(
            rms.x > 6.0 && (3.0..5.0).contains(&rms.y) && rms.z < 3.0,
            "{found:?}"
        );
        assert_eq!(found.clipped, 0);
        // A quarter of each sine's readings beyond 1 of √2.
        let clips = measure(&p, |t| {
            Vec3::new(
                0.0,
                0.0,
                -sine(t, 77.0, 2.0 * 1.414 * 9.806_65).clamp(-19.6, 19.6),
            )
        });
        assert!((900..1100).contains(&clips.clipped), "{clips:?}");
    }

    #[test]
    fn what_is_not_finite_does_not_count() {
        let mut meter = VibrationMeter::new(&Params::DEFAULT);
        let mut found = None;
        for i in 0..2000 {
            let x = if i % 2 == 0 { f32::NAN } else { 1.0 };
            found = found.or(meter.take(Vec3::new(x, 0.0, 0.0)));
        }
        assert_eq!(found, Some(Vibration::default()));
    }

    #[test]
    fn the_warning_takes_seconds_of_flight_and_outlives_the_landing() {
        let second = |size| Vibration {
            rms: Vec3::new(0.0, size, 0.0),
            clipped: 0,
        };
        let mut watch = VibrationWatch::default();
        let mut pass = |flies, size, count| {
            for _ in 0..count {
                watch.step(flies, None);
                watch.step(flies, Some(&second(size)));
            }
            watch.strong()
        };
        assert!(!pass(false, 5.0 * MARK, 5), "carried about");
        assert!(!pass(true, 0.95 * MARK, 60));
        assert!(!pass(true, 1.1 * MARK, 1));
        assert!(pass(true, 1.5 * MARK, 3));
        assert!(pass(false, 0.0, 60), "landed");
        assert!(pass(true, 0.9 * MARK, 60), "near the mark it stays");
        assert!(!pass(true, 0.3 * MARK, 6), "balanced");
        // A second that is not all flown does not count.
        for _ in 0..20 {
            watch.step(false, None);
            watch.step(true, Some(&second(2.0 * MARK)));
        }
        assert!(!watch.strong());
    }
}
