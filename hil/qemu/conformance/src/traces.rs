//! Traces that the end of a run leaves: stopped motors and the kept message.

use core::cell::RefCell;
use core::fmt::{self, Write};
use core::sync::atomic::AtomicBool;

use cortex_m::interrupt::{self, Mutex};

/// The motors were stopped.
pub static STOPPED: AtomicBool = AtomicBool::new(false);
static LEFT: Mutex<RefCell<Left>> = Mutex::new(RefCell::new(Left::new()));

/// A message of limited length.
pub struct Left {
    text: [u8; 240],
    length: usize,
}

impl Left {
    pub const fn new() -> Self {
        Self {
            text: [0; 240],
            length: 0,
        }
    }
}

impl Write for Left {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for (slot, byte) in self.text.iter_mut().skip(self.length).zip(text.bytes()) {
            *slot = byte;
            self.length += 1;
        }
        Ok(())
    }
}

impl fmt::Display for Left {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.text.get(..self.length).unwrap_or_default();
        f.write_str(core::str::from_utf8(text).unwrap_or_default())
    }
}

/// Keeps `left` as the last message.
pub fn keep(left: Left) {
    interrupt::free(|cs| LEFT.borrow(cs).replace(left));
}

/// Calls `show` with the last kept message.
pub fn with_kept<R>(show: impl FnOnce(&Left) -> R) -> R {
    interrupt::free(|cs| show(&LEFT.borrow(cs).borrow()))
}
