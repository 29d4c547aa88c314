//! The far end of a serial line: what is queued goes out as the line is free, what comes in is kept.

use std::collections::VecDeque;

use rigless::chip::{Timeline, uart};
use rigless::snapshot::store;
use rigless::time::VirtualNanos;
use serde::{Deserialize, Serialize};

/// Both directions of a line. The port times the bytes: each takes what its rate gives.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Line {
    /// Words to be sent to the chip.
    pub outgoing: VecDeque<u16>,
    /// Words that the chip has sent.
    pub incoming: Vec<u16>,
}

store!(Line);

impl uart::Peer for Line {
    fn receive(&mut self, word: u16, _: &mut Timeline<'_, '_>) {
        self.incoming.push(word);
    }

    fn transmit(&mut self, _: VirtualNanos) -> Option<u16> {
        self.outgoing.pop_front()
    }
}
