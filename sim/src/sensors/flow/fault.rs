//! What a faulty module sends instead.

/// Sizes of the faults: jump of the flow, counts of an interval (1.5 rad/s), jump of the range, mm, time between two
/// jumps, ms, and factors on the range.
const JUMP: i32 = 18;
const RANGE_JUMP: f64 = 600.0;
const JUMP_MS: u64 = 300;
const LONG: f64 = 1.6;
const SHORT: f64 = 0.6;

/// Fault of a flow module.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FlowFault {
    /// It sends nothing.
    #[default]
    Silent,
    /// Its pictures are dark: flow of quality 0.
    Dark,
    /// Its flow has the wrong sign.
    Mirrored,
    /// Its flow is 2.5 times as large.
    Scaled,
    /// Its flow repeats.
    Frozen,
    /// Its flow jumps by 1.5 rad/s, back and forth.
    Jumps,
    /// It sends no range.
    RangeSilent,
    /// Its range repeats.
    RangeFrozen,
    /// Its range jumps by 0.6 m, back and forth.
    RangeJumps,
    /// Its range is 1.6 times as long.
    RangeLong,
    /// Its range is 0.6 times as long.
    RangeShort,
}

/// A frame before it is sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Quality of the flow.
    pub quality: u8,
    /// Flow, counts.
    pub counts: [i32; 2],
    /// Range, mm; `None` without a return.
    pub distance: Option<f64>,
}

/// What a frozen module repeats.
#[derive(Clone, Copy, Debug, Default)]
pub struct Held {
    counts: Option<[i32; 2]>,
    range: Option<i32>,
}

impl Held {
    /// The reading of a module with `fault`, `ms` after power-up; `None` if it sends nothing.
    pub fn spoilt(&mut self, fault: Option<FlowFault>, ms: u64, sound: Reading) -> Option<Reading> {
        let jumped = (ms / JUMP_MS).is_multiple_of(2);
        let Reading { counts, distance, .. } = sound;
        let Some(fault) = fault else {
            *self = Self::default();
            return Some(sound);
        };
        let flow = |counts| Reading { counts, ..sound };
        let range = |distance| Reading { distance, ..sound };
        Some(match fault {
            FlowFault::Silent => return None,
            FlowFault::Dark => Reading { quality: 0, ..sound },
            FlowFault::Mirrored => flow(counts.map(|count| -count)),
            FlowFault::Scaled => flow(counts.map(|count| 5 * count / 2)),
            FlowFault::Frozen => flow(*self.counts.get_or_insert([counts[0] | 1, counts[1]])),
            FlowFault::Jumps => {
                let off = if jumped { JUMP } else { -JUMP };
                flow(counts.map(|count| count + off))
            }
            FlowFault::RangeSilent => range(None),
            FlowFault::RangeLong => range(distance.map(|d| LONG * d)),
            FlowFault::RangeShort => range(distance.map(|d| SHORT * d)),
            FlowFault::RangeFrozen => {
                let held = *self.range.get_or_insert(distance.unwrap_or(1000.0) as i32);
                range(Some(f64::from(held)))
            }
            FlowFault::RangeJumps => range(distance.map(|d| if jumped { d + RANGE_JUMP } else { d })),
        })
    }
}
