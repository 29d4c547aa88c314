//! Flow and range spoilt in every way, one after the other: stale, jumping, frozen, mirrored, wrongly scaled or any number.

extern crate std;
use proptest::prelude::*;

use super::flow_range::Rig;
use crate::navigation::flow_range_sample::Range;
use crate::navigation::position_estimator::*;

/// Longest stretch of one kind, views.
const LONGEST: u32 = 150;

/// How many views are spoilt, flow and range each how, and by which numbers.
type Stretch = (u32, u8, u8, [f32; 3]);

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![4 => -0.5f32..0.5, 2 => -5.0f32..5.0, 1 => any::<f32>()]
}

fn stretch() -> impl Strategy<Value = Stretch> {
    (1u32..LONGEST, 0u8..7, 0u8..7, prop::array::uniform3(number()))
}

/// `view`, the `i`th of its stretch, spoilt; `held` was the one before the stretch.
fn spoilt(view: GroundView, held: &GroundView, i: u32, (_, flow, range, [x, y, z]): Stretch) -> GroundView {
    let high = (i / 15).is_multiple_of(2);
    let angle = |to: fn([f32; 2], f32, f32) -> [f32; 2]| {
        view.flow.map(|f| Flow {
            angle: to(f.angle, x, y),
            ..f
        })
    };
    let distance = |to: fn(f32, f32) -> f32| {
        view.range.map(|r| Range {
            distance: r.distance.map(|d| to(d, z)),
            ..r
        })
    };
    GroundView {
        flow: match flow {
            0 => None,
            1 => view.flow.zip(held.flow).map(|(f, old)| Flow {
                angle: old.angle,
                ..f
            }),
            2 => angle(|[a, b], _, _| [-a, -b]),
            3 => angle(|[a, b], x, y| [a * x, b * y]),
            4 if high => angle(|[a, b], x, y| [a + x, b + y]),
            5 => held.flow,
            _ => view.flow,
        },
        range: match range {
            0 => None,
            1 => view.range.zip(held.range).map(|(r, old)| Range {
                distance: old.distance,
                ..r
            }),
            2 => distance(|d, z| d * z),
            3 if high => distance(|d, z| d + z),
            4 => distance(|_, z| z),
            5 => held.range,
            _ => view.range,
        },
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Numbers stay finite, the estimate as near as five refused seconds leave it, and what is sound again is taken again. A step
    /// that came too is a surface from then on, and what it hides of the view costs speed.
    #[test]
    fn flow_and_range_of_any_kind_leave_the_estimate_finite_and_are_got_over(
        stretches in prop::collection::vec(stretch(), 0..10),
    ) {
        let mut r = Rig::new();
        r.run(4.0);
        for stretch in stretches {
            let held = r.view().unwrap_or_default();
            for i in 0..4 * stretch.0 {
                let view = r.view().map(|view| spoilt(view, &held, i / 4, stretch));
                r.step(view.as_ref());
                if let Some(e) = r.out {
                    prop_assert!(e.is_finite(), "{e:?}");
                    prop_assert!(e.velocity.norm() < 40.0, "{e:?}");
                }
            }
        }
        r.run(25.0);
        prop_assert_eq!(r.fault(), None);
        let [v, _] = r.errors();
        prop_assert!(v < 0.5, "{}", v);
    }
}
