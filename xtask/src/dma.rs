//! Where DMA reads and writes: in memory that it reaches.
//!
//! Two kinds of memory are DMA's: statics called `DMA_…`, and the futures of the tasks (embassy's statics `POOL`), since
//! a buffer that lives across an `await` is part of its task's future. A buffer elsewhere would be moved from or to
//! nowhere, and on most chips nothing would say so.

use crate::Error;
use crate::boards::Board;
use crate::image::Image;

/// Fewest buffers that a board with motors, receiver and converter can have.
const FEWEST: usize = 3;

/// Checks every buffer; returns how many there are.
///
/// # Errors
/// A buffer where DMA does not reach, by name; or too few buffers, which means that the names have changed.
pub fn check(board: &Board, image: &Image) -> Result<usize, Error> {
    let buffers: Vec<_> = image
        .statics
        .iter()
        .filter(|s| s.name.contains("DMA_") && s.size > 0)
        .collect();
    let futures: Vec<_> = image
        .statics
        .iter()
        .filter(|s| s.name.contains("4POOL") && s.size > 0)
        .collect();
    if buffers.len() < FEWEST || futures.is_empty() {
        let (buffers, futures) = (buffers.len(), futures.len());
        return Err(format!(
            "only {buffers} DMA buffers and {futures} task futures found: were they renamed?"
        )
        .into());
    }
    for s in buffers.iter().chain(&futures) {
        let reached = board
            .dma_reaches
            .iter()
            .any(|&(start, end)| s.address >= start && s.address + s.size <= end);
        if !reached {
            return Err(format!("DMA does not reach {} at {:#010x}", s.name, s.address).into());
        }
    }
    Ok(buffers.len() + futures.len())
}
