//! Pulses on any of a timer's channels; embassy-stm32's `SimplePwm` requires four.

use embassy_stm32::Peri;
use embassy_stm32::gpio::{AfType, Flex, OutputType, Speed};
use embassy_stm32::timer::low_level::{OutputCompareMode, Timer};
use embassy_stm32::timer::{Channel, GeneralInstance4Channel, TimerChannel, TimerPin};
use embassy_time::{Duration, Instant};
use sophie_drivers::pwm_timing::PwmTiming;
use sophie_tasks::deadline::begins_next;

/// A running timer, outputs low until set; channels without a pin are untouched.
pub struct PulseTimer<T: GeneralInstance4Channel> {
    timer: Timer<'static, T>,
}

impl<T: GeneralInstance4Channel> PulseTimer<T> {
    /// With the frame of `timing`.
    pub fn new(timer: Peri<'static, T>, timing: PwmTiming) -> Self {
        let timer = Timer::new(timer);
        let registers = timer.regs_gp16();
        registers.psc().write_value(timing.prescaler);
        // `PwmTiming` is for 16 bits: period - 1 fits.
        registers.arr().write(|w| w.set_arr((timing.period - 1) as u16));
        timer.generate_update_event();
        timer.enable_outputs();
        timer.start();
        Self { timer }
    }

    /// Shifts the frames so that one in each `frame` begins at `phase` of the board's clock. Called before the outputs
    /// start, as it would change a pulse.
    pub fn put_frames_at(&mut self, timing: &PwmTiming, frame: Duration, phase: Duration) {
        critical_section::with(|_| {
            let now = Instant::now();
            let left = begins_next(now, frame, phase) - now;
            let passed = (frame - left).as_micros() % frame.as_micros().max(1);
            let counts = timing.passed(passed as u32);
            self.timer.regs_gp16().cnt().write(|w| w.set_cnt(counts as u16));
        });
    }

    /// Makes `pin` its channel's output while the returned value lives.
    pub fn output<C: TimerChannel>(&mut self, pin: Peri<'static, impl TimerPin<T, C>>) -> Flex<'static> {
        let channel = C::CHANNEL;
        self.set(channel, 0);
        self.timer
            .set_output_compare_mode(channel, OutputCompareMode::PwmMode1);
        // Preloaded: a new width takes effect at the next frame.
        self.timer.set_output_compare_preload(channel, true);
        self.timer.enable_channel(channel, true);
        let function = pin.af_num();
        let mut pin = Flex::new(pin);
        pin.set_as_af_unchecked(function, AfType::output(OutputType::PushPull, Speed::Low));
        pin
    }

    /// Sets a channel's pulses to `counts`; 0: none.
    pub fn set(&mut self, channel: Channel, counts: u32) {
        let registers = self.timer.regs_gp16();
        registers.ccr(channel.index()).write(|w| w.set_ccr(counts as u16));
    }

    /// Start of the next frame, to the microsecond, when the last set pulses take effect; late by one if a frame begins
    /// between setting and this call.
    pub fn next_frame(&self, timing: &PwmTiming) -> Instant {
        let passed = self.timer.regs_gp16().cnt().read().cnt();
        Instant::now() + Duration::from_micros(timing.left_us(u32::from(passed)).into())
    }
}
