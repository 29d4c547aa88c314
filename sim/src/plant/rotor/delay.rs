//! Time from a motor pulse to the controller's reaction: the rest of its own commutation cycle, and its filter.

use super::super::STEP;

/// Longest delay, s.
pub const LONGEST: f64 = 0.02;
/// Steps of the longest delay.
const STEPS: usize = 40;

/// Commands on their way.
#[derive(Clone, Copy, Debug)]
pub struct Delay {
    commands: [f64; STEPS],
    /// 0 to [`STEPS`].
    steps: usize,
    next: usize,
}

impl Delay {
    /// A delay of `seconds`, at most [`LONGEST`], to the next whole [`STEP`]; no command is on its way.
    #[must_use]
    pub fn new(seconds: f64) -> Self {
        Self {
            commands: [0.0; STEPS],
            steps: ((seconds / STEP).round() as usize).min(STEPS),
            next: 0,
        }
    }

    /// Takes the command of this step, and returns the one that arrives.
    pub fn pass(&mut self, command: f64) -> f64 {
        if self.steps == 0 {
            return command;
        }
        let arrived = std::mem::replace(&mut self.commands[self.next], command);
        self.next = (self.next + 1) % self.steps;
        arrived
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_arrives_after_the_delay() {
        for (seconds, steps) in [(0.0, 0), (STEP, 1), (0.005, 10), (LONGEST, STEPS)] {
            let mut delay = Delay::new(seconds);
            let arrived: Vec<f64> = (1..=50).map(|i| delay.pass(f64::from(i))).collect();
            for (i, command) in arrived.iter().enumerate() {
                let expected = (i + 1).saturating_sub(steps) as f64;
                assert_eq!(*command, expected, "{seconds} s, step {i}");
            }
        }
    }
}
