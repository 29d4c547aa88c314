//! Serial lines of receiver and console.

use embassy_stm32::gpio::Pull;
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::mode::Async;
use embassy_stm32::usart::{
    BufferedInterruptHandler, BufferedUart, BufferedUartRx, BufferedUartTx, Config, ConfigError, Instance,
    InterruptHandler, Parity, RingBufferedUartRx, RxDma, RxPin, StopBits, TxDma, TxPin, Uart, UartRx, UartTx,
};
use embassy_stm32::{Peri, dma};
use embassy_time::{Duration, with_timeout};
use embedded_io_async::{Read, Write};
use sophie_control::params::{Params, RcProtocol};
use sophie_tasks::ports::{PortError, SerialInput, SerialOutput};
use static_cell::ConstStaticCell;

use super::Aligned;

/// Time-out of a frame; the longest telemetry frame takes 1.6 ms at 420 kbaud.
const LONGEST_FRAME: Duration = Duration::from_millis(20);
/// Time-out of a line; the longest takes 20 ms at 115,200 baud, behind as long a buffer.
const LONGEST_LINE: Duration = Duration::from_millis(200);

static DMA_RECEIVER: ConstStaticCell<Aligned<[u8; 512]>> = ConstStaticCell::new(Aligned([0; 512]));
static CONSOLE_IN: ConstStaticCell<[u8; 128]> = ConstStaticCell::new([0; 128]);
static CONSOLE_OUT: ConstStaticCell<[u8; 256]> = ConstStaticCell::new([0; 256]);

fn receiver_config(protocol: RcProtocol) -> Config {
    let mut config = Config::default();
    match protocol {
        RcProtocol::Crsf => {
            config.baudrate = 420_000;
            config.rx_pull = Pull::Up;
        }
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

/// Console line: 115,200 baud, 8N1; DMA streams are scarce.
pub fn console_lines<T: Instance>(
    uart: Peri<'static, T>,
    rx: Peri<'static, impl RxPin<T>>,
    tx: Peri<'static, impl TxPin<T>>,
    irqs: impl Binding<T::Interrupt, BufferedInterruptHandler<T>> + 'static,
) -> (ConsoleInput, ConsoleOutput) {
    let mut config = Config::default();
    config.baudrate = 115_200;
    // An open input must not read as a character.
    config.rx_pull = Pull::Up;
    let uart = BufferedUart::new(uart, rx, tx, CONSOLE_OUT.take(), CONSOLE_IN.take(), irqs, config);
    let (tx, rx) = accepted(uart).split();
    (ConsoleInput(rx), ConsoleOutput(tx))
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

/// Console input.
pub struct ConsoleInput(BufferedUartRx<'static>);

impl SerialInput for ConsoleInput {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        self.0.read(buffer).await.map_err(|_| PortError::Corrupt)
    }
}

/// Console output.
pub struct ConsoleOutput(BufferedUartTx<'static>);

impl SerialOutput for ConsoleOutput {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        in_time(LONGEST_LINE, self.0.write_all(bytes)).await
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
