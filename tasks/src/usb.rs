//! USB: one serial port (CDC-ACM) for the console and MAVLink, selected by the protocol received.
//!
//! Runs in the background without a deadline: without a cable, on a suspended bus, or with a host that does not read,
//! output is dropped after a time-out and blocks no task. It is independent of the chip: the board provides an
//! `embassy_usb_driver::Driver`, the tests a simulated bus.

mod guard;
pub mod port;

use embassy_futures::join::join4;
use embassy_time::{Duration, Timer, with_timeout};
use embassy_usb::class::cdc_acm::{CdcAcmClass, ControlChanged, Receiver, Sender, State};
use embassy_usb::driver::{Driver, EndpointError};
use embassy_usb::{Builder, Config, UsbVersion};

use self::guard::Guarded;
use self::port::{PACKET, Port};

/// ST's vendor and product IDs of a virtual serial port, used by other firmware of these chips and known to every
/// operating system.
const VENDOR: u16 = 0x0483;
const PRODUCT: u16 = 0x5740;
/// Largest packet sent, bytes: one below the maximum, since a short packet ends a transfer and the host delivers it at
/// once.
const CHUNK: usize = PACKET as usize - 1;
/// Declared supply current, mA: USB's maximum, since sensors and receiver are supplied too.
const CURRENT: u16 = 500;
/// Time-out for the host to fetch a packet; then all pending output is dropped.
const FETCH: Duration = Duration::from_millis(100);
/// Pause after a packet that cannot be read.
const PAUSE: Duration = Duration::from_millis(1);

/// Identification in the device descriptor.
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// The board, at most 30 ASCII characters.
    pub product: &'static str,
    /// Serial number from the chip's unique ID, at most 30 ASCII characters; distinguishes boards on a host.
    pub serial: &'static str,
}

/// Static memory of the device.
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
    /// Unused memory.
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
        // Polled before the receiver: a change of DTR precedes data through the port that it opens.
        follow(control, port),
        receive(receiver, port),
        send(sender, port),
    )
    .await
    .0
}

/// Receives packets. A full port makes the host wait.
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

/// Sends the port's output while the host fetches it.
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

/// Follows DTR, which a program sets while it has the port open; each change returns the port to the console and drops
/// pending output.
async fn follow(control: ControlChanged<'_>, port: &Port) -> ! {
    let mut open = false;
    loop {
        control.control_changed().await;
        if core::mem::replace(&mut open, control.dtr()) != open {
            port.close();
        }
    }
}
