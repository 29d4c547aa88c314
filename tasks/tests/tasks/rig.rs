//! A task's links, a virtual clock, and the world's part of every millisecond.

use embassy_time::Instant;
use sophie_clock::VirtualTime;
use sophie_control::params::{Params, ServoMarks};
use sophie_tasks::links::Links;
use sophie_tasks::start::Start;

pub struct Rig {
    pub time: VirtualTime,
    pub links: &'static Links,
    ms: u64,
}

/// The default parameters once every servo is calibrated.
pub fn calibrated() -> Params {
    Params {
        servo_marks: ServoMarks::S1234,
        ..Params::default()
    }
}

impl Rig {
    pub fn new() -> Self {
        Self::with(Params::default())
    }

    pub fn with(params: Params) -> Self {
        Self::starting(params, Start::COLD)
    }

    pub fn starting(params: Params, start: Start) -> Self {
        Self {
            time: VirtualTime::new(),
            links: Box::leak(Box::new(Links::starting(params, start))),
            ms: 0,
        }
    }

    pub fn run(&mut self, ms: u64) {
        self.ms += ms;
        self.time.run_until(self.ms * 1000);
    }

    /// Calls `each` at the start of every millisecond.
    pub fn run_with(&mut self, ms: u64, mut each: impl FnMut(&Links, Instant)) {
        for _ in 0..ms {
            each(self.links, Instant::now());
            self.run(1);
        }
    }
}
