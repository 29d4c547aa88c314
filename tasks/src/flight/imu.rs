//! Inertial sensor: waits for data-ready, filters at the sensor's output rate, publishes at 1 kHz.
//!
//! The [`DEADLINE`] of the filtered sample counts from the data-ready of its last reading. The transfer
//! from the part counts as lateness, the filter as execution.

use embassy_time::{Duration, Instant, Timer, with_timeout};
use sophie_control::arming::ArmingInhibit;
use sophie_control::chain::{ImuSample, Sensing};
use sophie_ports::sensors::IMU_SILENCE;

use crate::deadline::note_run;
use crate::links::Links;
use crate::schedule::TaskId;
use sophie_ports::error::PortError;
use sophie_ports::sensors::Imu;

/// Time from data-ready to the handed-on sample.
pub const DEADLINE: Duration = TaskId::Imu.deadline();
/// Pause after a failed read.
pub const RETRY: Duration = Duration::from_millis(1);

/// Errors, less than [`CLEAN`] apart, before the fault is reported: a single glitch is ignored.
const ERRORS: u8 = 3;
/// Time without an error after which valid samples clear the report.
const CLEAN: Duration = Duration::from_millis(100);

/// Serves the inertial sensor; never returns. After a failed or timed-out read nothing is sent, and the link's age
/// shows it. Invalid answers of the part and a data-ready line that its port bypasses inhibit arming.
pub async fn run(links: &Links, mut port: impl Imu) -> ! {
    let mut sensing = Sensing::new(&links.params, port.rate_hz());
    let mut sample = ImuSample::default();
    let mut faults = Faults::default();
    loop {
        let batch = match with_timeout(IMU_SILENCE, port.read()).await {
            Ok(Ok(batch)) if !batch.as_ref().is_empty() => batch,
            // A port that fails immediately must not starve the levels below.
            Ok(failed) => {
                if let Err(error) = failed {
                    faults.failed(links, error);
                }
                Timer::after(RETRY).await;
                continue;
            }
            Err(_) => continue,
        };
        let started = Instant::now();
        let released = port.ready_at();
        faults.good(links, started, port.line_silent());
        if !sensing.take(released.as_micros(), batch.as_ref(), &mut sample) {
            continue;
        }
        if let [reading, ..] = batch.as_ref() {
            links.raw_forces.push(reading.accel);
        }
        links.imu.send(released, sample);
        note_run(links, TaskId::Imu, released, started, DEADLINE);
    }
}

/// The port's errors and their reports.
#[derive(Default)]
struct Faults {
    /// When the last error came, and how many have been counted.
    errors: Option<(Instant, u8)>,
    reported: Option<ArmingInhibit>,
    /// The data-ready line was reported as silent.
    line_silent: bool,
}

impl Faults {
    fn failed(&mut self, links: &Links, error: PortError) {
        let fault = match error {
            PortError::Absent => ArmingInhibit::ImuAbsent,
            PortError::WrongPart => ArmingInhibit::ImuWrongPart,
            PortError::Corrupt => ArmingInhibit::ImuCorrupt,
            // Silence shows as the link's age.
            PortError::Timeout => return,
        };
        let count = self.errors.map_or(0, |(_, count)| count).saturating_add(1);
        self.errors = Some((Instant::now(), count));
        if count >= ERRORS && self.reported != Some(fault) {
            self.clear(links);
            links.report(fault, true);
            self.reported = Some(fault);
        }
    }

    /// Called for every valid batch; usually a no-op.
    #[inline]
    fn good(&mut self, links: &Links, at: Instant, line_silent: bool) {
        if line_silent != self.line_silent {
            self.line_silent = line_silent;
            links.report(ArmingInhibit::ImuLineSilent, line_silent);
        }
        if let Some((last, _)) = self.errors
            && at.saturating_duration_since(last) >= CLEAN
        {
            self.errors = None;
            self.clear(links);
        }
    }

    fn clear(&mut self, links: &Links) {
        if let Some(fault) = self.reported.take() {
            links.report(fault, false);
        }
    }
}
