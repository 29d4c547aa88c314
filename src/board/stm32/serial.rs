//! The receiver's serial line, both ways.

use embassy_stm32::mode::Async;
use embassy_stm32::usart::{RingBufferedUartRx, UartTx};
use embassy_time::{Duration, with_timeout};
use sophie_tasks::ports::{PortError, SerialInput, SerialOutput};

/// The longest telemetry frame takes 1.6 ms at 420 kbaud; a line that needs this long is broken.
const LONGEST_WRITE: Duration = Duration::from_millis(20);

/// From the receiver: a ring filled by DMA, read when the line falls idle, that is at the end of a frame.
pub struct ReceiverLine(pub RingBufferedUartRx<'static>);

impl SerialInput for ReceiverLine {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        // Framing, noise and overrun stop the ring; the next call starts it again.
        self.0.read(buffer).await.map_err(|_| PortError::Corrupt)
    }
}

/// To the receiver.
pub struct TelemetryLine(pub UartTx<'static, Async>);

impl SerialOutput for TelemetryLine {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        match with_timeout(LONGEST_WRITE, self.0.write(bytes)).await {
            Ok(sent) => sent.map_err(|_| PortError::Corrupt),
            Err(_) => Err(PortError::Timeout),
        }
    }
}
