//! Autonomous perching: number of tries, and whether the pilot has taken over. The state `Approach` flies it.

use crate::maths::vector::Vec3;
use crate::mode::inputs::Inputs;
use crate::mode::modes::Mode;
use crate::pilot::rc::Sticks;
use crate::pilot::stick_positions::{THROTTLE_CENTRE, centred};

/// Number of tries after which the vehicle is handed back to the pilot.
pub const TRIES: u8 = 5;

/// The crown of the pipe as assumed at a descent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LastCrown {
    /// Position in the estimate's axes, m.
    pub position: Vec3,
    /// The estimate's reset counter at that time.
    pub reset_count: u8,
}

/// State of autonomous perching.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AutoPerch {
    /// The vehicle perches or leaves autonomously, or has perched so.
    pub active: bool,
    /// It leaves the pipe: no further try follows.
    pub leaving: bool,
    /// The pilot has moved a stick or turned a switch.
    pub taken: bool,
    /// Number of tries begun.
    pub tries: u8,
    /// A try has ended because the range was inconsistent with the motion.
    pub misfit: bool,
    /// Heading of the pipe, taken at the first try, by the vehicle's own attitude, rad.
    pub heading: f32,
    /// The crown at the last descent.
    pub last_crown: Option<LastCrown>,
}

impl AutoPerch {
    /// Starts the first try, at `heading` rad.
    pub fn begin(&mut self, heading: f32) {
        *self = Self {
            active: true,
            tries: 1,
            heading,
            ..Self::default()
        };
    }

    /// Starts the departure from the pipe.
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
            // A lower throttle does not count as taking over.
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

    /// A further try is allowed.
    pub fn may_try(&self) -> bool {
        self.active && !self.taken && !self.leaving && self.tries < TRIES
    }

    /// Autonomous perching is in control: the pilot has not taken over.
    pub fn acts(&self) -> bool {
        self.active && !self.taken
    }
}
