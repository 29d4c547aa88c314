//! TE MS5611-01BA03 on SPI, up to 20 MHz, mode 0 or 3: pressure and temperature over 4,096 samples.
//!
//! Commands, calibration and its checksum are those of the crate `ms5611-rs`. It checks no result; that is done by
//! [`crate::barometer`].

use embassy_time::{Delay, Duration, Instant, with_timeout};
use embedded_hal_async::spi::SpiDevice;
use ms5611_rs::{Error, Ms5611 as Commands, Oversampling, SpiInterface};

use crate::barometer::{Barometer, Chip};
use crate::fault::Fault;

/// Rated SPI clock, Hz.
pub const SPI_HZ: u32 = 20_000_000;
/// Longest conversion over 4,096 samples (datasheet, table of the analog digital converter): pressure comes first.
const CONVERSION: Duration = Duration::from_micros(9_040);
/// Limits of a start (reset, 2.8 ms, and eight words) and of a measurement (two conversions).
const START: Duration = Duration::from_millis(10);
const MEASUREMENT: Duration = Duration::from_millis(30);

/// An MS5611 on SPI device `S`.
pub type Ms5611<S> = Barometer<Part<S>>;

/// The chip.
pub struct Part<S>(Commands<SpiInterface<S>>);

impl<S: SpiDevice> Barometer<Part<S>> {
    /// The one at `spi`, without access until the first measurement.
    pub fn on(spi: S) -> Self {
        Self::new(Part(Commands::new_spi(spi)))
    }
}

impl<S: SpiDevice> Chip for Part<S> {
    const NAME: &'static str = "MS5611";

    // Within its start.
    const RESET_TIME: Duration = Duration::MIN;

    async fn reset(&mut self) -> Result<(), Fault> {
        Ok(())
    }

    async fn set_up(&mut self) -> Result<(), Fault> {
        with_timeout(START, self.0.init(&mut Delay))
            .await
            .map_err(|_| Fault::Silent)?
            .map_err(fault)
    }

    async fn measure(&mut self) -> Result<(Instant, f32, f32), Fault> {
        let middle = Instant::now() + CONVERSION / 2;
        let measured = with_timeout(MEASUREMENT, self.0.measure(Oversampling::Osr4096, &mut Delay))
            .await
            .map_err(|_| Fault::Silent)?
            .map_err(fault)?;
        // hPa.
        Ok((middle, 100.0 * measured.pressure_mbar, measured.temperature_c))
    }
}

/// The part has no identity: its checksum is what says that it is one.
fn fault<E>(error: Error<E>) -> Fault {
    match error {
        Error::BusError(_) => Fault::Bus,
        Error::CrcMismatch => Fault::Garbled,
        Error::NotInitialized => Fault::Silent,
    }
}
