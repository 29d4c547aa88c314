//! A test's state across its reset, in retained memory. The probe names the test only before the first part: the second
//! starts from the tests' setup and reports its own result.

use core::cell::RefCell;

use critical_section::Mutex;
use sophie_ports::retained::{Retain, WORDS, Words};

use crate::cycles;
use sophie_boards::retained::{self, Memory};
use sophie_boards::{ResetCause, stop_with_core, take_reset_cause};

/// What a reset interrupts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ResumableTest {
    /// Nothing.
    None,
    /// A test that no reset may interrupt.
    Test,
    /// The watchdog starves; duration so far, µs.
    Starving(u32),
    /// A changed parameter was stored; its former value.
    Stored(f32),
}

/// Marks valid words ("RIG" and layout version).
const MAGIC: u32 = 0x5249_4701;

static MEMORY: Mutex<RefCell<Option<Memory>>> = Mutex::new(RefCell::new(None));

impl ResumableTest {
    fn words(self) -> Words {
        let (kind, value) = match self {
            Self::None => (0, 0),
            Self::Test => (1, 0),
            Self::Starving(us) => (2, us),
            Self::Stored(value) => (3, value.to_bits()),
        };
        let mut words = [0; WORDS];
        for (word, part) in words.iter_mut().zip([MAGIC, kind, value, !value]) {
            *word = part;
        }
        words
    }

    fn of(words: &Words) -> Self {
        match *words {
            [MAGIC, kind, value, check, ..] if check == !value => match kind {
                1 => Self::Test,
                2 => Self::Starving(value),
                3 => Self::Stored(f32::from_bits(value)),
                _ => Self::None,
            },
            _ => Self::None,
        }
    }
}

/// Takes the interrupted test and the reset cause. Called once, first.
///
/// # Panics
/// If the watchdog interrupted a test that feeds it.
pub fn begin() -> (ResumableTest, ResetCause) {
    cycles::start();
    // The probe reads the verdict while the core is halted.
    stop_with_core();
    let cause = take_reset_cause();
    let (kept, memory) = retained::start(cause);
    critical_section::with(|cs| MEMORY.borrow(cs).replace(Some(memory)));
    let [words, _] = &kept.copies;
    let test = ResumableTest::of(words);
    leave(ResumableTest::None);
    assert!(
        test != ResumableTest::Test || cause != ResetCause::Watchdog,
        "the watchdog bit in the midst of a test"
    );
    (test, cause)
}

/// Keeps a test for after the next reset.
pub fn leave(test: ResumableTest) {
    critical_section::with(|cs| {
        if let Some(memory) = MEMORY.borrow(cs).borrow_mut().as_mut() {
            memory.keep(false, &test.words());
        }
    });
}
