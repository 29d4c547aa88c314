//! Tendon servos on four channels of one timer.

use embassy_stm32::gpio::Flex;
use embassy_stm32::timer::{Ch1, Ch2, Ch3, Ch4, Channel, GeneralInstance4Channel, TimerPin};
use embassy_stm32::{Peri, rcc};
use embassy_time::Instant;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::params::Params;
use sophie_drivers::pwm_timing::PwmTiming;
use sophie_drivers::servo_pulse;
use sophie_ports::actuators::Servos;
use sophie_tasks::perching::servos;

use super::pulse_timer::PulseTimer;

const SERVOS: [Channel; 4] = [Channel::Ch1, Channel::Ch2, Channel::Ch3, Channel::Ch4];

/// `timer` with frames at `servo_frame_rate`, starting at [`servos::FRAME_AT`] of the board's clock.
///
/// # Panics
/// If the timer's clock cannot make the frames: such a board never starts, so the bench finds it.
pub(super) fn timer_with_frames<T: GeneralInstance4Channel>(
    timer: Peri<'static, T>,
    params: &Params,
) -> (PulseTimer<T>, PwmTiming) {
    let frame = servos::period(params.servo_frame_rate);
    let Some(timing) = servo_pulse::timing(rcc::frequency::<T>().0, frame.as_micros() as u32) else {
        panic!(
            "a timer of the servos cannot make frames of {} us",
            frame.as_micros()
        )
    };
    let mut timer = PulseTimer::new(timer, timing);
    timer.put_frames_at(&timing, frame, servos::FRAME_AT);
    (timer, timing)
}

/// Four servos on channels 1 to 4 of a timer.
pub struct ServoTimer<T: GeneralInstance4Channel> {
    timer: PulseTimer<T>,
    timing: PwmTiming,
    /// Held to own the pins.
    _pins: [Flex<'static>; 4],
}

impl<T: GeneralInstance4Channel> ServoTimer<T> {
    /// Servos on these pins, without pulses, at `servo_frame_rate`.
    ///
    /// # Panics
    /// As [`timer_with_frames`].
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
        let (mut timer, timing) = timer_with_frames(timer, params);
        let pins = [
            timer.output(one),
            timer.output(two),
            timer.output(three),
            timer.output(four),
        ];
        Self {
            timer,
            timing,
            _pins: pins,
        }
    }
}

impl<T: GeneralInstance4Channel> Servos for ServoTimer<T> {
    async fn write(&mut self, pulses_us: PerArm<f32>) -> Instant {
        for (channel, pulse) in SERVOS.into_iter().zip(pulses_us) {
            self.timer.set(channel, servo_pulse::compare(&self.timing, pulse));
        }
        self.timer.next_frame(&self.timing)
    }
}
