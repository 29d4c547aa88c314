//! The motors' speed controllers: four channels of one timer, as DShot frames or as pulses.

use embassy_stm32::dma::InterruptHandler;
use embassy_stm32::gpio::{AfType, Flex, OutputType, Speed};
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::gpio::vals::Moder;
use embassy_stm32::timer::low_level::{OutputCompareMode, Timer};
use embassy_stm32::timer::{Ch1, Ch2, Ch3, Ch4, Channel, GeneralInstance4Channel, TimerPin, UpDma};
use embassy_stm32::{Peri, rcc};
use embassy_time::{Duration, Instant, with_timeout};
use sophie_control::wrench::PerArm;
use sophie_drivers::dshot::{self, BitTiming, Frame, fill_burst};
use sophie_drivers::esc_protocol::Protocol;
use sophie_drivers::esc_pwm::EscPulse;
use sophie_drivers::pwm_timing::PwmTiming;
use sophie_tasks::ports::Motors;
use static_cell::ConstStaticCell;

use super::Aligned;

/// The channels in the order of the motors.
const MOTORS: [Channel; 4] = [Channel::Ch1, Channel::Ch2, Channel::Ch3, Channel::Ch4];
/// The slowest frame takes 120 µs; one that takes this long never ends.
const LONGEST_FRAME: Duration = Duration::from_micros(500);
/// Length of a OneShot125 period, µs: the longest pulse and a moment of rest before it.
const ONESHOT_US: u32 = 260;

/// Rows of compare values that DMA writes into the timer: one for each bit of a frame, and two of zeros. The first of
/// those is in force when the second has been moved, so the pins are low at the end of the transfer.
type EscBurst = Aligned<[u16; dshot::BURST + dshot::MOTORS]>;

static DMA_MOTORS: ConstStaticCell<EscBurst> =
    ConstStaticCell::new(Aligned([0; dshot::BURST + dshot::MOTORS]));

/// How commands become compare values.
#[derive(Clone, Copy)]
enum Timing {
    DShot(BitTiming),
    Pulse(PwmTiming),
    OneShot(PwmTiming),
    Off,
}

/// Four speed controllers on the channels 1 to 4 of a 16-bit timer.
pub struct EscTimer<T: GeneralInstance4Channel, D: UpDma<T>, I> {
    timer: Timer<'static, T>,
    /// Kept, so that the pins stay the timer's.
    _pins: [Flex<'static>; 4],
    dma: Peri<'static, D>,
    irqs: I,
    burst: &'static mut EscBurst,
    timing: Timing,
}

/// Makes `pin` the output of its timer.
macro_rules! timer_output {
    ($pin:expr) => {{
        let pin = $pin;
        let function = pin.af_num();
        let mut output = Flex::new(pin);
        output.set_as_af_unchecked(function, AfType::output(OutputType::PushPull, Speed::High));
        output
    }};
}

impl<T: GeneralInstance4Channel, D: UpDma<T>, I> EscTimer<T, D, I>
where
    u16: Into<T::Word>,
{
    /// The controllers on these pins, which stay low until the first command. Called once.
    pub fn new(
        timer: Peri<'static, T>,
        (one, two, three, four): (
            Peri<'static, impl TimerPin<T, Ch1>>,
            Peri<'static, impl TimerPin<T, Ch2>>,
            Peri<'static, impl TimerPin<T, Ch3>>,
            Peri<'static, impl TimerPin<T, Ch4>>,
        ),
        dma: Peri<'static, D>,
        irqs: I,
        protocol: Protocol,
    ) -> Self {
        let timing = timing(protocol, rcc::frequency::<T>().0);
        let timer = Timer::new(timer);
        let (prescaler, period) = match timing {
            Timing::DShot(bit) => (0, u32::from(bit.period)),
            Timing::Pulse(t) | Timing::OneShot(t) => (t.prescaler, t.period),
            Timing::Off => (0, 1),
        };
        timer.regs_core().psc().write_value(prescaler);
        // `PwmTiming` and `BitTiming` are made for 16 bits: period - 1 always fits.
        timer.set_max_compare_value((period.wrapping_sub(1) as u16).into());
        // A OneShot pulse ends with the period: a counter that stops at zero must leave the pin low.
        let one_shot = matches!(timing, Timing::OneShot(_));
        let mode = if one_shot {
            OutputCompareMode::PwmMode2
        } else {
            OutputCompareMode::PwmMode1
        };
        timer.regs_core().cr1().modify(|w| w.set_opm(one_shot));
        for channel in MOTORS {
            timer.set_output_compare_mode(channel, mode);
            timer.set_output_compare_preload(channel, true);
            timer.set_compare_value(channel, if one_shot { u16::MAX } else { 0 }.into());
            timer.enable_channel(channel, true);
        }
        // Takes prescaler, period and compare values over while the outputs are still off.
        timer.generate_update_event();
        timer.enable_outputs();
        let pins = [
            timer_output!(one),
            timer_output!(two),
            timer_output!(three),
            timer_output!(four),
        ];
        Self {
            timer,
            _pins: pins,
            dma,
            irqs,
            burst: DMA_MOTORS.take(),
            timing,
        }
    }

    /// One pulse to all four, of a timer that runs on by itself.
    fn set_pulses(&mut self, t: PwmTiming, commands: PerArm<f32>) {
        for (channel, command) in MOTORS.into_iter().zip(commands) {
            let counts = EscPulse::Standard.compare(&t, command);
            // Preloaded: takes effect with the next pulse, never within one.
            self.timer.set_compare_value(channel, (counts as u16).into());
        }
        self.timer.start();
    }

    /// One pulse to all four, now.
    fn shoot(&mut self, t: PwmTiming, commands: PerArm<f32>) {
        self.timer.stop();
        for (channel, command) in MOTORS.into_iter().zip(commands) {
            let counts = EscPulse::OneShot125.compare(&t, command);
            let low = t.period.saturating_sub(counts);
            self.timer.set_compare_value(channel, (low as u16).into());
        }
        self.timer.generate_update_event();
        self.timer.start();
    }

    /// One frame to all four, over when this returns; gives its beginning.
    ///
    /// The order matters: counter stopped, DMA armed, request enabled, counter started. With the request enabled first,
    /// an update that comes before the stream is armed is lost, and with it the frame's first bit.
    async fn send_frame(&mut self, bit: BitTiming, commands: PerArm<f32>) -> Instant
    where
        I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
    {
        fill_burst(&mut self.burst.0, commands.map(Frame::from_command), bit);
        self.timer.stop();
        self.timer.enable_update_dma(false);
        self.timer.reset();
        let rows = &self.burst.0[..];
        let transfer = self.timer.setup_update_dma_burst(
            self.dma.reborrow(),
            self.irqs,
            Channel::Ch1,
            Channel::Ch4,
            rows,
        );
        self.timer.enable_update_dma(true);
        self.timer.start();
        let began = Instant::now();
        // A transfer that does not end is given up: the task must go on, and the supervisor sees it late.
        let _ = with_timeout(LONGEST_FRAME, transfer).await;
        self.timer.enable_update_dma(false);
        self.timer.stop();
        began
    }
}

impl<T: GeneralInstance4Channel, D: UpDma<T>, I> Motors for EscTimer<T, D, I>
where
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
    u16: Into<T::Word>,
{
    async fn write(&mut self, commands: PerArm<f32>) -> Instant {
        match self.timing {
            Timing::DShot(bit) => return self.send_frame(bit, commands).await,
            Timing::Pulse(t) => self.set_pulses(t, commands),
            Timing::OneShot(t) => self.shoot(t, commands),
            Timing::Off => {}
        }
        Instant::now()
    }
}

/// The timer's values for a protocol, on a timer clocked at `clock_hz`.
///
/// # Panics
/// If the clock cannot make the protocol: a board with such a clock never starts, so it is found at the bench.
fn timing(protocol: Protocol, clock_hz: u32) -> Timing {
    let found = match protocol {
        Protocol::DShot(speed) => BitTiming::new(clock_hz, speed).map(Timing::DShot),
        Protocol::Pulse(EscPulse::Standard) => EscPulse::Standard.timing(clock_hz).map(Timing::Pulse),
        // The length of its pulses is all that OneShot125 is: its rate is that of the commands.
        Protocol::Pulse(EscPulse::OneShot125) => {
            PwmTiming::new(clock_hz, 1_000_000 / ONESHOT_US).map(Timing::OneShot)
        }
        Protocol::Off => Some(Timing::Off),
    };
    match found {
        Some(timing) => timing,
        None => panic!("the motors' timer cannot make the protocol from {clock_hz} Hz"),
    }
}

/// Makes pins of a port outputs at low level, whatever drove them: the last resort of a fault handler.
pub fn pull_low(port: Gpio, pins: [usize; 4]) {
    for pin in pins {
        port.bsrr().write(|w| w.set_br(pin, true));
        port.moder().modify(|w| w.set_moder(pin, Moder::OUTPUT));
    }
}
