//! A timer that ignores DMA requests.

use rigless::device::{Device, DeviceContext, RegisterFile, RequestChange};
use rigless::soc::RegisterSpec;
use rigless::soc::stm32h743::peripherals::tim::{Family, Tim};
use rigless::time::{EventId, VirtualNanos};

/// Every model receives every request; a timer's look-up takes a third of the run's time. A timer without requests, or
/// served by the burst register, may ignore them.
#[derive(Debug)]
pub struct IgnoreDma<F: Family>(pub Tim<F>);

impl<F: Family> Device for IgnoreDma<F>
where
    Tim<F>: Device,
{
    type Register = <Tim<F> as Device>::Register;

    fn layout(&self) -> &'static [RegisterSpec] {
        Device::layout(&self.0)
    }

    fn read(&mut self, r: Self::Register, file: &mut RegisterFile, c: &mut DeviceContext<'_>) -> Option<u64> {
        self.0.read(r, file, c)
    }

    fn peek(&self, r: Self::Register, file: &RegisterFile, now: VirtualNanos) -> Option<u64> {
        self.0.peek(r, file, now)
    }

    fn write(&mut self, r: Self::Register, value: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.0.write(r, value, file, c);
    }

    fn on_event(&mut self, event: EventId, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.0.on_event(event, file, c);
    }

    fn on_request(&mut self, _: RequestChange, _: &mut RegisterFile, _: &mut DeviceContext<'_>) {}

    fn on_clock(&mut self, hz: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.0.on_clock(hz, file, c);
    }

    fn reset(&mut self) {
        self.0.reset();
    }

    fn reset_line(&mut self, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.0.reset_line(file, c);
    }
}
