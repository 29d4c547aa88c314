//! A bar of many flights.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sophie_terminal::console::Console;

/// How many of a number of flights are done: a bar on a terminal, nothing in a pipe or file.
pub struct Tally {
    bar: ProgressBar,
}

impl Tally {
    /// Of `count` flights.
    #[must_use]
    pub fn new(console: &Console, count: u64) -> Self {
        let target = match (console.is_terminal(), console.to_stderr()) {
            (false, _) => ProgressDrawTarget::hidden(),
            (true, true) => ProgressDrawTarget::stderr(),
            (true, false) => ProgressDrawTarget::stdout(),
        };
        let bar = ProgressBar::with_draw_target(Some(count), target);
        let style = ProgressStyle::with_template("{bar:32.cyan} {pos} of {len} flown, {eta} left");
        bar.set_style(
            style
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .progress_chars("━╸─"),
        );
        bar.tick();
        Self { bar }
    }

    /// One more is done; from any thread.
    pub fn one(&self) {
        self.bar.inc(1);
    }

    /// Takes the bar away.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}
