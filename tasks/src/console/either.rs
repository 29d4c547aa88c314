//! A port of either of two types, so that code generic over ports is compiled once for both.

use sophie_ports::error::PortError;
use sophie_ports::serial::{SerialInput, SerialOutput};

/// Either of two types.
pub enum Either<A, B> {
    /// The first type.
    First(A),
    /// The second type.
    Second(B),
}

impl<A: SerialInput, B: SerialInput> SerialInput for Either<A, B> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        match self {
            Self::First(port) => port.read(buffer).await,
            Self::Second(port) => port.read(buffer).await,
        }
    }

    fn private(&self) -> bool {
        match self {
            Self::First(port) => port.private(),
            Self::Second(port) => port.private(),
        }
    }
}

impl<A: SerialOutput, B: SerialOutput> SerialOutput for Either<A, B> {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        match self {
            Self::First(port) => port.write(bytes).await,
            Self::Second(port) => port.write(bytes).await,
        }
    }

    fn listens(&self) -> bool {
        match self {
            Self::First(port) => port.listens(),
            Self::Second(port) => port.listens(),
        }
    }
}
