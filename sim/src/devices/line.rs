//! A serial line of the simulated board; its far end sends and receives datagrams.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;

use embassy_sync::pipe::Pipe;
use sophie_ports::error::PortError;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_tasks::links::last_value::Raw;

/// Bytes towards the board that wait for its task: more than a fast client sends within a millisecond.
const INPUT: usize = 4096;
/// Writes of the board that wait for the next millisecond.
const OUTPUT: usize = 256;

/// Both directions. Each write of the board stays one datagram.
pub struct Line {
    input: Pipe<Raw, INPUT>,
    output: RefCell<VecDeque<Vec<u8>>>,
    /// The board is to restart.
    restart: Cell<bool>,
}

impl Line {
    /// An empty line.
    pub const fn new() -> Self {
        Self {
            input: Pipe::new(),
            output: RefCell::new(VecDeque::new()),
            restart: Cell::new(false),
        }
    }

    /// Puts a datagram on the line; one without room is lost whole.
    pub fn receive(&self, datagram: &[u8]) {
        if datagram.len() > self.input.free_capacity() {
            return;
        }
        let mut rest = datagram;
        while !rest.is_empty()
            && let Ok(taken) = self.input.try_write(rest)
        {
            rest = rest.get(taken..).unwrap_or_default();
        }
    }

    /// Takes the oldest write of the board.
    pub fn take_write(&self) -> Option<Vec<u8>> {
        self.output.borrow_mut().pop_front()
    }

    /// Asks for a restart of the board.
    pub fn restart(&self) {
        self.restart.set(true);
    }

    /// A restart has been asked for since the last call.
    pub fn restarts(&self) -> bool {
        self.restart.take()
    }

    /// Discards all bytes in both directions.
    pub fn clear(&self) {
        self.input.clear();
        self.output.borrow_mut().clear();
    }
}

/// The board's end of a line.
#[derive(Clone, Copy)]
pub struct LinePort(pub &'static Line);

impl SerialInput for LinePort {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        Ok(self.0.input.read(buffer).await)
    }
}

impl SerialOutput for LinePort {
    /// Never waits; a full line loses the oldest write.
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        let mut output = self.0.output.borrow_mut();
        if output.len() == OUTPUT {
            output.pop_front();
        }
        output.push_back(bytes.to_vec());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use embassy_futures::block_on;

    use super::*;

    #[test]
    fn datagrams_become_bytes_and_writes_stay_whole() {
        let line: &'static Line = Box::leak(Box::new(Line::new()));
        let mut port = LinePort(line);
        line.receive(b"ab");
        line.receive(b"c");
        let mut bytes = [0; 8];
        assert_eq!(block_on(port.read(&mut bytes)), Ok(3));
        assert_eq!(&bytes[..3], b"abc");
        block_on(port.write(b"one")).unwrap();
        block_on(port.write(b"two")).unwrap();
        assert_eq!(
            (line.take_write(), line.take_write(), line.take_write()),
            (Some(b"one".to_vec()), Some(b"two".to_vec()), None)
        );
    }

    #[test]
    fn a_full_line_loses_whole_datagrams_and_the_oldest_writes() {
        let line: &'static Line = Box::leak(Box::new(Line::new()));
        let mut port = LinePort(line);
        line.receive(&[1; INPUT - 1]);
        line.receive(&[2; 2]);
        line.receive(&[3; 1]);
        let mut bytes = [0; INPUT + 1];
        let mut count = 0;
        while count < INPUT {
            count += block_on(port.read(&mut bytes[count..])).unwrap();
        }
        assert!(bytes[..INPUT - 1].iter().all(|byte| *byte == 1) && bytes[INPUT - 1] == 3);
        for n in 0..=OUTPUT {
            block_on(port.write(&n.to_le_bytes())).unwrap();
        }
        assert_eq!(line.take_write(), Some(1_usize.to_le_bytes().to_vec()));
    }
}
