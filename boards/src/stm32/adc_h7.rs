//! A scan on the H7's converter.

use embassy_stm32::Peri;
use embassy_stm32::adc::{Adc, AnyAdcChannel, RxDma, SampleTime};
use embassy_stm32::dma::InterruptHandler;
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::peripherals::ADC1;
use embassy_time::{Duration, with_timeout};
use sophie_ports::error::PortError;

use super::Aligned;
use super::analog::{CHANNELS, Scan};

/// Time-out; a scan takes about 0.1 ms.
const LONGEST: Duration = Duration::from_millis(1);

/// Sampling time for the 10 kOhm of a pressure sensor's divider.
const SAMPLE_TIME: SampleTime = SampleTime::CYCLES387_5;

/// Converter and channels.
pub struct Converter<D: RxDma<ADC1>, I> {
    adc: Adc<'static, ADC1>,
    channels: [AnyAdcChannel<'static, ADC1>; CHANNELS],
    dma: Peri<'static, D>,
    irqs: I,
    buffer: &'static mut Aligned<[u16; CHANNELS]>,
}

impl<D: RxDma<ADC1>, I> Converter<D, I> {
    /// Bits beyond the port's twelve.
    pub const EXTRA_BITS: u32 = 4;

    /// Pressure sensors 1 to 4, battery voltage and current, and servo battery on `channels`.
    pub fn new(
        adc: Peri<'static, ADC1>,
        channels: [AnyAdcChannel<'static, ADC1>; CHANNELS],
        dma: Peri<'static, D>,
        irqs: I,
        buffer: &'static mut Aligned<[u16; CHANNELS]>,
    ) -> Self {
        Self {
            adc: Adc::new(adc),
            channels,
            dma,
            irqs,
            buffer,
        }
    }
}

impl<D, I> Scan for Converter<D, I>
where
    D: RxDma<ADC1>,
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
{
    async fn scan(&mut self) -> Result<[u16; CHANNELS], PortError> {
        let sequence = self.channels.iter_mut().map(|channel| (channel, SAMPLE_TIME));
        let scan = self
            .adc
            .read(self.dma.reborrow(), self.irqs, sequence, &mut self.buffer.0);
        with_timeout(LONGEST, scan)
            .await
            .map_err(|_| PortError::Timeout)?;
        Ok(self.buffer.0)
    }
}
