//! The tendon servos: four channels of one timer.

use embassy_stm32::Peri;
use embassy_stm32::gpio::OutputType;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};
use embassy_stm32::timer::{Ch1, Ch2, Ch3, Ch4, Channel, GeneralInstance4Channel, TimerPin};
use sophie_control::params::Params;
use sophie_control::wrench::PerArm;
use sophie_drivers::pwm_timing::PwmTiming;
use sophie_drivers::servo_pulse;
use sophie_tasks::ports::Servos;

/// The channels in the order of the servos.
const SERVOS: [Channel; 4] = [Channel::Ch1, Channel::Ch2, Channel::Ch3, Channel::Ch4];

/// Four servos on the channels 1 to 4 of a timer.
pub struct ServoTimer<T: GeneralInstance4Channel> {
    pwm: SimplePwm<'static, T>,
    timing: PwmTiming,
}

impl<T: GeneralInstance4Channel> ServoTimer<T> {
    /// Servos on these pins without pulses, with the frames of the parameter `servo_frame_rate`.
    pub fn new(
        timer: Peri<'static, T>,
        (one, two, three, four): (
            Peri<'static, impl TimerPin<T, Ch1>>,
            Peri<'static, impl TimerPin<T, Ch2>>,
            Peri<'static, impl TimerPin<T, Ch3>>,
            Peri<'static, impl TimerPin<T, Ch4>>,
        ),
        params: &Params,
    ) -> Self {
        let push_pull = OutputType::PushPull;
        let mut pwm = SimplePwm::new(
            timer,
            Some(PwmPin::new(one, push_pull)),
            Some(PwmPin::new(two, push_pull)),
            Some(PwmPin::new(three, push_pull)),
            Some(PwmPin::new(four, push_pull)),
            Hertz((params.servo_frame_rate + 0.5) as u32),
            Default::default(),
        );
        let timing = PwmTiming::given(pwm.max_duty_cycle(), pwm.get_frequency().0 as f32);
        for channel in SERVOS {
            let mut output = pwm.channel(channel);
            output.set_duty_cycle(0);
            output.enable();
        }
        Self { pwm, timing }
    }
}

impl<T: GeneralInstance4Channel> Servos for ServoTimer<T> {
    async fn write(&mut self, pulses_us: PerArm<f32>) {
        for (channel, pulse) in SERVOS.into_iter().zip(pulses_us) {
            // Preloaded: a new width takes effect with the next frame, never within a pulse.
            self.pwm
                .channel(channel)
                .set_duty_cycle(servo_pulse::compare(&self.timing, pulse));
        }
    }
}
