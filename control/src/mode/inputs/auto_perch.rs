//! Perching by itself, beyond the state that flies it: tries, and the pilot's hands on the sticks.

use crate::maths::vector::Vec3;
use crate::mode::inputs::Inputs;
use crate::mode::modes::Mode;
use crate::pilot::rc::Sticks;
use crate::pilot::stick_positions::{THROTTLE_CENTRE, centred};

/// Tries after which the vehicle is handed back.
pub const TRIES: u8 = 5;
/// What the vehicle does without the pilot's sticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AutoPerch {
    /// It perches or leaves by itself, or has come here so.
    pub active: bool,
    /// It is leaving: there is no other try.
    pub leaving: bool,
    /// The pilot's hands are on the sticks, or he has turned a switch.
    pub taken: bool,
    /// Tries begun.
    pub tries: u8,
    /// One has ended because the range did not fit the motion.
    pub misfit: bool,
    /// Heading at the first one, which is the pipe's, by the vehicle's own attitude, rad.
    pub heading: f32,
    /// Where the crown was taken to be on the last way down, in the estimate's axes, m, and how often these had jumped.
    pub crown: Option<(Vec3, u8)>,
}

impl AutoPerch {
    /// The first try, at `heading` rad.
    pub fn begin(&mut self, heading: f32) {
        *self = Self {
            active: true,
            tries: 1,
            heading,
            ..Self::default()
        };
    }

    /// The way off the pipe.
    pub fn leave(&mut self, heading: f32) {
        *self = Self {
            active: true,
            leaving: true,
            heading,
            ..Self::default()
        };
    }

    /// One step before the transitions of `mode`.
    pub fn follow(&mut self, mode: Mode, inputs: &Inputs) {
        let Some(sticks) = inputs.sticks.filter(|_| self.active) else {
            return;
        };
        let on_pipe = matches!(mode, Mode::Contact | Mode::Clamping | Mode::Releasing);
        let moved = match mode {
            Mode::Approach | Mode::Escaping => !centred(&sticks),
            // A throttle that is drawn back is no wish to fly.
            _ if on_pipe => !centred(&Sticks {
                throttle: sticks.throttle.max(THROTTLE_CENTRE),
                ..sticks
            }),
            _ => return,
        };
        let switched = !self.leaving && !sticks.perch_switch;
        self.taken |= moved || switched || !sticks.hold_switch;
    }

    /// `mode` begins.
    pub fn enters(&mut self, mode: Mode) {
        match mode {
            Mode::Approach | Mode::Contact | Mode::Clamping | Mode::Releasing | Mode::Escaping => (),
            Mode::Perched => {
                *self = Self {
                    active: self.active,
                    ..Self::default()
                }
            }
            _ => *self = Self::default(),
        }
    }

    /// Another try is left.
    pub fn may_try(&self) -> bool {
        self.active && !self.taken && !self.leaving && self.tries < TRIES
    }

    /// It acts, and the pilot has not taken over.
    pub fn acts(&self) -> bool {
        self.active && !self.taken
    }
}
