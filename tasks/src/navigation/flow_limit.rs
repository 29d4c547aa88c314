//! Reason why optical flow is unusable in flight while no other position is fresh, for the pilot's display.

use embassy_time::{Duration, Instant};
use sophie_control::mode::Mode;
use sophie_control::navigation::flow_range::FlowRangeLimit;

use crate::links::Links;

/// Age of the position, s, beyond which the reason is displayed; a hold may not begin with an older one.
const PLACED_AGE: f32 = 0.2;
/// Debounce time before a limit, or its end, is shown: near the threshold range noise crosses it with each frame.
const LAST: Duration = Duration::from_millis(500);

/// The debounced limit.
#[derive(Default)]
pub struct FlowLimit {
    newest: Option<FlowRangeLimit>,
    since: Option<Instant>,
    shown: Option<FlowRangeLimit>,
}

impl FlowLimit {
    /// Makes one step in `mode` and returns the limit to show.
    pub fn step(&mut self, links: &Links, mode: Mode, now: Instant) -> Option<FlowRangeLimit> {
        let flies = matches!(mode, Mode::Flight | Mode::Hold);
        let placed = links.position.fresh_to(now, |e| e.age <= PLACED_AGE);
        let view = links.ground.fresh().filter(|_| flies && placed != Some(true));
        self.follow(view.and_then(|view| FlowRangeLimit::of(&view)), now)
    }

    fn follow(&mut self, limit: Option<FlowRangeLimit>, now: Instant) -> Option<FlowRangeLimit> {
        if limit != self.newest || self.since.is_none() {
            (self.newest, self.since) = (limit, Some(now));
        }
        if self
            .since
            .is_some_and(|since| now.saturating_duration_since(since) >= LAST)
        {
            self.shown = self.newest;
        }
        self.shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_flickers_at_an_edge_is_not_shown_and_what_lasts_is() {
        let mut limit = FlowLimit::default();
        let at = |ms: u64| Instant::from_millis(1000 + ms);
        let flickers =
            |ms: u64| Some([FlowRangeLimit::TooLow, FlowRangeLimit::NoRange][(ms / 40 % 2) as usize]);
        for ms in (0..2000).step_by(10) {
            assert_eq!(limit.follow(flickers(ms), at(ms)), None);
        }
        for ms in (2000..3000).step_by(10) {
            let shown = limit.follow(Some(FlowRangeLimit::TooHigh), at(ms));
            assert_eq!(shown.is_some(), ms >= 2500, "{ms}");
        }
        // It stays through a moment without, and goes with what lasts.
        for ms in (3000..3600).step_by(10) {
            let limit = limit.follow(None, at(ms));
            assert_eq!(limit == Some(FlowRangeLimit::TooHigh), ms < 3500, "{ms}");
        }
    }
}
