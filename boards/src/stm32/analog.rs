//! Analog inputs: seven channels of one converter, scanned on demand by DMA.

use embassy_stm32::Peri;
use embassy_stm32::adc::{AnyAdcChannel, RxDma};
use embassy_stm32::dma::InterruptHandler;
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::peripherals::ADC1;
use sophie_ports::error::PortError;
use sophie_ports::sensors::{Analog, AnalogFrame};
use static_cell::ConstStaticCell;

use super::Aligned;
use super::adc::Converter;

/// Channels: pressure sensors 1 to 4, battery voltage, battery current, servo battery.
pub const CHANNELS: usize = 7;
/// Full scale at the pin, V, per count.
const VOLTS_PER_COUNT: f32 = 3.3 / 4095.0;

static DMA_ANALOG: ConstStaticCell<Aligned<[u16; CHANNELS]>> = ConstStaticCell::new(Aligned([0; CHANNELS]));

/// A converter with its channels.
pub trait Scan {
    /// Converts all channels once.
    async fn scan(&mut self) -> Result<[u16; CHANNELS], PortError>;
}

/// A board's analog inputs.
pub struct AnalogInputs<D: RxDma<ADC1>, I> {
    converter: Converter<D, I>,
}

impl<D, I> AnalogInputs<D, I>
where
    D: RxDma<ADC1>,
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
{
    /// Pressure sensors 1 to 4, battery voltage and current, and servo battery on `channels`. Called once.
    pub fn new(
        adc: Peri<'static, ADC1>,
        channels: [AnyAdcChannel<'static, ADC1>; CHANNELS],
        dma: Peri<'static, D>,
        irqs: I,
    ) -> Self {
        Self {
            converter: Converter::new(adc, channels, dma, irqs, DMA_ANALOG.take()),
        }
    }
}

impl<D, I> Analog for AnalogInputs<D, I>
where
    D: RxDma<ADC1>,
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
{
    fn volts_per_count(&self) -> f32 {
        VOLTS_PER_COUNT
    }

    async fn read(&mut self) -> Result<AnalogFrame, PortError> {
        let counts = self.converter.scan().await?;
        let [a, b, c, d, battery_voltage, battery_current, servo_battery] =
            counts.map(|n| n >> Converter::<D, I>::EXTRA_BITS);
        Ok(AnalogFrame {
            fsr: [a, b, c, d],
            battery_voltage,
            battery_current,
            servo_battery,
        })
    }
}
