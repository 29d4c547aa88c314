//! A driver between the USB stack and the chip's, for what a host may do to both.
//!
//! - The stack looks at nothing else while it waits for a host in a control transfer: one that is never finished ends in
//!   time here.
//! - The chip's driver panics at an endpoint that it does not have, which any host may ask for: others than those of this
//!   device do not get to it.
//! - The chip keeps an IN endpoint's enable bit over a reset of the bus, while the driver empties its packet memory: a
//!   packet that the host did not fetch before its cable was pulled would be waited for until a restart. Each of this
//!   device's is disabled at a reset.
//! - A suspension that was noticed late would keep a stack that waits for the bus to resume from being enumerated: it is
//!   told to the port alone. The board has other supplies and does not save power for the host.

use embassy_time::{Duration, with_timeout};
use embassy_usb::driver::{
    Bus, ControlPipe, Direction, Driver, EndpointAddress, EndpointAllocError, EndpointError, EndpointInfo,
    EndpointType, Event, Unsupported,
};

use super::port::Port;

/// Time that a host has for a stage of a control transfer: it sends a device all of them at once (USB 2.0 §9.2.6.4 gives
/// the device as long for each).
const STAGE: Duration = Duration::from_millis(500);

/// The chip's driver, with what it must not see kept away.
pub(super) struct Guarded<'d, D> {
    driver: D,
    port: &'d Port,
    endpoints: Endpoints,
}

/// The device's endpoints beside the control endpoint, a bit each: IN above OUT.
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

    /// Those towards the host, with the control endpoint, which a chip has always.
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

/// The bus, as the stack may see it.
pub(super) struct Watched<'d, B> {
    bus: B,
    port: &'d Port,
    endpoints: Endpoints,
}

impl<B: Bus> Watched<'_, B> {
    /// Ends what was being sent before a reset of the bus.
    ///
    /// The driver orders NAK and the end at once, but the core only ends what has sent NAK before (RM0090 §34.17.6, "IN
    /// endpoint disable"), and at a reset the driver does not order it for the control endpoint: the second round ends
    /// what the first has made ready. The host asks for nothing within 10 ms of a reset (USB 2.0 §7.1.7.5).
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
            // A core that reports without end must not take the background. Before the event: the stack drops this call for
            // a request of the host, and an event with it.
            embassy_futures::yield_now().await;
            let event = self.bus.poll().await;
            if event == Event::Reset {
                self.end_transfers();
            }
            match event {
                // A cable without a host looks the same.
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

/// The control pipe, whose waits end.
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
