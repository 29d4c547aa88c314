//! Receiver protocol: parameter `rc_protocol`.

use embassy_time::Instant;
use sophie_control::params::{Params, RcProtocol};
use sophie_ports::receiver::{RcDecoder, RcState};

use crate::{crsf, sbus};

/// Receiver decoder.
pub enum Decoder {
    /// CRSF.
    Crsf(crsf::Decoder),
    /// SBUS.
    Sbus(sbus::Decoder),
}

impl Decoder {
    /// The decoder of `rc_protocol`.
    pub fn from_params(params: &Params) -> Self {
        match params.rc_protocol {
            RcProtocol::Crsf => Self::Crsf(crsf::Decoder::new()),
            RcProtocol::Sbus => Self::Sbus(sbus::Decoder::new()),
        }
    }

    /// Last decoded state, including frames that were not published.
    pub const fn state(&self) -> &RcState {
        match self {
            Self::Crsf(decoder) => decoder.state(),
            Self::Sbus(decoder) => decoder.state(),
        }
    }
}

impl RcDecoder for Decoder {
    fn take(&mut self, bytes: &[u8], at: Instant) -> Option<RcState> {
        match self {
            Self::Crsf(decoder) => decoder.take(bytes, at),
            Self::Sbus(decoder) => decoder.take(bytes, at),
        }
    }

    fn broken(&mut self, at: Instant) {
        match self {
            Self::Crsf(decoder) => decoder.broken(at),
            Self::Sbus(decoder) => decoder.broken(at),
        }
    }
}
