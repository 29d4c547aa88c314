//! Memory retained over a reset: the count of starts, the end of the last run, and two copies of the tasks' state
//! (`sophie_tasks::start::retained_state`).
//!
//! Only these functions access it: the linker places nothing else there, no DMA points at it, and the stack lies at the
//! bottom of another memory, where an overflow faults. A fault handler writes only the message, so it may interrupt a
//! copy.

use core::cell::UnsafeCell;
use core::fmt::{self, Write};

use heapless::String;
use sophie_ports::retained::{Retain, StartCause, WORDS as STATE_WORDS, Words};

/// Reset cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum ResetCause {
    /// Power was switched on.
    PowerOn,
    /// Supply below the brown-out level.
    BrownOut,
    /// Watchdog not fed.
    Watchdog,
    /// By the firmware: after a fault or on command.
    Software,
    /// Reset pin: button or probe.
    Pin,
    /// Not given by the chip.
    Unknown,
}

impl ResetCause {
    /// The tasks' view; `fault` if the last run left a fault message.
    pub fn with_record(self, fault: bool) -> StartCause {
        match self {
            Self::PowerOn => StartCause::PowerOn,
            Self::BrownOut => StartCause::BrownOut,
            _ if fault => StartCause::Fault,
            Self::Watchdog => StartCause::Watchdog,
            Self::Software | Self::Pin | Self::Unknown => StartCause::Software,
        }
    }
}

const LONGEST: usize = 240;
/// Fault message that ended the last run.
pub type LastWords = String<LONGEST>;

/// State at start-up.
pub struct Kept {
    /// Starts since power-on, including this one.
    pub starts: u32,
    /// Of these, after a fault or watchdog reset.
    pub faults: u32,
    /// Message of the last run's fault.
    pub last_words: Option<LastWords>,
    /// Copies kept by the last run; blank after power-on.
    pub copies: [Words; 2],
}

const WORDS: usize = LONGEST / 4;
/// Marks a block of this firmware ("SOPH"); rejects noise after power-on.
const MAGIC: u32 = 0x534F_5048;

#[repr(C)]
struct Block {
    magic: u32,
    starts: u32,
    faults: u32,
    length: u32,
    text: [u32; WORDS],
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
            // Only ASCII is stored.
            words.push(char::from(byte)).ok()?;
        }
        (!words.is_empty()).then_some(words)
    }
}

/// The block, in memory that start-up does not initialise.
#[repr(transparent)]
struct Cell(UnsafeCell<Block>);

// SAFETY: accessed only by `load` and `store`, which are called only without concurrency: at start-up before any task,
// and in a fault handler with interrupts off.
unsafe impl Sync for Cell {}

// SAFETY: the linker script gives the section its own memory.
#[unsafe(link_section = ".retained")]
static BLOCK: Cell = Cell(UnsafeCell::new(Block::EMPTY));

#[repr(transparent)]
struct Copies(UnsafeCell<[Words; 2]>);

// SAFETY: written only by `Memory`, of which `start` makes one; read by `start` before that.
unsafe impl Sync for Copies {}

// SAFETY: as for the block.
#[unsafe(link_section = ".retained")]
static COPIES: Copies = Copies(UnsafeCell::new([[0; STATE_WORDS]; 2]));

/// Request of a run to the next start. Stored as a word and its complement.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Request {
    /// To enter the chip's loader ("LOAD").
    EnterLoader = 0x4C4F_4144,
    /// To start with the clocks as they are: the reset that should have stopped them is done ("GOON").
    GoOn = 0x474F_4F4E,
}

#[repr(transparent)]
struct Requested(UnsafeCell<[u32; 2]>);

// SAFETY: accessed only by `requested`, at start-up before any task, and `request`, just before a reset.
unsafe impl Sync for Requested {}

// SAFETY: as for the block.
#[unsafe(link_section = ".retained")]
static REQUEST: Requested = Requested(UnsafeCell::new([0; 2]));

/// Stores a request to the next start. Called just before a reset.
pub fn request(what: Request) {
    let word = what as u32;
    // SAFETY: valid and aligned, and nothing else accesses it (see `Requested`).
    unsafe { REQUEST.0.get().write_volatile([word, !word]) }
}

/// Takes the request of the previous run. Called once, before [`start`].
pub fn requested(cause: ResetCause) -> Option<Request> {
    // As in `start`: noise is not read.
    let words = if cause == ResetCause::Software {
        // SAFETY: valid, aligned, any bits are words; volatile, since the compiler assumes the initialiser.
        unsafe { REQUEST.0.get().read_volatile() }
    } else {
        [0; 2]
    };
    // SAFETY: as above.
    unsafe { REQUEST.0.get().write_volatile([0; 2]) };
    [Request::EnterLoader, Request::GoOn]
        .into_iter()
        .find(|&request| words == [request as u32, !(request as u32)])
}

/// Writer of the copies; only [`start`] makes one.
pub struct Memory(());

impl Retain for Memory {
    fn keep(&mut self, second: bool, words: &Words) {
        // SAFETY: the pointer stays within the two copies. Nothing reads them before the next start, and nothing else
        // writes them: `start` made one `Memory`. Volatile, since the compiler sees no reader.
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
    // SAFETY: valid, aligned, and any bits are a `Block`; volatile, since the compiler assumes the initialiser.
    unsafe { BLOCK.0.get().read_volatile() }
}

fn store(mut block: Block) {
    block.sum = block.sum();
    // SAFETY: valid and aligned, and nothing else runs (see `Cell`).
    unsafe {
        BLOCK.0.get().write_volatile(block);
    }
}

/// Takes the last run's state, counts this start and clears the message. Called once, before any task.
pub fn start(cause: ResetCause) -> (Kept, Memory) {
    // Noise fails the memory's error correction.
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
        // The error correction needs a write before the first read.
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

/// Keeps `message` for the next start. Called with interrupts off, just before a reset.
pub fn leave(message: fmt::Arguments<'_>) {
    let mut block = load();
    if !block.is_whole() {
        block = Block::EMPTY;
    }
    let mut text = Ascii {
        words: [0; WORDS],
        length: 0,
    };
    // Never fails: long messages are truncated.
    let _ = text.write_fmt(message);
    store(Block {
        length: text.length as u32,
        text: text.words,
        ..block
    });
}

/// Withdraws the message: its cause did not occur. Called before any task.
pub fn forget() {
    let block = load();
    store(Block { length: 0, ..block });
}

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
