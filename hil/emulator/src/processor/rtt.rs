//! Reads the firmware's log buffer as a probe does.

use rigless::emulator::Host;
use rigless::soc::Width;

/// Control block to first up buffer.
const UP: u64 = 24;
/// Field offsets in a buffer's descriptor.
const BUFFER: u64 = 4;
const SIZE: u64 = 8;
const WRITTEN: u64 = 12;
const READ: u64 = 16;
/// Largest plausible buffer: memory is undefined before set-up.
const LARGEST: u64 = 1 << 16;

#[derive(Debug)]
pub struct Rtt {
    up: u64,
}

impl Rtt {
    pub fn new(address: u64) -> Self {
        Self { up: address + UP }
    }

    /// Address of the write position.
    pub fn written(&self) -> u64 {
        self.up + WRITTEN
    }

    pub fn drain(&mut self, host: &mut dyn Host) -> Vec<u8> {
        let mut field = |offset| host.read(self.up + offset, Width::W32).unwrap_or(0);
        let (buffer, size, written, mut read) = (field(BUFFER), field(SIZE), field(WRITTEN), field(READ));
        let mut bytes = Vec::new();
        if size == 0 || size > LARGEST || written >= size || read >= size || read == written {
            return bytes;
        }
        while read != written {
            let Ok(byte) = host.read(buffer + read, Width::W8) else {
                return bytes;
            };
            bytes.push(byte as u8);
            read = (read + 1) % size;
        }
        // Refused only without memory, and then nothing was read.
        let _ = host.write(self.up + READ, Width::W32, read);
        bytes
    }
}
