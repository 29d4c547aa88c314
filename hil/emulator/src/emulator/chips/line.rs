//! The far end of a serial line.

use std::collections::VecDeque;

use rigless::chip::{Timeline, uart};
use rigless::snapshot::store;
use rigless::time::VirtualNanos;
use serde::{Deserialize, Serialize};

/// Both directions of a line; the port times the bytes by its rate.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Line {
    pub outgoing: VecDeque<u16>,
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
