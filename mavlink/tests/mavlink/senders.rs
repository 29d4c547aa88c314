//! Inputs of several senders: each has its own clock, each input one source, and what is refused changes nothing.

use mavlink_core::MessageData;
use sophie_control::params::{FlowPort, Params};
use sophie_dialect::*;
use sophie_mavlink::inputs::{Counts, Inputs};
use sophie_ports::external_pose::TimeSource;

use crate::station::{Station, frame_by};

/// 2026-11-25 in µs since 1970.
const DATE: u64 = 1_795_618_800_000_000;

/// A computer whose clock is `ahead` of the vehicle's, µs. It answers what it is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sender {
    system: u8,
    component: u8,
    ahead: u64,
}

const VIO: Sender = Sender {
    system: 1,
    component: 197,
    ahead: DATE,
};
const CAMERA: Sender = Sender {
    system: 1,
    component: 191,
    ahead: 7 * DATE / 8,
};

impl Sender {
    fn say<M: MessageData>(self, station: &mut Station, message: &M) {
        station.say(&frame_by(self.system, self.component, message));
    }

    /// Its clock at `age` µs before now.
    fn clock(self, station: &Station, age: u64) -> u64 {
        station.now + self.ahead - age
    }

    fn pose(self, station: &mut Station, age: u64) {
        self.pose_at(station, age, 0);
    }

    fn pose_at(self, station: &mut Station, age: u64, reset_counter: u8) {
        let time_usec = self.clock(station, age);
        let pose = ODOMETRY_DATA {
            time_usec,
            q: [1.0, 0.0, 0.0, 0.0],
            frame_id: 1,
            child_frame_id: 12,
            reset_counter,
            ..ODOMETRY_DATA::DEFAULT
        };
        self.say(station, &pose);
    }

    fn pipe(self, station: &mut Station, age: u64) {
        let time_usec = self.clock(station, age);
        let pipe = LANDING_TARGET_DATA {
            time_usec,
            frame: 1,
            position_valid: 1,
            ..LANDING_TARGET_DATA::DEFAULT
        };
        self.say(station, &pipe);
    }

    /// 1.2 m along `orientation`, its time as MAVROS cuts it.
    fn range(self, station: &mut Station, age: u64, orientation: u8) {
        let time_boot_ms = (self.clock(station, age) / 1000) as u32;
        let range = DISTANCE_SENSOR_DATA {
            time_boot_ms,
            min_distance: 10,
            max_distance: 800,
            current_distance: 120,
            orientation,
            ..DISTANCE_SENSOR_DATA::DEFAULT
        };
        self.say(station, &range);
    }

    fn flow(self, station: &mut Station, distance: f32) {
        let time_usec = self.clock(station, 0);
        let flow = OPTICAL_FLOW_RAD_DATA {
            time_usec,
            integration_time_us: 20_000,
            quality: 90,
            distance,
            ..OPTICAL_FLOW_RAD_DATA::DEFAULT
        };
        self.say(station, &flow);
    }
}

fn begin() -> Station {
    let mut station = Station::new();
    station.now = 5_000_000;
    station
}

/// Lets 100 ms pass, in which `senders` answer what they are asked at once; the questions to each of them.
fn pass(station: &mut Station, senders: &[Sender]) -> Vec<usize> {
    let mut questions = vec![0; senders.len()];
    for _ in 0..5 {
        let from = station.sent.len();
        station.run(20);
        for question in station.since::<TIMESYNC_DATA>(from) {
            let to = (question.target_system, question.target_component);
            let place = senders.iter().position(|s| (s.system, s.component) == to);
            let place = place.expect("a question to no sender");
            questions[place] += 1;
            // Broadcast, it is heard by all, and each answers by its own clock.
            for sender in senders {
                let answer = TIMESYNC_DATA {
                    tc1: (sender.clock(station, 0) * 1000) as i64,
                    ts1: question.ts1,
                    target_system: 1,
                    target_component: 1,
                };
                sender.say(station, &answer);
            }
        }
    }
    questions
}

/// What the counts have grown by while `work` is done.
fn grown(station: &mut Station, work: impl FnOnce(&mut Station)) -> Counts {
    let before = station.inputs.counts();
    work(station);
    let after = station.inputs.counts();
    Counts {
        poses: after.poses - before.poses,
        views: after.views - before.views,
        targets: after.targets - before.targets,
        system: after.system - before.system,
        source: after.source - before.source,
        frame: after.frame - before.frame,
        value: after.value - before.value,
        late: after.late - before.late,
    }
}

/// A vehicle that knows the clocks of `senders`, which send poses and the place of the pipe.
fn known() -> Station {
    let mut station = begin();
    for _ in 0..3 {
        VIO.pose(&mut station, 20_000);
        CAMERA.pipe(&mut station, 20_000);
        pass(&mut station, &[VIO, CAMERA]);
    }
    assert_eq!(station.inputs.counts().late, 0);
    station
}

#[test]
fn two_senders_have_a_clock_each_and_are_asked_once_a_second_each() {
    let mut station = known();
    let mut asked = [0, 0];
    let fresh = grown(&mut station, |station| {
        for _ in 0..30 {
            VIO.pose(station, 50_000);
            CAMERA.pipe(station, 50_000);
            for (sum, more) in asked.iter_mut().zip(pass(station, &[VIO, CAMERA])) {
                *sum += more;
            }
        }
    });
    assert_eq!(asked, [3, 3]);
    assert_eq!((fresh.poses, fresh.targets, fresh.late), (30, 30, 0));
    assert_eq!(station.inputs.take_pose().unwrap().clock, TimeSource::Offset);
    let old = grown(&mut station, |station| {
        for _ in 0..30 {
            VIO.pose(station, 2_000_000);
            CAMERA.pipe(station, 2_000_000);
            pass(station, &[VIO, CAMERA]);
        }
    });
    assert_eq!((old.poses, old.targets, old.late), (0, 0, 60));
}

#[test]
fn what_is_refused_asks_nothing_and_changes_no_clock() {
    let mut station = known();
    let stranger = Sender {
        system: 7,
        component: 197,
        ahead: 0,
    };
    let standby = Sender {
        component: 198,
        ..VIO
    };
    let grew = grown(&mut station, |station| {
        for _ in 0..30 {
            VIO.pose(station, 2_000_000);
            // Looks forward; belongs to another vehicle; is no second source; is no number.
            Sender {
                component: 173,
                ..VIO
            }
            .range(station, 0, 0);
            stranger.pose(station, 0);
            CAMERA.pipe(station, 0);
            Sender {
                component: 192,
                ..VIO
            }
            .pipe(station, 0);
            let broken = VISION_POSITION_ESTIMATE_DATA {
                x: f32::NAN,
                ..Default::default()
            };
            standby.say(station, &broken);
            pass(station, &[VIO, CAMERA]);
        }
    });
    // Nothing of the two-seconds-old poses is taken for new.
    assert_eq!((grew.poses, grew.late), (0, 30));
    assert_eq!(
        (grew.frame, grew.system, grew.source, grew.value, grew.targets),
        (30, 30, 30, 30, 30)
    );
}

#[test]
fn a_time_of_32_bits_is_aged_modulo_its_range() {
    let module = Sender {
        component: 173,
        ..VIO
    };
    let mut station = begin();
    for _ in 0..3 {
        module.range(&mut station, 20_000, 25);
        pass(&mut station, &[module]);
    }
    for age in [0, 50_000, 300_000, 990_000] {
        station.now += 1_000_000;
        module.range(&mut station, age, 25);
        let at = station.inputs.take_ground().unwrap().range.unwrap().at_us;
        let was = station.now - at;
        assert!(
            (age..age + 1_000).contains(&was) || was == 0 && age == 0,
            "{age} {was}"
        );
    }
    let late = grown(&mut station, |station| module.range(station, 1_100_000, 25));
    assert_eq!((late.views, late.late), (0, 1));
    // Where the field wraps as well, and beyond the 49 days that it can count.
    for ahead in [(1_u64 << 32) * 1000 - station.now, 3 * (1_u64 << 32) * 1000] {
        let module = Sender { ahead, ..module };
        let mut station = begin();
        for n in 0..60 {
            station.run(20);
            module.range(&mut station, 10_000, 25);
            pass(&mut station, &[module]);
            if n > 2 {
                let range = station.inputs.take_ground().unwrap().range.unwrap();
                let was = station.now - 100_000 - range.at_us;
                assert!((10_000..11_001).contains(&was), "{n} {was}");
            }
        }
        assert_eq!(station.inputs.counts().late, 0);
    }
}

#[test]
fn a_restarted_sender_with_another_clock_is_late_until_it_answers_a_timesync() {
    let mut station = known();
    let again = Sender {
        ahead: 1_000_000,
        ..VIO
    };
    let grew = grown(&mut station, |station| {
        for _ in 0..20 {
            again.pose(station, 0);
            pass(station, &[again]);
        }
    });
    assert!((1..=10).contains(&grew.late) && grew.poses >= 10, "{grew:?}");
    again.pose(&mut station, 10_000);
    let pose = station.inputs.take_pose().unwrap();
    assert_eq!(pose.clock, TimeSource::Offset);
}

#[test]
fn a_new_clock_counts_by_a_slower_answer_as_well() {
    let mut station = known();
    let again = Sender {
        ahead: 1_000_000,
        ..VIO
    };
    // The first was known by answers at once, which later ones are measured against.
    station.now += 1_000_000;
    let grew = grown(&mut station, |station| {
        for _ in 0..3 {
            again.pose(station, 0);
            let from = station.sent.len();
            station.run(1000);
            for question in station.since::<TIMESYNC_DATA>(from) {
                let at = question.ts1 as u64 / 1000;
                station.now = at + 80_000;
                let answer = TIMESYNC_DATA {
                    tc1: ((at + 40_000 + again.ahead) * 1000) as i64,
                    ts1: question.ts1,
                    target_system: 1,
                    target_component: 1,
                };
                again.say(station, &answer);
            }
        }
    });
    assert_eq!((grew.late, grew.poses), (1, 2), "{grew:?}");
}

#[test]
fn another_source_comes_after_two_seconds_of_silence_as_a_reset() {
    let standby = Sender {
        component: 198,
        ..VIO
    };
    let mut station = begin();
    VIO.pose_at(&mut station, 0, 3);
    assert_eq!(station.inputs.take_pose().unwrap().pose.resets, 3);
    station.now += 2_000_000;
    let grew = grown(&mut station, |station| standby.pose_at(station, 0, 4));
    assert_eq!((grew.poses, grew.source), (0, 1));
    station.now += 20_000;
    let mut published = Vec::new();
    for resets in [4, 4, 5] {
        standby.pose_at(&mut station, 0, resets);
        published.push(station.inputs.take_pose().unwrap().pose.resets);
        station.now += 20_000;
    }
    assert_eq!(published, [4, 4, 5]);
    // One that happens to count as the source before is another all the same.
    station.now += 2_020_000;
    VIO.pose_at(&mut station, 0, 5);
    assert_eq!(station.inputs.take_pose().unwrap().pose.resets, 6);
    // The first is a standby itself now, and so is another message of the same sender.
    let grew = grown(&mut station, |station| {
        standby.pose(station, 0);
        let vision = VISION_POSITION_ESTIMATE_DATA::DEFAULT;
        VIO.say(station, &vision);
    });
    assert_eq!((grew.poses, grew.source), (0, 2));
}

#[test]
fn another_sender_does_not_take_the_clock_of_an_active_one() {
    let module = Sender {
        component: 173,
        ..VIO
    };
    let flow = Sender {
        component: 174,
        ..CAMERA
    };
    let all = [VIO, CAMERA, module, flow];
    let mut station = begin();
    // Two seconds of poses that are too old: just not long enough for another to be their source.
    for round in 0..70_u8 {
        VIO.pose(&mut station, if round < 50 { 20_000 } else { 2_000_000 });
        CAMERA.pipe(&mut station, 20_000);
        module.range(&mut station, 20_000, 25);
        flow.flow(&mut station, -1.0);
        let stray = Sender {
            component: 2 + round,
            ..VIO
        };
        stray.pose(&mut station, 0);
        stray.pipe(&mut station, 0);
        stray.range(&mut station, 0, 25);
        stray.flow(&mut station, 1.0);
        pass(&mut station, &all);
    }
    let counts = station.inputs.counts();
    assert_eq!((counts.poses, counts.late), (50, 20));
    assert_eq!((counts.targets, counts.views, counts.source), (70, 140, 280));
}

#[test]
fn another_system_s_inputs_are_refused_by_name_unless_the_parameter_has_it() {
    let other = Sender {
        system: 42,
        component: 1,
        ahead: 0,
    };
    let all = |station: &mut Station| {
        other.pose(station, 0);
        other.pipe(station, 0);
        other.range(station, 0, 25);
        other.flow(station, -1.0);
    };
    let mut station = begin();
    let grew = grown(&mut station, all);
    assert_eq!(
        grew,
        Counts {
            system: 4,
            ..Counts::default()
        }
    );
    for (system, taken) in [(42.0, 2), (41.0, 0)] {
        let mut station = begin();
        station.inputs = Inputs::new(&Params {
            mav_inputs_sys: system,
            ..Params::DEFAULT
        });
        let grew = grown(&mut station, all);
        assert_eq!((grew.views, grew.system), (taken, 2 * (2 - taken)));
        // The vehicle's own computers as ever, where the other one is silent.
        station.now += 3_000_000;
        let own = grown(&mut station, |station| VIO.pose(station, 0));
        assert_eq!(own.poses, 1);
    }
}

#[test]
fn two_sensors_below_do_not_interleave() {
    let other = Sender {
        component: 174,
        ..VIO
    };
    let mut station = begin();
    let grew = grown(&mut station, |station| {
        for _ in 0..5 {
            station.now += 20_000;
            VIO.range(station, 0, 25);
            other.range(station, 10_000, 25);
            let second = DISTANCE_SENSOR_DATA {
                max_distance: 800,
                orientation: 25,
                id: 1,
                ..DISTANCE_SENSOR_DATA::DEFAULT
            };
            VIO.say(station, &second);
        }
    });
    assert_eq!((grew.views, grew.source, grew.late), (5, 10, 0));
    // Beside it, the range that a flow brings along is left, and the flow taken; alone it is taken.
    let view = |station: &mut Station| station.inputs.take_ground().unwrap();
    other.flow(&mut station, 3.0);
    assert_eq!(view(&mut station).range.unwrap().distance, Some(1.2));
    station.now += 3_000_000;
    other.flow(&mut station, 3.0);
    assert_eq!(view(&mut station).range.unwrap().distance, Some(3.0));
    // A sensor comes first again, not with a time before that of the flow's range.
    let grew = grown(&mut station, |station| {
        VIO.range(station, 5_000, 25);
        station.now += 20_000;
        VIO.range(station, 5_000, 25);
    });
    assert_eq!((grew.views, grew.late), (1, 1));
    assert_eq!(view(&mut station).range.unwrap().distance, Some(1.2));
}

#[test]
fn a_module_on_the_vehicles_own_port_is_the_source_of_flow_and_range() {
    let mut station = begin();
    station.inputs = Inputs::new(&Params {
        flow_port: FlowPort::Msp,
        ..Params::DEFAULT
    });
    let grew = grown(&mut station, |station| {
        VIO.flow(station, 1.0);
        VIO.range(station, 0, 25);
        VIO.pose(station, 0);
    });
    assert_eq!((grew.views, grew.source, grew.poses), (0, 2, 1));
}

#[test]
fn a_time_that_is_not_given_is_that_of_receipt() {
    let mut station = known();
    let pose = ODOMETRY_DATA {
        time_usec: 0,
        q: [1.0, 0.0, 0.0, 0.0],
        frame_id: 1,
        child_frame_id: 12,
        ..ODOMETRY_DATA::DEFAULT
    };
    VIO.say(&mut station, &pose);
    let pose = station.inputs.take_pose().unwrap();
    assert_eq!((pose.measured_at, pose.clock), (station.now, TimeSource::Receipt));
}
