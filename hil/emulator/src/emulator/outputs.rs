//! Time after a reset until the firmware drives each output, and the chip's pull-ups meanwhile.

use rigless::session::Session;
use rigless::time::VirtualNanos;

use crate::boards::wired::Wired;
use crate::processor::chip::Chip;
use crate::wires::Output;

/// Checked at each write to a port's register.
#[derive(Debug, Default)]
pub struct Outputs {
    /// Number of starts, with power-on, and time of the last, ns.
    starts: usize,
    since: u64,
    open: usize,
    pub found: Vec<Output>,
}

impl Outputs {
    pub fn check<C: Chip>(&mut self, session: &mut Session<Wired<C>>, now: VirtualNanos) {
        let starts = session.resets().len() + 1;
        if starts != self.starts {
            self.starts = starts;
            self.since = session.resets().last().map_or(0, |reset| reset.at.0);
            self.open = session.board_mut().outputs().len();
            for output in &mut self.found {
                output.after_us.push(None);
            }
        }
        if self.open == 0 {
            return;
        }
        let board = session.board_mut();
        if self.found.is_empty() {
            self.found = board
                .outputs()
                .into_iter()
                .map(|(what, pin)| Output::new(what, pin))
                .collect();
        }
        self.open = 0;
        let pins = board.outputs();
        for (output, (_, pin)) in self.found.iter_mut().zip(pins) {
            let Some(after @ None) = output.after_us.last_mut() else {
                continue;
            };
            if board.drives(now, pin) {
                *after = Some((now.0 - self.since) as f64 * 1e-3);
            } else {
                self.open += 1;
                output.pulled_up |= board.pulls_up(now, pin);
            }
        }
    }
}
