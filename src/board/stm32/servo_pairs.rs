//! The tendon servos where no timer has four free channels: two on one timer, two on another.

use embassy_stm32::gpio::{Flex, OutputType};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};
use embassy_stm32::timer::{Ch1, Ch2, Ch3, Channel, GeneralInstance4Channel, TimerPin};
use embassy_stm32::{Peri, rcc};
use sophie_control::params::Params;
use sophie_control::wrench::PerArm;
use sophie_drivers::pwm_timing::PwmTiming;
use sophie_drivers::servo_pulse;
use sophie_tasks::ports::Servos;

use super::small_timer::SmallTimer;

/// Servos 1 and 2 on the channels 2 and 3 of one timer, servos 3 and 4 on the channels 1 and 2 of a small one.
pub struct ServoPairs<A: GeneralInstance4Channel, B: GeneralInstance4Channel> {
    first: SimplePwm<'static, A>,
    first_timing: PwmTiming,
    second: SmallTimer<B>,
    second_timing: PwmTiming,
    /// Kept, so that the pins stay the timer's.
    _pins: [Flex<'static>; 2],
}

impl<A: GeneralInstance4Channel, B: GeneralInstance4Channel> ServoPairs<A, B> {
    /// Servos on these pins without pulses, with the frames of the parameter `servo_frame_rate`.
    ///
    /// # Panics
    /// If the clock cannot make the frames: a board with such a clock never starts, so it is found at the bench.
    pub fn new(
        first: Peri<'static, A>,
        (one, two): (
            Peri<'static, impl TimerPin<A, Ch2>>,
            Peri<'static, impl TimerPin<A, Ch3>>,
        ),
        second: Peri<'static, B>,
        (three, four): (
            Peri<'static, impl TimerPin<B, Ch1>>,
            Peri<'static, impl TimerPin<B, Ch2>>,
        ),
        params: &Params,
    ) -> Self {
        let frame_hz = (params.servo_frame_rate + 0.5) as u32;
        let mut first = SimplePwm::new(
            first,
            None,
            Some(PwmPin::new(one, OutputType::PushPull)),
            Some(PwmPin::new(two, OutputType::PushPull)),
            None,
            Hertz(frame_hz),
            Default::default(),
        );
        for channel in [Channel::Ch2, Channel::Ch3] {
            let mut output = first.channel(channel);
            output.set_duty_cycle(0);
            output.enable();
        }
        let first_timing = PwmTiming::given(first.max_duty_cycle(), first.get_frequency().0 as f32);

        let Some(second_timing) = servo_pulse::timing(rcc::frequency::<B>().0, frame_hz) else {
            panic!("the servos' timer cannot make {frame_hz} Hz")
        };
        let mut second = SmallTimer::new(second, second_timing);
        let pins = [second.output(three), second.output(four)];
        Self {
            first,
            first_timing,
            second,
            second_timing,
            _pins: pins,
        }
    }
}

impl<A: GeneralInstance4Channel, B: GeneralInstance4Channel> Servos for ServoPairs<A, B> {
    async fn write(&mut self, [one, two, three, four]: PerArm<f32>) {
        // All preloaded: a new width takes effect with the next frame, never within a pulse.
        for (channel, pulse) in [(Channel::Ch2, one), (Channel::Ch3, two)] {
            self.first
                .channel(channel)
                .set_duty_cycle(servo_pulse::compare(&self.first_timing, pulse));
        }
        for (channel, pulse) in [(Channel::Ch1, three), (Channel::Ch2, four)] {
            self.second
                .set(channel, servo_pulse::compare(&self.second_timing, pulse));
        }
    }
}
