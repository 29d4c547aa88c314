//! The far end of a serial line.

use std::collections::VecDeque;

use rigless::chip::uart::Errors;
use rigless::chip::{Timeline, uart};
use rigless::snapshot::store;
use rigless::time::VirtualNanos;
use serde::{Deserialize, Serialize};

/// Data bits of a word to which noise is added: 8N1.
const BITS: u32 = 8;

/// Both directions of a line; the port times the bytes by its rate.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Line {
    pub outgoing: VecDeque<u16>,
    pub incoming: Vec<u16>,
    /// The port's own random noise. Runs take no snapshots.
    #[serde(skip)]
    noise: Errors,
}

impl Line {
    /// Advances the port's noise by a word. The port flips the bits that the noise hits; flipped here first, the word
    /// arrives right, as a majority of three samples would make it.
    pub fn align(&mut self, noise: Errors) {
        if self.outgoing.is_empty() {
            self.noise = noise;
        }
    }
}

store!(Line);

impl uart::Peer for Line {
    fn receive(&mut self, word: u16, _: &mut Timeline<'_, '_>) {
        self.incoming.push(word);
    }

    fn transmit(&mut self, _: VirtualNanos) -> Option<u16> {
        let word = self.outgoing.pop_front()?;
        Some(word ^ self.noise.next(BITS).flipped)
    }
}
