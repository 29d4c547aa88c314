//! The STM32H743 with what the emulator's own part lacks, and without what the board does not use.

use rigless::device::{Device, ErasedDevice, Level, ResetCause};
use rigless::mcu::Mcu;
use rigless::soc::Bus;
use rigless::soc::stm32h743::Stm32h743;
use rigless::soc::stm32h743::peripherals::gpio::{Gpio, Pin};
use rigless::time::VirtualNanos;

use super::chips::icm42688p::Imu;
use super::tap::Tap;
use super::watchdog::Watchdog;

/// Instances that no firmware of ours uses. Asking their models costs half the speed; whoever reaches one all the same
/// finds it listed as unimplemented, and the run failed.
const UNUSED: [&str; 27] = [
    "TIM1", "TIM6", "TIM7", "TIM8", "TIM12", "TIM13", "TIM14", "TIM16", "TIM17", "SPI2", "SPI3", "SPI4",
    "SPI5", "SPI6", "I2C3", "I2C4", "UART4", "UART5", "UART8", "BDMA", "DMAMUX2", "ADC2", "ADC3", "SDMMC2",
    "GPIOI", "GPIOJ", "GPIOK",
];
/// Serial ports in the order of [`Stm32h743::usart`].
const SERIAL: [&str; 8] = [
    "USART1", "USART2", "USART3", "UART4", "UART5", "USART6", "UART7", "UART8",
];
/// Which of the general-purpose timers drive motors (TIM4).
const MOTOR_TIMER: usize = 2;
/// Port and pin of the inertial sensor's data-ready line: PB2.
const READY: (usize, u8) = (1, 2);

/// A pin of the part: port (0 is A) and number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct At(pub usize, pub u8);

impl std::fmt::Display for At {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "P{}{}", char::from(b'A' + self.0 as u8), self.1)
    }
}

/// The part.
#[derive(Debug)]
pub struct Part {
    /// The emulator's own.
    pub inner: Stm32h743,
    /// The motors' timer.
    pub motors: Tap,
    watchdog: Watchdog,
    slots: Slots,
    pulses: u64,
}

#[derive(Debug)]
struct Slots {
    watchdog: usize,
    motors: usize,
    serial: Vec<usize>,
    unused: Vec<bool>,
}

impl Part {
    /// The part around `inner`.
    ///
    /// # Errors
    /// The emulator does not know an instance by its name.
    pub fn new(inner: Stm32h743) -> Result<Self, rigless::soc::Error> {
        let bus = inner.bus();
        let mut unused = vec![false; bus.slots().len()];
        for name in UNUSED {
            unused[bus.slot(name)?] = true;
        }
        let serial = SERIAL
            .iter()
            .map(|name| bus.slot(name))
            .collect::<Result<_, _>>()?;
        let slots = Slots {
            watchdog: bus.slot("IWDG")?,
            motors: bus.slot("TIM4")?,
            serial,
            unused,
        };
        Ok(Self {
            inner,
            motors: Tap::new(MOTOR_TIMER),
            watchdog: Watchdog::default(),
            slots,
            pulses: 0,
        })
    }

    /// The alternate function that a pin carries; `None` when it carries none.
    pub fn function(&mut self, now: VirtualNanos, pin: At) -> Option<u8> {
        let number = Pin::new(pin.1)?;
        self.inner
            .drive_port(now, pin.0, |_, file, _| Gpio::function(number, file))
    }

    /// Drives a pin from outside.
    pub fn drive(&mut self, now: VirtualNanos, pin: At, level: Level) {
        if let Some(number) = Pin::new(pin.1) {
            self.inner.drive_port(now, pin.0, |port, file, c| {
                port.drive(number, Some(level), file, c);
            });
        }
    }

    /// The pin is high.
    pub fn is_high(&mut self, now: VirtualNanos, pin: At) -> bool {
        Pin::new(pin.1).is_some_and(|number| {
            self.inner.drive_port(now, pin.0, |port, file, _| {
                port.level(number, file) == Level::High
            })
        })
    }

    /// Gives the data-ready pulses that the sensor has sent to the pin that it is wired to.
    fn carry_data_ready(&mut self, now: VirtualNanos) {
        let pulses = self.inner.spi[0].chip_mut::<Imu>(0).map_or(0, |imu| imu.pulses);
        if pulses == self.pulses {
            return;
        }
        self.pulses = pulses;
        let (port, pin) = READY;
        let Some(pin) = Pin::new(pin) else { return };
        // 8 µs on the real part; the interrupt takes the edge.
        self.inner.drive_port(now, port, |port, file, c| {
            port.drive(pin, Some(Level::High), file, c);
            port.drive(pin, Some(Level::Low), file, c);
        });
    }
}

impl Mcu for Part {
    fn bus(&self) -> &Bus {
        self.inner.bus()
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.inner.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        // It builds its models anew, keeping what hangs on them; ours go the same way.
        self.inner.reset(at, cause);
        self.watchdog = Watchdog::default();
        self.motors.restart(at);
    }

    fn poll(&mut self, now: VirtualNanos) {
        // Only serial ports with something at the far end look outside; the stock part asks every model at every stop.
        for (nth, slot) in self.slots.serial.iter().enumerate() {
            if self.inner.usart[nth].attached() {
                let mut port = std::mem::take(&mut self.inner.usart[nth]);
                let (file, mut c) = self.inner.bus_mut().drive(now, *slot);
                Device::poll(&mut port, file, &mut c);
                self.inner.usart[nth] = port;
            }
        }
        self.carry_data_ready(now);
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        if slot == self.slots.watchdog {
            return (self.inner.bus_mut(), Some(&mut self.watchdog));
        }
        if slot == self.slots.motors {
            return (self.inner.bus_mut(), Some(&mut self.motors));
        }
        if self.slots.unused.get(slot) == Some(&true) {
            return (self.inner.bus_mut(), None);
        }
        self.inner.split(slot)
    }
}
