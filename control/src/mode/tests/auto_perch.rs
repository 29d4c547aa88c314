//! Perching by itself: how it begins, how the pilot takes over from every part of it, tries, and the way back.

use super::rig::Rig;
use crate::approach::limits::CLIMB_SPEED;
use crate::approach::pipe_target::PipeTarget;
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::grip::ArmState;
use crate::maths::vector::Vec3;
use crate::mode::inputs::auto_perch::TRIES;
use crate::mode::shared::on_pipe::SPOOL_DOWN_TIME;
use crate::mode::state::State;
use crate::mode::states::clamping::STOP_TIME;
use crate::mode::states::contact::CONTACT_TIME;
use crate::mode::*;
use crate::navigation::estimate::{Estimate, SurfaceLevels};
use crate::navigation::range_hit::RangeHit;
use crate::pilot::rc::Sticks;
use crate::pilot::remote::RemoteOrder::{Grab, Release};
use crate::pilot::remote::RemoteRefusal;

/// Height of the crown over the ground in the rig's world, and where it is to the right, m.
const CROWN: f32 = 1.5;
const RIGHT: f32 = 0.2;

/// The vehicle is where it holds: it follows the velocities that are asked for without a lag.
struct World {
    r: Rig,
    at: Vec3,
    held: Vec3,
    count: u8,
    pipe: bool,
    /// There is a range.
    ranged: bool,
    /// The pipe has been seen, and by how much its level is too low then, m.
    met: bool,
    lowered: f32,
    /// How often the estimate's origin has jumped.
    jumps: u8,
}

impl World {
    fn holding() -> Self {
        let mut w = Self {
            r: Rig::flown(),
            at: Vec3::new(0.0, 0.0, -2.2),
            held: Vec3::new(0.0, 0.0, -2.2),
            count: 0,
            pipe: true,
            ranged: true,
            met: false,
            lowered: 0.0,
            jumps: 0,
        };
        w.see();
        w.r.sticks().hold_switch = true;
        w.r.sticks().throttle = 0.5;
        w.step();
        assert_eq!(w.r.out.mode, Mode::Hold);
        w
    }

    fn searching() -> Self {
        let mut w = Self::holding();
        w.r.sticks().perch_switch = true;
        w.step();
        assert_eq!(w.r.out.mode, Mode::Approach);
        w
    }

    fn touched() -> Self {
        let mut w = Self::searching();
        for _ in 0..8000 {
            w.step();
            if w.r.out.mode == Mode::Contact {
                return w;
            }
        }
        panic!("no touch: {:?} {:?}", w.r.out, w.at);
    }

    fn clamping() -> Self {
        let mut w = Self::touched();
        w.r.grip(false, false, ArmState::Closing, 0.0);
        w.expect(CONTACT_TIME + 0.3, Mode::Clamping);
        w
    }

    fn perched() -> Self {
        let mut w = Self::clamping();
        w.expect(2.0, Mode::Clamping);
        w.r.grip(true, false, ArmState::Holding, 950.0);
        w.expect(SPOOL_DOWN_TIME + STOP_TIME + 0.1, Mode::Perched);
        w
    }

    fn see(&mut self) {
        let y = self.at.y - RIGHT;
        let on = self.pipe && y.abs() < 0.15;
        let flank = 0.15 - crate::maths::scalar::sqrt((0.0225 - y * y).max(0.0));
        let z = if on { flank - CROWN } else { 0.0 };
        self.count = self.count.wrapping_add(1);
        self.met |= on;
        let range_hit = RangeHit {
            surface_point: Some(Vec3::new(self.at.x, self.at.y, z)),
            lens: self.at,
            count: self.count,
            age: 0.02,
            ..RangeHit::default()
        };
        self.r.inputs.position = Some(Estimate {
            position: self.at,
            reset_count: self.jumps,
            age: 0.02,
            levels: SurfaceLevels {
                ground: 0.0,
                raised: self.met.then_some(self.lowered - CROWN),
            },
            range_hit: if self.ranged {
                range_hit
            } else {
                RangeHit::default()
            },
            ..Estimate::default()
        });
    }

    fn step(&mut self) {
        self.see();
        self.r.step();
        if let State::Approach(a) = &self.r.logic.state() {
            let moved = a.position_hold.held() - self.held;
            self.held = a.position_hold.held();
            // The first step in a mode sets the point.
            if moved.norm() < 0.05 {
                self.at += moved;
            } else {
                self.held = self.at;
            }
            let carried = self.pipe && self.at.z > -CROWN - 0.05 && (self.at.y - RIGHT).abs() < 0.15;
            if carried && !self.r.carried {
                self.r.falling = 0.2;
            }
            self.r.carried = carried;
        } else {
            self.held = self.at;
        }
    }

    fn run(&mut self, seconds: f32) {
        for _ in 0..(seconds * 100.0 + 0.5) as u32 {
            self.step();
        }
    }

    fn expect(&mut self, seconds: f32, mode: Mode) {
        self.run(seconds);
        assert_eq!(self.r.out.mode, mode, "{:?} at {:?}", self.r.out.reason, self.at);
    }
}

/// With an empty battery the pilot steers: nothing is flown aside against his sticks.
#[test]
fn an_empty_battery_over_the_pipe_leaves_the_way_to_the_pilot() {
    let mut w = World::searching();
    w.r.inputs.battery = Some(10.0);
    for _ in 0..200 {
        w.step();
        if w.r.out.mode == Mode::Failsafe {
            break;
        }
    }
    w.run(0.6);
    assert_eq!(w.r.out.mode, Mode::Failsafe);
    let thrust = w.r.out.rotors.thrust();
    assert!(thrust < w.r.params.mass * 9.75, "{thrust}");
}

/// Without radio it comes down beside the pipe, not on it.
#[test]
fn a_radio_lost_over_the_pipe_leads_away_from_it() {
    type There = fn(&World, f32) -> bool;
    // Where the approach begins, from the crown, and where the radio is lost.
    let cases: [(f32, There); 4] = [
        // Over the crown.
        (-0.2, |w, off| w.at.z > -2.0 && off.abs() < 0.05),
        // The beam has just come onto the pipe.
        (-0.2, |_, off| (-0.13..-0.05).contains(&off)),
        // Still over the pipe, where it has begun.
        (0.0, |_, off| off > 0.02),
        // Just off the pipe again.
        (0.0, |_, off| off > 0.2),
    ];
    for (case, (begins, there)) in cases.into_iter().enumerate() {
        let mut w = World::holding();
        w.at.y = RIGHT + begins;
        w.run(0.1);
        w.r.sticks().perch_switch = true;
        w.step();
        for _ in 0..4000 {
            w.step();
            if there(&w, w.at.y - RIGHT) {
                break;
            }
        }
        let off = w.at.y - RIGHT;
        assert_eq!(w.r.out.mode, Mode::Approach, "{case}");
        w.r.inputs.sticks = None;
        w.run(0.7);
        assert_eq!(w.r.out.mode, Mode::Failsafe);
        let [roll, _, _, thrust] = w.r.out.rotors.numbers();
        assert!(
            roll * off > 0.0 && roll.abs() > 0.02,
            "{case}: {off} m beside the crown: {roll} rad"
        );
        assert!(thrust > w.r.params.mass * 9.5, "{thrust}");
    }
}

/// The pipe's crown as a companion says it, `off` m.
fn said(off: Vec3) -> Option<PipeTarget> {
    Some(PipeTarget {
        at_us: 1,
        crown_position: Vec3::new(0.0, RIGHT, -CROWN) + off,
        heading: Some(crate::maths::scalar::PI),
    })
}

/// A vehicle on its way to where a companion says that the pipe is, without any range.
fn told() -> World {
    let mut w = World::holding();
    w.ranged = false;
    w.r.inputs.target = said(Vec3::ZERO);
    w.r.sticks().perch_switch = true;
    w.step();
    assert_eq!(w.r.out.mode, Mode::Approach);
    w
}

#[test]
fn where_a_companion_says_the_pipe_is_it_comes_down_without_a_range() {
    let mut w = told();
    for _ in 0..2000 {
        w.step();
        if w.r.out.mode == Mode::Contact {
            break;
        }
    }
    assert_eq!(w.r.out.mode, Mode::Contact, "{:?}", w.r.out.reason);
    assert!((w.at.y - RIGHT).abs() < 0.02, "{:?}", w.at);
    // The way there is short: nothing was searched.
    assert!(w.r.out.reason.is_none());
}

/// An escape from the crown ends two metres beside it, and first it is no higher than that.
#[test]
fn after_a_slide_it_comes_back_from_farther_than_it_may_begin() {
    let mut w = told();
    for _ in 0..2000 {
        w.step();
        if w.r.out.mode == Mode::Contact {
            break;
        }
    }
    w.r.carried = false;
    w.expect(0.5, Mode::Escaping);
    w.at += Vec3::new(0.0, -2.0, 0.1);
    w.expect(1.0, Mode::Approach);
    for _ in 0..4000 {
        w.step();
        if w.r.out.mode != Mode::Approach {
            break;
        }
    }
    assert_eq!(w.r.out.mode, Mode::Contact, "{:?}", w.r.out.reason);
}

#[test]
fn a_place_of_the_pipe_that_is_stale_far_or_jumps_ends_it_by_its_name() {
    for (target, reason) in [
        (None, Reason::TargetStale),
        (said(Vec3::new(50.0, 0.0, 0.0)), Reason::TargetFar),
        (said(Vec3::new(0.0, 0.0, -1.5)), Reason::TargetFar),
        (
            Some(PipeTarget {
                crown_position: Vec3::new(f32::NAN, 0.0, 0.0),
                ..said(Vec3::ZERO).unwrap_or_default()
            }),
            Reason::TargetStale,
        ),
    ] {
        let mut w = told();
        w.expect(1.0, Mode::Approach);
        w.r.inputs.target = target;
        if reason == Reason::TargetStale {
            w.expect(2.9, Mode::Approach);
            assert_eq!(w.r.out.reason, Some(reason));
            w.expect(0.1, Mode::Approach);
        }
        w.expect(0.03, Mode::Hold);
        assert_eq!(w.r.out.reason, Some(reason));
        // Nor does it begin with one: a new turn of the switch says why.
        w.r.sticks().perch_switch = false;
        w.expect(11.0, Mode::Hold);
        w.r.sticks().perch_switch = true;
        w.expect(0.5, Mode::Hold);
        let why = match reason {
            Reason::TargetStale => Reason::NoRange,
            far => far,
        };
        assert_eq!(w.r.out.reason, Some(why));
    }
    // A jump is another try from above, and the last one ends it.
    let mut w = told();
    w.expect(1.0, Mode::Approach);
    for i in 0..2 * TRIES {
        w.r.inputs.target = said(Vec3::new(0.0, if i % 2 == 0 { 0.3 } else { 0.0 }, 0.0));
        w.step();
    }
    w.step();
    assert_eq!(
        (w.r.out.mode, w.r.out.reason),
        (Mode::Hold, Some(Reason::TargetJumps))
    );
}

/// A tag out of view for 2.5 s, more often than there are tries: it holds meanwhile, and the plan goes on to the touch.
#[test]
fn a_place_of_the_pipe_that_comes_back_in_time_is_waited_for() {
    let mut w = told();
    w.expect(1.0, Mode::Approach);
    let place = w.r.inputs.target;
    let mut waits = 0;
    while w.r.out.mode == Mode::Approach {
        w.r.inputs.target = None;
        w.run(2.5);
        w.r.inputs.target = place;
        w.run(0.5);
        waits += 1;
        assert!(waits < 4 * TRIES, "{:?}", w.r.out.reason);
    }
    assert_eq!(w.r.out.mode, Mode::Contact);
    assert!(waits > TRIES, "{waits}");
}

type Hand = fn(&mut Sticks);

/// What a pilot may do to end it, and the mode in which he is then in free air.
const HANDS: [(Hand, Mode); 7] = [
    (|s| s.roll = 0.2, Mode::Hold),
    (|s| s.pitch = -0.2, Mode::Hold),
    (|s| s.yaw = 0.2, Mode::Hold),
    (|s| s.throttle = 0.7, Mode::Hold),
    (|s| s.perch_switch = false, Mode::Hold),
    (|s| s.hold_switch = false, Mode::Flight),
    (|s| s.stick_mode = crate::pilot::rc::StickMode::Rate, Mode::Flight),
];

#[test]
fn the_perch_switch_starts_it_in_a_hold_and_it_closes_on_the_crown() {
    let mut w = World::perched();
    assert!((w.at.y - RIGHT).abs() < 0.02, "{:?}", w.at);
    // Sticks on the pipe start no rotor, whatever they do.
    for (hands, _) in &HANDS[..4] {
        let before = *w.r.sticks();
        hands(w.r.sticks());
        w.expect(1.0, Mode::Perched);
        assert_eq!(w.r.out.rotors, Setpoint::Stop);
        *w.r.sticks() = before;
    }
}

#[test]
fn it_does_not_begin_without_a_range_a_position_or_centred_sticks_and_says_so() {
    let mut w = World::holding();
    w.r.sticks().perch_switch = true;
    w.r.sticks().roll = 0.3;
    w.expect(0.5, Mode::Hold);
    assert_eq!(w.r.out.reason, Some(Reason::SticksNotCentred));
    w.r.sticks().roll = 0.0;
    w.expect(0.02, Mode::Approach);

    let mut w = World::holding();
    w.r.sticks().perch_switch = true;
    let seen = w.r.inputs.position.unwrap();
    w.r.inputs.position = Some(Estimate {
        range_hit: RangeHit::default(),
        ..seen
    });
    w.r.expect(0.5, Mode::Hold);
    assert_eq!(w.r.out.reason, Some(Reason::NoRange));
    w.r.inputs.position = Some(Estimate { age: 0.5, ..seen });
    w.r.expect(15.0, Mode::Hold);
    assert_eq!(w.r.out.reason, Some(Reason::NoPosition));

    // The pilot's patience: no more than some seconds.
    let mut w = World::holding();
    w.r.logic.forget_thrust();
    w.r.sticks().perch_switch = true;
    w.expect(0.5, Mode::Hold);
    assert_eq!(w.r.out.reason, Some(Reason::ThrustUnknown));
    w.expect(4.0, Mode::Approach);

    // By hand the perch switch means what it ever did.
    let mut r = Rig::flying();
    r.sticks().perch_switch = true;
    r.expect(1.0, Mode::Flight);
}

#[test]
fn any_stick_or_switch_ends_it_within_a_step_and_a_new_turn_starts_it_again() {
    for (i, (hands, mode)) in HANDS.iter().enumerate() {
        for seconds in [0.0, 1.3, 6.0, 12.0] {
            let mut w = World::searching();
            w.expect(seconds, Mode::Approach);
            hands(w.r.sticks());
            w.step();
            assert_eq!(w.r.out.mode, *mode, "{i} after {seconds} s");
            if *mode == Mode::Hold {
                assert_eq!(w.r.out.reason, Some(Reason::TakenOver));
            }
            // Centred again, with perch still on, it stays with the pilot.
            let sticks = *w.r.sticks();
            *w.r.sticks() = Sticks {
                roll: 0.0,
                pitch: 0.0,
                yaw: 0.0,
                throttle: 0.5,
                ..sticks
            };
            w.expect(0.5, *mode);
            if *mode == Mode::Hold {
                w.r.sticks().perch_switch = false;
                w.step();
                w.r.sticks().perch_switch = true;
                w.expect(0.01, Mode::Approach);
            }
        }
    }
}

#[test]
fn a_throttle_beyond_the_zone_climbs_at_once() {
    let mut w = World::searching();
    w.run(1.0);
    w.r.sticks().throttle = 0.8;
    w.run(0.3);
    let weight = w.r.params.mass * 9.806_65;
    assert_eq!(w.r.out.mode, Mode::Hold);
    assert!(w.r.out.rotors.thrust() > weight + 0.5, "{:?}", w.r.out.rotors);
}

#[test]
fn hands_on_the_sticks_while_the_arms_close_leave_the_pipe_and_hold() {
    for start in [World::touched as fn() -> World, World::clamping] {
        for (hands, mode) in &HANDS[..6] {
            let mut w = start();
            hands(w.r.sticks());
            w.step();
            assert_eq!(w.r.out.mode, Mode::Escaping);
            w.r.carried = false;
            w.r.grip(false, true, ArmState::Free, 0.0);
            w.run(1.6);
            assert_eq!(w.r.out.mode, *mode);
        }
    }
}

#[test]
fn after_a_slide_it_climbs_and_tries_again_a_bounded_number_of_times() {
    let mut w = World::touched();
    for i in 1..TRIES {
        // Nothing carries it any more.
        w.r.carried = false;
        w.expect(0.5, Mode::Escaping);
        assert_eq!(w.r.out.reason, Some(Reason::SlidesOff));
        let height = w.at.z;
        w.expect(1.0, Mode::Approach);
        w.run(1.5);
        assert!(w.at.z < height - 0.3, "try {i}: {:?}", w.at);
        for _ in 0..8000 {
            if w.r.out.mode != Mode::Approach {
                break;
            }
            w.step();
        }
        assert_eq!(w.r.out.mode, Mode::Contact, "try {i}: {:?}", w.r.out.reason);
    }
    w.r.carried = false;
    w.expect(0.5, Mode::Escaping);
    w.expect(1.0, Mode::Hold);
    assert_eq!(w.r.out.reason, Some(Reason::SlidesOff));
    w.expect(2.0, Mode::Hold);
}

/// An escape carries the vehicle farther than a search about where it ends reaches.
#[test]
fn after_a_slide_it_searches_about_where_the_pipe_was() {
    for aside in [-2.0, 2.0] {
        let mut w = World::touched();
        w.r.carried = false;
        w.expect(0.5, Mode::Escaping);
        w.at.y += aside;
        w.expect(1.0, Mode::Approach);
        for _ in 0..8000 {
            if w.r.out.mode != Mode::Approach {
                break;
            }
            w.step();
        }
        assert_eq!(w.r.out.mode, Mode::Contact, "{aside}: {:?}", w.r.out.reason);
    }
}

#[test]
fn without_a_pipe_or_a_range_it_is_handed_back_with_a_reason() {
    let mut w = World::searching();
    w.pipe = false;
    for _ in 0..6000 {
        w.step();
        if w.r.out.mode == Mode::Hold {
            break;
        }
    }
    assert_eq!(w.r.out.reason, Some(Reason::NoPipe));

    let mut w = World::searching();
    w.run(2.0);
    let seen = w.r.inputs.position.unwrap();
    for (stale, why) in [
        (
            Estimate {
                range_hit: RangeHit {
                    age: 0.4,
                    ..seen.range_hit
                },
                ..seen
            },
            Reason::RangeStale,
        ),
        (Estimate { age: 3.1, ..seen }, Reason::PositionStale),
    ] {
        let mut r = w.r.clone();
        r.inputs.position = Some(stale);
        r.run(0.02);
        assert_eq!((r.out.mode, r.out.reason), (Mode::Hold, Some(why)));
    }
}

#[test]
fn a_position_that_comes_back_in_time_is_waited_for_and_another_try_follows() {
    let mut w = World::searching();
    w.run(6.0);
    let seen = w.r.inputs.position.unwrap();
    w.r.inputs.position = Some(Estimate { age: 1.4, ..seen });
    w.r.expect(1.5, Mode::Approach);
    assert_eq!(w.r.out.reason, Some(Reason::PositionStale));
    let [roll, pitch, ..] = w.r.out.rotors.numbers();
    assert!(roll.abs() < 0.02 && pitch.abs() < 0.02, "{:?}", w.r.out.rotors);
    // A stick ends the wait as it ends an approach.
    let mut r = w.r.clone();
    r.sticks().pitch = 0.3;
    r.run(0.02);
    assert_eq!(r.out.mode, Mode::Hold);
    w.r.falling = 0.0;
    for _ in 0..8000 {
        w.step();
        if w.r.out.mode != Mode::Approach {
            break;
        }
    }
    assert_eq!(w.r.out.mode, Mode::Contact);

    // A companion's place of the pipe comes a little later than its pose.
    let mut w = told();
    w.run(1.0);
    let target = w.r.inputs.target.take();
    let seen = w.r.inputs.position.unwrap();
    w.r.inputs.position = Some(Estimate { age: 1.4, ..seen });
    w.r.expect(1.0, Mode::Approach);
    w.expect(0.3, Mode::Approach);
    let mut r = w.r.clone();
    r.run(2.8);
    assert_eq!(
        (r.out.mode, r.out.reason),
        (Mode::Hold, Some(Reason::TargetStale))
    );
    w.r.inputs.target = target;
    w.expect(2.0, Mode::Approach);
}

#[test]
fn a_pipe_at_another_level_ends_a_try_and_the_second_time_the_approach() {
    let mut w = World::searching();
    w.run(0.5);
    for last in [false, true] {
        w.expect(5.0, Mode::Approach);
        let before = w.at.z;
        w.lowered = 0.3;
        w.expect(0.02, Mode::Approach);
        assert_eq!(w.r.out.reason, Some(Reason::RangeMisfit));
        w.lowered = 0.0;
        let mut highest = before;
        for _ in 0..500 {
            w.step();
            highest = highest.min(w.at.z);
        }
        // By then over the crown, or from where it was as high as flow sees the ground.
        let wanted = if last { before - 0.3 } else { -CROWN - 0.5 };
        assert!(highest < wanted && highest > -2.45, "{last}: {before} {highest}");
    }
    assert_eq!(
        (w.r.out.mode, w.r.out.reason),
        (Mode::Hold, Some(Reason::RangeMisfit))
    );
}

#[test]
fn a_height_that_is_lost_is_waited_for_on_the_way_up_over_the_place_and_another_try_follows() {
    let mut w = World::searching();
    w.run(6.0);
    let lost = |w: &World, height_age: f32, by_pressure: bool| {
        let mut r = w.r.clone();
        r.inputs.position = r.inputs.position.map(|e| Estimate {
            height_age,
            by_pressure,
            ..e
        });
        r
    };
    let held = |r: &Rig| match r.logic.state() {
        State::Approach(a) => a.position_hold.held(),
        _ => panic!("{:?}", r.out),
    };
    // A height that is young enough, or by the pressure, is none that is lost.
    for (age, by_pressure) in [(0.9, false), (5.0, true)] {
        let mut r = lost(&w, age, by_pressure);
        r.expect(0.5, Mode::Approach);
        assert_ne!(r.out.reason, Some(Reason::PositionStale), "{age}");
    }
    let mut r = lost(&w, 1.1, false);
    r.expect(1.0, Mode::Approach);
    assert_eq!(r.out.reason, Some(Reason::PositionStale));
    // What it holds rises as fast as a climb, as long as the vehicle goes with it; where it is blown aside it leans against it.
    let mut rising = lost(&w, 1.1, false);
    rising.expect(1.0, Mode::Approach);
    let from = held(&rising);
    rising.inputs.position = rising.inputs.position.map(|e| Estimate { position: from, ..e });
    rising.expect(0.2, Mode::Approach);
    let way = held(&rising) - from;
    assert!((way.z + 0.2 * CLIMB_SPEED).abs() < 0.01, "{way:?}");
    assert!(way.x.hypot(way.y) < 0.01, "{way:?}");
    rising.inputs.position = rising.inputs.position.map(|e| Estimate {
        position: e.position + Vec3::new(0.0, 0.3, 0.0),
        ..e
    });
    rising.expect(0.2, Mode::Approach);
    let [roll, ..] = rising.out.rotors.numbers();
    assert!(roll < -0.05, "{:?}", rising.out.rotors);
    // It is back.
    w.r = r;
    w.r.falling = 0.0;
    w.step();
    let height = w.at.z;
    assert_eq!(w.r.out.mode, Mode::Approach);
    w.run(1.5);
    assert!(w.at.z < height - 0.1, "{height} {:?}", w.at);
    for _ in 0..8000 {
        w.step();
        if w.r.out.mode != Mode::Approach {
            break;
        }
    }
    assert_eq!(w.r.out.mode, Mode::Contact, "{:?}", w.r.out.reason);
    assert!((w.at.y - RIGHT).abs() < 0.02, "{:?}", w.at);
}

#[test]
fn an_origin_that_jumps_on_the_way_off_leaves_it_climbing() {
    let mut w = World::perched();
    w.r.sticks().perch_switch = false;
    w.run(2.0);
    w.r.grip(false, true, ArmState::Free, 0.0);
    w.expect(0.4, Mode::Escaping);
    w.r.carried = false;
    w.pipe = false;
    w.expect(1.0, Mode::Approach);
    let height = w.at.z;
    w.jumps = 1;
    w.expect(4.0, Mode::Hold);
    assert!(w.at.z < height - 0.4, "{:?}", w.at);
}

#[test]
fn leaving_is_by_itself_too_with_the_sticks_centred() {
    let mut w = World::perched();
    w.r.sticks().perch_switch = false;
    w.expect(0.05, Mode::Releasing);
    w.run(2.0);
    let full = 4.0 * w.r.params.thrust_max * w.r.out.thrust_factor.value;
    assert!(
        (w.r.out.rotors.thrust() - 0.2 * full).abs() < 0.01,
        "{:?}",
        w.r.out.rotors
    );
    w.r.grip(false, true, ArmState::Free, 0.0);
    w.expect(0.4, Mode::Escaping);
    w.r.carried = false;
    w.pipe = false;
    w.expect(1.0, Mode::Approach);
    let height = w.at.z;
    w.expect(4.0, Mode::Hold);
    assert!(
        w.at.z < height - 0.4 && w.r.out.reason.is_none(),
        "{:?} {:?}",
        w.at,
        w.r.out.reason
    );

    // With the throttle of a release by hand it is the pilot's.
    let mut w = World::perched();
    w.r.sticks().throttle = 0.3;
    w.r.sticks().perch_switch = false;
    w.expect(2.0, Mode::Releasing);
    w.r.grip(false, true, ArmState::Free, 0.0);
    w.expect(0.5, Mode::Flight);
}

#[test]
fn a_grab_and_a_release_by_order_do_it_with_the_pilots_switch_left_alone() {
    let mut w = World::holding();
    w.r.sticks().roll = 0.3;
    assert_eq!(w.r.remote(Grab), Some(RemoteRefusal::SticksNotCentred));
    w.r.sticks().roll = 0.0;
    let seen = w.r.inputs.position;
    w.r.inputs.position = seen.map(|e| Estimate {
        range_hit: RangeHit::default(),
        ..e
    });
    assert_eq!(w.r.remote(Grab), Some(RemoteRefusal::NoWay));
    let learnt = w.r.logic.clone();
    w.r.logic.forget_thrust();
    assert_eq!(w.r.remote(Grab), Some(RemoteRefusal::ThrustUnknown));
    w.r.logic = learnt;
    w.r.inputs.position = seen;
    assert_eq!((w.r.remote(Grab), w.r.out.mode), (None, Mode::Approach));
    // A second one changes nothing, and a release takes it back; where the switch stands then is no wish.
    assert_eq!((w.r.remote(Grab), w.r.out.mode), (None, Mode::Approach));
    assert_eq!((w.r.remote(Release), w.r.out.mode), (None, Mode::Hold));
    w.expect(1.0, Mode::Hold);
    assert!(!w.r.sticks().perch_switch);
    assert_eq!((w.r.remote(Grab), w.r.out.mode), (None, Mode::Approach));
    while w.r.out.mode == Mode::Approach {
        w.step();
    }
    assert_eq!(w.r.out.mode, Mode::Contact);
    // A slide: the order lasts over the next try.
    w.r.inputs.motion = w.r.inputs.motion.map(|m| Motion {
        q: crate::maths::vector::Quat::from_euler(0.5, 0.0, 0.0),
        ..m
    });
    w.run(0.1);
    assert_eq!(w.r.out.mode, Mode::Escaping);
    w.r.inputs.motion = w.r.inputs.motion.map(|m| Motion {
        q: crate::maths::vector::Quat::IDENTITY,
        ..m
    });
    w.r.grip(false, true, ArmState::Free, 0.0);
    w.r.carried = false;
    w.pipe = false;
    w.expect(1.0, Mode::Approach);
}

#[test]
fn after_a_remote_release_the_perch_switch_left_on_does_not_close_the_arms() {
    let mut w = World::perched();
    assert_eq!((w.r.remote(Release), w.r.out.mode), (None, Mode::Releasing));
    w.run(2.0);
    w.r.grip(false, true, ArmState::Free, 0.0);
    w.expect(0.4, Mode::Escaping);
    w.r.carried = false;
    w.pipe = false;
    w.expect(1.0, Mode::Approach);
    assert_eq!(w.r.remote(Grab), Some(RemoteRefusal::NotHere));
    w.expect(6.0, Mode::Hold);
    assert!(w.r.sticks().perch_switch);
    assert_eq!(w.r.remote(Grab), Some(RemoteRefusal::SwitchNotOff));
}

#[test]
fn what_ends_a_flight_ends_it_too() {
    let mut w = World::searching();
    w.r.inputs.sticks = None;
    w.expect(0.02, Mode::Failsafe);
    let mut w = World::searching();
    w.r.inputs.battery = Some(10.0);
    w.expect(3.0, Mode::Failsafe);
    let mut w = World::searching();
    w.r.sticks().arm_switch = false;
    w.expect(0.01, Mode::Disarmed);
    let mut w = World::searching();
    w.r.inputs.motion = None;
    w.expect(0.1, Mode::Disarmed);
}

/// Carried by the pipe since a step, before the touch is sure.
fn at_the_touch() -> World {
    let mut w = World::searching();
    for _ in 0..8000 {
        w.step();
        if w.r.carried {
            break;
        }
    }
    w.r.step();
    assert_eq!(w.r.out.mode, Mode::Approach);
    w
}

#[test]
fn what_ends_it_at_the_touch_leaves_the_pipe_instead_of_holding_on_it() {
    let mut w = at_the_touch();
    w.r.sticks().roll = 0.3;
    w.r.step();
    assert_eq!(w.r.out.mode, Mode::Escaping);
    assert_eq!(w.r.out.reason, Some(Reason::TakenOver));

    let mut w = at_the_touch();
    w.r.inputs.position = w.r.inputs.position.map(|e| Estimate { age: 1.4, ..e });
    w.r.step();
    assert_eq!(w.r.out.mode, Mode::Escaping);
    assert_eq!(w.r.out.reason, Some(Reason::PositionStale));

    // Six centimetres beside the crown, which ends the try.
    let mut w = at_the_touch();
    w.at.y += 0.06;
    w.see();
    w.r.step();
    w.r.step();
    assert_eq!(w.r.out.mode, Mode::Escaping);
    assert_eq!(w.r.out.reason, Some(Reason::NotCentred));
}

#[test]
fn a_touch_where_nothing_was_seen_so_near_climbs_and_tries_again() {
    let mut w = World::searching();
    w.run(1.0);
    (w.r.carried, w.r.falling) = (true, 0.2);
    for _ in 0..12 {
        w.see();
        w.r.step();
    }
    assert_eq!(w.r.out.mode, Mode::Escaping);
    assert_eq!(w.r.out.reason, Some(Reason::TouchedEarly));
    w.r.carried = false;
    w.expect(1.0, Mode::Approach);
}

#[test]
fn without_a_position_an_escape_asks_for_the_pilot_and_he_flies_on() {
    let mut w = World::touched();
    w.r.carried = false;
    w.r.inputs.position = w.r.inputs.position.map(|e| Estimate { age: 2.0, ..e });
    w.r.expect(0.5, Mode::Escaping);
    assert_eq!(w.r.out.reason, Some(Reason::SlidesOff));
    // Flow sees again as it rises: that is waited for.
    w.r.expect(1.0, Mode::Escaping);
    assert_eq!(w.r.out.reason, Some(Reason::SlidesOff));
    w.r.expect(1.0, Mode::Escaping);
    assert_eq!(w.r.out.reason, Some(Reason::PositionLost));
    w.r.sticks().hold_switch = false;
    w.r.expect(0.02, Mode::Flight);
}
