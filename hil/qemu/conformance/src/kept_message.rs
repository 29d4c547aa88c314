//! The message that a run keeps when it ends.

use core::cell::RefCell;
use core::fmt::{self, Arguments, Write};

use cortex_m::interrupt::{self, Mutex};

static KEPT: Mutex<RefCell<KeptMessage>> = Mutex::new(RefCell::new(KeptMessage::new()));

/// A text, cut to its room.
pub struct KeptMessage {
    text: [u8; 240],
    length: usize,
}

impl KeptMessage {
    pub const fn new() -> Self {
        Self {
            text: [0; 240],
            length: 0,
        }
    }
}

impl Write for KeptMessage {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for (slot, byte) in self.text.iter_mut().skip(self.length).zip(text.bytes()) {
            *slot = byte;
            self.length += 1;
        }
        Ok(())
    }
}

impl fmt::Display for KeptMessage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.text.get(..self.length).unwrap_or_default();
        f.write_str(core::str::from_utf8(text).unwrap_or_default())
    }
}

/// Keeps `message` in place of the one before.
pub fn keep(message: Arguments<'_>) {
    let mut kept = KeptMessage::new();
    let _ = kept.write_fmt(message);
    interrupt::free(|cs| KEPT.borrow(cs).replace(kept));
}

/// Shows the message that was kept last.
pub fn with_kept<R>(show: impl FnOnce(&KeptMessage) -> R) -> R {
    interrupt::free(|cs| show(&KEPT.borrow(cs).borrow()))
}
