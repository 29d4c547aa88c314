//! The tasks' timing over defmt: each second a record of each task, and a line at once when the flight level is late.
//!
//! ```text
//! timing estimator: 1000/s, late 28/28/29, run 1/1/2, response 29/29/31 of 300 us, 0 missed
//! timing chain: 1000/s, 42/43/43/44 us from data-ready to motor frame
//! timing contact: 50/s, 901/901/901 us from pressure to servo command, 1498/1499/1499/1499 us to its pulse of 3500 us, 0 missed
//! ```
//!
//! Times are half, 99 % and all of the second's runs (too large by less than a quarter; the last is exact); of four
//! times the first is the shortest. docs/timing.md defines them.

use sophie_tasks::links::Links;
use sophie_tasks::schedule::TaskId;
use sophie_tasks::schedule::histogram::Histogram;
use sophie_tasks::schedule::timing::{Quantity, Timing};

/// Missed deadlines already reported.
#[derive(Default)]
pub struct TimingReport {
    recorded: [u32; TaskId::COUNT],
    reported: [u32; TaskId::COUNT],
    /// The same of the chain from pressure to servo pulse.
    contact_recorded: u32,
    contact_reported: u32,
}

impl TimingReport {
    /// Report of the `look`-th poll of each second: one task, after the last task the chain from pressure to pulse,
    /// then missed deadlines.
    pub fn second(&mut self, links: &Links, look: u32) {
        match TaskId::ALL.get(look as usize) {
            Some(&task) => self.record(links, task),
            None if look as usize == TaskId::COUNT => self.contact(links),
            None if look as usize == TaskId::COUNT + 1 => self.missed(links),
            None => {}
        }
    }

    /// Logs every task with new missed deadlines, with its worst times since the start.
    pub fn missed(&mut self, links: &Links) {
        for (task, reported) in TaskId::ALL.into_iter().zip(&mut self.reported) {
            report(task.name(), &links.timing.task(task), reported);
        }
        report("contact", &links.timing.contact(), &mut self.contact_reported);
    }

    /// The chain from pressure conversion to the resulting pulse.
    fn contact(&mut self, links: &Links) {
        let [command, pulse] = [Quantity::Lateness, Quantity::Response]
            .map(|quantity| links.timing.take_contact_histogram(quantity));
        let totals = links.timing.contact();
        let missed = totals
            .overruns
            .wrapping_sub(core::mem::replace(&mut self.contact_recorded, totals.overruns));
        // Before the first command, and while the pressure is stale, no pulse exists.
        if pulse.count() == 0 {
            return;
        }
        let ([c50, c99, c100], [p50, p99, p100]) = (three(&command), three(&pulse));
        defmt::info!(
            "timing contact: {=u32}/s, {=u32}/{=u32}/{=u32} us from pressure to servo command, {=u32}/{=u32}/{=u32}/{=u32} us to its pulse of {=u32} us, {=u32} missed",
            pulse.count(),
            c50,
            c99,
            c100,
            pulse.min(),
            p50,
            p99,
            p100,
            totals.deadline_us,
            missed
        );
    }

    fn record(&mut self, links: &Links, task: TaskId) {
        let [late, run, response] = [Quantity::Lateness, Quantity::Execution, Quantity::Response]
            .map(|quantity| links.timing.take_histogram(task, quantity));
        let totals = links.timing.task(task);
        let Some(recorded) = self.recorded.get_mut(task as usize) else {
            return;
        };
        let missed = totals
            .overruns
            .wrapping_sub(core::mem::replace(recorded, totals.overruns));
        // A task that does not run, such as telemetry with SBUS.
        if run.count() == 0 && missed == 0 {
            return;
        }
        let ([l50, l99, l100], [r50, r99, r100]) = (three(&late), three(&run));
        let [t50, t99, t100] = three(&response);
        defmt::info!(
            "timing {=str}: {=u32}/s, late {=u32}/{=u32}/{=u32}, run {=u32}/{=u32}/{=u32}, response {=u32}/{=u32}/{=u32} of {=u32} us, {=u32} missed",
            task.name(),
            response.count(),
            l50,
            l99,
            l100,
            r50,
            r99,
            r100,
            t50,
            t99,
            t100,
            totals.deadline_us,
            missed
        );
        if task == TaskId::Motors {
            defmt::info!(
                "timing chain: {=u32}/s, {=u32}/{=u32}/{=u32}/{=u32} us from data-ready to motor frame",
                response.count(),
                response.min(),
                t50,
                t99,
                t100
            );
        }
    }
}

fn report(name: &str, t: &Timing, reported: &mut u32) {
    if t.overruns != *reported {
        *reported = t.overruns;
        defmt::warn!(
            "{=str}: {=u32} overruns in {=u32} runs; worst: {=u32} us late, {=u32} us response, {=u32} us execution",
            name,
            t.overruns,
            t.runs,
            t.worst_lateness_us,
            t.worst_response_us,
            t.worst_execution_us
        );
    }
}

/// Half, 99 % and all of the runs, µs.
fn three(histogram: &Histogram) -> [u32; 3] {
    [histogram.quantile(500), histogram.quantile(990), histogram.max()]
}
