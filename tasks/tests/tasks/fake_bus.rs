//! A USB bus without wires: the chip's driver for the stack, the host's end for a script.
//!
//! As the chips' driver it panics at an endpoint that the device does not have, waits for a host that does not go on
//! with a control transfer, and holds one packet for each endpoint. As the chips' core (RM0090 §34.17.6) it keeps an IN
//! endpoint's enable bit over a reset of the bus, which empties the packet memory alone, and obeys an order to disable
//! one only where it has sent NAK before.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::future::poll_fn;
use std::rc::Rc;
use std::task::{Poll, Waker};

use embassy_usb::driver::{
    Bus, ControlPipe, Direction, Driver, Endpoint, EndpointAddress, EndpointAllocError, EndpointError,
    EndpointIn, EndpointInfo, EndpointOut, EndpointType, Event, Unsupported,
};

/// Endpoints that a chip has in each direction: the F405, which has the fewest.
const ENDPOINTS: usize = 4;

/// The control endpoint, towards the host.
const CONTROL_IN: u8 = 0x80;

/// How the device took a control request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    Accepted,
    Stalled,
}

#[derive(Default)]
struct Wires {
    events: VecDeque<Event>,
    setup: Option<[u8; 8]>,
    /// Data stage from the host, packet by packet.
    control_out: VecDeque<Vec<u8>>,
    /// Data stage to the host; it fetches nothing where it is `absent`.
    control_in: Vec<u8>,
    absent: bool,
    status: Option<Status>,
    address: u8,
    enabled: BTreeSet<u8>,
    stalled: BTreeSet<u8>,
    endpoints: BTreeMap<u8, EndpointInfo>,
    out: VecDeque<Vec<u8>>,
    to_host: BTreeMap<u8, Vec<u8>>,
    /// IN endpoints whose enable bit is set: nothing more is taken from the device until the host has fetched what it had.
    sending: BTreeSet<u8>,
    /// IN endpoints that send NAK.
    refusing: BTreeSet<u8>,
    wakers: Vec<Waker>,
    /// Polls of the bus: what the device costs.
    polls: u32,
}

/// Both ends of the bus.
#[derive(Clone, Default)]
pub struct FakeBus(Rc<RefCell<Wires>>);

impl FakeBus {
    fn change<R>(&self, change: impl FnOnce(&mut Wires) -> R) -> R {
        let (result, wakers) = {
            let mut wires = self.0.borrow_mut();
            (change(&mut wires), std::mem::take(&mut wires.wakers))
        };
        wakers.into_iter().for_each(Waker::wake);
        result
    }

    /// Waits on the device's side until `look` gives something.
    async fn until<R>(&self, mut look: impl FnMut(&mut Wires) -> Option<R>) -> R {
        poll_fn(|context| {
            let mut wires = self.0.borrow_mut();
            match look(&mut wires) {
                Some(result) => {
                    let wakers = std::mem::take(&mut wires.wakers);
                    drop(wires);
                    wakers.into_iter().for_each(Waker::wake);
                    Poll::Ready(result)
                }
                None => {
                    wires.wakers.push(context.waker().clone());
                    Poll::Pending
                }
            }
        })
        .await
    }

    /// What happens on the bus.
    pub fn event(&self, event: Event) {
        self.change(|wires| {
            if event == Event::Reset {
                wires.enabled.clear();
                wires.stalled.clear();
                wires.address = 0;
                wires.out.clear();
                // `sending` stays; the driver has all but the control endpoint send NAK.
                wires.to_host.clear();
                wires.refusing = wires.endpoints.keys().copied().collect();
            }
            wires.events.push_back(event);
        });
    }

    /// Begins a control transfer, with its data stage where it has one towards the device.
    pub fn setup(&self, setup: [u8; 8], data: &[u8]) {
        self.change(|wires| {
            wires.setup = Some(setup);
            wires.control_out = data.chunks(64).map(<[u8]>::to_vec).collect();
            wires.control_in.clear();
            wires.status = None;
        });
    }

    /// From here on the host does not go on with control transfers, or does.
    pub fn absent(&self, absent: bool) {
        self.change(|wires| {
            wires.absent = absent;
            wires.fetch_control();
        });
    }

    /// How the control transfer has ended, and what came.
    pub fn answer(&self) -> (Option<Status>, Vec<u8>) {
        let wires = self.0.borrow();
        (wires.status, wires.control_in.clone())
    }

    /// The endpoints that the device has asked for.
    pub fn endpoints(&self) -> Vec<EndpointInfo> {
        self.0.borrow().endpoints.values().copied().collect()
    }

    pub fn is_enabled(&self, at: u8) -> bool {
        self.0.borrow().enabled.contains(&at)
    }

    pub fn is_stalled(&self, at: u8) -> bool {
        self.0.borrow().stalled.contains(&at)
    }

    pub fn address(&self) -> u8 {
        self.0.borrow().address
    }

    pub fn polls(&self) -> u32 {
        self.0.borrow().polls
    }

    /// Sends a packet to the bulk endpoint.
    pub fn send(&self, packet: &[u8]) {
        assert!(packet.len() <= 64);
        self.change(|wires| wires.out.push_back(packet.to_vec()));
    }

    /// Packets that the device has not taken.
    pub fn held_back(&self) -> usize {
        self.0.borrow().out.len()
    }

    /// A packet waits for the host at endpoint `at`.
    pub fn has_packet(&self, at: u8) -> bool {
        self.0.borrow().to_host.contains_key(&at)
    }

    /// Fetches what the device has for the host at endpoint `at`.
    pub fn fetch(&self, at: u8) -> Option<Vec<u8>> {
        self.change(|wires| wires.fetch(at))
    }
}

impl Wires {
    fn fetch(&mut self, at: u8) -> Option<Vec<u8>> {
        let packet = self.to_host.remove(&at)?;
        self.sending.remove(&at);
        Some(packet)
    }

    fn fetch_control(&mut self) {
        if !self.absent {
            let packet = self.fetch(CONTROL_IN);
            self.control_in.extend(packet.unwrap_or_default());
        }
    }

    /// Takes a packet for the host, if the one before has been fetched.
    fn load(&mut self, at: u8, bytes: &[u8]) -> Option<()> {
        let free = self.sending.insert(at);
        free.then(|| {
            self.refusing.remove(&at);
            self.to_host.insert(at, bytes.to_vec());
        })
    }

    fn disable(&mut self, at: u8) {
        self.to_host.remove(&at);
        if !self.refusing.insert(at) {
            self.sending.remove(&at);
        }
    }
}

impl Driver<'_> for FakeBus {
    type EndpointOut = FakeEndpoint;
    type EndpointIn = FakeEndpoint;
    type ControlPipe = FakePipe;
    type Bus = FakeBus;

    fn alloc_endpoint_out(
        &mut self,
        kind: EndpointType,
        at: Option<EndpointAddress>,
        packet: u16,
        interval_ms: u8,
    ) -> Result<FakeEndpoint, EndpointAllocError> {
        self.allocate(Direction::Out, kind, at, packet, interval_ms)
    }

    fn alloc_endpoint_in(
        &mut self,
        kind: EndpointType,
        at: Option<EndpointAddress>,
        packet: u16,
        interval_ms: u8,
    ) -> Result<FakeEndpoint, EndpointAllocError> {
        self.allocate(Direction::In, kind, at, packet, interval_ms)
    }

    fn start(self, packet: u16) -> (FakeBus, FakePipe) {
        assert_eq!(packet, 64);
        (self.clone(), FakePipe(self))
    }
}

impl FakeBus {
    fn allocate(
        &self,
        direction: Direction,
        ep_type: EndpointType,
        at: Option<EndpointAddress>,
        max_packet_size: u16,
        interval_ms: u8,
    ) -> Result<FakeEndpoint, EndpointAllocError> {
        assert_eq!(at, None);
        self.change(|wires| {
            let addr = (1..ENDPOINTS)
                .map(|index| EndpointAddress::from_parts(index, direction))
                .find(|addr| !wires.endpoints.contains_key(&u8::from(*addr)))
                .ok_or(EndpointAllocError)?;
            let info = EndpointInfo {
                addr,
                ep_type,
                max_packet_size,
                interval_ms,
            };
            wires.endpoints.insert(addr.into(), info);
            Ok(FakeEndpoint {
                bus: self.clone(),
                info,
            })
        })
    }

    fn check(at: EndpointAddress) {
        assert!(at.index() < ENDPOINTS, "endpoint {} is out of range", at.index());
    }
}

impl Bus for FakeBus {
    async fn enable(&mut self) {}

    async fn disable(&mut self) {}

    async fn poll(&mut self) -> Event {
        self.until(|wires| {
            wires.polls += 1;
            wires.events.pop_front()
        })
        .await
    }

    fn endpoint_set_enabled(&mut self, at: EndpointAddress, enabled: bool) {
        Self::check(at);
        self.change(|wires| {
            if enabled {
                wires.enabled.insert(at.into());
            } else {
                wires.enabled.remove(&at.into());
                if at.direction() == Direction::In {
                    wires.disable(at.into());
                }
            }
        });
    }

    fn endpoint_set_stalled(&mut self, at: EndpointAddress, stalled: bool) {
        Self::check(at);
        self.change(|wires| {
            if stalled {
                wires.stalled.insert(at.into());
            } else {
                wires.stalled.remove(&at.into());
            }
        });
    }

    fn endpoint_is_stalled(&mut self, at: EndpointAddress) -> bool {
        Self::check(at);
        self.is_stalled(at.into())
    }

    async fn remote_wakeup(&mut self) -> Result<(), Unsupported> {
        Err(Unsupported)
    }
}

pub struct FakeEndpoint {
    bus: FakeBus,
    info: EndpointInfo,
}

impl FakeEndpoint {
    fn at(&self) -> u8 {
        self.info.addr.into()
    }
}

impl Endpoint for FakeEndpoint {
    fn info(&self) -> &EndpointInfo {
        &self.info
    }

    async fn wait_enabled(&mut self) {
        let at = self.at();
        self.bus
            .until(|wires| wires.enabled.contains(&at).then_some(()))
            .await;
    }
}

impl EndpointOut for FakeEndpoint {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, EndpointError> {
        let at = self.at();
        self.bus
            .until(|wires| {
                if !wires.enabled.contains(&at) {
                    return Some(Err(EndpointError::Disabled));
                }
                let packet = wires.out.front()?;
                if packet.len() > buffer.len() {
                    return Some(Err(EndpointError::BufferOverflow));
                }
                let packet = wires.out.pop_front()?;
                buffer[..packet.len()].copy_from_slice(&packet);
                Some(Ok(packet.len()))
            })
            .await
    }
}

impl EndpointIn for FakeEndpoint {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), EndpointError> {
        let at = self.at();
        assert!(bytes.len() <= usize::from(self.info.max_packet_size));
        self.bus
            .until(|wires| {
                if !wires.enabled.contains(&at) {
                    return Some(Err(EndpointError::Disabled));
                }
                wires.load(at, bytes).map(Ok)
            })
            .await
    }
}

pub struct FakePipe(FakeBus);

impl ControlPipe for FakePipe {
    fn max_packet_size(&self) -> usize {
        64
    }

    async fn setup(&mut self) -> [u8; 8] {
        self.0.until(|wires| wires.setup.take()).await
    }

    async fn data_out(
        &mut self,
        buffer: &mut [u8],
        _first: bool,
        _last: bool,
    ) -> Result<usize, EndpointError> {
        let packet = self.0.until(|wires| wires.control_out.pop_front()).await;
        buffer[..packet.len()].copy_from_slice(&packet);
        Ok(packet.len())
    }

    async fn data_in(&mut self, data: &[u8], _first: bool, last: bool) -> Result<(), EndpointError> {
        self.send(data).await;
        if last {
            // The host's empty packet follows what it has fetched.
            self.0
                .until(|wires| (!wires.absent && !wires.to_host.contains_key(&CONTROL_IN)).then_some(()))
                .await;
            self.0.change(|wires| wires.status = Some(Status::Accepted));
        }
        Ok(())
    }

    async fn accept(&mut self) {
        self.send(&[]).await;
        self.0.change(|wires| wires.status = Some(Status::Accepted));
    }

    async fn reject(&mut self) {
        self.0.change(|wires| wires.status = Some(Status::Stalled));
    }

    async fn accept_set_address(&mut self, address: u8) {
        self.0.change(|wires| wires.address = address);
        self.accept().await;
    }
}

impl FakePipe {
    async fn send(&self, packet: &[u8]) {
        self.0.until(|wires| wires.load(CONTROL_IN, packet)).await;
        self.0.change(Wires::fetch_control);
    }
}
