//! The arm sensors' I2C buses, freed at start-up and after failures from chips that hold them.

use embassy_stm32::gpio::OutputOpenDrain;
use embassy_stm32::i2c::mode::Master;
use embassy_stm32::i2c::{Config, Error, I2c};
use embassy_stm32::mode::Async;
use embassy_stm32::time::Hertz;
use embassy_time::Duration;
use embedded_hal_async::i2c::{ErrorType, Operation};
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
    unsafe fn build(&mut self) -> I2c<'static, Async, Master>;
}

/// Makes the parts `$parts` of `assign_resources!` (fields `bus`, `clock`, `data`, `tx_dma`, `rx_dma`) an I2C bus.
macro_rules! i2c_bus {
    ($parts:ident, $irqs:ident) => {
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

            unsafe fn build(
                &mut self,
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
                        $crate::stm32::i2c_config(),
                    )
                };
                $crate::stm32::set_fast_mode(&self.bus);
                bus
            }
        }
    };
}
pub(crate) use i2c_bus;

/// 400 kHz, every wait limited.
pub fn i2c_config() -> Config {
    let mut config = Config::default();
    config.frequency = Hertz(400_000);
    // Busy-waited on a stretched clock: for the background only.
    config.timeout = Duration::from_millis(3);
    config
}

/// An I2C with a register `TIMINGR`.
#[cfg(any(family = "f7", family = "h7"))]
pub trait TimedBus: embassy_stm32::PeripheralType + embassy_stm32::rcc::RccPeripheral {
    /// Registers of the I2C.
    fn registers() -> embassy_stm32::pac::i2c::I2c;
}

#[cfg(any(family = "f7", family = "h7"))]
macro_rules! timed {
    ($($bus:ident),*) => {
        $(impl TimedBus for embassy_stm32::peripherals::$bus {
            fn registers() -> embassy_stm32::pac::i2c::I2c {
                embassy_stm32::pac::$bus
            }
        })*
    };
}

#[cfg(any(family = "f7", family = "h7"))]
timed!(I2C1, I2C2, I2C3);
// Some F7 lack it.
#[cfg(family = "h7")]
timed!(I2C4);

/// Sets fast-mode times instead of embassy-stm32's, whose upper bits do not fit the register. Called while no transfer
/// runs.
///
/// # Panics
/// If the clock cannot make them: such a board never starts, so the bench finds it.
#[cfg(any(family = "f7", family = "h7"))]
pub fn set_fast_mode<T: TimedBus>(_bus: &embassy_stm32::Peri<'static, T>) {
    let clock = embassy_stm32::rcc::frequency::<T>().0;
    let Some(timing) = I2cTiming::fast_mode(clock) else {
        panic!("an I2C cannot make 400 kHz from {clock} Hz")
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

/// No effect: embassy-stm32 sets the older I2C's times right.
#[cfg(family = "f4")]
pub fn set_fast_mode<T: embassy_stm32::PeripheralType>(_bus: &embassy_stm32::Peri<'static, T>) {}

/// A bus that is rebuilt after a failure: clocks free the lines, then the peripheral starts from reset.
///
/// For the background only: blocks for up to some milliseconds.
pub struct ArmBus<P> {
    parts: P,
    bus: Option<I2c<'static, Async, Master>>,
    lines: Lines,
}

impl<P: BusParts> ArmBus<P> {
    /// The bus of `parts`, untouched until the first transfer.
    pub const fn new(parts: P) -> Self {
        Self {
            parts,
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
        // SAFETY: called only while there is no bus, and the lines are dropped.
        (lines != Lines::Held).then(|| unsafe { self.parts.build() })
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
        if matches!(result, Ok(()) | Err(Error::Nack)) {
            self.bus = Some(bus);
        }
        result
    }
}
