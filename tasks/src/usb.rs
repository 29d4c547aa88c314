//! USB: one serial port (CDC-ACM) that carries the console and MAVLink, whichever arrives.
//!
//! Background, without a deadline: with no cable, a suspended bus or a host that does not read, what is written is
//! dropped in time and nothing waits. It knows no chip: the board gives an `embassy_usb_driver::Driver`, the tests a bus
//! of their own.

mod guard;
pub mod port;

use embassy_futures::join::join4;
use embassy_time::{Duration, Timer, with_timeout};
use embassy_usb::class::cdc_acm::{CdcAcmClass, ControlChanged, Receiver, Sender, State};
use embassy_usb::driver::{Driver, EndpointError};
use embassy_usb::{Builder, Config, UsbVersion};

use self::guard::Guarded;
use self::port::{PACKET, Port};

/// ST's own numbers of a virtual serial port, which its chips' other firmwares use and every system knows.
const VENDOR: u16 = 0x0483;
const PRODUCT: u16 = 0x5740;
/// What is sent at once: a packet that is not full ends a transfer, so that nothing waits for one that does.
const CHUNK: usize = PACKET as usize - 1;
/// What the board may draw, mA: the most there is, since sensors and receiver hang on it.
const CURRENT: u16 = 500;
/// Time that the host has to fetch what is sent; then all that waits is dropped.
const FETCH: Duration = Duration::from_millis(100);
/// Pause after a packet that cannot be read.
const PAUSE: Duration = Duration::from_millis(1);

/// What the device says of itself.
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// The board, at most 30 ASCII characters.
    pub product: &'static str,
    /// The chip's number, the same: by it systems tell one board from the next.
    pub serial: &'static str,
}

/// Memory of the device, for as long as it runs.
pub struct Memory<'d> {
    configuration: [u8; 96],
    objects: [u8; 16],
    control: [u8; 64],
    class: State<'d>,
}

impl Default for Memory<'_> {
    fn default() -> Self {
        Self::new()
    }
}

impl Memory<'_> {
    /// Before the start.
    pub const fn new() -> Self {
        Self {
            configuration: [0; 96],
            objects: [0; 16],
            control: [0; 64],
            class: State::new(),
        }
    }
}

/// Serves `port` over `driver`; never returns.
pub async fn run<'d, D: Driver<'d> + 'd>(
    driver: D,
    memory: &'d mut Memory<'d>,
    port: &'d Port,
    identity: Identity,
) -> ! {
    let mut config = Config::new(VENDOR, PRODUCT);
    config.manufacturer = Some("SOPHIE");
    config.product = Some(identity.product);
    config.serial_number = Some(identity.serial);
    config.max_power = CURRENT;
    config.bcd_usb = UsbVersion::Two;
    let mut builder = Builder::new(
        Guarded::new(driver, port),
        config,
        &mut memory.configuration,
        &mut memory.objects,
        &mut [],
        &mut memory.control,
    );
    let class = CdcAcmClass::new(&mut builder, &mut memory.class, PACKET);
    let (sender, receiver, control) = class.split_with_control();
    let mut device = builder.build();
    join4(
        device.run(),
        // Before what arrives through the port that it opens.
        follow(control, port),
        receive(receiver, port),
        send(sender, port),
    )
    .await
    .0
}

/// Takes what arrives. A port that is full holds the host back.
async fn receive<'d, D: Driver<'d>>(mut receiver: Receiver<'d, D>, port: &Port) -> ! {
    let mut packet = [0; PACKET as usize];
    loop {
        match receiver.read_packet(&mut packet).await {
            Ok(count) => port.take(packet.get(..count).unwrap_or_default()).await,
            Err(EndpointError::Disabled) => {
                port.close();
                receiver.wait_connection().await;
            }
            Err(EndpointError::BufferOverflow) => Timer::after(PAUSE).await,
        }
    }
}

/// Sends what the port has, as long as the host fetches it.
async fn send<'d, D: Driver<'d>>(mut sender: Sender<'d, D>, port: &Port) -> ! {
    let mut chunk = [0; CHUNK];
    loop {
        let count = port.next(&mut chunk).await;
        let bytes = chunk.get(..count).unwrap_or_default();
        match with_timeout(FETCH, sender.write_packet(bytes)).await {
            Ok(Ok(())) => (),
            Ok(Err(_)) => {
                port.drop_output();
                sender.wait_connection().await;
            }
            Err(_) => port.drop_output(),
        }
    }
}

/// Follows the line that says whether a program has the port open: each change begins anew.
async fn follow(control: ControlChanged<'_>, port: &Port) -> ! {
    let mut open = false;
    loop {
        control.control_changed().await;
        if core::mem::replace(&mut open, control.dtr()) != open {
            port.close();
        }
    }
}
