//! The tendon servos where no timer has four free channels: two on TIM4, two on TIM12.

use embassy_stm32::gpio::{AfType, Flex, OutputType, Speed};
use embassy_stm32::pac::timer::vals::Ocm;
use embassy_stm32::peripherals::{PH6, PH9, TIM4, TIM12};
use embassy_stm32::timer::low_level::Timer;
use embassy_stm32::timer::simple_pwm::SimplePwm;
use embassy_stm32::timer::{Ch1, Ch2, Channel, TimerPin};
use embassy_stm32::{Peri, rcc};
use sophie_control::wrench::PerArm;
use sophie_drivers::pwm_timing::PwmTiming;
use sophie_drivers::servo_pulse;
use sophie_tasks::ports::Servos;

/// Frames a second, Hz.
const FRAME_HZ: u32 = 50;

/// Servos 1 and 2 on the channels 2 and 3 of TIM4, servos 3 and 4 on the channels 1 and 2 of TIM12.
pub struct ServoPairs {
    first: SimplePwm<'static, TIM4>,
    first_timing: PwmTiming,
    second: Timer<'static, TIM12>,
    second_timing: PwmTiming,
    /// Kept, so that the pins stay the timer's.
    _pins: [Flex<'static>; 2],
}

impl ServoPairs {
    /// Servos without pulses. embassy-stm32's `SimplePwm` wants four channels, and TIM12 has two.
    ///
    /// # Panics
    /// If the clock cannot make 50 Hz: a board with such a clock never starts, so it is found at the bench.
    pub fn new(
        mut first: SimplePwm<'static, TIM4>,
        second: Peri<'static, TIM12>,
        servo_3: Peri<'static, PH6>,
        servo_4: Peri<'static, PH9>,
    ) -> Self {
        for channel in [Channel::Ch2, Channel::Ch3] {
            let mut output = first.channel(channel);
            output.set_duty_cycle(0);
            output.enable();
        }
        let first_timing = PwmTiming::given(first.max_duty_cycle(), first.get_frequency().0 as f32);

        let Some(second_timing) = servo_pulse::timing(rcc::frequency::<TIM12>().0, FRAME_HZ) else {
            panic!("the servos' timer cannot make {FRAME_HZ} Hz")
        };
        let second = Timer::new(second);
        let registers = second.regs_2ch();
        registers.psc().write_value(second_timing.prescaler);
        registers
            .arr()
            .write(|w| w.set_arr((second_timing.period - 1) as u16));
        for channel in 0..2 {
            registers.ccmr_output(0).modify(|w| {
                w.set_ocm(channel, Ocm::PWM_MODE1);
                w.set_ocpe(channel, true);
            });
            registers.ccr(channel).write(|w| w.set_ccr(0));
            registers.ccer().modify(|w| w.set_cce(channel, true));
        }
        // Takes prescaler, period and compare values over.
        second.generate_update_event();
        second.start();
        let three = (TimerPin::<TIM12, Ch1>::af_num(&*servo_3), Flex::new(servo_3));
        let four = (TimerPin::<TIM12, Ch2>::af_num(&*servo_4), Flex::new(servo_4));
        let pins = [three, four].map(|(function, mut pin)| {
            pin.set_as_af_unchecked(function, AfType::output(OutputType::PushPull, Speed::Low));
            pin
        });
        Self {
            first,
            first_timing,
            second,
            second_timing,
            _pins: pins,
        }
    }
}

impl Servos for ServoPairs {
    async fn write(&mut self, [one, two, three, four]: PerArm<f32>) {
        // All preloaded: a new width takes effect with the next frame, never within a pulse.
        for (channel, pulse) in [(Channel::Ch2, one), (Channel::Ch3, two)] {
            self.first
                .channel(channel)
                .set_duty_cycle(servo_pulse::compare(&self.first_timing, pulse));
        }
        for (channel, pulse) in [three, four].into_iter().enumerate() {
            let counts = servo_pulse::compare(&self.second_timing, pulse);
            self.second
                .regs_2ch()
                .ccr(channel)
                .write(|w| w.set_ccr(counts as u16));
        }
    }
}
