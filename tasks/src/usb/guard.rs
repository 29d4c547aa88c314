//! Wrapper of the chip's USB driver that protects the stack and the driver against misbehaving hosts.
//!
//! - The stack blocks while it waits for the host within a control transfer: each stage has a time-out here.
//! - The chip's driver panics on an endpoint number that it lacks, which any host may request: only this device's
//!   endpoints are passed on.
//! - The chip keeps an IN endpoint's enable bit over a bus reset, while the driver clears its packet memory: a packet
//!   that was pending when the cable was pulled would block the endpoint until a restart. A reset therefore disables
//!   each IN endpoint of this device.
//! - A suspension reported late would leave the stack waiting for resume and prevent enumeration: only the port
//!   receives it. The board has other supplies and does not save power for the host.

use embassy_time::{Duration, with_timeout};
use embassy_usb::driver::{
    Bus, ControlPipe, Direction, Driver, EndpointAddress, EndpointAllocError, EndpointError, EndpointInfo,
    EndpointType, Event, Unsupported,
};

use super::port::Port;

/// Time-out of a stage of a control transfer: hosts send the stages back to back (USB 2.0 §9.2.6.4 allows the device
/// the same time for each).
const STAGE: Duration = Duration::from_millis(500);

/// The chip's driver behind these protections.
pub(super) struct Guarded<'d, D> {
    driver: D,
    port: &'d Port,
    endpoints: Endpoints,
}

/// Bit mask of the device's endpoints without the control endpoint: IN above OUT.
#[derive(Clone, Copy, Default)]
struct Endpoints(u32);

impl Endpoints {
    fn bit(at: EndpointAddress) -> u32 {
        let above = match at.direction() {
            Direction::In => 16,
            Direction::Out => 0,
        };
        1 << (above + at.index() % 16)
    }

    fn has(self, at: EndpointAddress) -> bool {
        self.0 & Self::bit(at) != 0
    }

    /// The IN endpoints, with the control endpoint, which every chip has.
    fn inward(self) -> impl Iterator<Item = EndpointAddress> {
        (0..16)
            .map(|index| EndpointAddress::from_parts(index, Direction::In))
            .filter(move |at| at.index() == 0 || self.has(*at))
    }
}

impl<'d, D> Guarded<'d, D> {
    pub(super) fn new(driver: D, port: &'d Port) -> Self {
        Self {
            driver,
            port,
            endpoints: Endpoints::default(),
        }
    }

    fn note(&mut self, info: &EndpointInfo) {
        self.endpoints.0 |= Endpoints::bit(info.addr);
    }
}

impl<'d, D: Driver<'d> + 'd> Driver<'d> for Guarded<'d, D> {
    type EndpointOut = D::EndpointOut;
    type EndpointIn = D::EndpointIn;
    type ControlPipe = Bounded<D::ControlPipe>;
    type Bus = Watched<'d, D::Bus>;

    fn alloc_endpoint_out(
        &mut self,
        kind: EndpointType,
        at: Option<EndpointAddress>,
        packet: u16,
        interval_ms: u8,
    ) -> Result<Self::EndpointOut, EndpointAllocError> {
        use embassy_usb::driver::Endpoint;
        let endpoint = self.driver.alloc_endpoint_out(kind, at, packet, interval_ms)?;
        self.note(endpoint.info());
        Ok(endpoint)
    }

    fn alloc_endpoint_in(
        &mut self,
        kind: EndpointType,
        at: Option<EndpointAddress>,
        packet: u16,
        interval_ms: u8,
    ) -> Result<Self::EndpointIn, EndpointAllocError> {
        use embassy_usb::driver::Endpoint;
        let endpoint = self.driver.alloc_endpoint_in(kind, at, packet, interval_ms)?;
        self.note(endpoint.info());
        Ok(endpoint)
    }

    fn start(self, packet: u16) -> (Self::Bus, Self::ControlPipe) {
        let (bus, pipe) = self.driver.start(packet);
        let bus = Watched {
            bus,
            port: self.port,
            endpoints: self.endpoints,
        };
        (bus, Bounded(pipe))
    }
}

/// The bus as presented to the stack.
pub(super) struct Watched<'d, B> {
    bus: B,
    port: &'d Port,
    endpoints: Endpoints,
}

impl<B: Bus> Watched<'_, B> {
    /// Aborts pending IN transfers after a bus reset.
    ///
    /// The driver sets NAK and disable together, but the core disables only an endpoint that is already in NAK state
    /// (RM0090 §34.17.6, "IN endpoint disable"), and at a reset the driver omits the control endpoint. Two rounds are
    /// therefore needed: the first sets NAK, the second disables. The host sends no request within 10 ms of a reset
    /// (USB 2.0 §7.1.7.5).
    fn end_transfers(&mut self) {
        for _ in 0..2 {
            for at in self.endpoints.inward() {
                self.bus.endpoint_set_enabled(at, false);
            }
        }
    }
}

impl<B: Bus> Bus for Watched<'_, B> {
    async fn enable(&mut self) {
        self.bus.enable().await;
    }

    async fn disable(&mut self) {
        self.bus.disable().await;
    }

    async fn poll(&mut self) -> Event {
        loop {
            // A core with endless events must not occupy the background level. The yield precedes the event: the stack
            // cancels this call for a host request, which would lose an event already taken.
            embassy_futures::yield_now().await;
            let event = self.bus.poll().await;
            if event == Event::Reset {
                self.end_transfers();
            }
            match event {
                // A cable without a host is indistinguishable from suspension.
                Event::Suspend | Event::PowerRemoved => self.port.suspend(true),
                Event::Reset | Event::Resume => self.port.suspend(false),
                Event::PowerDetected => (),
            }
            if !matches!(event, Event::Resume | Event::PowerDetected) {
                self.port.close();
            }
            if event != Event::Suspend {
                return event;
            }
        }
    }

    fn endpoint_set_enabled(&mut self, at: EndpointAddress, enabled: bool) {
        if self.endpoints.has(at) {
            self.bus.endpoint_set_enabled(at, enabled);
        }
    }

    fn endpoint_set_stalled(&mut self, at: EndpointAddress, stalled: bool) {
        if self.endpoints.has(at) {
            self.bus.endpoint_set_stalled(at, stalled);
        }
    }

    fn endpoint_is_stalled(&mut self, at: EndpointAddress) -> bool {
        self.endpoints.has(at) && self.bus.endpoint_is_stalled(at)
    }

    fn force_reset(&mut self) -> Result<(), Unsupported> {
        self.bus.force_reset()
    }

    async fn remote_wakeup(&mut self) -> Result<(), Unsupported> {
        Err(Unsupported)
    }
}

/// The control pipe with time-outs.
pub(super) struct Bounded<P>(P);

impl<P: ControlPipe> ControlPipe for Bounded<P> {
    fn max_packet_size(&self) -> usize {
        self.0.max_packet_size()
    }

    async fn setup(&mut self) -> [u8; 8] {
        self.0.setup().await
    }

    async fn data_out(&mut self, buffer: &mut [u8], first: bool, last: bool) -> Result<usize, EndpointError> {
        let taken = with_timeout(STAGE, self.0.data_out(buffer, first, last)).await;
        taken.unwrap_or(Err(EndpointError::Disabled))
    }

    async fn data_in(&mut self, data: &[u8], first: bool, last: bool) -> Result<(), EndpointError> {
        let sent = with_timeout(STAGE, self.0.data_in(data, first, last)).await;
        sent.unwrap_or(Err(EndpointError::Disabled))
    }

    async fn accept(&mut self) {
        let _ = with_timeout(STAGE, self.0.accept()).await;
    }

    async fn reject(&mut self) {
        let _ = with_timeout(STAGE, self.0.reject()).await;
    }

    async fn accept_set_address(&mut self, address: u8) {
        let _ = with_timeout(STAGE, self.0.accept_set_address(address)).await;
    }
}
