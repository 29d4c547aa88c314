//! The motors' speed controllers, by DShot frames or pulses, on any channels of one or two timers.
//!
//! Each command starts one frame or pulse, which ends with the pins low: in zeros, or by the timer's stop. If the
//! software hangs, frames and pulses cease and the controllers stop the motors.

use embassy_futures::join::join;
use embassy_stm32::dma::InterruptHandler;
use embassy_stm32::gpio::{AfType, Flex, OutputType, Speed};
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::timer::low_level::{self, OutputCompareMode};
use embassy_stm32::timer::{Channel, GeneralInstance4Channel, TimerChannel, TimerPin, UpDma};
use embassy_stm32::{Peri, rcc};
use embassy_time::{Duration, Instant, Timer};
use sophie_control::allocation::wrench::PerArm;
use sophie_drivers::dshot::{self, BitTiming, Frame, fill_burst};
use sophie_drivers::esc_protocol::EscProtocol;
use sophie_drivers::esc_pwm::EscPulse;
use sophie_drivers::pwm_timing::PwmTiming;
use sophie_ports::actuators::Motors;
use static_cell::ConstStaticCell;

use super::Aligned;
use super::frame_stream::{FrameStream, Stream};

/// Marks a channel without a motor.
const NO_MOTOR: usize = usize::MAX;

/// Rows of compare values in a frame: one a bit, and two of zeros. The first of these is in force once the second has
/// been moved: the pins end low.
const FRAME_ROWS: usize = dshot::BITS + 2;
/// Rows given to DMA. The timer is stopped in the zeros after the frame, which last as long as a frame of the fastest
/// protocol: longer than any task of the level delays this one.
const ROWS: usize = 2 * FRAME_ROWS;
type EscBurst = Aligned<[u16; ROWS * dshot::MOTORS]>;

static DMA_MOTORS: ConstStaticCell<EscBurst> = ConstStaticCell::new(Aligned([0; ROWS * dshot::MOTORS]));
static DMA_MORE_MOTORS: ConstStaticCell<EscBurst> = ConstStaticCell::new(Aligned([0; ROWS * dshot::MOTORS]));

#[derive(Clone, Copy)]
enum Timing {
    /// With the time of all rows.
    DShot(BitTiming, Duration),
    Pulse(EscPulse, PwmTiming),
}

/// Speed controllers on channels of a 16-bit timer.
pub struct EscTimer<T: GeneralInstance4Channel, D: UpDma<T>, I> {
    timer: low_level::Timer<'static, T>,
    channels: PerArm<Option<Channel>>,
    motors: [usize; dshot::MOTORS],
    /// Kept to own the pins.
    pins: PerArm<Option<Flex<'static>>>,
    /// Kept to own the stream.
    _dma: Peri<'static, D>,
    _irqs: I,
    stream: Stream,
    burst: &'static mut EscBurst,
    timing: Timing,
}

impl<T: GeneralInstance4Channel, D: UpDma<T> + FrameStream, I> EscTimer<T, D, I>
where
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
    u16: Into<T::Word>,
{
    /// Motors 1 to 4 on these pins, low until the first command. The pins determine the channels, in any order; two of
    /// one channel do not build. Called once.
    pub fn new<C1: TimerChannel, C2: TimerChannel, C3: TimerChannel, C4: TimerChannel>(
        timer: Peri<'static, T>,
        (one, two, three, four): (
            Peri<'static, impl TimerPin<T, C1>>,
            Peri<'static, impl TimerPin<T, C2>>,
            Peri<'static, impl TimerPin<T, C3>>,
            Peri<'static, impl TimerPin<T, C4>>,
        ),
        dma: Peri<'static, D>,
        irqs: I,
        protocol: EscProtocol,
    ) -> Self {
        const {
            let bits = 1 << C1::CHANNEL as u32
                | 1 << C2::CHANNEL as u32
                | 1 << C3::CHANNEL as u32
                | 1 << C4::CHANNEL as u32;
            assert!(bits == 0b1111, "two motors are on one channel of the timer");
        }
        Self::first(timer, dma, irqs, protocol)
            .motor(0, one)
            .motor(1, two)
            .motor(2, three)
            .motor(3, four)
    }

    /// The first of two timers, without motors yet. Called once.
    pub fn first(timer: Peri<'static, T>, dma: Peri<'static, D>, irqs: I, protocol: EscProtocol) -> Self {
        Self::bare(timer, dma, irqs, protocol, DMA_MOTORS.take())
    }

    /// The second of two timers, without motors yet. Called once.
    pub fn second(timer: Peri<'static, T>, dma: Peri<'static, D>, irqs: I, protocol: EscProtocol) -> Self {
        Self::bare(timer, dma, irqs, protocol, DMA_MORE_MOTORS.take())
    }

    fn bare(
        timer: Peri<'static, T>,
        mut dma: Peri<'static, D>,
        irqs: I,
        protocol: EscProtocol,
        burst: &'static mut EscBurst,
    ) -> Self {
        let timing = timing(protocol, rcc::frequency::<T>().0);
        let mut timer = low_level::Timer::new(timer);
        let (prescaler, period) = match timing {
            Timing::DShot(bit, _) => (0, u32::from(bit.period)),
            Timing::Pulse(_, t) => (t.prescaler, t.period),
        };
        timer.regs_core().psc().write_value(prescaler);
        // `PwmTiming` and `BitTiming` are 16-bit: period - 1 always fits.
        timer.set_max_compare_value((period.wrapping_sub(1) as u16).into());
        let rows = &burst.0[..];
        let first = timer.setup_update_dma_burst(dma.reborrow(), irqs, Channel::Ch1, Channel::Ch4, rows);
        let stream = Stream::of::<D>(first, rows.len());
        Self {
            timer,
            channels: [None; 4],
            motors: [NO_MOTOR; 4],
            pins: [const { None }; 4],
            _dma: dma,
            _irqs: irqs,
            stream,
            burst,
            timing,
        }
    }

    /// Adds motor `index`, 0 to 3, on its pin, low until the first command.
    pub fn motor<C: TimerChannel>(mut self, index: usize, pin: Peri<'static, impl TimerPin<T, C>>) -> Self {
        let channel = C::CHANNEL;
        self.timer
            .set_output_compare_mode(channel, OutputCompareMode::PwmMode1);
        self.timer.set_output_compare_preload(channel, true);
        self.timer.set_compare_value(channel, 0.into());
        self.timer.enable_channel(channel, true);
        // Loads all values before the pin becomes the timer's.
        self.timer.generate_update_event();
        self.timer.enable_outputs();
        let function = pin.af_num();
        let mut output = Flex::new(pin);
        output.set_as_af_unchecked(function, AfType::output(OutputType::PushPull, Speed::High));
        if let (Some(of), Some(kept)) = (self.channels.get_mut(index), self.pins.get_mut(index)) {
            *of = Some(channel);
            *kept = Some(output);
        }
        if let Some(motor) = self.motors.get_mut(channel.index()) {
            *motor = index;
        }
        self
    }

    fn on_channels<V: Copy>(
        &self,
        motors: PerArm<V>,
    ) -> impl Iterator<Item = (Channel, V)> + use<T, D, I, V> {
        let pairs = self.channels.into_iter().zip(motors);
        pairs.filter_map(|(channel, value)| Some((channel?, value)))
    }

    /// Starts one pulse on all motors. A command within the last pulse's period is dropped, so that it neither cuts nor
    /// lengthens the pulse; the next is newer.
    fn shoot(&mut self, pulse: EscPulse, t: PwmTiming, commands: PerArm<f32>) {
        let registers = self.timer.regs_core();
        // In one-pulse mode the hardware stops the counter.
        if registers.cr1().read().cen() {
            return;
        }
        for (channel, command) in self.on_channels(commands) {
            let counts = pulse.compare(&t, command);
            self.timer.set_compare_value(channel, (counts as u16).into());
        }
        // Pins rise with the first line, the pulse is timed from the last: less than 0.5 µs.
        critical_section::with(|_| {
            registers.egr().write(|w| w.set_ug(true));
            // In force when the counter stops at zero: the pins stay low.
            for (channel, _) in self.on_channels(commands) {
                self.timer.set_compare_value(channel, 0.into());
            }
            registers.cr1().write(|w| {
                w.set_opm(true);
                w.set_cen(true);
            });
        });
    }

    /// Stops the counter first: a pending request is still served.
    fn stop_frame(&mut self) {
        self.timer.stop();
        self.timer.enable_update_dma(false);
        self.stream.stop();
    }

    /// Sends one frame to all motors; returns its start once it is over.
    ///
    /// Order: stop counter and stream, write rows, arm stream, enable request, start counter. An update between
    /// enabling and arming would be lost, and the frame's first bit with it.
    async fn send_frame(&mut self, bit: BitTiming, time: Duration, commands: PerArm<f32>) -> Instant {
        // Ends an abandoned frame.
        self.stop_frame();
        self.timer.reset();
        // In channel order. A channel without a motor has no pin.
        let frame = |motor| {
            commands
                .get(motor)
                .map_or(Frame::STOP, |c| Frame::from_command(*c))
        };
        let frames = self.motors.map(frame);
        if let Some(rows) = self.burst.0.first_chunk_mut::<{ FRAME_ROWS * dshot::MOTORS }>() {
            fill_burst(rows, frames, bit);
        }
        self.stream.arm();
        self.timer.enable_update_dma(true);
        self.timer.start();
        let began = Instant::now();
        // Not waiting for a stalled stream: the next frame sets it up.
        Timer::at(began + time).await;
        self.stop_frame();
        began
    }
}

impl<T: GeneralInstance4Channel, D: UpDma<T> + FrameStream, I> Motors for EscTimer<T, D, I>
where
    I: Binding<D::Interrupt, InterruptHandler<D>> + Copy,
    u16: Into<T::Word>,
{
    async fn write(&mut self, commands: PerArm<f32>) -> Instant {
        match self.timing {
            Timing::DShot(bit, time) => return self.send_frame(bit, time, commands).await,
            Timing::Pulse(pulse, t) => self.shoot(pulse, t, commands),
        }
        Instant::now()
    }
}

/// Motors on two timers, each with its own stream.
pub struct EscTimers<A, B>(A, B);

impl<T, D, I, U, E, J> EscTimers<EscTimer<T, D, I>, EscTimer<U, E, J>>
where
    T: GeneralInstance4Channel,
    D: UpDma<T>,
    U: GeneralInstance4Channel,
    E: UpDma<U>,
{
    /// Both timers with their motors.
    ///
    /// # Panics
    /// If a motor is on none or both: such a board never starts, so the bench finds it.
    pub fn new(first: EscTimer<T, D, I>, second: EscTimer<U, E, J>) -> Self {
        for (a, b) in first.channels.iter().zip(&second.channels) {
            assert!(a.is_some() != b.is_some(), "each motor is on one timer");
        }
        Self(first, second)
    }
}

impl<A: Motors, B: Motors> Motors for EscTimers<A, B> {
    /// The frames begin within some microseconds of each other.
    async fn write(&mut self, commands: PerArm<f32>) -> Instant {
        let (first, second) = join(self.0.write(commands), self.1.write(commands)).await;
        first.min(second)
    }
}

/// Timer values for a protocol at `clock_hz`.
///
/// # Panics
/// If the clock cannot make the protocol: such a board never starts, so the bench finds it.
fn timing(protocol: EscProtocol, clock_hz: u32) -> Timing {
    let found = match protocol {
        EscProtocol::DShot(speed) => BitTiming::new(clock_hz, speed).map(|bit| {
            let counts = FRAME_ROWS as u64 * u64::from(bit.period);
            // 1 µs for each end: the clock's resolution.
            let time = Duration::from_micros(counts * 1_000_000 / u64::from(clock_hz) + 2);
            Timing::DShot(bit, time)
        }),
        EscProtocol::Pulse(pulse) => pulse.timing(clock_hz).map(|t| Timing::Pulse(pulse, t)),
    };
    match found {
        Some(timing) => timing,
        None => panic!("the motors' timer cannot make the protocol from {clock_hz} Hz"),
    }
}
