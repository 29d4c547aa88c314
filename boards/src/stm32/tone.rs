//! A passive sounder.

use embassy_stm32::gpio::Flex;
use embassy_stm32::timer::{Ch1, Channel, GeneralInstance4Channel, TimerPin};
use embassy_stm32::{Peri, rcc};
use sophie_drivers::pwm_timing::PwmTiming;

use super::lights::Switch;
use super::pulse_timer::PulseTimer;

/// Wave period, µs: about 2.7 kHz, where such sounders are loudest.
const WAVE_US: u32 = 370;

/// A sounder on a timer's first channel.
pub struct Tone<T: GeneralInstance4Channel> {
    timer: PulseTimer<T>,
    /// Counts of half a wave.
    half: u32,
    /// Held to own the pin.
    _pin: Flex<'static>,
}

impl<T: GeneralInstance4Channel> Tone<T> {
    /// The sounder on `pin`, silent.
    ///
    /// # Panics
    /// If the clock cannot make the tone: such a board never starts, so the bench finds it.
    pub fn new(timer: Peri<'static, T>, pin: Peri<'static, impl TimerPin<T, Ch1>>) -> Self {
        let Some(timing) = PwmTiming::new(rcc::frequency::<T>().0, WAVE_US) else {
            panic!("the sounder's timer cannot make waves of {WAVE_US} us")
        };
        let mut timer = PulseTimer::new(timer, timing);
        let pin = timer.output(pin);
        Self {
            timer,
            half: timing.period / 2,
            _pin: pin,
        }
    }
}

impl<T: GeneralInstance4Channel> Switch for Tone<T> {
    fn set(&mut self, on: bool) {
        self.timer.set(Channel::Ch1, if on { self.half } else { 0 });
    }
}
