//! Bytes of a line with their times, through the decoder that flies.

use std::path::Path;

use embassy_time::Instant;
use sophie_control::params::{Params, RcProtocol};
use sophie_drivers::ground_module::GroundModule;
use sophie_drivers::{msp, rc_decoder};
use sophie_ports::receiver::RcDecoder;
use sophie_ports::sensors::GroundDecoder;

use crate::lines::{Lines, short, time};

/// Protocol of the bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// A receiver's SBUS or S.BUS2.
    Sbus,
    /// A receiver's CRSF.
    Crsf,
    /// A module of flow and range.
    Msp,
}

/// Result of the decoder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decoded {
    /// From the first byte to the last, s.
    pub seconds: f64,
    /// Bytes.
    pub bytes: u64,
    /// Valid frames.
    pub frames: u64,
    /// Number of outputs: sticks, or flow and range.
    pub published: u64,
    /// Longest time without an output, from the first to the last byte, ms.
    pub longest_pause_ms: f64,
}

/// Decodes a capture.
///
/// # Errors
/// One line: place, value, allowed values.
pub fn decode(path: &Path, protocol: Protocol, params: &Params) -> Result<Decoded, String> {
    let mut lines = Lines::open(path)?;
    let mut decoder = Decoder::new(protocol, params);
    let mut out = Decoded::default();
    let mut times: Option<[u64; 3]> = None;
    let mut longest = 0;
    while let Some(line) = lines.next()? {
        let (at, byte) = parse(line).map_err(|why| lines.bad(&why))?;
        let [first, last, published] = times.get_or_insert([at; 3]);
        if at < *last {
            let why = format!("time {at}, allowed {last} us or later, as the line before it");
            return Err(lines.bad(&why));
        }
        *last = at;
        out.bytes += 1;
        if decoder.take(byte, Instant::from_micros(at)) {
            longest = longest.max(at - *published);
            *published = at;
            out.published += 1;
        }
        out.seconds = (at - *first) as f64 * 1e-6;
    }
    let Some([_, last, published]) = times else {
        return Err(lines.whole("empty, allowed are lines of a time in us and a byte"));
    };
    out.frames = decoder.frames();
    out.longest_pause_ms = longest.max(last - published) as f64 * 1e-3;
    Ok(out)
}

/// `time_us byte`, decimal or 0x and hexadecimal, with blanks or a comma between.
fn parse(line: &str) -> Result<(u64, u8), String> {
    let mut cells = line.split([' ', '\t', ',']).filter(|cell| !cell.is_empty());
    let (Some(at), Some(byte), None) = (cells.next(), cells.next(), cells.next()) else {
        return Err(format!("'{}', allowed are a time in us and a byte", short(line)));
    };
    let value = match byte.strip_prefix("0x") {
        Some(hex) => u8::from_str_radix(hex, 16),
        None => byte.parse(),
    };
    let value = value.map_err(|_| format!("byte '{}', allowed 0 to 255 or 0x00 to 0xff", short(byte)))?;
    Ok((time("time", at)?, value))
}

/// One of them.
enum Decoder {
    Rc(Box<rc_decoder::Decoder>),
    /// The module's decoder, and its count of frames: only frames with news give an output.
    Ground(Box<GroundModule>, msp::Parser, u64),
}

impl Decoder {
    fn new(protocol: Protocol, params: &Params) -> Self {
        let rc_protocol = match protocol {
            Protocol::Sbus => RcProtocol::Sbus,
            Protocol::Crsf => RcProtocol::Crsf,
            Protocol::Msp => {
                let module = GroundModule::from_params(params);
                return Self::Ground(Box::new(module), msp::Parser::new(), 0);
            }
        };
        let params = Params {
            rc_protocol,
            ..*params
        };
        Self::Rc(Box::new(rc_decoder::Decoder::from_params(&params)))
    }

    /// Takes a byte; true if it completes an output.
    fn take(&mut self, byte: u8, at: Instant) -> bool {
        match self {
            Self::Rc(decoder) => decoder.take(&[byte], at).is_some(),
            Self::Ground(module, parser, frames) => {
                *frames += u64::from(parser.take(byte).is_some());
                module.take(&[byte], at).is_some()
            }
        }
    }

    fn frames(&self) -> u64 {
        match self {
            Self::Rc(decoder) => u64::from(decoder.state().frames),
            Self::Ground(_, _, frames) => *frames,
        }
    }
}
