//! Common part of the barometer drivers: detects the chip, pauses after failures, rejects implausible values.
//!
//! A call waits some tens of milliseconds without holding the bus. Failures cause a pause, doubling up to 1 s: on a
//! board without the part, one unacknowledged address a second.

use embassy_time::{Duration, Instant};
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_ports::error::PortError;
use sophie_ports::sensors::Barometer as Port;

use crate::fault::{Fault, report};

/// First and longest pause after a failure.
const PAUSE: [Duration; 2] = [Duration::from_millis(20), Duration::from_secs(1)];
/// Consecutive failed measurements before the chip is reset.
const FAILURES_MAX: u8 = 3;
/// Consecutive equal measurements that mark a stuck part, 1 s at 25 Hz: with noise of one step (MS5611: 1.2 Pa of
/// noise, steps of 1 Pa), a quarter of neighbouring values are equal.
const STUCK: u8 = 25;

/// One chip. Each call is a separate bus access and releases the bus afterwards.
pub trait Chip {
    /// In the log.
    const NAME: &'static str;

    /// From its reset until it can be set up.
    const RESET_TIME: Duration;

    /// Finds the chip and resets it.
    ///
    /// # Errors
    /// None, or another one.
    async fn reset(&mut self) -> Result<(), Fault>;

    /// Sets it up and reads its calibration.
    ///
    /// # Errors
    /// One that has not started, or keeps no settings.
    async fn set_up(&mut self) -> Result<(), Fault>;

    /// One measurement: time of its middle, pressure, Pa, and temperature, °C, unchecked.
    ///
    /// # Errors
    /// [`Fault::Bus`], [`Fault::Silent`] if it does not end, or a chip that has lost its settings.
    async fn measure(&mut self) -> Result<(Instant, f32, f32), Fault>;
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Its reset is due.
    Absent(Instant),
    /// Its reset ends.
    Resetting(Instant),
    Running,
}

/// A barometer on chip `C`.
pub struct Barometer<C> {
    chip: C,
    state: State,
    pause: Duration,
    failures: u8,
    /// Equal measurements in a row, and the last one.
    same: u8,
    before: [f32; 2],
    last_fault: Option<Fault>,
}

impl<C: Chip> Barometer<C> {
    /// Without bus access until the first measurement.
    pub const fn new(chip: C) -> Self {
        let [pause, _] = PAUSE;
        Self {
            chip,
            state: State::Absent(Instant::MIN),
            pause,
            failures: 0,
            same: 0,
            before: [0.0; 2],
            last_fault: None,
        }
    }

    /// Last fault since power-up.
    pub const fn last_fault(&self) -> Option<Fault> {
        self.last_fault
    }

    /// One step towards a chip that measures.
    async fn advance(&mut self) -> Result<(), Fault> {
        self.state = match self.state {
            State::Absent(_) => {
                self.chip.reset().await?;
                State::Resetting(Instant::now() + C::RESET_TIME)
            }
            State::Resetting(_) | State::Running => {
                self.chip.set_up().await?;
                (self.failures, self.same) = (0, 0);
                State::Running
            }
        };
        Ok(())
    }

    async fn measure(&mut self) -> Result<AirPressure, Fault> {
        let (at, pascal, celsius) = self.chip.measure().await?;
        let air = AirPressure {
            at_us: at.as_micros(),
            pascal,
            celsius,
        };
        let air = air.checked().ok_or(Fault::Garbled)?;
        let now = [pascal, celsius];
        let equal = now.map(f32::to_bits) == self.before.map(f32::to_bits);
        self.before = now;
        self.same = if equal { self.same.saturating_add(1) } else { 0 };
        if self.same >= STUCK {
            return Err(Fault::Stuck);
        }
        Ok(air)
    }

    fn lose(&mut self, fault: Fault) {
        if self.last_fault != Some(fault) {
            report(C::NAME, &fault);
        }
        self.last_fault = Some(fault);
        let [_, longest] = PAUSE;
        self.state = State::Absent(Instant::now() + self.pause);
        self.pause = (self.pause * 2).min(longest);
    }
}

impl<C: Chip> Port for Barometer<C> {
    const FITTED: bool = true;

    async fn read(&mut self) -> Result<AirPressure, PortError> {
        if let State::Absent(at) | State::Resetting(at) = self.state {
            if Instant::now() >= at
                && let Err(fault) = self.advance().await
            {
                self.lose(fault);
            }
            return Err(PortError::Absent);
        }
        match self.measure().await {
            Ok(air) => {
                let [pause, _] = PAUSE;
                (self.pause, self.failures) = (pause, 0);
                Ok(air)
            }
            Err(fault) => {
                self.failures = self.failures.saturating_add(1);
                if self.failures >= FAILURES_MAX
                    || matches!(fault, Fault::Stuck | Fault::Configuration { .. })
                {
                    self.lose(fault);
                }
                Err(fault.port_error())
            }
        }
    }
}
