//! I2C buses of the arm sensors, with bus recovery at start-up and after failures if a chip holds a line low.

#[cfg(any(family = "f7", family = "h7"))]
use core::marker::PhantomData;

use embassy_stm32::gpio::OutputOpenDrain;
use embassy_stm32::i2c::mode::Master;
use embassy_stm32::i2c::{Config, Error, I2c};
#[cfg(any(family = "f7", family = "h7"))]
use embassy_stm32::i2c::{ErrorInterruptHandler, Instance};
#[cfg(any(family = "f7", family = "h7"))]
use embassy_stm32::interrupt::typelevel::{Binding, Handler};
use embassy_stm32::mode::Async;
use embassy_stm32::pac::i2c::I2c as Registers;
use embassy_stm32::time::Hertz;
use embedded_hal_async::i2c::{ErrorType, Operation};
use sophie_control::params::ArmBusSpeed;
use sophie_drivers::bno055::TRANSACTION;
use sophie_drivers::i2c_lines::{Lines, free};
#[cfg(any(family = "f7", family = "h7"))]
use sophie_drivers::i2c_timing::I2cTiming;

/// Pins and peripheral of a bus, for repeated construction.
pub trait BusParts {
    /// Name in the log.
    const NAME: &'static str;

    /// Both lines as plain pins, high: clock, data.
    fn lines(&mut self) -> (OutputOpenDrain<'_>, OutputOpenDrain<'_>);

    /// Resets and sets up the peripheral.
    ///
    /// # Safety
    /// At most one bus exists at a time, and none while the lines are used.
    unsafe fn build(&mut self, speed: ArmBusSpeed) -> I2c<'static, Async, Master>;

    /// Registers of the peripheral.
    fn registers(&self) -> Registers;
}

/// Makes the parts `$parts` of `assign_resources!` (fields `bus`, of the I2C `$bus`, `clock`, `data`, `tx_dma`, `rx_dma`) an
/// I2C bus. Where [`BusErrors`] is, it is bound to the bus's error interrupt.
macro_rules! i2c_bus {
    ($parts:ident, $irqs:ident, $bus:ident) => {
        #[cfg(any(family = "f7", family = "h7"))]
        // SAFETY: `BusErrors`, which `set_times` asks for as well, calls this handler for every error that is left.
        unsafe impl
            embassy_stm32::interrupt::typelevel::Binding<
                <embassy_stm32::peripherals::$bus as embassy_stm32::i2c::Instance>::ErrorInterrupt,
                embassy_stm32::i2c::ErrorInterruptHandler<embassy_stm32::peripherals::$bus>,
            > for $irqs
        {
        }

        impl $crate::stm32::BusParts for $parts {
            const NAME: &'static str = stringify!($parts);

            fn lines(
                &mut self,
            ) -> (
                embassy_stm32::gpio::OutputOpenDrain<'_>,
                embassy_stm32::gpio::OutputOpenDrain<'_>,
            ) {
                use embassy_stm32::gpio::{Level, OutputOpenDrain, Speed};
                (
                    OutputOpenDrain::new(self.clock.reborrow(), Level::High, Speed::Low),
                    OutputOpenDrain::new(self.data.reborrow(), Level::High, Speed::Low),
                )
            }

            fn registers(&self) -> embassy_stm32::pac::i2c::I2c {
                <embassy_stm32::peripherals::$bus as $crate::stm32::BusRegisters>::registers()
            }

            unsafe fn build(
                &mut self,
                speed: sophie_control::params::ArmBusSpeed,
            ) -> embassy_stm32::i2c::I2c<
                'static,
                embassy_stm32::mode::Async,
                embassy_stm32::i2c::mode::Master,
            > {
                // SAFETY: these parts own the peripherals, and the caller ensures that only one bus uses them.
                let bus = unsafe {
                    embassy_stm32::i2c::I2c::new(
                        self.bus.clone_unchecked(),
                        self.clock.clone_unchecked(),
                        self.data.clone_unchecked(),
                        self.tx_dma.clone_unchecked(),
                        self.rx_dma.clone_unchecked(),
                        $irqs,
                        $crate::stm32::i2c_config(speed),
                    )
                };
                #[cfg(any(family = "f7", family = "h7"))]
                $crate::stm32::set_times(&self.bus, $irqs, speed);
                bus
            }
        }
    };
}
pub(crate) use i2c_bus;

/// Every wait limited.
pub fn i2c_config(speed: ArmBusSpeed) -> Config {
    let mut config = Config::default();
    config.frequency = match speed {
        // Between 88 and 100 kHz an F4 breaches the set-up time of a repeated start (ES0182 and ES0206, I2C).
        ArmBusSpeed::Standard if cfg!(family = "f4") => Hertz(87_500),
        ArmBusSpeed::Standard => Hertz(100_000),
        ArmBusSpeed::Fast => Hertz(400_000),
    };
    // Busy-waited on a stretched clock: for the background only.
    config.timeout = TRANSACTION;
    config
}

/// An I2C.
pub trait BusRegisters {
    /// Its registers.
    fn registers() -> Registers;
}

macro_rules! registers {
    ($($bus:ident),*) => {
        $(impl BusRegisters for embassy_stm32::peripherals::$bus {
            fn registers() -> Registers {
                embassy_stm32::pac::$bus
            }
        })*
    };
}

registers!(I2C1, I2C2, I2C3);
// Some F7 lack it, and every F4.
#[cfg(family = "h7")]
registers!(I2C4);

/// Error interrupt of a bus. A bus error is cleared and the transfer continues: F7 and H7 flag spurious ones (ST's
/// errata, "Spurious bus error detection in master mode"), and embassy-stm32 0.6 would end the transfer for it.
#[cfg(any(family = "f7", family = "h7"))]
pub struct BusErrors<T>(PhantomData<T>);

#[cfg(any(family = "f7", family = "h7"))]
impl<T: Instance + BusRegisters> Handler<T::ErrorInterrupt> for BusErrors<T> {
    unsafe fn on_interrupt() {
        let registers = T::registers();
        registers.icr().write(|w| w.set_berrcf(true));
        let errors = registers.isr().read();
        if errors.arlo() || errors.ovr() {
            // SAFETY: called from the interrupt that it is for.
            unsafe { <ErrorInterruptHandler<T> as Handler<T::ErrorInterrupt>>::on_interrupt() }
        }
    }
}

/// Follows embassy-stm32's handler of a bus's events, which shuts every interrupt of the bus, at a repeated start in
/// particular: that of the errors stays, for [`BusErrors`] to see them before the transfer's end does.
#[cfg(any(family = "f7", family = "h7"))]
pub struct WatchErrors<T>(PhantomData<T>);

#[cfg(any(family = "f7", family = "h7"))]
impl<T: Instance + BusRegisters> Handler<T::EventInterrupt> for WatchErrors<T> {
    unsafe fn on_interrupt() {
        T::registers().cr1().modify(|w| w.set_errie(true));
    }
}

/// Readies the bus for the next transfer; false if it has to be rebuilt.
///
/// After a data byte that is not acknowledged, the DMA's next byte stands in TXDR and would be the first of the next
/// transfer, a register's number perhaps of another chip (RM0433 §47.9.7: TXE flushes it).
#[cfg(any(family = "f7", family = "h7"))]
async fn settled(registers: Registers) -> bool {
    registers.isr().write(|w| w.set_txe(true));
    true
}

/// Waits until the stop is on the wire; false if it does not come.
///
/// Until then CR1 must not be written: that could ask for a second stop or start (RM0090 §27.6.1). embassy-stm32 0.6
/// returns at once, and after a data byte that is not acknowledged sends no stop at all.
#[cfg(family = "f4")]
async fn settled(registers: Registers) -> bool {
    /// Two bits at 87.5 kHz, 23 us, and a clock that a chip holds after its last byte, 180 us.
    const STOP: embassy_time::Duration = embassy_time::Duration::from_micros(300);
    let end = embassy_time::Instant::now() + STOP;
    while registers.cr1().read().stop() || registers.sr2().read().busy() {
        if embassy_time::Instant::now() > end {
            return false;
        }
        embassy_futures::yield_now().await;
    }
    true
}

/// Sets the mode's times instead of embassy-stm32's, whose upper bits do not fit the register. Called while no transfer
/// runs.
///
/// # Panics
/// If the clock cannot make them: such a board never starts, so the bench finds it.
#[cfg(any(family = "f7", family = "h7"))]
pub fn set_times<T: Instance + BusRegisters>(
    _bus: &embassy_stm32::Peri<'static, T>,
    _irqs: impl Binding<T::ErrorInterrupt, BusErrors<T>> + Binding<T::EventInterrupt, WatchErrors<T>>,
    speed: ArmBusSpeed,
) {
    let clock = embassy_stm32::rcc::frequency::<T>().0;
    let Some(timing) = I2cTiming::at(clock, speed) else {
        panic!("an I2C cannot make its times from {clock} Hz")
    };
    let registers = T::registers();
    // Writable only while the peripheral is off.
    registers.cr1().modify(|w| w.set_pe(false));
    registers.timingr().write(|w| {
        w.set_presc(timing.prescaler);
        w.set_scldel(timing.set_up);
        w.set_sdadel(timing.hold);
        w.set_sclh(timing.high);
        w.set_scll(timing.low);
    });
    registers.cr1().modify(|w| w.set_pe(true));
}

/// A bus that is rebuilt after a failure: clocks free the lines, then the peripheral starts from reset.
///
/// For the background only: blocks for up to some milliseconds.
pub struct ArmBus<P> {
    parts: P,
    speed: ArmBusSpeed,
    bus: Option<I2c<'static, Async, Master>>,
    lines: Lines,
}

impl<P: BusParts> ArmBus<P> {
    /// The bus of `parts`, untouched until the first transfer.
    pub const fn new(parts: P, speed: ArmBusSpeed) -> Self {
        Self {
            parts,
            speed,
            bus: None,
            lines: Lines::Idle,
        }
    }

    /// A bus with free lines; `None` if clocks cannot free them.
    async fn rebuilt(&mut self) -> Option<I2c<'static, Async, Master>> {
        let (mut clock, mut data) = self.parts.lines();
        let lines = free(&mut clock, &mut data).await;
        drop((clock, data));
        if lines != self.lines {
            match lines {
                Lines::Idle => defmt::info!("{=str}: lines free", P::NAME),
                Lines::Freed(clocks) => {
                    defmt::warn!("{=str}: data freed after {=u8} clocks", P::NAME, clocks)
                }
                Lines::Held => defmt::error!("{=str}: a line is held low", P::NAME),
            }
            self.lines = lines;
        }
        // SAFETY: called only before a bus exists, and the lines are dropped.
        (lines != Lines::Held).then(|| unsafe { self.parts.build(self.speed) })
    }
}

impl<P> ErrorType for ArmBus<P> {
    type Error = Error;
}

impl<P: BusParts> embedded_hal_async::i2c::I2c for ArmBus<P> {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        // Taken out: after a dropped transfer the next one rebuilds the bus.
        let mut bus = match self.bus.take() {
            Some(bus) => bus,
            None => self.rebuilt().await.ok_or(Error::Bus)?,
        };
        let result = bus.transaction(address, operations).await;
        // Other errors may leave the bus in disorder.
        if matches!(result, Ok(()) | Err(Error::Nack)) && settled(self.parts.registers()).await {
            self.bus = Some(bus);
        }
        result
    }
}
