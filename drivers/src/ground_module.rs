//! Downward modules of optical flow and range that send [`msp`](crate::msp) unrequested, as the MTF-01, MTF-02 and
//! 3901-L0X do: converts counts to angles along the vehicle's axes, with the time of measurement.

use embassy_time::{Duration, Instant};
use sophie_control::navigation::flow_range_sample::{Flow, GroundView, Range};
use sophie_control::params::{FlowMounting, Params};
use sophie_ports::sensors::GroundDecoder;

use crate::msp::{Message, Parser};

/// From the end of a flow's interval to its last byte (assumed, with half an interval of 20 ms 35 ms in all).
pub const FLOW_DELAY: Duration = Duration::from_millis(25);
/// From a range's measurement to its last byte (assumed).
pub const RANGE_DELAY: Duration = Duration::from_millis(25);
/// Nearest and farthest that such modules measure, m: 2 cm and 2.5 m of the MTF-02, 8 m of the MTF-01.
const REACH: (f32, f32) = (0.02, 8.0);
/// Times between two frames of flow, s: 100 to 10 a second.
const PERIOD: (f32, f32) = (0.008, 0.12);
/// A frame that comes later than this many periods has one before it that was lost.
const LOST: f32 = 1.5;
/// Share of a new time between two frames that the period follows.
const FOLLOW: f32 = 0.1;

/// The decoder of a module.
#[derive(Clone, Debug)]
pub struct GroundModule {
    parser: Parser,
    /// rad a count.
    per_count: f32,
    mounting: FlowMounting,
    /// Integration time of a frame, s; `None` before the second one.
    period: Option<f32>,
    /// When the frame of flow before had come.
    before: Option<Instant>,
    view: GroundView,
}

impl GroundModule {
    /// The module that `p` describes.
    pub fn from_params(p: &Params) -> Self {
        Self {
            parser: Parser::new(),
            per_count: 1.0 / (p.flow_scale.max(f32::MIN_POSITIVE) * 1f32.to_degrees()),
            mounting: p.flow_mounting,
            period: None,
            before: None,
            view: GroundView::default(),
        }
    }

    /// Integration time of the frame at `at`, s. A frame integrates over its own period only: the counts of a lost
    /// frame are missing in the next.
    fn interval(&mut self, at: Instant) -> Option<f32> {
        let before = self.before.replace(at)?;
        let since = at.saturating_duration_since(before).as_micros() as f32 * 1e-6;
        let (least, most) = PERIOD;
        let sound = (least..=most).contains(&since);
        let period = match self.period {
            Some(period) if sound && since < LOST * period => period + FOLLOW * (since - period),
            Some(period) => period,
            None if sound => since,
            None => return None,
        };
        self.period = Some(period);
        Some(period)
    }

    fn flow(&mut self, quality: u8, [x, y]: [i32; 2], at: Instant) -> Option<Flow> {
        let seconds = self.interval(at)?;
        // The modules count the image's motion, opposite to the vehicle's (ArduPilot inverts the sign as well).
        let [x, y] = [x, y].map(|count| -(count as f32) * self.per_count);
        let angle = match self.mounting {
            FlowMounting::Forward => [x, y],
            FlowMounting::Right => [-y, x],
            FlowMounting::Backward => [-x, -y],
            FlowMounting::Left => [y, -x],
        };
        let flow = Flow {
            until_us: at.checked_sub(FLOW_DELAY)?.as_micros(),
            seconds,
            angle,
            quality,
        };
        flow.checked()
    }
}

impl GroundDecoder for GroundModule {
    fn take(&mut self, bytes: &[u8], at: Instant) -> Option<GroundView> {
        let mut news = false;
        for byte in bytes {
            match self.parser.take(*byte) {
                Some(Message::Flow { quality, counts }) => {
                    if let Some(flow) = self.flow(quality, counts, at) {
                        self.view.flow = Some(flow);
                        news = true;
                    }
                }
                // Validity follows from the distance alone, as in INAV and ArduPilot: some modules send no range
                // quality.
                Some(Message::Range { distance, .. }) => {
                    let seen = distance > 0;
                    let range = Range {
                        at_us: at.checked_sub(RANGE_DELAY).map_or(0, |at| at.as_micros()),
                        distance: seen.then_some(distance as f32 / 1000.0),
                        reach: REACH,
                    };
                    if let Some(range) = range.checked() {
                        self.view.range = Some(range);
                        news = true;
                    }
                }
                None => {}
            }
        }
        news.then_some(self.view)
    }

    fn broken(&mut self) {
        self.parser.reset();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_MS: u64 = 20;

    fn module(mounting: FlowMounting) -> GroundModule {
        GroundModule::from_params(&Params {
            flow_scale: 10.0,
            flow_mounting: mounting,
            ..Params::default()
        })
    }

    fn say(module: &mut GroundModule, message: Message, ms: u64) -> Option<GroundView> {
        module.take(&message.frame(), Instant::from_millis(ms))
    }

    fn counts(x: i32, y: i32) -> Message {
        Message::Flow {
            quality: 100,
            counts: [x, y],
        }
    }

    #[test]
    fn counts_become_angles_along_the_vehicles_axes() {
        // 100 counts at 10 a degree; what is seen turns against its sign.
        let ten = 10f32.to_radians();
        let turned = [
            (FlowMounting::Forward, [-0.1 * ten, -0.2 * ten]),
            (FlowMounting::Right, [0.2 * ten, -0.1 * ten]),
            (FlowMounting::Backward, [0.1 * ten, 0.2 * ten]),
            (FlowMounting::Left, [-0.2 * ten, 0.1 * ten]),
        ];
        for (mounting, expected) in turned {
            let mut module = module(mounting);
            assert_eq!(say(&mut module, counts(1, 1), 1000), None);
            let flow = say(&mut module, counts(10, 20), 1020).unwrap().flow.unwrap();
            for (angle, expected) in flow.angle.iter().zip(expected) {
                assert!((angle - expected).abs() < 1e-6, "{mounting:?} {flow:?}");
            }
            assert!((flow.seconds - 0.02).abs() < 1e-6);
            assert_eq!(flow.until_us, 1_020_000 - FLOW_DELAY.as_micros());
        }
    }

    #[test]
    fn after_a_lost_frame_the_next_has_but_its_own_interval() {
        let mut module = module(FlowMounting::Forward);
        let mut now = 1000;
        for _ in 0..20 {
            now += PERIOD_MS;
            say(&mut module, counts(3, 3), now);
        }
        let flow = say(&mut module, counts(3, 3), now + 3 * PERIOD_MS).unwrap().flow;
        assert!((flow.unwrap().seconds - 0.02).abs() < 1e-3);
    }

    #[test]
    fn a_range_is_metres_or_nothing_within_reach() {
        let mut module = module(FlowMounting::Forward);
        let mut range = |quality, distance| {
            let view = say(&mut module, Message::Range { quality, distance }, 1000);
            view.unwrap().range.unwrap().distance
        };
        // Modules are seen that send no quality of a range.
        for quality in [200, 1, 0] {
            assert_eq!(range(quality, 1500), Some(1.5), "{quality}");
        }
        for (quality, distance) in [
            (200, -1),
            (0, -1),
            (200, 0),
            (200, 10),
            (200, 9000),
            (200, i32::MIN),
        ] {
            assert_eq!(range(quality, distance), None, "{quality} {distance}");
        }
    }

    #[test]
    fn counts_that_cannot_be_are_no_flow() {
        let mut module = module(FlowMounting::Forward);
        say(&mut module, counts(0, 0), 1000);
        for wild in [i32::MAX, i32::MIN, 1000] {
            assert_eq!(say(&mut module, counts(wild, 0), 1020), None);
        }
    }
}
