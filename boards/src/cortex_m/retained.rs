//! The few words that outlive a reset: how often the board started, what ended the run before, and two copies of what
//! the tasks go on from (`sophie_tasks::retained_state`), which this file only stores.
//!
//! Nothing but these functions reaches the memory: the linker gives it to no one else, no DMA is pointed at it, and the
//! stack lies alone at the very bottom of a memory, where one that overflows faults. A fault handler writes the message
//! only; the copies are not in its way, however torn the one being written is.

use core::cell::UnsafeCell;
use core::fmt::{self, Write};

use heapless::String;
use sophie_tasks::ports::Retain;
use sophie_tasks::retained_state::{WORDS as STATE_WORDS, Words};
use sophie_tasks::start::StartCause;

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

impl ResetCause {
    /// The tasks' view; `fault` when a message of the run before says that it gave up.
    pub fn told(self, fault: bool) -> StartCause {
        match self {
            Self::PowerOn => StartCause::PowerOn,
            Self::BrownOut => StartCause::BrownOut,
            _ if fault => StartCause::Fault,
            Self::Watchdog => StartCause::Watchdog,
            Self::Software | Self::Pin | Self::Unknown => StartCause::Software,
        }
    }
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
    /// The copies that the run before kept; blank after power-on.
    pub copies: [Words; 2],
}

const WORDS: usize = LONGEST / 4;
/// Marks a block that this firmware wrote ("SOPH"), so that noise after power-on is rejected.
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

/// The copies, beside the block.
#[repr(transparent)]
struct Copies(UnsafeCell<[Words; 2]>);

// SAFETY: written by `Memory` alone, of which `start` makes one; read by `start`, before there is one.
unsafe impl Sync for Copies {}

// SAFETY: as for the block.
#[unsafe(link_section = ".retained")]
static COPIES: Copies = Copies(UnsafeCell::new([[0; STATE_WORDS]; 2]));

/// Writes the copies. One exists, from [`start`].
pub struct Memory(());

impl Retain for Memory {
    fn keep(&mut self, second: bool, words: &Words) {
        // SAFETY: the pointer stays within the two copies. Nothing reads them before the next start, and nothing else
        // writes them: `start` gave this out once. Volatile, because the compiler sees no reader at all.
        unsafe {
            COPIES
                .0
                .get()
                .cast::<Words>()
                .add(usize::from(second))
                .write_volatile(*words);
        }
    }
}

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

/// Takes what the run before left, counts this start and forgets the message. Called once, before any task.
pub fn start(cause: ResetCause) -> (Kept, Memory) {
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
    let mut memory = Memory(());
    let blank = [[0; STATE_WORDS]; 2];
    let copies = if lost {
        // Written before it is ever read, as the error correction wants it.
        for (second, words) in [false, true].into_iter().zip(&blank) {
            memory.keep(second, words);
        }
        blank
    } else {
        // SAFETY: valid, aligned, any bits are words, and no task runs yet.
        unsafe { COPIES.0.get().read_volatile() }
    };
    let kept = Kept {
        starts: block.starts,
        faults: block.faults,
        last_words,
        copies,
    };
    store(Block { length: 0, ..block });
    (kept, memory)
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

/// Takes the message back: what it was left for did not happen. Called before any task runs.
pub fn forget() {
    let block = load();
    store(Block { length: 0, ..block });
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
