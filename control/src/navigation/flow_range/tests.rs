//! Surfaces below, of ranges of a vehicle whose way is known.

extern crate std;
use super::*;
use crate::navigation::axis_filter::{Axis, DOWN};
use crate::navigation::history::StateHistory;
use std::vec;
use std::vec::Vec;

const STEP_US: u64 = 5_000;
/// Half a pipe's diameter, m, and where its middle is across, m.
const RADIUS: f32 = 0.15;
const MIDDLE: f32 = 0.95;

/// What a range reads, m, of a vehicle at a place across, m, at a height, m down.
type Read = fn(f32, f32) -> f32;

/// Ground at 0 and a pipe whose crown is 1.5 m above it. A beam of 6° mixes both by the light that comes back.
fn pipe(y: f32, z: f32) -> f32 {
    let aside = (y - MIDDLE).abs();
    let back = RADIUS - scalar::sqrt((RADIUS * RADIUS - aside * aside).max(0.0));
    mixed(-1.5 + back - z, -z, RADIUS - aside)
}

/// The same with a flat top from the pipe's left edge on.
fn table(y: f32, z: f32) -> f32 {
    mixed(-1.5 - z, -z, y - MIDDLE + RADIUS)
}

fn floor(_: f32, z: f32) -> f32 {
    -z
}

/// Range between something `near`, of which the beam's middle is `inside` its edge by so much, and what is `far`, m.
fn mixed(near: f32, far: f32, inside: f32) -> f32 {
    let share = (0.5 + inside / (0.105 * near)).clamp(0.0, 1.0);
    let (pipe, ground) = (share / (near * near), (1.0 - share) / (far * far));
    (pipe * near + ground * far) / (pipe + ground)
}

/// A vehicle at rest or at a steady speed, with an axis that is predicted by an ideal inertial sensor.
struct Rig {
    fusion: FlowRangeFusion,
    axis: Axis,
    history: StateHistory,
    now: u64,
    /// True places at each step.
    way: Vec<(u64, Vec3)>,
    place: Vec3,
    q: Quat,
    read: Read,
    every_us: u64,
    late_us: u64,
    silent: bool,
    posed: bool,
    /// Ranges that counted, and how often the pipe was newly below.
    counted: u32,
}

impl Rig {
    /// 1.9 m above the ground, 0.45 m beside the pipe.
    fn new(read: Read) -> Self {
        let place = Vec3::new(0.0, 0.5, -1.9);
        Self {
            fusion: FlowRangeFusion::new(2.0 * RADIUS, Vec3::ZERO),
            axis: Axis::at(place.z),
            history: StateHistory::default(),
            now: 1_000_000,
            way: vec![],
            place,
            q: Quat::IDENTITY,
            read,
            every_us: 20_000,
            late_us: 25_000,
            silent: false,
            posed: false,
            counted: 0,
        }
    }

    /// Moves for `seconds` across at `speed` m/s, and rises as the inertial sensor does not show by `unseen` m/s.
    fn fly(&mut self, seconds: f32, speed: f32, unseen: f32) {
        for _ in 0..(seconds * 200.0) as u32 {
            self.now += STEP_US;
            self.place.y += 0.005 * speed;
            self.place.z -= 0.005 * unseen;
            self.axis.predict(0.0, DOWN, 0.005);
            self.way.push((self.now, self.place));
            self.history.push(StateSnapshot {
                at_us: self.now,
                position: Vec3::new(self.place.x, self.place.y, self.axis.position()),
                q: self.q,
                ..StateSnapshot::default()
            });
            self.fusion
                .predict(self.now, Some(0.0), self.q, &VerticalState::default());
            if !self.silent && self.now.is_multiple_of(self.every_us) {
                self.look();
            }
        }
    }

    /// Moves `metres` across at `speed` m/s.
    fn across(&mut self, metres: f32, speed: f32) {
        self.fly(metres / speed.abs(), speed, 0.0);
    }

    fn look(&mut self) {
        let at = self.now - self.late_us;
        let Some((_, then)) = self.way.iter().rev().find(|(us, _)| *us <= at) else {
            return;
        };
        let wobble = 0.004 * ((at / self.every_us) % 3) as f32 - 0.004;
        let distance = (self.read)(then.y, then.z) / self.q.down_in_body().z + wobble;
        let frame = Frame {
            at_us: self.now,
            yaw_offset: 0.0,
            posed: self.posed,
            anew: VerticalState::default(),
        };
        (self.fusion.range_us, self.fusion.now_us, self.fusion.flow_us) = (at, self.now, at);
        let taken = self
            .fusion
            .take_height(&mut self.axis, &mut self.history, (at, distance), &frame);
        self.counted += u32::from(taken.is_some());
    }

    /// Error of the height, m down.
    fn off(&self) -> f32 {
        self.axis.position() - self.place.z
    }

    fn levels(&self) -> SurfaceLevels {
        self.fusion.levels()
    }

    fn depth(&self) -> f32 {
        let here = StateSnapshot {
            position: Vec3::new(self.place.x, self.place.y, self.axis.position()),
            ..StateSnapshot::default()
        };
        self.fusion.depth(&here, 1.0, 0.0).distance / CALIBRATED
    }
}

#[test]
fn a_pipe_is_measured_though_the_height_is_off_and_the_ground_gives_the_height_back() {
    for unseen in [0.1, -0.1] {
        let mut r = Rig::new(pipe);
        r.fly(3.0, 0.0, 0.0);
        assert!(r.off().abs() < 0.01 && r.levels().raised.is_none());
        // The height is off from here on, and no range is there until the beam is over the pipe.
        r.silent = true;
        r.axis.jump(r.place.z + unseen, 0.0, 0.0);
        r.across(0.35, 0.3);
        r.silent = false;
        r.across(0.15, 0.3);
        assert!(r.fusion.raised, "{unseen}");
        // The crown is known from the height that it was seen at, which is off.
        let level = r.levels().raised.expect("a pipe");
        let distance = level - r.axis.position();
        assert!((r.off() - unseen).abs() < 0.03, "{unseen}: {}", r.off());
        assert!((distance - 0.4).abs() < 0.02, "{unseen}: {distance}");
        r.across(0.4, 0.3);
        r.fly(0.5, 0.0, 0.0);
        assert!(!r.fusion.raised && r.off().abs() < 0.02, "{unseen}: {}", r.off());
        let level = r.levels().raised.expect("a pipe");
        // What of the error had been there before, and what has come on the pipe, is shared by their variances.
        assert!((level + 1.5).abs() < 0.035, "{unseen}: {level}");
        assert_eq!((r.levels().ground, r.fusion.fault()), (0.0, None));
    }
}

/// Over the pipe the height drifts: the ground that it falls back to is the ground, whatever height it had before. Two grounds
/// would make of the true one something narrow, and of each way across it one that is twice as long.
#[test]
fn the_ground_is_the_surface_to_which_the_beam_returns() {
    let mut r = Rig::new(pipe);
    r.fly(1.0, 0.0, 0.0);
    for speed in [0.3, -0.3, 0.3, -0.3] {
        r.across(0.45, speed);
        assert!(r.fusion.raised);
        r.fly(0.5, 0.0, 0.03);
        r.across(0.45, speed);
        r.fly(0.5, 0.0, 0.0);
        assert!(!r.fusion.raised && r.off().abs() < 0.02, "{speed} {}", r.off());
        assert!(r.levels().raised.is_some_and(|level| (level + 1.5).abs() < 0.04));
        assert!((r.depth() + r.place.z).abs() < 0.2, "{} {}", r.depth(), r.place.z);
    }
}

/// The beam comes over the edge at 5 cm/s: what it reads between both moves the height by less than 2 cm.
#[test]
fn a_mixture_on_the_way_onto_a_pipe_does_not_move_the_height() {
    for read in [pipe, table] {
        let mut r = Rig::new(read);
        r.fly(1.0, 0.0, 0.0);
        r.across(0.25, 0.3);
        let mut most = 0.0f32;
        for _ in 0..20 {
            r.across(0.01, 0.05);
            most = most.max(r.off().abs());
        }
        assert!(most < 0.02 && r.fusion.raised, "{most}");
        assert!(r.levels().raised.is_some_and(|level| (level + 1.5).abs() < 0.03));
    }
}

/// On the way off a back that falls below the beam for two seconds the height goes off by as much as it is unsure, and comes back
/// with the ground.
#[test]
fn a_slow_way_off_a_pipe_is_got_over_on_the_ground() {
    let flat: Read = |y, z| mixed(-1.5 - z, -z, RADIUS - (y - MIDDLE).abs());
    for read in [pipe, flat] {
        let mut r = Rig::new(read);
        r.fly(1.0, 0.0, 0.0);
        for (metres, speed) in [(0.45, 0.3), (0.3, 0.05), (0.3, 0.3)] {
            for _ in 0..20 {
                r.across(metres / 20.0, speed);
                let unsure = scalar::sqrt(r.axis.position_variance());
                assert!(r.off().abs() < 2.0 * unsure, "{} {unsure}", r.off());
            }
        }
        assert!(!r.fusion.raised && r.levels().ground.abs() < 1e-6 && r.off().abs() < 0.01);
        assert!(r.levels().raised.is_some_and(|level| (level + 1.5).abs() < 0.02));
    }
}

#[test]
fn a_beam_that_rests_on_an_edge_moves_nothing_and_is_on_nothing() {
    for aside in [-0.015, -0.005, 0.0, 0.01] {
        let mut r = Rig::new(pipe);
        r.fly(2.0, 0.0, 0.0);
        let way = MIDDLE - RADIUS + aside - r.place.y;
        r.across(way, 0.3);
        for i in 0..30u8 {
            r.fly(0.1, if i.is_multiple_of(2) { 0.04 } else { -0.04 }, 0.0);
            assert!(
                r.off().abs() < 0.02 && r.levels().raised.is_none(),
                "{aside}: {}",
                r.off()
            );
        }
        // It goes on over the pipe as if nothing had been.
        r.across(0.7, 0.3);
        r.fly(0.5, 0.0, 0.0);
        let level = r.levels().raised;
        assert!(
            level.is_some_and(|level| (level + 1.5).abs() < 0.02),
            "{aside}: {level:?}"
        );
        assert!(r.off().abs() < 0.02 && r.fusion.fault().is_none(), "{aside}");
    }
}

/// Whatever moves without a jump is no other surface: height or range are wrong, and after four seconds it is named.
#[test]
fn a_range_that_creeps_makes_no_surface_and_is_named() {
    for speed in [0.8, -0.8] {
        let mut r = Rig::new(floor);
        r.fly(5.0, 0.0, 0.0);
        r.fly(0.3, 0.3, speed);
        let counted = r.counted;
        for i in 0..36u8 {
            r.fly(0.1, 0.3, if i < 15 { speed } else { 0.0 });
            assert_eq!((r.levels(), r.fusion.fault()), (SurfaceLevels::default(), None));
        }
        // The height is what the inertial sensor says, which sees no motion.
        assert!(
            r.counted == counted && (r.axis.position() + 1.9).abs() < 0.15,
            "{}",
            r.axis.position()
        );
        r.fly(0.4, 0.0, 0.0);
        assert_eq!(r.fusion.fault(), Some(FlowRangeFault::RangeInconsistent));
        // The module's ranges are not passed on then; afterwards the surfaces begin anew.
        r.silent = true;
        r.fly(5.0, 0.0, 0.0);
        r.silent = false;
        r.fly(1.0, 0.0, 0.0);
        assert!(r.fusion.fault().is_none() && r.counted > counted + 30);
        assert!(
            (r.levels().ground - r.axis.position() + r.place.z).abs() < 0.03 && r.levels().raised.is_none()
        );
    }
}

#[test]
fn what_is_wider_than_a_pipe_becomes_the_ground() {
    let mut r = Rig::new(table);
    r.fly(1.0, 0.0, 0.0);
    r.across(0.55, 0.3);
    assert!(r.fusion.raised && r.levels().ground == 0.0);
    r.across(0.6, 0.3);
    assert!(!r.fusion.raised && r.levels().raised.is_none());
    assert!(
        (r.levels().ground + 1.5).abs() < 0.02 && r.off().abs() < 0.02,
        "{:?}",
        r.levels()
    );
    // Back over its edge the beam falls off the ground: the deeper surface is that then, and the table is raised.
    r.across(1.2, -0.3);
    r.fly(0.5, 0.0, 0.0);
    assert!(
        !r.fusion.raised && r.levels().ground.abs() < 0.03,
        "{:?}",
        r.levels()
    );
    assert!(r.levels().raised.is_some_and(|level| (level + 1.5).abs() < 0.03));
}

/// A range waits for 0.16 s beyond its own latency: what is as late is still compared with the state of its time.
#[test]
fn ranges_of_any_rate_and_latency_give_the_height() {
    for every_us in [20_000, 50_000, 100_000] {
        for late_us in [20_000, 50_000, 100_000, 200_000] {
            let mut r = Rig::new(floor);
            (r.every_us, r.late_us) = (every_us, late_us);
            r.axis = Axis::at(r.place.z + 0.05);
            r.fly(8.0, 0.0, 0.0);
            assert!(r.off().abs() < 0.01, "{every_us} {late_us}: {}", r.off());
            // A slow climb that the inertial sensor does not show is found by the range alone.
            r.fly(8.0, 0.0, 0.02);
            assert!(r.off().abs() < 0.03, "{every_us} {late_us}: {}", r.off());
            assert_eq!(r.fusion.fault(), None);
        }
    }
}

/// Poses give the height, and the levels follow it.
#[test]
fn beside_poses_a_pipe_is_raised_and_the_ground_is_so_again_behind_it() {
    let mut r = Rig::new(pipe);
    r.posed = true;
    // The poses' origin is 0.7 m above the ground.
    r.place.z = -1.9;
    r.axis = Axis::at(-1.2);
    r.fusion.forget_surfaces();
    let pose = |r: &mut Rig, seconds: f32, speed: f32| {
        for _ in 0..(seconds * 50.0) as u32 {
            let off = r.place.z + 0.7 - r.axis.position();
            r.axis.correct(off, 1e-4, 0.0);
            r.fly(0.02, speed, 0.0);
        }
    };
    pose(&mut r, 1.0, 0.0);
    assert!((r.levels().ground - 0.7).abs() < 0.03, "{:?}", r.levels());
    pose(&mut r, 1.5, 0.3);
    assert!(r.fusion.raised && r.counted == 0);
    assert!(
        r.levels().raised.is_some_and(|level| (level + 0.8).abs() < 0.03),
        "{:?}",
        r.levels()
    );
    pose(&mut r, 1.5, 0.3);
    assert!(
        !r.fusion.raised && (r.levels().ground - 0.7).abs() < 0.03,
        "{:?}",
        r.levels()
    );
    // Their height drifts against the ground by 20 cm: the level goes with it.
    for _ in 0..20 {
        r.place.z += 0.01;
        r.way.iter_mut().for_each(|(_, place)| place.z += 0.01);
        pose(&mut r, 0.2, 0.0);
        let ground = r.axis.position() - r.place.z;
        assert!(
            (r.levels().ground - ground).abs() < 0.05,
            "{:?} {ground}",
            r.levels()
        );
    }
    assert_eq!(r.fusion.fault(), None);
}

/// In other axes the surfaces and places of the ones before are none.
#[test]
fn a_new_estimate_drops_the_surfaces_of_the_previous_axes() {
    let mut r = Rig::new(pipe);
    r.place.x = 7.0;
    r.fly(1.0, 0.0, 0.0);
    r.across(0.3, 0.3);
    let half_seen = r.fusion;
    r.across(0.15, 0.3);
    assert!(half_seen.step.begun() && r.fusion.raised && r.fusion.band.is_some());
    for mut fusion in [half_seen, r.fusion] {
        assert!(fusion.surface_point.x > 6.9);
        fusion.range = Some((20_000, 1.0));
        let flow = Flow {
            until_us: 20_000,
            seconds: 0.02,
            angle: [0.0; 2],
            quality: 100,
        };
        assert_eq!(fusion.begin(&flow, Quat::IDENTITY), Some(1.0));
        assert_eq!((fusion.step, fusion.settled), Default::default());
        assert_eq!((fusion.levels(), fusion.raised, fusion.band), Default::default());
        assert!(fusion.surface_point.norm() < 1e-6, "{:?}", fusion.surface_point);
        assert!(fusion.unproven.is_none_or(|first| first.norm() < 1e-6));
    }
}

/// Along its own line beyond its end, and a while later, nothing narrow is in the view.
#[test]
fn a_pipe_is_left_behind_by_way_and_by_time() {
    for (way, seconds) in [(2.5, 1.0), (0.0, 25.0)] {
        let mut r = Rig::new(pipe);
        r.fly(1.0, 0.0, 0.0);
        r.across(0.75, 0.3);
        r.fly(0.3, 0.0, 0.0);
        assert!(!r.fusion.raised && r.depth() < 1.8, "beside it: {}", r.depth());
        (r.read, r.place.x) = (floor, way);
        r.fly(seconds, 0.0, 0.0);
        assert!((r.depth() - 1.9).abs() < 0.02, "{way} {seconds}: {}", r.depth());
    }
}

/// A beam that leans by 5° in a cross wind meets the ground 17 cm beside the vehicle and the pipe 3 cm.
#[test]
fn a_leaning_beam_finds_the_edges_where_they_are() {
    // To the left of the vehicle.
    const LEAN: f32 = 0.09;
    let mut r = Rig::new(|y, z| {
        let near = y + LEAN.tan() * (z + 1.5) - MIDDLE;
        if near.abs() < RADIUS { -1.5 - z } else { -z }
    });
    r.q = Quat::from_euler(LEAN, 0.0, 0.0);
    r.fly(1.0, 0.0, 0.0);
    r.across(0.9, 0.25);
    let band = r.fusion.band.expect("a band");
    let middle = Vec3::new(0.0, MIDDLE, 0.0);
    // The beam's back falls by less than it does in truth: here it is flat.
    let (drop, _) = band.drop(middle, 0.0);
    assert!(drop < 2e-3, "{drop} {band:?}");
}
