//! Serial lines of receiver, console, MAVLink, and the module of optical flow and range.

use embassy_stm32::gpio::Pull;
use embassy_stm32::interrupt::Priority;
use embassy_stm32::interrupt::typelevel::{Binding, Interrupt};
use embassy_stm32::mode::Async;
use embassy_stm32::usart::{
    BufferedInterruptHandler, BufferedUart, BufferedUartRx, BufferedUartTx, Config, ConfigError, Instance,
    InterruptHandler, Parity, RingBufferedUartRx, RxDma, RxPin, StopBits, TxDma, TxPin, Uart, UartRx, UartTx,
};
use embassy_stm32::{Peri, dma};
use embassy_time::{Duration, with_timeout};
use embedded_io_async::{Read, Write};
use sophie_control::params::{FlowPort, Params, RcProtocol};
use sophie_ports::error::PortError;
use sophie_ports::serial::{SerialInput, SerialOutput};
use static_cell::ConstStaticCell;

use super::Aligned;
use crate::cortex_m::BELOW_FLIGHT;

/// Time-out of a frame; the longest telemetry frame takes 1.6 ms at 420 kbaud.
const LONGEST_FRAME: Duration = Duration::from_millis(20);
/// Time-out of a write to a buffered line: the longest line of text takes 20 ms at 115,200 baud, the longest MAVLink
/// frame 49 ms at 57,600, each behind a full buffer, 22 and 44 ms.
const LONGEST_WRITE: Duration = Duration::from_millis(200);

static DMA_RECEIVER: ConstStaticCell<Aligned<[u8; 512]>> = ConstStaticCell::new(Aligned([0; 512]));
static CONSOLE_IN: ConstStaticCell<[u8; 128]> = ConstStaticCell::new([0; 128]);
static CONSOLE_OUT: ConstStaticCell<[u8; 256]> = ConstStaticCell::new([0; 256]);
/// 44 ms of the line: longer than the background level waits for anything but flash.
static MAVLINK_IN: ConstStaticCell<[u8; 256]> = ConstStaticCell::new([0; 256]);
static MAVLINK_OUT: ConstStaticCell<[u8; 256]> = ConstStaticCell::new([0; 256]);

/// 11 ms of the line: two reports of a module, one of which the steady level can be late for.
static GROUND_IN: ConstStaticCell<[u8; 128]> = ConstStaticCell::new([0; 128]);
/// Nothing is sent, but the driver of both directions wants room.
static GROUND_OUT: ConstStaticCell<[u8; 1]> = ConstStaticCell::new([0; 1]);

/// Rate of modules of optical flow and range, baud. A byte takes 87 us, longer than the flight level holds the core at a
/// stretch.
const GROUND_BAUD: u32 = 115_200;
/// Priority of the console's interrupts: that of the drivers.
const AS_DRIVERS: Priority = Priority::P0;
/// Rate of the MAVLink line, baud: what SiK radios, PX4's TELEM1 and ArduPilot's serial ports start with. A byte takes
/// 174 us, longer than the flight level holds the core at a stretch: with its interrupts below that level none is lost.
const MAVLINK_BAUD: u32 = 57_600;
/// Send budget of the MAVLink line, bytes/s: four fifths of its capacity, so that the line is free for each frame.
pub const MAVLINK_BYTES_PER_SECOND: u32 = MAVLINK_BAUD / 10 * 4 / 5;

fn receiver_config(protocol: RcProtocol) -> Config {
    let mut config = Config::default();
    match protocol {
        RcProtocol::Crsf => {
            config.baudrate = 420_000;
            config.rx_pull = Pull::Up;
            // One sample a bit: with three, one that differs stops the DMA ring and costs the frames in it, though the byte
            // is right by the other two. A wrong one is found by the frame's checksum, and costs that frame. The buffered
            // lines keep three: they take a byte whatever its flags.
            config.assume_noise_free = true;
        }
        // Three samples a bit: of a frame without a checksum, a byte with noise on it is not to be trusted.
        RcProtocol::Sbus => {
            config.baudrate = 100_000;
            config.parity = Parity::ParityEven;
            config.stop_bits = StopBits::STOP2;
            // The F4 cannot invert: the board's inverter makes the line idle high.
            #[cfg(family = "f4")]
            {
                config.rx_pull = Pull::Up;
            }
            #[cfg(not(family = "f4"))]
            {
                config.invert_rx = true;
                config.rx_pull = Pull::Down;
            }
        }
    }
    config
}

/// The receiver's line for `rc_protocol`.
#[expect(clippy::too_many_arguments, reason = "the parts of one port of the board")]
pub fn receiver_line<T: Instance, R: RxDma<T>, D: TxDma<T>>(
    uart: Peri<'static, T>,
    rx: Peri<'static, impl RxPin<T>>,
    tx: Peri<'static, impl TxPin<T>>,
    rx_dma: Peri<'static, R>,
    tx_dma: Peri<'static, D>,
    irqs: impl Binding<T::Interrupt, InterruptHandler<T>>
    + Binding<R::Interrupt, dma::InterruptHandler<R>>
    + Binding<D::Interrupt, dma::InterruptHandler<D>>
    + 'static,
    params: &Params,
) -> (ReceiverLine, TelemetryLine) {
    let protocol = params.rc_protocol;
    let config = receiver_config(protocol);
    let (rx, tx) = match protocol {
        RcProtocol::Crsf => {
            let both = Uart::new(uart, rx, tx, tx_dma, rx_dma, irqs, config);
            let (tx, rx) = accepted(both).split();
            (rx, Some(tx))
        }
        // The other pin stays an input.
        RcProtocol::Sbus => {
            let rx = UartRx::new(uart, rx, rx_dma, irqs, config);
            (accepted(rx), None)
        }
    };
    (
        ReceiverLine(rx.into_ring_buffered(&mut DMA_RECEIVER.take().0)),
        TelemetryLine(tx),
    )
}

/// Line of the module that `flow_port` names: [`GROUND_BAUD`], 8N1, its interrupts as MAVLink's. Without one the port stays
/// as the reset left it.
pub fn ground_line<T: Instance>(
    uart: Peri<'static, T>,
    rx: Peri<'static, impl RxPin<T>>,
    tx: Peri<'static, impl TxPin<T>>,
    irqs: impl Binding<T::Interrupt, BufferedInterruptHandler<T>> + 'static,
    params: &Params,
) -> GroundLine {
    GroundLine(match params.flow_port {
        FlowPort::Closed => None,
        FlowPort::Msp => {
            let line = BufferedLine {
                baud: GROUND_BAUD,
                priority: BELOW_FLIGHT,
                input: GROUND_IN.take(),
                output: GROUND_OUT.take(),
            };
            Some(line.open(uart, rx, tx, irqs))
        }
    })
}

/// A line moved by the processor through two rings, an interrupt a byte: DMA streams are scarce.
pub struct BufferedLine {
    baud: u32,
    priority: Priority,
    input: &'static mut [u8],
    output: &'static mut [u8],
}

impl BufferedLine {
    /// Console line: 115,200 baud. Called once.
    pub fn console() -> Self {
        Self {
            baud: 115_200,
            priority: AS_DRIVERS,
            input: CONSOLE_IN.take(),
            output: CONSOLE_OUT.take(),
        }
    }

    /// MAVLink line: [`MAVLINK_BAUD`], its interrupts between the flight and the steady level. Called once.
    pub fn mavlink() -> Self {
        Self {
            baud: MAVLINK_BAUD,
            priority: BELOW_FLIGHT,
            input: MAVLINK_IN.take(),
            output: MAVLINK_OUT.take(),
        }
    }

    /// The line on its port and pins, 8N1.
    pub fn open<T: Instance>(
        self,
        uart: Peri<'static, T>,
        rx: Peri<'static, impl RxPin<T>>,
        tx: Peri<'static, impl TxPin<T>>,
        irqs: impl Binding<T::Interrupt, BufferedInterruptHandler<T>> + 'static,
    ) -> (BufferedInput, BufferedOutput) {
        let mut config = Config::default();
        config.baudrate = self.baud;
        // An open input must not read as a character.
        config.rx_pull = Pull::Up;
        T::Interrupt::set_priority(self.priority);
        let uart = BufferedUart::new(uart, rx, tx, self.output, self.input, irqs, config);
        let (tx, rx) = accepted(uart).split();
        (BufferedInput(rx), BufferedOutput(tx))
    }
}

/// All rates are in range: a refusal means wrong clocks, found on the bench.
fn accepted<U>(port: Result<U, ConfigError>) -> U {
    match port {
        Ok(port) => port,
        Err(_) => panic!("a serial port refuses its configuration"),
    }
}

/// Receiver input: a DMA ring, read when the line idles after a frame.
pub struct ReceiverLine(RingBufferedUartRx<'static>);

impl SerialInput for ReceiverLine {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        // Line errors stop the ring; the next call restarts it.
        self.0.read(buffer).await.map_err(|_| PortError::Corrupt)
    }
}

/// Output to the receiver, if it listens.
pub struct TelemetryLine(Option<UartTx<'static, Async>>);

impl SerialOutput for TelemetryLine {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        match &mut self.0 {
            Some(line) => in_time(LONGEST_FRAME, line.write(bytes)).await,
            None => Ok(()),
        }
    }
}

/// Input of a buffered line.
pub struct BufferedInput(BufferedUartRx<'static>);

impl SerialInput for BufferedInput {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        self.0.read(buffer).await.map_err(|_| PortError::Corrupt)
    }
}

/// Line of the module of optical flow and range; its output is held, and silent. Closed, it never gives a byte.
pub struct GroundLine(Option<(BufferedInput, BufferedOutput)>);

impl SerialInput for GroundLine {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        match &mut self.0 {
            Some((input, _)) => input.read(buffer).await,
            None => core::future::pending().await,
        }
    }
}

/// Output of a buffered line.
pub struct BufferedOutput(BufferedUartTx<'static>);

impl SerialOutput for BufferedOutput {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        in_time(LONGEST_WRITE, self.0.write_all(bytes)).await
    }
}

async fn in_time<E>(
    longest: Duration,
    writing: impl Future<Output = Result<(), E>>,
) -> Result<(), PortError> {
    match with_timeout(longest, writing).await {
        Ok(sent) => sent.map_err(|_| PortError::Corrupt),
        Err(_) => Err(PortError::Timeout),
    }
}
