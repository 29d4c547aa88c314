//! Stack of an image: its placement, and the depth of the USB handlers, which the bench's flights do not reach.

mod frames;
mod thumb;

use std::cell::RefCell;
use std::collections::HashMap;

use self::frames::Frames;
use crate::Error;
use crate::boards::Board;
use crate::image::Image;

/// An exception's frame with floats, and its alignment (ARMv7-M, B1.5.7).
const EXCEPTION: u64 = 26 * 4 + 4;
/// The interrupt of the USB core, and the task.
const HANDLER: &str = "OTG_FS";
const TASK: &str = "__usb_task_inner_function";
/// Excluded: it ends the run, so its own stack use does not matter.
const END: &str = "core::panicking::panic_fmt";
/// Functions that calls by an address in a register reach from there: the wakers of the executor, and the USB class's
/// handlers of the device's events.
const REACHED: [&str; 2] = ["embassy_executor::raw::waker::", "as embassy_usb::Handler>::"];

/// Checks that the stack of `image` lies at the bottom of a memory, so that an overflow faults.
///
/// # Errors
/// It lies elsewhere, or reaches beyond.
pub fn check(board: &Board, image: &Image) -> Result<(), Error> {
    let (end, start) = (image.symbol("_stack_end")?, image.symbol("_stack_start")?);
    let banks = board.banks;
    let at_bottom = banks.iter().any(|bank| bank.start == end && start <= bank.end);
    if at_bottom && banks.iter().all(|bank| bank.end != end) {
        Ok(())
    } else {
        Err(format!(
            "the stack lies at {end:#010x} to {start:#010x}: allowed is the bottom of a memory, where an overflow faults"
        )
        .into())
    }
}

/// Depth of the USB handlers of `image`, bytes: the interrupt with its exception frame, and the task's deepest poll.
///
/// # Errors
/// The handlers or the functions that they reach are not found, or their depth is unbounded.
pub fn usb(image: &Image) -> Result<u64, Error> {
    let frames = frames::read(image)?;
    let chains = Chains::new(&frames)?;
    let root = |named: &dyn Fn(&str) -> bool, what: &str| {
        let found = frames.iter().find(|(_, frame)| named(&frame.name));
        found
            .map(|(at, _)| *at)
            .ok_or_else(|| format!("the image has no `{what}`: was it renamed?"))
    };
    let interrupt = root(&|name| name == HANDLER, HANDLER)?;
    let task = root(&|name| name.contains(TASK) && name.ends_with(">::poll"), TASK)?;
    Ok(EXCEPTION + chains.depth(interrupt)? + chains.depth(task)?)
}

struct Chains<'a> {
    frames: &'a Frames,
    /// Depth of the deepest that a call by an address in a register reaches.
    reached: i64,
    known: RefCell<HashMap<u64, i64>>,
}

impl<'a> Chains<'a> {
    fn new(frames: &'a Frames) -> Result<Self, Error> {
        let mut chains = Self {
            frames,
            reached: 0,
            known: RefCell::default(),
        };
        let mut reached = 0;
        for name in REACHED {
            let mut found = frames
                .iter()
                .filter(|(_, frame)| frame.name.contains(name))
                .peekable();
            if found.peek().is_none() {
                return Err(format!("the image has no `{name}`: was it renamed?").into());
            }
            for (at, _) in found {
                reached = reached.max(chains.below(*at, &mut Vec::new())?);
            }
        }
        chains.reached = reached;
        chains.known.take();
        Ok(chains)
    }

    fn depth(&self, at: u64) -> Result<u64, Error> {
        Ok(u64::try_from(self.below(at, &mut Vec::new())?)?)
    }

    /// Of the function at `at` and all below, called by `path`.
    fn below(&self, at: u64, path: &mut Vec<u64>) -> Result<i64, Error> {
        let Some(frame) = self.frames.get(&at) else {
            return Err(format!("a call leads to {at:#010x}, where no function begins").into());
        };
        if frame.name == END {
            return Ok(0);
        }
        if let Some(known) = self.known.borrow().get(&at) {
            return Ok(*known);
        }
        if path.contains(&at) {
            return Err(format!("{} calls itself: its stack has no bound", frame.name).into());
        }
        path.push(at);
        let mut deepest = frame
            .own
            .max(frame.unknown.map_or(0, |depth| depth + self.reached));
        for (to, depth) in &frame.calls {
            deepest = deepest.max(depth + self.below(*to, path)?);
        }
        path.pop();
        self.known.borrow_mut().insert(at, deepest);
        Ok(deepest)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::frames::Frame;
    use super::*;
    use crate::boards;

    #[test]
    fn a_stack_lies_where_one_that_overflows_faults() {
        for (board, end, start, good) in [
            ("f405", 0x1000_0000, 0x1001_0000, true),
            ("matek-h743", 0x2000_0000, 0x2001_FC00, true),
            ("cuav-v5", 0x2000_0000, 0x2000_E000, true),
            // Below are the statics; other memory; beyond the end.
            ("f405", 0x1000_8000, 0x1001_0000, false),
            ("cuav-v5", 0x2002_0000, 0x2003_0000, false),
            ("f405", 0x1000_0000, 0x1001_0400, false),
        ] {
            let symbols = [("_stack_end", end), ("_stack_start", start)];
            let image = Image {
                symbols: symbols.map(|(name, at)| (name.to_string(), at)).into(),
                ..Image::default()
            };
            let checked = check(boards::find(board).unwrap(), &image);
            assert_eq!(checked.is_ok(), good, "{board} {end:#x}");
        }
    }

    fn frame(name: &str, own: i64, calls: &[(u64, i64)], unknown: Option<i64>) -> Frame {
        Frame {
            name: name.to_string(),
            own,
            calls: calls.iter().copied().collect(),
            unknown,
        }
    }

    #[test]
    fn the_deepest_chain_counts_with_what_registers_reach_and_without_the_end_of_the_run() {
        let mut frames: Frames = BTreeMap::from([
            (1, frame("root", 40, &[(2, 16), (3, 40)], None)),
            (2, frame("deep", 100, &[(4, 100), (5, 100)], None)),
            (3, frame("register", 8, &[], Some(8))),
            (4, frame("leaf", 12, &[], None)),
            (5, frame(END, 9000, &[], None)),
            (
                6,
                frame("embassy_executor::raw::waker::wake", 24, &[(4, 24)], None),
            ),
            (
                7,
                frame("<Handler as embassy_usb::Handler>::reset", 200, &[], None),
            ),
        ]);
        let chains = Chains::new(&frames).unwrap();
        // 40 + 8 + 200; 16 + 100 + 12.
        assert_eq!(chains.depth(1).unwrap(), 248);
        assert_eq!(chains.depth(2).unwrap(), 112);
        frames.get_mut(&4).unwrap().calls.insert(2, 12);
        let chains = Chains::new(&frames);
        assert!(
            chains
                .and_then(|chains| chains.depth(1))
                .unwrap_err()
                .to_string()
                .contains("calls itself")
        );
        frames.remove(&7);
        let missing = Chains::new(&frames).err().unwrap().to_string();
        assert!(
            missing.contains("renamed") || missing.contains("calls itself"),
            "{missing}"
        );
    }
}
