//! One chip on its own SPI bus.

use embassy_embedded_hal::adapter::BlockingAsync;
use embassy_stm32::gpio::{Level, Output, Pin, Speed};
use embassy_stm32::spi::mode::Master;
use embassy_stm32::spi::{Config, Instance as SpiInstance, MODE_3, MisoPin, MosiPin, SckPin, Spi};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Peri, rcc};
use embassy_time::Timer;
use embedded_hal_async::spi::{ErrorType, Operation, SpiBus, SpiDevice};
use sophie_drivers::spi_clock;

/// Mode 3, fit for every chip here, and the fastest clock of bus `T` up to `most_hz`.
pub fn spi_config<T: SpiInstance>(_bus: &Peri<'static, T>, most_hz: u32) -> Config {
    let mut config = Config::default();
    config.mode = MODE_3;
    config.frequency = Hertz(spi_clock::at_most(rcc::frequency::<T>().0, most_hz));
    config
}

/// A bus with its only chip's select line.
pub struct Selected<B> {
    bus: B,
    select: Output<'static>,
}

impl<B> Selected<B> {
    /// The chip on `bus` with the line `select`.
    ///
    /// The select edges are slow, some tens of nanoseconds, within the time before the first clock: the Matek's select
    /// (PC13 to PC15, backup domain's supply) drives at most 2 MHz and 30 pF, one at a time (STM32H743 datasheet, pin
    /// table).
    pub fn new(bus: B, select: Peri<'static, impl Pin>) -> Self {
        Self {
            bus,
            select: Output::new(select, Level::High, Speed::Low),
        }
    }
}

/// A chip on a bus with DMA.
pub type DmaChip = Selected<Spi<'static, embassy_stm32::mode::Async, Master>>;

/// A chip of up to `most_hz` on a bus without DMA.
pub fn plain_chip<T: SpiInstance>(
    spi: Peri<'static, T>,
    clock: Peri<'static, impl SckPin<T>>,
    data_out: Peri<'static, impl MosiPin<T>>,
    data_in: Peri<'static, impl MisoPin<T>>,
    select: Peri<'static, impl Pin>,
    most_hz: u32,
) -> PlainChip {
    let config = spi_config(&spi, most_hz);
    let bus = Spi::new_blocking(spi, clock, data_out, data_in, config);
    Selected::new(BlockingAsync::new(bus), select)
}

/// A chip on a bus without DMA: the processor waits.
pub type PlainChip = Selected<BlockingAsync<Spi<'static, embassy_stm32::mode::Blocking, Master>>>;

/// Selects the chip; a dropped transfer also releases it.
struct Hold<'a>(&'a mut Output<'static>);

impl Drop for Hold<'_> {
    fn drop(&mut self) {
        self.0.set_high();
    }
}

impl<B: SpiBus> ErrorType for Selected<B> {
    type Error = B::Error;
}

impl<B: SpiBus> SpiDevice for Selected<B> {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Self::Error> {
        self.select.set_low();
        let hold = Hold(&mut self.select);
        for operation in operations {
            match operation {
                Operation::Read(words) => self.bus.read(words).await?,
                Operation::Write(words) => self.bus.write(words).await?,
                Operation::Transfer(read, write) => self.bus.transfer(read, write).await?,
                Operation::TransferInPlace(words) => self.bus.transfer_in_place(words).await?,
                Operation::DelayNs(ns) => Timer::after_nanos(u64::from(*ns)).await,
            }
        }
        self.bus.flush().await?;
        drop(hold);
        Ok(())
    }
}
