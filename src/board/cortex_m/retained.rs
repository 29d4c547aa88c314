//! The few words that outlive a reset: how often the board started, and what ended the run before.

use core::cell::UnsafeCell;
use core::fmt::{self, Write};

use heapless::String;

/// Why the chip was reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum ResetCause {
    /// Power was switched on.
    PowerOn,
    /// The supply fell below the brown-out level.
    BrownOut,
    /// A watchdog was not fed.
    Watchdog,
    /// The firmware asked for it: after a fault, or on command.
    Software,
    /// The reset pin: a button or the probe.
    Pin,
    /// The chip does not tell.
    Unknown,
}

/// Longest message of a fault.
const LONGEST: usize = 240;
/// Message of the fault that ended the run before.
pub type LastWords = String<LONGEST>;

/// What is known at start-up.
pub struct Kept {
    /// Starts since power-on, this one included.
    pub starts: u32,
    /// Starts since power-on that a fault or the watchdog caused.
    pub faults: u32,
    /// Message of the fault that ended the run before.
    pub last_words: Option<LastWords>,
}

const WORDS: usize = LONGEST / 4;
/// Marks a block that this firmware wrote ("SOPH"), so that noise after power-on is not believed.
const MAGIC: u32 = 0x534F_5048;

#[repr(C)]
struct Block {
    magic: u32,
    starts: u32,
    faults: u32,
    length: u32,
    text: [u32; WORDS],
    /// Sum of all words before it.
    sum: u32,
}

impl Block {
    const EMPTY: Self = Self {
        magic: MAGIC,
        starts: 0,
        faults: 0,
        length: 0,
        text: [0; WORDS],
        sum: 0,
    };

    fn sum(&self) -> u32 {
        let head = [self.magic, self.starts, self.faults, self.length];
        head.iter()
            .chain(&self.text)
            .fold(0, |sum, &word| sum.rotate_left(5).wrapping_add(word))
    }

    fn is_whole(&self) -> bool {
        self.magic == MAGIC && self.length as usize <= LONGEST && self.sum == self.sum()
    }

    fn words(&self) -> Option<LastWords> {
        let bytes = self
            .text
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .take(self.length as usize);
        let mut words = LastWords::new();
        for byte in bytes {
            // Only ASCII was stored.
            words.push(char::from(byte)).ok()?;
        }
        (!words.is_empty()).then_some(words)
    }
}

/// The block, in memory that start-up code neither clears nor fills.
#[repr(transparent)]
struct Cell(UnsafeCell<Block>);

// SAFETY: every access goes through `load` and `store`, and those are only called where nothing else runs: at
// start-up before any task, and from a fault handler with interrupts off.
unsafe impl Sync for Cell {}

// SAFETY: the linker script gives the section its own memory, which nothing else uses.
#[unsafe(link_section = ".retained")]
static BLOCK: Cell = Cell(UnsafeCell::new(Block::EMPTY));

fn load() -> Block {
    // SAFETY: valid, aligned and any bits are a `Block`; volatile, because the compiler believes in the initialiser.
    unsafe { BLOCK.0.get().read_volatile() }
}

fn store(mut block: Block) {
    block.sum = block.sum();
    // SAFETY: valid and aligned, and nothing else runs (see `Cell`).
    unsafe {
        BLOCK.0.get().write_volatile(block);
    }
}

/// Takes what the run before left, counts this start and forgets the message.
pub fn start(cause: ResetCause) -> Kept {
    // After power-on the block is noise, and its memory's error correction would stumble over it.
    let lost = matches!(cause, ResetCause::PowerOn | ResetCause::BrownOut);
    let mut block = if lost { Block::EMPTY } else { load() };
    if !block.is_whole() && !lost {
        block = Block::EMPTY;
    }
    let last_words = block.words();
    block.starts = block.starts.saturating_add(1);
    let faulty = last_words.is_some() || cause == ResetCause::Watchdog;
    block.faults = block.faults.saturating_add(u32::from(faulty));
    let kept = Kept {
        starts: block.starts,
        faults: block.faults,
        last_words,
    };
    store(Block { length: 0, ..block });
    kept
}

/// Leaves `message` for the next start. Called with interrupts off, as the last thing before a reset.
pub fn leave(message: fmt::Arguments<'_>) {
    let mut block = load();
    if !block.is_whole() {
        block = Block::EMPTY;
    }
    let mut text = Ascii {
        words: [0; WORDS],
        length: 0,
    };
    // Never fails: what does not fit is cut off.
    let _ = text.write_fmt(message);
    store(Block {
        length: text.length as u32,
        text: text.words,
        ..block
    });
}

/// Text packed into words.
struct Ascii {
    words: [u32; WORDS],
    length: usize,
}

impl Write for Ascii {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            let byte = if byte.is_ascii_graphic() || byte == b' ' {
                byte
            } else {
                b'?'
            };
            let Some(word) = self.words.get_mut(self.length / 4) else {
                return Ok(());
            };
            *word |= u32::from(byte) << (8 * (self.length % 4));
            self.length += 1;
        }
        Ok(())
    }
}
