//! Several terminals at one console: commands are accepted from all, output goes to the terminal with the latest
//! input.
//!
//! A single console serves them all, so that there is one working copy of the parameters and one source of orders.

use core::array;
use core::cell::Cell;

use embassy_futures::select::select_array;

use crate::console::CANCEL;
use sophie_ports::error::PortError;
use sophie_ports::serial::{SerialInput, SerialOutput};

/// Index of the active terminal: the one with the latest input.
#[derive(Debug, Default)]
pub struct ActiveTerminal(Cell<usize>);

/// Input of all terminals. Input at an inactive terminal takes the console over and aborts the other's command or
/// line, as Ctrl-C does.
pub struct TerminalInputs<'a, I, const N: usize> {
    served: &'a ActiveTerminal,
    ports: [I; N],
    /// Terminal polled first if several have input (round robin).
    turn: usize,
}

/// Output to the active terminal.
pub struct TerminalOutputs<'a, O, const N: usize> {
    served: &'a ActiveTerminal,
    ports: [O; N],
}

impl ActiveTerminal {
    /// Combined input of `ports`.
    pub const fn inputs<I, const N: usize>(&self, ports: [I; N]) -> TerminalInputs<'_, I, N> {
        TerminalInputs {
            served: self,
            ports,
            turn: 0,
        }
    }

    /// Combined output of `ports`, in the same order.
    pub const fn outputs<O, const N: usize>(&self, ports: [O; N]) -> TerminalOutputs<'_, O, N> {
        TerminalOutputs { served: self, ports }
    }
}

impl<I: SerialInput, const N: usize> SerialInput for TerminalInputs<'_, I, N> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        let share = buffer.len().checked_div(N).unwrap_or(0);
        // The first byte of each share is reserved for the CANCEL of a takeover.
        let (Some((before, after)), 2..) = (self.ports.split_at_mut_checked(self.turn), share) else {
            return Err(PortError::Absent);
        };
        let mut ports = after.iter_mut().chain(before);
        let mut shares = buffer.chunks_exact_mut(share);
        let reads = array::from_fn::<_, N, _>(|_| {
            let port = ports.next();
            let room = shares.next().and_then(<[u8]>::split_first_mut);
            async move {
                match (port, room) {
                    (Some(port), Some((_, room))) => port.read(room).await,
                    _ => Err(PortError::Absent),
                }
            }
        });
        let (read, at) = select_array(reads).await;
        let from = following(self.turn + at, N);
        self.turn = following(from + 1, N);
        let served = self.served.0.get();
        let count = match read {
            Err(_) if from != served => return Ok(0),
            read => read?,
        };
        let start = at * share + 1;
        let typed = start..start + count;
        if from == served {
            buffer.copy_within(typed, 0);
            return Ok(count);
        }
        // A lone CANCEL does not take the console over.
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
        let served = self.ports.get(self.served.0.get());
        served.is_some_and(SerialInput::private)
    }
}

/// `place` modulo `count`, for `place` below twice `count`.
const fn following(place: usize, count: usize) -> usize {
    if place >= count { place - count } else { place }
}

impl<O: SerialOutput, const N: usize> SerialOutput for TerminalOutputs<'_, O, N> {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        match self.ports.get_mut(self.served.0.get()) {
            Some(port) => port.write(bytes).await,
            None => Err(PortError::Absent),
        }
    }
}
