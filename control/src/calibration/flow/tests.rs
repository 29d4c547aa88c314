//! The fit of a module by turning it, with hands that turn it beside its lens.

extern crate std;
use std::format;
use std::string::String;

use super::*;
use crate::navigation::flow_range_sample::{Flow, Range};
use crate::params::FlowMounting;

/// A module in hands.
#[derive(Clone, Copy)]
struct Hands {
    /// Counts of a degree over those of the parameter.
    scale: f32,
    /// Quarter turns by which it sits beyond the parameter.
    quarters: u32,
    mirrored: bool,
    /// Height of the point of turning over the lens, m.
    pivot: f32,
    distance: f32,
    /// Turning, rad.
    roll: f32,
    pitch: f32,
    quality: u8,
    /// What else it sees, rad/s.
    passing: f32,
}

const HANDS: Hands = Hands {
    scale: 1.0,
    quarters: 0,
    mirrored: false,
    pivot: 0.0,
    distance: 0.5,
    roll: 0.35,
    pitch: 0.35,
    quality: 120,
    passing: 0.0,
};

/// Noise of 0.12 rad/s in 20 ms, by a fixed generator.
struct Noise(u32);

impl Noise {
    fn next(&mut self) -> f32 {
        let mut sum = 0.0;
        for _ in 0..3 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            sum += (self.0 >> 8) as f32 / 8_388_608.0 - 1.0;
        }
        2.4e-3 * sum
    }
}

fn attitude(hands: &Hands, us: u64) -> Quat {
    let t = us as f64 * 1e-6;
    let swing = |amplitude: f32, w: f64| amplitude * (w * t).sin() as f32;
    Quat::from_euler(swing(hands.roll, 3.5), swing(hands.pitch, 4.3), 0.1)
}

fn round(hands: &Hands, far: bool) -> Result<Round, String> {
    let (mut turns, mut noise, mut view) = (FlowTurns::default(), Noise(7), GroundView::default());
    for ms in (1000..9000u64).step_by(10) {
        let now = ms * 1000;
        if ms.is_multiple_of(20) {
            let (from, until) = (now - 45_000, now - 25_000);
            let (a, b) = (attitude(hands, from), attitude(hands, until));
            let turned = a.conjugate() * b;
            let lever = 1.0 + hands.pivot / hands.distance;
            let seen = [turned.x, turned.y].map(|part| 2.0 * part * lever + hands.passing * 0.02);
            let [x, y] = seen;
            let [x, y] = match hands.quarters {
                0 => [x, y],
                1 => [y, -x],
                2 => [-x, -y],
                _ => [-y, x],
            };
            let y = if hands.mirrored { -y } else { y };
            view.flow = Some(Flow {
                until_us: until,
                seconds: 0.02,
                angle: [x, y].map(|part| hands.scale * part + noise.next()),
                quality: hands.quality,
            });
            view.range = Some(Range {
                at_us: until,
                distance: Some(hands.distance),
                reach: (0.02, 8.0),
            });
        }
        turns.add(now, attitude(hands, now), &view);
    }
    turns
        .round(far)
        .map_err(|unfit| format!("{} {:.2}", unfit.what, unfit.value))
}

fn fitted(hands: Hands, now: FlowFit) -> Result<(FlowFit, f32), String> {
    let near = round(&hands, false)?;
    let far = Hands {
        distance: 1.6,
        ..hands
    };
    let far = round(&far, true)?;
    flow_fit(&near, &far, now).map_err(|unfit| format!("{} {:.2}", unfit.what, unfit.value))
}

const NOW: FlowFit = FlowFit {
    scale: 10.5,
    mounting: FlowMounting::Forward,
};

/// Scale within 2 %, the mounting always, the point of turning within 2 cm.
#[test]
fn scale_mounting_and_the_point_of_turning_are_found() {
    for (is, mounting) in FlowMounting::ALL.iter().enumerate() {
        for quarters in 0..4 {
            for (scale, pivot) in [(1.0, 0.0), (0.6, 0.1), (1.4, -0.08), (2.5, 0.15)] {
                let hands = Hands {
                    scale,
                    quarters,
                    pivot,
                    ..HANDS
                };
                let now = FlowFit {
                    mounting: *mounting,
                    ..NOW
                };
                let (fit, found) = fitted(hands, now).unwrap();
                let off = fit.scale / (10.5 * scale) - 1.0;
                assert!(off.abs() < 0.02, "{scale} {pivot}: {off}");
                assert!((found - pivot).abs() < 0.02, "{scale} {pivot}: {found}");
                let sits = FlowMounting::ALL[(is + quarters as usize) % 4];
                assert_eq!(fit.mounting, sits, "{quarters}");
            }
        }
    }
}

#[test]
fn what_is_wrong_is_named_with_its_number() {
    let cases = [
        (Hands { quality: 3, ..HANDS }, "quality of the picture 3.00"),
        (
            Hands {
                distance: 1.0,
                ..HANDS
            },
            "range 1.00",
        ),
        (Hands { roll: 0.04, ..HANDS }, "rolling 0.1"),
        (Hands { pitch: 0.0, ..HANDS }, "pitching 0.0"),
        (
            Hands {
                mirrored: true,
                ..HANDS
            },
            "mirrored part of the flow 1.00",
        ),
        (
            Hands {
                passing: 2.0,
                ..HANDS
            },
            "share that the turning explains 0.",
        ),
        (Hands { pivot: 0.4, ..HANDS }, "height of the point of turning 0."),
        (Hands { scale: 0.0, ..HANDS }, "share that the turning explains"),
    ];
    for (hands, why) in cases {
        let found = fitted(hands, NOW).unwrap_err();
        assert!(found.starts_with(why), "{found}, not {why}");
    }
    let none = FlowTurns::default().round(false).unwrap_err();
    assert_eq!((none.what, none.value), ("flows", 0.0));
    let beyond = fitted(HANDS, FlowFit { scale: 0.4, ..NOW }).unwrap_err();
    assert!(beyond.starts_with("scale 0.4"), "{beyond}");
}

#[test]
fn numbers_that_are_none_give_no_fit_that_is_none() {
    for bad in [f32::NAN, f32::INFINITY, 1e30] {
        for spoil in [
            Hands { scale: bad, ..HANDS },
            Hands {
                distance: bad,
                ..HANDS
            },
            Hands { roll: bad, ..HANDS },
        ] {
            assert!(fitted(spoil, NOW).is_err());
        }
    }
}
