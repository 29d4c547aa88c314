//! Output during a flight.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sophie_control::mode::Mode;
use sophie_sim::record::{Event, Observer, Phase};

use sophie_terminal::console::{Console, one_line};

/// Plain lines per step and event, for files and pipes.
pub struct Lines<'a> {
    console: &'a Console,
}

impl<'a> Lines<'a> {
    /// Lines on `console`.
    pub fn new(console: &'a Console) -> Self {
        Self { console }
    }
}

impl Observer for Lines<'_> {
    fn step_began(&mut self, t: f64, index: usize, count: usize, name: &str) {
        self.console
            .say(&format!("{t:8.2} s  {:>2}/{count} {name}", index + 1));
    }

    fn step_ended(&mut self, _: f64, _: &Phase) {}

    fn progress(&mut self, _: f64, _: Mode, _: f64) {}

    fn event(&mut self, event: &Event) {
        self.console.say(&event_line(event));
    }
}

fn event_line(event: &Event) -> String {
    format!("{:8.2} s        {}", event.t, one_line(&event.text))
}

/// A progress bar with a live line, and a permanent line per step and event.
pub struct Bar {
    bar: ProgressBar,
    step: String,
}

impl Bar {
    /// A bar on stderr or stdout.
    pub fn new(to_stderr: bool) -> Self {
        let target = if to_stderr {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::stdout()
        };
        let bar = ProgressBar::with_draw_target(None, target);
        let style = ProgressStyle::with_template("{bar:16.cyan} step {pos} of {len}  {wide_msg}");
        bar.set_style(
            style
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .progress_chars("━╸─"),
        );
        Self {
            bar,
            step: String::new(),
        }
    }

    /// Takes the bar away.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Bar {
    fn step_began(&mut self, _: f64, index: usize, count: usize, name: &str) {
        self.step = name.to_owned();
        self.bar.set_length(count as u64);
        self.bar.set_position(index as u64 + 1);
    }

    fn step_ended(&mut self, t: f64, phase: &Phase) {
        let word = if phase.done { "done" } else { "given up" };
        let line = format!(
            "{t:8.2} s  {:<12} {word} after {:.1} s",
            phase.name,
            phase.end - phase.start
        );
        self.bar.println(line);
    }

    fn progress(&mut self, t: f64, mode: Mode, height: f64) {
        // Fits 80 columns with the bar.
        self.bar.set_message(format!(
            "{:<11} {t:6.1} s  {:<11} {height:5.2} m",
            self.step,
            mode.name()
        ));
    }

    fn event(&mut self, event: &Event) {
        self.bar.println(event_line(event));
    }
}

/// Runs `flight` with its observer: a progress bar on a terminal, plain lines elsewhere.
pub fn watch<T>(console: &Console, flight: impl FnOnce(&mut dyn Observer) -> T) -> T {
    if console.is_terminal() {
        let mut bar = Bar::new(console.to_stderr());
        let result = flight(&mut bar);
        bar.finish();
        result
    } else {
        flight(&mut Lines::new(console))
    }
}
