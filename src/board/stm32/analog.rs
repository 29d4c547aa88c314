//! The analog inputs: six channels of one converter, moved by DMA in one scan on demand.

use sophie_tasks::ports::{Analog, AnalogFrame, PortError};

/// Channels of a scan: pressure sensors 1 to 4, battery voltage, battery current.
pub const CHANNELS: usize = 6;

/// A converter with its channels.
pub trait Scan {
    /// Converts all channels once.
    async fn scan(&mut self) -> Result<[u16; CHANNELS], PortError>;
}

/// What the converter's counts mean.
#[derive(Clone, Copy)]
pub struct AnalogScale {
    /// Bits that the converter gives beyond the port's twelve.
    pub extra_bits: u32,
    /// Battery voltage, V per count of twelve bits.
    pub volts_per_count: f32,
    /// Battery current, A per count of twelve bits.
    pub amps_per_count: f32,
}

/// The analog inputs of a board.
pub struct AnalogInputs<S> {
    /// The converter.
    pub converter: S,
    /// What its counts mean.
    pub scale: AnalogScale,
}

impl<S: Scan> Analog for AnalogInputs<S> {
    fn volts_per_count(&self) -> f32 {
        self.scale.volts_per_count
    }

    fn amps_per_count(&self) -> f32 {
        self.scale.amps_per_count
    }

    async fn read(&mut self) -> Result<AnalogFrame, PortError> {
        let counts = self.converter.scan().await?;
        let [a, b, c, d, battery_voltage, battery_current] = counts.map(|n| n >> self.scale.extra_bits);
        Ok(AnalogFrame {
            fsr: [a, b, c, d],
            battery_voltage,
            battery_current,
        })
    }
}
