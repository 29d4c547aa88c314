//! One chip on an SPI bus of its own.

use embassy_stm32::gpio::Output;
use embassy_stm32::mode::Async;
use embassy_stm32::spi::Spi;
use embassy_stm32::spi::mode::Master;
use embassy_time::Timer;
use embedded_hal_async::spi::{ErrorType, Operation, SpiBus, SpiDevice};

/// A bus with its only chip's select line.
pub struct Selected {
    /// The bus.
    pub bus: Spi<'static, Async, Master>,
    /// Low while the chip is spoken to.
    pub select: Output<'static>,
}

/// Holds the select line low; a transfer that is given up half-way still lets go of the chip.
struct Hold<'a>(&'a mut Output<'static>);

impl Drop for Hold<'_> {
    fn drop(&mut self) {
        self.0.set_high();
    }
}

impl ErrorType for Selected {
    type Error = embassy_stm32::spi::Error;
}

impl SpiDevice for Selected {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Self::Error> {
        self.select.set_low();
        let hold = Hold(&mut self.select);
        for operation in operations {
            match operation {
                Operation::Read(words) => SpiBus::read(&mut self.bus, words).await?,
                Operation::Write(words) => SpiBus::write(&mut self.bus, words).await?,
                Operation::Transfer(read, write) => SpiBus::transfer(&mut self.bus, read, write).await?,
                Operation::TransferInPlace(words) => SpiBus::transfer_in_place(&mut self.bus, words).await?,
                Operation::DelayNs(ns) => Timer::after_nanos(u64::from(*ns)).await,
            }
        }
        SpiBus::<u8>::flush(&mut self.bus).await?;
        drop(hold);
        Ok(())
    }
}
