//! Stack frame of each function of an image, and the stack depth at each of its calls, read from its instructions.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

use super::thumb::{Effect, Flow};
use crate::Error;
use crate::image::Image;

/// A function's own stack.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    pub name: String,
    /// Greatest depth of its own, bytes.
    pub own: i64,
    /// Functions that it calls or jumps to, and its greatest depth there, bytes.
    pub calls: BTreeMap<u64, i64>,
    /// Greatest depth at a call through a register, bytes.
    pub unknown: Option<i64>,
}

/// Every function of an image, by its address.
pub type Frames = BTreeMap<u64, Frame>;

/// Reads the code of `image`.
///
/// # Errors
/// A function whose stack depends on a register.
pub fn read(image: &Image) -> Result<Frames, Error> {
    let ends: BTreeMap<u64, u64> = image
        .functions
        .iter()
        .filter(|f| f.size > 0)
        .map(|f| (f.address, f.address + f.size))
        .collect();
    let mut frames = Frames::new();
    for function in image.functions.iter().filter(|f| f.size > 0) {
        // Some have several names.
        if let Entry::Vacant(entry) = frames.entry(function.address) {
            entry.insert(frame(image, &function.name, function.address, &ends)?);
        }
    }
    Ok(frames)
}

fn frame(image: &Image, name: &str, begin: u64, ends: &BTreeMap<u64, u64>) -> Result<Frame, Error> {
    let name = format!("{:#}", rustc_demangle::demangle(name));
    let end = ends.get(&begin).copied().unwrap_or(begin);
    let mut frame = Frame {
        name,
        ..Frame::default()
    };
    // Address, depth, instructions that are still under a condition.
    let mut open = vec![(begin, 0, 0)];
    let mut seen = BTreeMap::<u64, i64>::new();
    while let Some((at, depth, conditional)) = open.pop() {
        // Constants or the next function may follow a call that never returns.
        if !(begin..end).contains(&at) || !image.is_code(at) {
            continue;
        }
        if seen.get(&at).is_some_and(|before| *before >= depth) {
            continue;
        }
        seen.insert(at, depth);
        let Some(effect) = Effect::of(at, image.halfword(at), image.halfword(at + 2)) else {
            return Err(format!("{}: its stack depends on a register at {at:#010x}", frame.name).into());
        };
        let (after, next) = (depth + effect.grows, at + effect.bytes);
        frame.own = frame.own.max(after);
        let under = effect.conditional.max(u8::saturating_sub(conditional, 1));
        // A conditional instruction may not be executed.
        let mut go_on = conditional > 0;
        match effect.flow {
            Flow::Next => go_on = true,
            // Out of the function is a call that comes back to this one's caller.
            Flow::Branch(to) | Flow::Jump(to) if !(begin..end).contains(&to) => {
                frame.call(to, after);
                go_on |= effect.flow == Flow::Branch(to);
            }
            Flow::Branch(to) => {
                open.push((to, after, 0));
                go_on = true;
            }
            Flow::Jump(to) => open.push((to, after, 0)),
            Flow::Call(to) => {
                frame.call(to, after);
                go_on = true;
            }
            Flow::CallRegister => {
                frame.unknown = frame.unknown.max(Some(after));
                go_on = true;
            }
            Flow::JumpRegister => frame.unknown = frame.unknown.max(Some(after)),
            Flow::Table(size) => open.extend(table(image, next, size).into_iter().map(|to| (to, after, 0))),
            Flow::End => {}
        }
        if go_on {
            open.push((
                next,
                if conditional > 0 { depth.max(after) } else { after },
                under,
            ));
        }
    }
    Ok(frame)
}

impl Frame {
    fn call(&mut self, to: u64, depth: i64) {
        let known = self.calls.entry(to).or_insert(depth);
        *known = (*known).max(depth);
    }
}

/// Places that the table at `at` leads to. It ends where the first of them begins.
fn table(image: &Image, at: u64, size: u64) -> BTreeSet<u64> {
    let mut places = BTreeSet::new();
    let mut entry = at;
    while places.first().is_none_or(|first| entry < *first) {
        let half = image.halfword(entry & !1);
        let value = match size {
            2 => half,
            _ if entry & 1 == 0 => half & 0xFF,
            _ => half >> 8,
        };
        places.insert(at + 2 * u64::from(value));
        entry += size;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Load, Static};

    const AT: u64 = 0x0800_C000;
    const OTHER: u64 = AT + 0x100;

    /// The frame of a function of these halfwords.
    fn of(code: &[u16]) -> Frame {
        let function = |name: &str, address, size| Static {
            name: name.into(),
            address,
            size,
        };
        // In whole words, as the linker loads them.
        let padded = code.iter().chain(&[0; 1]).take(code.len().next_multiple_of(2));
        let bytes: Vec<u8> = padded.flat_map(|half| half.to_le_bytes()).collect();
        let image = Image {
            functions: vec![
                function("f", AT, 2 * code.len() as u64),
                function("other", OTHER, 2),
            ],
            loads: vec![Load { address: AT, bytes }],
            ..Image::default()
        };
        read(&image).unwrap().remove(&AT).unwrap()
    }

    #[test]
    fn a_frame_is_as_deep_as_its_deepest_path_and_calls_from_where_they_stand() {
        // push {r4, lr}; cbz r0, 1f; sub sp, #16; bl other; add sp, #16; 1: pop {r4, pc}
        let frame = of(&[0xB510, 0xB118, 0xB084, 0xF000, 0xF87B, 0xB004, 0xBD10]);
        assert_eq!((frame.own, &frame.calls), (24, &BTreeMap::from([(OTHER, 24)])));
        // push {r4, lr}; pop.w {r4, lr}; b.w other
        let frame = of(&[0xB510, 0xE8BD, 0x4010, 0xF000, 0xB87B]);
        assert_eq!((frame.own, &frame.calls), (8, &BTreeMap::from([(OTHER, 0)])));
        // push {r7, lr}; blx r3; pop {r7, pc}
        assert_eq!(of(&[0xB580, 0x4798, 0xBD80]).unknown, Some(8));
    }

    #[test]
    fn tables_and_conditions_are_followed() {
        // tbb [pc, r0]; 2, 1; pop {pc}; sub sp, #64; pop {pc}
        let frame = of(&[0xE8DF, 0xF000, 0x0102, 0xBD00, 0xB090, 0xBD00]);
        assert_eq!(frame.own, 64);
        // it eq; bxeq lr; sub sp, #32; bx lr
        assert_eq!(of(&[0xBF08, 0x4770, 0xB088, 0x4770]).own, 32);
    }
}
