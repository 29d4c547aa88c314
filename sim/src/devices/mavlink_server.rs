//! The simulated board's MAVLink server on a line.

use sophie_ports::chip::Chip;
use sophie_tasks::ground_station::console_pipe::ConsolePipe;
use sophie_tasks::ground_station::mavlink;
use sophie_tasks::links::Links;

use super::line::{Line, LinePort};
use super::storage::{Memory, Port};
use crate::clock::VirtualTime;

/// Spawns the server on `line` for one start of the board. It sends at most `bytes_per_second`, stores parameters and
/// key in `memory`. Returns the pipe to the console.
pub(crate) fn spawn(
    time: &VirtualTime,
    links: &'static Links,
    line: &'static Line,
    bytes_per_second: u32,
    memory: &'static Memory,
    chip: impl Chip + 'static,
) -> &'static ConsolePipe {
    let port = LinePort(line);
    let lines = mavlink::Lines {
        inputs: [port],
        outputs: [port],
        bytes_per_second: [bytes_per_second],
    };
    let shell: &'static ConsolePipe = Box::leak(Box::default());
    time.spawn(mavlink::run(
        links,
        lines,
        shell,
        Port(memory),
        chip,
        memory.key(),
    ));
    shell
}
