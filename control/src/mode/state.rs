//! The state of the machine: a mode with its fields, and the entry functions.

use super::behaviour::Behaviour;
use super::context::Step;
use super::modes::{Mode, for_each_mode};
use super::reason::Reason;
use super::states;

/// Declares [`State`] and [`Entry`].
macro_rules! declare_states {
    ($($(#[$doc:meta])+ $name:ident in $file:ident = $number:literal, $text:literal;)+) => {
        /// A mode with its fields.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum State { $($name(states::$file::$name),)+ }

        impl State {
            pub fn mode(&self) -> Mode {
                match self { $(Self::$name(_) => Mode::$name,)+ }
            }

            pub fn behaviour(&self) -> &dyn Behaviour {
                match self { $(Self::$name(state) => state,)+ }
            }

            pub fn behaviour_mut(&mut self) -> &mut dyn Behaviour {
                match self { $(Self::$name(state) => state,)+ }
            }
        }

        /// Entry function: previous state, this step, reason.
        #[derive(Clone, Copy, Debug)]
        #[expect(dead_code, reason = "no transition leads to the mode of the start")]
        pub enum Entry { $($name(fn(&State, &mut Step<'_>, Option<Reason>) -> states::$file::$name),)+ }

        impl Entry {
            pub fn enter(self, from: &State, step: &mut Step<'_>, why: Option<Reason>) -> State {
                match self { $(Self::$name(enter) => State::$name(enter(from, step, why)),)+ }
            }

            #[cfg(test)]
            pub fn mode(self) -> Mode {
                match self { $(Self::$name(_) => Mode::$name,)+ }
            }
        }
    };
}

for_each_mode!(declare_states);
