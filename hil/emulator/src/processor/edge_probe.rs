//! A timer with recorded output edges.

use rigless::device::{Device, DeviceContext, Level, RegisterFile, RequestChange};
use rigless::soc::RegisterSpec;
use rigless::soc::stm32h743::peripherals::tim::{Channel, Family, Tim};
use rigless::time::{EventId, VirtualNanos};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Emulated time, ns.
    pub at: u64,
    /// Channel, 0 to 3.
    pub channel: usize,
    /// New level; an undriven pin is low.
    pub high: bool,
}

#[derive(Debug)]
pub struct EdgeProbe<F: Family> {
    tim: Tim<F>,
    make: fn() -> Tim<F>,
    high: [bool; 4],
    pub edges: Vec<Edge>,
}

impl<F: Family> EdgeProbe<F> {
    /// The timer made by `make`, now and after each reset.
    pub fn new(make: fn() -> Tim<F>) -> Self {
        Self {
            tim: make(),
            make,
            high: [false; 4],
            edges: Vec::new(),
        }
    }

    /// Resets the timer; its outputs fall.
    pub fn restart(&mut self, at: VirtualNanos) {
        self.tim = (self.make)();
        for channel in 0..4 {
            self.set(at, channel, false);
        }
    }

    pub fn is_high(&self, channel: usize) -> bool {
        self.high[channel]
    }

    fn record(&mut self, file: &RegisterFile, now: VirtualNanos) {
        for channel in 0..4 {
            let Some(number) = Channel::new(channel as u8 + 1) else {
                continue;
            };
            let high = self.tim.output(number, file) == Some(Level::High);
            self.set(now, channel, high);
        }
    }

    fn set(&mut self, now: VirtualNanos, channel: usize, high: bool) {
        if std::mem::replace(&mut self.high[channel], high) != high {
            self.edges.push(Edge {
                at: now.0,
                channel,
                high,
            });
        }
    }
}

impl<F: Family> Device for EdgeProbe<F>
where
    Tim<F>: Device,
{
    type Register = <Tim<F> as Device>::Register;

    fn layout(&self) -> &'static [RegisterSpec] {
        Device::layout(&self.tim)
    }

    fn read(&mut self, r: Self::Register, file: &mut RegisterFile, c: &mut DeviceContext<'_>) -> Option<u64> {
        self.tim.read(r, file, c)
    }

    fn peek(&self, r: Self::Register, file: &RegisterFile, now: VirtualNanos) -> Option<u64> {
        self.tim.peek(r, file, now)
    }

    fn write(&mut self, r: Self::Register, value: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.tim.write(r, value, file, c);
        self.record(file, c.now());
    }

    fn on_event(&mut self, event: EventId, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.tim.on_event(event, file, c);
        self.record(file, c.now());
    }

    // As in [`super::ignore_dma::IgnoreDma`]: a burst through DMAR serves its request itself.
    fn on_request(&mut self, _: RequestChange, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {}

    fn on_clock(&mut self, hz: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.tim.on_clock(hz, file, c);
    }

    fn reset(&mut self) {
        self.tim.reset();
    }

    fn reset_line(&mut self, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.tim.reset_line(file, c);
        self.record(file, c.now());
    }
}
