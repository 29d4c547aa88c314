//! Single scans on the converter of the F4 and F7: embassy-stm32 0.6 only has a free-running ring there, with thousands
//! of interrupts a second for 500 readings.

use embassy_stm32::adc::{Adc, AnyAdcChannel, RxDma, SampleTime};
use embassy_stm32::dma::{self, InterruptHandler, TransferOptions};
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::pac::adc::vals::{Dds, Eocs};
use embassy_stm32::peripherals::ADC1;
use embassy_stm32::{Peri, pac};
use embassy_time::{Duration, with_timeout};
use sophie_ports::error::PortError;

use super::Aligned;
use super::analog::{CHANNELS, Scan};

/// Time-out; a scan takes about 0.05 ms.
const LONGEST: Duration = Duration::from_millis(1);

/// Converter and channels.
pub struct Converter<D: RxDma<ADC1>, I> {
    /// Held to own converter and pins.
    _kept: (Adc<'static, ADC1>, [AnyAdcChannel<'static, ADC1>; CHANNELS]),
    dma: Peri<'static, D>,
    irqs: I,
    buffer: &'static mut Aligned<[u16; CHANNELS]>,
}

impl<D: RxDma<ADC1>, I> Converter<D, I> {
    /// Bits beyond the port's twelve.
    pub const EXTRA_BITS: u32 = 0;

    /// Pressure sensors 1 to 4, battery voltage and current, and servo battery on `channels`.
    pub fn new(
        adc: Peri<'static, ADC1>,
        channels: [AnyAdcChannel<'static, ADC1>; CHANNELS],
        dma: Peri<'static, D>,
        irqs: I,
        buffer: &'static mut Aligned<[u16; CHANNELS]>,
    ) -> Self {
        let adc = Adc::new(adc);
        let registers = pac::ADC1;
        registers.cr1().modify(|w| w.set_scan(true));
        registers.cr2().modify(|w| {
            w.set_cont(false);
            w.set_dds(Dds::SINGLE);
            w.set_eocs(Eocs::EACH_SEQUENCE);
        });
        registers.sqr1().modify(|w| w.set_l(CHANNELS as u8 - 1));
        for (rank, channel) in channels.iter().enumerate() {
            let number = channel.get_hw_channel();
            // Ranks 1 to 6 are in the third register, the next six in the second.
            match rank.checked_sub(6) {
                None => registers.sqr3().modify(|w| w.set_sq(rank, number)),
                Some(rank) => registers.sqr2().modify(|w| w.set_sq(rank, number)),
            }
            // For the 10 kOhm of a pressure sensor's divider.
            if number <= 9 {
                registers
                    .smpr2()
                    .modify(|w| w.set_smp(number.into(), SampleTime::CYCLES144));
            } else {
                registers
                    .smpr1()
                    .modify(|w| w.set_smp(usize::from(number) - 10, SampleTime::CYCLES144));
            }
        }
        Self {
            _kept: (adc, channels),
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
        let r = pac::ADC1;
        // The request must fall before each scan: it stays masked after the last transfer of the previous one.
        r.cr2().modify(|w| w.set_dma(false));
        r.sr().modify(|w| {
            w.set_eoc(false);
            w.set_ovr(false);
        });
        let request = self.dma.request();
        let mut stream = dma::Channel::new(self.dma.reborrow(), self.irqs);
        // SAFETY: the data register is as wide as the buffer's elements, and the transfer borrows the buffer and ends
        // (or is stopped when dropped) before it is read.
        let transfer = unsafe {
            stream.read(
                request,
                r.dr().as_ptr().cast::<u16>(),
                &mut self.buffer.0,
                TransferOptions::default(),
            )
        };
        r.cr2().modify(|w| w.set_dma(true));
        r.cr2().modify(|w| w.set_swstart(true));
        with_timeout(LONGEST, transfer)
            .await
            .map_err(|_| PortError::Timeout)?;
        Ok(self.buffer.0)
    }
}
