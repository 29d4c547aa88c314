//! A scan on the H7's converter, through embassy-stm32's driver.

use embassy_stm32::Peri;
use embassy_stm32::adc::{Adc, AnyAdcChannel, DefaultInstance, RxDma, SampleTime};
use embassy_stm32::dma::InterruptHandler;
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_time::{Duration, with_timeout};
use sophie_tasks::ports::PortError;

use super::Aligned;
use super::analog::{CHANNELS, Scan};

/// A scan takes about 0.1 ms; one that takes this long never ends.
const LONGEST: Duration = Duration::from_millis(1);

/// The converter with its channels.
pub struct Converter<T: DefaultInstance, D: RxDma<T>, I> {
    /// The converter, set up.
    pub adc: Adc<'static, T>,
    /// Pressure sensors 1 to 4, battery voltage, battery current.
    pub channels: [AnyAdcChannel<'static, T>; CHANNELS],
    /// How long each input is sampled: long enough for the 10 kOhm of a pressure sensor's divider.
    pub sample_time: SampleTime,
    /// The stream that moves the counts.
    pub dma: Peri<'static, D>,
    /// Its interrupt.
    pub irqs: I,
    /// Where it moves them.
    pub buffer: &'static mut Aligned<[u16; CHANNELS]>,
}

impl<T, D, I> Scan for Converter<T, D, I>
where
    T: DefaultInstance,
    D: RxDma<T>,
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
{
    async fn scan(&mut self) -> Result<[u16; CHANNELS], PortError> {
        let sample_time = self.sample_time;
        let sequence = self.channels.iter_mut().map(|channel| (channel, sample_time));
        let scan = self
            .adc
            .read(self.dma.reborrow(), self.irqs, sequence, &mut self.buffer.0);
        with_timeout(LONGEST, scan)
            .await
            .map_err(|_| PortError::Timeout)?;
        Ok(self.buffer.0)
    }
}
