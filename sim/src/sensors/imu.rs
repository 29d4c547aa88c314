//! The inertial sensor, after the ICM-42688-P's datasheet.

use std::f64::consts::TAU;

use glam::DVec3;
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;
use sophie_control::attitude::mounting::Mounting;
use sophie_control::chain::ImuReading;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::Params;

use super::soft_mount::SoftMount;
use crate::normal::StandardNormal;
use crate::streams::Streams;

/// Default sample rate, samples/s.
const RATE_HZ: f64 = 4000.0;
/// Gyro noise, rad/s at 4 kHz: 2.8 mdps/√Hz over 2 kHz (datasheet).
const GYRO_NOISE: f64 = 2.8e-3 * (std::f64::consts::PI / 180.0) * 44.7;
/// Accel noise, m/s² at 4 kHz: 70 µg/√Hz over 2 kHz (datasheet).
const ACCEL_NOISE: f64 = 70e-6 * 9.806_65 * 44.7;
/// Largest gyro bias, rad/s: ±0.5 dps (datasheet).
const GYRO_BIAS: f64 = 0.5 * (std::f64::consts::PI / 180.0);
/// Largest accel bias, m/s²: ±20 mg (datasheet).
const ACCEL_BIAS: f64 = 0.020 * 9.806_65;
/// Largest bench error, m/s²: a bench level to 0.25° (assumed).
const BENCH_ERROR: f64 = 0.04;
/// Vibration of the rate over that of the acceleration, rad·s/m (assumed).
const RATE_SHARE: f64 = 0.04;

/// Vibration at the sensor, as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VibrationSpec {
    /// Amplitude by each rotor's imbalance at 600 rad/s, m/s²; with the square of the speed.
    pub once: f64,
    /// Amplitude at twice the rotor's frequency, by its two blades, over that at once.
    pub twice: f64,
    /// Mode of the platform between the arms and the sensor, Hz; `None`: rigid.
    pub platform: Option<f64>,
    /// Its damping ratio.
    pub damping: f64,
}

impl Default for VibrationSpec {
    fn default() -> Self {
        Self {
            // Assumed; soft arms isolate. 3DR's Iris has up to 15 m/s², "normal" (ArduPilot, measuring vibration).
            once: 0.25,
            twice: 0.0,
            platform: None,
            damping: 0.1,
        }
    }
}

/// Error of the mounting or scale of a part against its board's file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Mounting of the part.
    pub mounting: Mounting,
    /// Scale of its accelerometer along the board's axes; nominal 1.
    pub scale: Vec3,
}

impl Misfit {
    /// Reading of the part for the `reading` of one without error.
    #[must_use]
    pub fn reads(&self, reading: ImuReading) -> ImuReading {
        ImuReading {
            gyro: self.mounting.to_board(reading.gyro),
            accel: self.mounting.to_board(reading.accel).scale_by(self.scale),
        }
    }
}

/// The sensor with its errors.
#[derive(Clone, Debug)]
pub struct Imu {
    rate: f64,
    /// Noise relative to 4 kHz: it grows with the band, half the rate.
    noise: f64,
    /// Resolution of gyro, rad/s, and accelerometer, m/s².
    lsb: (f64, f64),
    gyro_bias: DVec3,
    accel_bias: DVec3,
    /// `None`: no misfit.
    pub misfit: Option<Misfit>,
    bench_error: DVec3,
    rng: Pcg64Mcg,
    pipeline: ImuReading,
    phase: [f64; 4],
    vibration: VibrationSpec,
    /// Of rate and specific force.
    mounts: Option<[SoftMount; 2]>,
}

impl Imu {
    /// A part with the biases of `streams`, configured by `params`.
    #[must_use]
    pub fn new(params: &Params, streams: Streams) -> Self {
        let rate = f64::from(params.imu_rate.number());
        let (dps, g) = (
            f64::from(params.imu_gyro_range.number()),
            f64::from(params.imu_accel_range.number()),
        );
        let within = |what: &str, limit: f64| {
            let axis = |axis: &str| streams.within(&format!("imu.{what}.{axis}"), -limit, limit);
            DVec3::from_array(["x", "y", "z"].map(axis))
        };
        Self {
            rate,
            noise: (rate / RATE_HZ).sqrt(),
            lsb: (
                dps * (std::f64::consts::PI / 180.0) / 32768.0,
                g * 9.806_65 / 32768.0,
            ),
            gyro_bias: within("gyro", GYRO_BIAS),
            accel_bias: within("accel", ACCEL_BIAS),
            misfit: None,
            bench_error: within("bench", BENCH_ERROR),
            rng: streams.of("imu"),
            pipeline: ImuReading::default(),
            phase: [0.0; 4],
            vibration: VibrationSpec::default(),
            mounts: None,
        }
    }

    /// Puts the part into a vehicle of `vibration`.
    pub fn mount(&mut self, vibration: VibrationSpec) {
        self.vibration = vibration;
        let mount = |frequency| [SoftMount::new(frequency, vibration.damping); 2];
        self.mounts = vibration.platform.map(mount);
    }

    /// Accelerometer bias as measured on a level bench, with its error, m/s².
    #[must_use]
    pub fn bench_bias(&self) -> DVec3 {
        self.accel_bias + self.bench_error
    }

    /// Body rate (rad/s) and specific force (m/s²) with rotors at `rotors` rad/s, a sample late as from the part's
    /// filter.
    pub fn sample(&mut self, rate: DVec3, specific_force: DVec3, rotors: &[f64; 4]) -> ImuReading {
        let (mut shake_gyro, mut shake_accel) = (DVec3::ZERO, DVec3::ZERO);
        for (i, (phase, speed)) in self.phase.iter_mut().zip(rotors).enumerate() {
            *phase += speed / self.rate;
            if *phase > TAU {
                *phase -= TAU;
            }
            let share = speed * speed / (600.0 * 600.0);
            let mut size = share * libm::sin(*phase + i as f64);
            if self.vibration.twice > 0.0 {
                size += self.vibration.twice * share * libm::cos(2.0 * *phase);
            }
            let once = self.vibration.once;
            shake_gyro += DVec3::new(size, -size, 0.3 * size) * (RATE_SHARE * once);
            shake_accel += DVec3::new(size, 0.7 * size, size) * once;
        }
        let dt = 1.0 / self.rate;
        let (rate, specific_force) = match &mut self.mounts {
            None => (
                rate + self.gyro_bias + shake_gyro,
                specific_force + self.accel_bias + shake_accel,
            ),
            Some([turning, moving]) => (
                turning.step(dt, rate + shake_gyro) + self.gyro_bias,
                moving.step(dt, specific_force + shake_accel) + self.accel_bias,
            ),
        };
        let (gyro_lsb, accel_lsb) = self.lsb;
        let gyro = self.measure(rate, GYRO_NOISE * self.noise, gyro_lsb);
        let accel = self.measure(specific_force, ACCEL_NOISE * self.noise, accel_lsb);
        let reading = ImuReading { gyro, accel };
        let read = self.misfit.map_or(reading, |misfit| misfit.reads(reading));
        std::mem::replace(&mut self.pipeline, read)
    }

    /// Adds `noise` RMS, rounds to `lsb`, saturates at full scale.
    fn measure(&mut self, truth: DVec3, noise: f64, lsb: f64) -> Vec3 {
        let mut axis = |x: f64| {
            let n: f64 = StandardNormal.sample(&mut self.rng);
            // A cast is faster than `round`, a library call on the baseline processor.
            let counts = (x + n * noise) * (1.0 / lsb);
            let counts = (counts + 0.5f64.copysign(counts)) as i32;
            (f64::from(counts.clamp(-32768, 32767)) * lsb) as f32
        };
        Vec3::new(axis(truth.x), axis(truth.y), axis(truth.z))
    }
}

#[cfg(test)]
mod tests {
    use sophie_control::params::{ImuAccelRange, ImuGyroRange, ImuRate};

    use super::*;

    #[test]
    fn noise_and_bias_are_those_of_the_datasheet() {
        let mut imu = Imu::new(&Params::default(), Streams::new(3));
        let n = 40_000;
        let (mut sum, mut square) = (0.0, 0.0);
        for _ in 0..n {
            let x = f64::from(imu.sample(DVec3::ZERO, DVec3::ZERO, &[0.0; 4]).gyro.x);
            sum += x;
            square += x * x;
        }
        let mean = sum / f64::from(n);
        let sd = (square / f64::from(n) - mean * mean).sqrt();
        assert!(mean.abs() <= GYRO_BIAS && (sd / GYRO_NOISE - 1.0).abs() < 0.05);
    }

    #[test]
    fn noise_and_full_scale_follow_the_parameters() {
        let spread = |rate| {
            let params = Params {
                imu_rate: rate,
                ..Params::default()
            };
            let mut imu = Imu::new(&params, Streams::new(3));
            let x: Vec<f64> = (0..20_000)
                .map(|_| f64::from(imu.sample(DVec3::ZERO, DVec3::ZERO, &[0.0; 4]).gyro.x))
                .collect();
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            (x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / x.len() as f64).sqrt()
        };
        // Twice the band gives √2 of the noise.
        let (slow, fast) = (spread(ImuRate::Hz1000), spread(ImuRate::Hz8000));
        assert!((fast / slow / 8f64.sqrt() - 1.0).abs() < 0.1, "{slow} {fast}");

        let params = Params {
            imu_gyro_range: ImuGyroRange::Dps250,
            imu_accel_range: ImuAccelRange::G2,
            ..Params::default()
        };
        let mut imu = Imu::new(&params, Streams::new(3));
        imu.sample(DVec3::splat(100.0), DVec3::splat(-500.0), &[0.0; 4]);
        let r = imu.sample(DVec3::ZERO, DVec3::ZERO, &[0.0; 4]);
        assert!((r.gyro.x - 4.363).abs() < 0.001 && (r.accel.y + 19.613).abs() < 0.01);
    }

    /// 4 m/s² at twice 100 Hz, of a rotor at 600 rad/s, through a platform at 40 Hz: 5.1 at its mode, a sixth at 200 Hz.
    #[test]
    fn a_soft_platform_keeps_fast_vibration_from_the_sensor() {
        let rms = |platform| {
            let mut imu = Imu::new(&Params::default(), Streams::new(3));
            imu.mount(VibrationSpec {
                once: 4.0,
                twice: 1.0,
                platform,
                damping: 0.1,
            });
            let x: Vec<f64> = (0..8000)
                .map(|_| {
                    f64::from(
                        imu.sample(DVec3::ZERO, DVec3::ZERO, &[600.0, 0.0, 0.0, 0.0])
                            .accel
                            .x,
                    )
                })
                .skip(4000)
                .collect();
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            (x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / x.len() as f64).sqrt()
        };
        // Two sines of 4 m/s²: 4.
        let rigid = rms(None);
        assert!((rigid - 4.0).abs() < 0.1, "{rigid}");
        assert!(rms(Some(40.0)) < 0.35 * rigid);
    }

    #[test]
    fn it_saturates_at_full_scale() {
        let mut imu = Imu::new(&Params::default(), Streams::new(3));
        imu.sample(DVec3::splat(100.0), DVec3::splat(-500.0), &[0.0; 4]);
        let r = imu.sample(DVec3::ZERO, DVec3::ZERO, &[0.0; 4]);
        assert!((r.gyro.x - 34.905).abs() < 0.01 && (r.accel.y + 156.9).abs() < 0.1);
    }
}
