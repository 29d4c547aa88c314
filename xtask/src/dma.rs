//! Checks that DMA reaches its buffers; elsewhere it would silently fail on most chips. Buffers are statics named
//! `DMA_…`, and task futures (embassy's statics `POOL`), which hold buffers that live across an `await`.

use crate::Error;
use crate::boards::Board;
use crate::image::Image;

/// Motors, receiver and converter.
const FEWEST: usize = 3;

/// Checks every buffer; returns their number.
///
/// # Errors
/// A buffer out of DMA's reach; or too few, which means that names have changed.
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
