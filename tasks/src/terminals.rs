//! Two terminals at one console: what is typed at either is obeyed, and answered where something was typed last.
//!
//! There is one console for both, so that there is one working copy of the parameters and one who gives orders.

use core::cell::Cell;

use embassy_futures::select::{Either, select};

use crate::console::CANCEL;
use crate::ports::{PortError, SerialInput, SerialOutput};

/// Where something was typed last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Terminal {
    #[default]
    First,
    Second,
}

/// Which of two terminals the console serves.
#[derive(Debug, Default)]
pub struct Served(Cell<Terminal>);

/// What is typed at two terminals. One that had been idle takes the console over: what was begun at the other ends, as by
/// its Ctrl-C.
pub struct Keyboards<'a, A, B> {
    served: &'a Served,
    first: A,
    second: B,
    /// Looked at first where both have something: each has its turn.
    turn: Terminal,
}

/// What is shown at the terminal that is served.
pub struct Screens<'a, A, B> {
    served: &'a Served,
    first: A,
    second: B,
}

impl Served {
    /// Two keyboards.
    pub const fn keyboards<A, B>(&self, first: A, second: B) -> Keyboards<'_, A, B> {
        Keyboards {
            served: self,
            first,
            second,
            turn: Terminal::First,
        }
    }

    /// Their screens.
    pub const fn screens<A, B>(&self, first: A, second: B) -> Screens<'_, A, B> {
        Screens {
            served: self,
            first,
            second,
        }
    }
}

impl<A: SerialInput, B: SerialInput> SerialInput for Keyboards<'_, A, B> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        let middle = buffer.len() / 2;
        let (one, other) = buffer.split_at_mut(middle);
        // The first byte of each is kept for the end of what was begun elsewhere.
        let (Some((_, one)), Some((_, other))) = (one.split_first_mut(), other.split_first_mut()) else {
            return Err(PortError::Absent);
        };
        let (from, read) = match self.turn {
            Terminal::First => match select(self.first.read(one), self.second.read(other)).await {
                Either::First(read) => (Terminal::First, read),
                Either::Second(read) => (Terminal::Second, read),
            },
            Terminal::Second => match select(self.second.read(other), self.first.read(one)).await {
                Either::First(read) => (Terminal::Second, read),
                Either::Second(read) => (Terminal::First, read),
            },
        };
        let (start, next) = match from {
            Terminal::First => (1, Terminal::Second),
            Terminal::Second => (middle + 1, Terminal::First),
        };
        self.turn = next;
        let served = self.served.0.get();
        let count = match read {
            Err(_) if from != served => return Ok(0),
            read => read?,
        };
        let typed = start..start + count;
        if from == served {
            buffer.copy_within(typed, 0);
            return Ok(count);
        }
        // The end of what was never begun takes nothing over.
        let idle = buffer.get(typed.clone()).unwrap_or_default();
        if idle.iter().all(|&byte| byte == CANCEL) {
            return Ok(0);
        }
        self.served.0.set(from);
        buffer.copy_within(typed, 1);
        if let Some(first) = buffer.first_mut() {
            *first = CANCEL;
        }
        Ok(count + 1)
    }

    fn private(&self) -> bool {
        self.first.private() && self.second.private()
    }
}

impl<A: SerialOutput, B: SerialOutput> SerialOutput for Screens<'_, A, B> {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        match self.served.0.get() {
            Terminal::First => self.first.write(bytes).await,
            Terminal::Second => self.second.write(bytes).await,
        }
    }
}
