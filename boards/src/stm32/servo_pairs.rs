//! Tendon servos on two timers, where no timer has four free channels.

use embassy_stm32::Peri;
use embassy_stm32::gpio::Flex;
use embassy_stm32::timer::{Channel, GeneralInstance4Channel, TimerChannel, TimerPin};
use embassy_time::Instant;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::params::Params;
use sophie_drivers::pwm_timing::PwmTiming;
use sophie_drivers::servo_pulse;
use sophie_ports::actuators::Servos;

use super::pulse_timer::PulseTimer;
use super::servos::timer_with_frames;

struct Pair<T: GeneralInstance4Channel> {
    timer: PulseTimer<T>,
    timing: PwmTiming,
    channels: [Channel; 2],
    /// Held to own the pins.
    _pins: [Flex<'static>; 2],
}

impl<T: GeneralInstance4Channel> Pair<T> {
    fn new<C1: TimerChannel, C2: TimerChannel>(
        timer: Peri<'static, T>,
        (one, two): (
            Peri<'static, impl TimerPin<T, C1>>,
            Peri<'static, impl TimerPin<T, C2>>,
        ),
        params: &Params,
    ) -> Self {
        const {
            assert!(
                C1::CHANNEL as u32 != C2::CHANNEL as u32,
                "two servos are on one channel of a timer"
            );
        }
        let (mut timer, timing) = timer_with_frames(timer, params);
        let pins = [timer.output(one), timer.output(two)];
        Self {
            timer,
            timing,
            channels: [C1::CHANNEL, C2::CHANNEL],
            _pins: pins,
        }
    }

    /// Sets both pulses, µs; returns when they first begin.
    fn set(&mut self, pulses_us: [f32; 2]) -> Instant {
        for (channel, pulse) in self.channels.into_iter().zip(pulses_us) {
            self.timer.set(channel, servo_pulse::compare(&self.timing, pulse));
        }
        self.timer.next_frame(&self.timing)
    }
}

/// Servos 1 and 2 on one timer, 3 and 4 on another.
pub struct ServoPairs<A: GeneralInstance4Channel, B: GeneralInstance4Channel> {
    first: Pair<A>,
    second: Pair<B>,
}

impl<A: GeneralInstance4Channel, B: GeneralInstance4Channel> ServoPairs<A, B> {
    /// Servos on these pins, without pulses, at `servo_frame_rate`. The pins determine the channels, in any order; two
    /// of one channel do not build.
    ///
    /// # Panics
    /// As [`timer_with_frames`].
    pub fn new<C1: TimerChannel, C2: TimerChannel, C3: TimerChannel, C4: TimerChannel>(
        first: Peri<'static, A>,
        one_two: (
            Peri<'static, impl TimerPin<A, C1>>,
            Peri<'static, impl TimerPin<A, C2>>,
        ),
        second: Peri<'static, B>,
        three_four: (
            Peri<'static, impl TimerPin<B, C3>>,
            Peri<'static, impl TimerPin<B, C4>>,
        ),
        params: &Params,
    ) -> Self {
        Self {
            first: Pair::new(first, one_two, params),
            second: Pair::new(second, three_four, params),
        }
    }
}

impl<A: GeneralInstance4Channel, B: GeneralInstance4Channel> Servos for ServoPairs<A, B> {
    async fn write(&mut self, [one, two, three, four]: PerArm<f32>) -> Instant {
        let [first, second] = [self.first.set([one, two]), self.second.set([three, four])];
        first.max(second)
    }
}
