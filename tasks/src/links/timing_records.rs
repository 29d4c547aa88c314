//! Timing of every task, and of the chain from the conversion of pressures to the servos' pulse.

use core::cell::RefCell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::signal::Signal;

use super::last_value::Raw;
use crate::schedule::histogram::Histogram;
use crate::schedule::timing::{Quantity, Record, Run, Timing};
use crate::schedule::{Level, TaskId};

/// Records of timing, each behind its own lock.
pub struct TimingRecords {
    /// every task of the flight level -> log. When one misses its deadline.
    pub missed: Signal<Raw, ()>,
    tasks: [Mutex<Raw, RefCell<Record>>; TaskId::COUNT],
    contact: Mutex<Raw, RefCell<Record>>,
}

impl TimingRecords {
    pub(super) const fn new() -> Self {
        Self {
            missed: Signal::new(),
            tasks: [const { Mutex::new(RefCell::new(Record::new())) }; TaskId::COUNT],
            contact: Mutex::new(RefCell::new(Record::new())),
        }
    }

    /// Records one pass of the chain: released at the conversion of the pressures, started when the compare values
    /// were written, ended when their pulse begins.
    pub fn record_contact(&self, run: &Run) {
        with(&self.contact, |record| record.add(run));
    }

    /// Timing from the conversion of pressures to the servos' pulse, since power-up.
    pub fn contact(&self) -> Timing {
        with(&self.contact, |record| record.totals()).unwrap_or_default()
    }

    /// Histogram of the chain's times since it was last taken.
    pub fn take_contact_histogram(&self, quantity: Quantity) -> Histogram {
        with(&self.contact, |record| record.take(quantity)).unwrap_or(Histogram::EMPTY)
    }

    /// Timing of a task since power-up.
    pub fn task(&self, task: TaskId) -> Timing {
        self.with_record(task, |record| record.totals())
            .unwrap_or_default()
    }

    /// Longest settled response of a task, µs; does not settle the last run.
    pub fn worst_response(&self, task: TaskId) -> u32 {
        self.with_record(task, |record| record.worst_response())
            .unwrap_or(0)
    }

    /// Histogram of a task's times since it was taken last.
    pub fn take_histogram(&self, task: TaskId, quantity: Quantity) -> Histogram {
        self.with_record(task, |record| record.take(quantity))
            .unwrap_or(Histogram::EMPTY)
    }

    /// Records one run of a task.
    pub fn record(&self, task: TaskId, run: &Run) {
        let missed = self.with_record(task, |record| record.add(run));
        self.signal_missed(task, missed);
    }

    /// Notes one run of a task of the flight level; [`Self::settle`] adds it later.
    #[inline]
    pub fn note(&self, task: TaskId, run: &Run) {
        let missed = self.with_record(task, |record| record.note(run));
        self.signal_missed(task, missed);
    }

    /// Adds the noted runs of the flight level. Called after the motor frame; each task has its own lock, so that
    /// interrupts are masked only while one run is added.
    pub fn settle(&self) {
        for task in TaskId::ALL
            .into_iter()
            .filter(|task| task.level() == Level::Flight)
        {
            self.with_record(task, Record::settle);
        }
    }

    #[inline]
    fn signal_missed(&self, task: TaskId, missed: Option<bool>) {
        if missed == Some(true) && task.level() == Level::Flight {
            self.missed.signal(());
        }
    }

    fn with_record<T>(&self, task: TaskId, f: impl FnOnce(&mut Record) -> T) -> Option<T> {
        with(self.tasks.get(task as usize)?, f)
    }
}

fn with<T>(slot: &Mutex<Raw, RefCell<Record>>, f: impl FnOnce(&mut Record) -> T) -> Option<T> {
    // The borrow succeeds: it happens only under this lock.
    slot.lock(|cell| cell.try_borrow_mut().ok().map(|mut record| f(&mut record)))
}
