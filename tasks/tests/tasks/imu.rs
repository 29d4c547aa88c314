//! Batches of the inertial part become samples at 1 kHz.

use std::cell::Cell;
use std::rc::Rc;

use embassy_time::{Instant, Timer};
use heapless::Vec as Few;
use sophie_control::arming::ArmingInhibit;
use sophie_control::chain::ImuReading;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::Params;
use sophie_ports::error::PortError;
use sophie_ports::sensors::{IMU_BATCH, Imu};
use sophie_tasks::flight::imu;
use sophie_tasks::schedule::TaskId;

use crate::rig::Rig;

/// Transfer time after data-ready, µs.
const TRANSFER_US: u64 = 40;

/// A part of `rate_hz`, read `batch` samples at a time, turning about x.
#[derive(Clone)]
struct Part {
    rate_hz: f32,
    batch: u64,
    /// Answers of the next calls.
    errors: Rc<Cell<(u32, Option<PortError>)>>,
    /// Delay of the next call, µs.
    gap: Rc<Cell<u64>>,
    ready: Rc<Cell<u64>>,
}

impl Part {
    fn new(rate_hz: f32, batch: u64) -> Self {
        Self {
            rate_hz,
            batch,
            errors: Rc::default(),
            gap: Rc::default(),
            ready: Rc::default(),
        }
    }
}

impl Imu for Part {
    type Batch = Few<ImuReading, IMU_BATCH>;

    fn rate_hz(&self) -> f32 {
        self.rate_hz
    }

    async fn read(&mut self) -> Result<Self::Batch, PortError> {
        let (left, error) = self.errors.get();
        if let (Some(error), true) = (error, left > 0) {
            self.errors.set((left - 1, Some(error)));
            return Err(error);
        }
        let ready = self
            .ready
            .get()
            .max(Instant::now().as_micros() - TRANSFER_US.min(Instant::now().as_micros()));
        let next = ready + self.gap.take() + (1e6 * self.batch as f32 / self.rate_hz) as u64;
        Timer::at(Instant::from_micros(next + TRANSFER_US)).await;
        self.ready.set(next);
        let mut batch = Few::new();
        for _ in 0..self.batch {
            let _ = batch.push(ImuReading {
                gyro: Vec3::new(0.5, 0.0, 0.0),
                accel: Vec3::new(0.0, 0.0, -GRAVITY),
            });
        }
        Ok(batch)
    }

    fn ready_at(&self) -> Instant {
        Instant::from_micros(self.ready.get())
    }
}

fn started(params: Params, part: &Part) -> Rig {
    let rig = Rig::with(params);
    rig.time.spawn(imu::run(rig.links, part.clone()));
    rig
}

#[test]
fn samples_come_at_1_khz_from_every_rate_and_batch_stamped_with_their_data_ready() {
    for (rate_hz, batch) in [
        (1000.0, 1),
        (2000.0, 1),
        (4000.0, 1),
        (4000.0, 2),
        (4000.0, 4),
        (8000.0, 8),
        (8000.0, 1),
    ] {
        let mut rig = started(Params::default(), &Part::new(rate_hz, batch));
        rig.run(10);
        let before = rig.links.timing.task(TaskId::Imu).runs;
        rig.run_with(1000, |links, at| {
            let sample = links.imu.latest().unwrap();
            assert!(
                (sample.value.dt - 1e-3).abs() < 1e-7,
                "{rate_hz} {batch}: {sample:?}"
            );
            assert_eq!(sample.at.as_micros() % 1000, 0);
            // The newest transfer has just begun.
            assert_eq!((at - sample.at).as_micros(), 1000);
        });
        assert_eq!(
            rig.links.timing.task(TaskId::Imu).runs - before,
            1000,
            "{rate_hz} {batch}"
        );
        let (mut seen, mut raw) = (rig.links.raw_forces.newest() - 5, 0);
        rig.links.raw_forces.take(&mut seen, |force| {
            assert_eq!(force, Vec3::new(0.0, 0.0, -GRAVITY));
            raw += 1;
        });
        assert_eq!(raw, 5, "one of each millisecond, not filtered");
        let timing = rig.links.timing.task(TaskId::Imu);
        assert_eq!(
            (timing.worst_lateness_us, timing.overruns),
            (TRANSFER_US as u32, 0)
        );
    }
}

#[test]
fn the_accelerometers_bias_is_taken_off_and_the_gyro_is_left_to_the_estimator() {
    let params = Params {
        accel_bias_x: 0.3,
        accel_bias_y: -0.2,
        accel_bias_z: 0.1,
        ..Params::default()
    };
    let mut rig = started(params, &Part::new(4000.0, 4));
    rig.run(500);
    let sample = rig.links.imu.fresh().unwrap();
    let accel = Vec3::new(-0.3, 0.2, -9.806_65 - 0.1);
    assert!((sample.accel - accel).norm() < 1e-3, "{sample:?}");
    assert!(
        (sample.gyro - Vec3::new(0.5, 0.0, 0.0)).norm() < 1e-3,
        "{sample:?}"
    );
}

#[test]
fn a_sample_carries_the_time_since_the_previous_one_up_to_five_milliseconds() {
    for (gap, dt) in [(0, 1e-3), (1000, 2e-3), (1500, 2.5e-3), (2500, 3.5e-3)] {
        let part = Part::new(1000.0, 1);
        let mut rig = started(Params::default(), &part);
        rig.run(10);
        part.gap.set(gap);
        let mut longest = 0.0f32;
        rig.run_with(20, |links, _| {
            longest = longest.max(links.imu.latest().unwrap().value.dt)
        });
        // After 3 ms the part is asked again.
        assert!(
            (longest - dt).abs() < 1e-5 || gap > 1500 && longest <= 5e-3,
            "{gap}: {longest}"
        );
        assert!(gap == 0 || longest > 1.9e-3, "{gap}: {longest}");
    }
    let part = Part::new(1000.0, 1);
    let mut rig = started(Params::default(), &part);
    rig.run(10);
    part.errors.set((100, Some(PortError::Timeout)));
    let mut longest = 0.0f32;
    rig.run_with(200, |links, _| {
        longest = longest.max(links.imu.latest().unwrap().value.dt)
    });
    assert!((longest - 5e-3).abs() < 1e-7, "{longest}");
}

#[test]
fn the_third_error_is_reported_and_taken_back_after_a_tenth_of_a_second_without() {
    for (error, inhibit) in [
        (PortError::Absent, Some(ArmingInhibit::ImuAbsent)),
        (PortError::WrongPart, Some(ArmingInhibit::ImuWrongPart)),
        (PortError::Corrupt, Some(ArmingInhibit::ImuCorrupt)),
        (PortError::Timeout, None),
    ] {
        let part = Part::new(1000.0, 1);
        let mut rig = started(Params::default(), &part);
        rig.run(10);
        part.errors.set((2, Some(error)));
        rig.run(20);
        assert!(rig.links.hardware().is_empty(), "{error:?}");
        // The third within 100 ms.
        part.errors.set((1, Some(error)));
        rig.run(5);
        assert!(rig.links.hardware().iter().eq(inhibit), "{error:?}");
        rig.run(90);
        assert!(rig.links.hardware().iter().eq(inhibit), "{error:?}");
        rig.run(15);
        assert!(rig.links.hardware().is_empty(), "{error:?}");
        // Counted from zero again.
        part.errors.set((2, Some(error)));
        rig.run(20);
        assert!(rig.links.hardware().is_empty(), "{error:?}");
    }
}
