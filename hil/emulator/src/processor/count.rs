//! Counts the control path's instructions: from data-ready to the end of the sensor's transfer, and from there to the
//! motor frame. Every instruction is watched by address, independent of the emulator's code generator.

use rigless::emulator::{Access, AccessKind, Hit, Host, Watch};

use crate::chain::{Counted, Functions, Step};
use crate::elf::Firmware;

/// In the timer's first control register.
const ENABLE: u64 = 1;

#[derive(Clone, Copy, Debug)]
pub struct Marks {
    /// Handler of the data-ready line.
    pub ready: &'static str,
    /// Handler of the sensor's DMA stream.
    pub received: &'static str,
    /// First control register of the motors' timer.
    pub motors: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// Before data-ready or after the frame's start.
    Neither,
    /// From data-ready to the end of the transfer.
    Reading,
    /// From the transfer's end to the frame's start.
    Acting,
}

#[derive(Debug)]
pub struct Counter {
    functions: Functions,
    ready: u64,
    received: u64,
    motors: u64,
    from_ms: u64,
    wanted: usize,
    watching: bool,
    part: Part,
    step: Step,
    counted: Counted,
}

impl Counter {
    /// A counter for `firmware`, if anything is to be counted.
    ///
    /// # Errors
    /// One line: what the image lacks.
    pub fn new(firmware: &Firmware, marks: Marks) -> Result<Option<Self>, String> {
        let Some(window) = firmware.count else {
            return Ok(None);
        };
        let functions = Functions::read(&firmware.bytes)?;
        let begin = |name: &str| {
            let begin = functions.begin_of(name);
            begin.ok_or_else(|| format!("{}: has no function {name}", firmware.path.display()))
        };
        Ok(Some(Self {
            ready: begin(marks.ready)?,
            received: begin(marks.received)?,
            motors: marks.motors,
            from_ms: window.from_ms,
            wanted: window.steps,
            watching: false,
            part: Part::Neither,
            step: Step::default(),
            counted: Counted::default(),
            functions,
        }))
    }

    /// Starts at millisecond `ms`, stops after the wanted steps.
    pub fn on_millisecond(&mut self, ms: u64, host: &mut dyn Host) {
        let wanted = ms >= self.from_ms && self.counted.steps.len() < self.wanted;
        if wanted == self.watching {
            return;
        }
        self.watching = wanted;
        self.part = Part::Neither;
        for address in self.functions.halfwords() {
            if wanted {
                host.watch(Watch::Instruction(address));
            } else {
                host.unwatch(Watch::Instruction(address));
            }
        }
    }

    pub fn on_hit(&mut self, hit: Hit) {
        if hit.address == self.ready {
            self.step = Step::default();
            self.part = Part::Reading;
        } else if hit.address == self.received && self.part == Part::Reading {
            self.part = Part::Acting;
            self.step.received = hit.instruction_count;
        }
        let counts = match self.part {
            Part::Neither => return,
            Part::Reading => &mut self.step.reading,
            Part::Acting => &mut self.step.acting,
        };
        *counts.entry(self.functions.at(hit.address)).or_default() += 1;
    }

    pub fn on_access(&mut self, access: &Access) {
        let starts =
            access.kind == AccessKind::Write && access.address == self.motors && access.value & ENABLE != 0;
        if starts && self.part == Part::Acting && self.counted.steps.len() < self.wanted {
            self.part = Part::Neither;
            let mut step = std::mem::take(&mut self.step);
            step.passed = access.instruction_count - step.received;
            self.counted.steps.push(step);
        }
    }

    pub fn finish(self) -> Counted {
        self.counted
    }
}
