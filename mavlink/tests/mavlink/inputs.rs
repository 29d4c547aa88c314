//! Poses, flow, range and pipe from outside: axes, bounds, times.

use mavlink_core::MessageData;
use sophie_control::approach::pipe_target::PipeTarget;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::navigation::flow_range_sample::GroundView;
use sophie_dialect::*;
use sophie_mavlink::inputs::Counts;
use sophie_ports::external_pose::{ExternalPose, TimeSource};

use crate::station::{Station, frame_by};

/// A frame of `message` from a computer aboard.
fn frame<M: MessageData>(message: &M) -> Vec<u8> {
    frame_by(1, 190, message)
}

const NAN: [f32; 21] = [f32::NAN; 21];

/// At 1, 2, 3 m in NED, level, heading north, at 4, 5, 6 m/s along the body's axes; nothing is known of its errors.
fn odometry() -> ODOMETRY_DATA {
    ODOMETRY_DATA {
        time_usec: 0,
        x: 1.0,
        y: 2.0,
        z: 3.0,
        q: [1.0, 0.0, 0.0, 0.0],
        vx: 4.0,
        vy: 5.0,
        vz: 6.0,
        pose_covariance: NAN,
        velocity_covariance: NAN,
        frame_id: 1,
        child_frame_id: 12,
        ..ODOMETRY_DATA::DEFAULT
    }
}

fn after<M: MessageData>(message: &M) -> (Option<ExternalPose>, Counts) {
    let mut station = Station::new();
    station.now = 5_000_000;
    station.say(&frame(message));
    let inputs = &mut station.inputs;
    (inputs.take_pose(), inputs.counts())
}

fn taken<M: MessageData>(message: &M) -> ExternalPose {
    let (pose, counts) = after(message);
    assert_eq!(
        counts,
        Counts {
            poses: 1,
            ..Counts::default()
        }
    );
    pose.unwrap()
}

/// Counts of what refuses `message`: frame, value, late.
fn refused<M: MessageData>(message: &M) -> [u32; 3] {
    let (pose, counts) = after(message);
    assert!(pose.is_none() && counts.poses == 0);
    [counts.frame, counts.value, counts.late]
}

fn near(a: Vec3, b: Vec3) {
    assert!((a - b).norm() < 1e-5, "{a:?} {b:?}");
}

/// The same rotation.
fn turned_alike(a: Option<Quat>, b: Quat) {
    let a = a.unwrap();
    for axis in [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)] {
        near(a.rotate(axis), b.rotate(axis));
    }
}

#[test]
fn a_pose_in_ned_is_taken_as_it_is() {
    let pose = taken(&odometry()).pose;
    assert_eq!(pose.position, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(pose.velocity, Some(Vec3::new(4.0, 5.0, 6.0)));
    assert!(pose.north && pose.quality.is_none() && pose.resets == 0);
    assert_eq!(
        (
            pose.position_variance,
            pose.attitude_variance,
            pose.velocity_variance
        ),
        (None, None, None)
    );
    turned_alike(pose.attitude, Quat::IDENTITY);
}

#[test]
fn every_frame_is_turned_into_the_vehicles() {
    // The body's axes along each world's: x_b north or forward, y_b east or right, z_b down.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    for (frame_id, north, q, position) in [
        (1, true, [1.0, 0.0, 0.0, 0.0], [1.0, 2.0, 3.0]),
        (4, true, [0.0, half, half, 0.0], [2.0, 1.0, -3.0]),
        (20, false, [1.0, 0.0, 0.0, 0.0], [1.0, 2.0, 3.0]),
        (21, false, [0.0, 1.0, 0.0, 0.0], [1.0, -2.0, -3.0]),
    ] {
        let [x, y, z] = position;
        let in_world = ODOMETRY_DATA {
            frame_id,
            q,
            x,
            y,
            z,
            ..odometry()
        };
        let pose = taken(&in_world).pose;
        assert_eq!((pose.position, pose.north), (Vec3::new(1.0, 2.0, 3.0), north));
        turned_alike(pose.attitude, Quat::IDENTITY);
        near(pose.velocity.unwrap(), Vec3::new(4.0, 5.0, 6.0));
        // The velocity in the world's axes.
        let [vx, vy, vz] = position;
        let pose = taken(&ODOMETRY_DATA {
            child_frame_id: frame_id,
            vx,
            vy,
            vz,
            ..in_world
        })
        .pose;
        assert_eq!(pose.velocity, Some(Vec3::new(1.0, 2.0, 3.0)));
    }
    for frame_id in [0, 2, 3, 5, 7, 8, 12, 13, 22, 255] {
        assert_eq!(
            refused(&ODOMETRY_DATA {
                frame_id,
                ..odometry()
            }),
            [1, 0, 0],
            "{frame_id}"
        );
    }
    for child_frame_id in [0, 7, 13, 20, 21, 255] {
        assert_eq!(
            refused(&ODOMETRY_DATA {
                child_frame_id,
                ..odometry()
            }),
            [1, 0, 0],
            "{child_frame_id}"
        );
    }
}

#[test]
fn errors_of_the_body_s_velocity_are_turned_with_it() {
    // Heading east: the body's x is the world's y.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut m = ODOMETRY_DATA {
        q: [half, 0.0, 0.0, half],
        quality: 77,
        reset_counter: 3,
        ..odometry()
    };
    for (at, value) in [(0, 1.0), (6, 2.0), (11, 3.0), (15, 0.1), (18, 0.2), (20, 0.3)] {
        m.pose_covariance[at] = value;
        m.velocity_covariance[at] = value;
    }
    let pose = taken(&m).pose;
    near(pose.velocity.unwrap(), Vec3::new(-5.0, 4.0, 6.0));
    assert_eq!(pose.position_variance, Some(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(pose.attitude_variance, Some(Vec3::new(0.1, 0.2, 0.3)));
    near(pose.velocity_variance.unwrap(), Vec3::new(2.0, 1.0, 3.0));
    assert_eq!((pose.quality, pose.resets), (Some(77), 3));
    m.frame_id = 4;
    let pose = taken(&m).pose;
    assert_eq!(pose.position_variance, Some(Vec3::new(2.0, 1.0, 3.0)));
    assert_eq!(pose.attitude_variance, None);
}

#[test]
fn what_is_not_given_is_left_out() {
    let pose = taken(&ODOMETRY_DATA {
        q: [f32::NAN; 4],
        ..odometry()
    })
    .pose;
    assert_eq!(
        (pose.attitude, pose.velocity),
        (None, None),
        "no axes for the velocity"
    );
    let pose = taken(&ODOMETRY_DATA {
        vx: f32::NAN,
        ..odometry()
    })
    .pose;
    assert!(pose.attitude.is_some() && pose.velocity.is_none());
}

#[test]
fn the_other_two_poses_are_in_ned() {
    let vision = VISION_POSITION_ESTIMATE_DATA {
        x: 1.0,
        y: 2.0,
        z: 3.0,
        yaw: 1.0,
        ..Default::default()
    };
    let pose = taken(&vision).pose;
    assert_eq!(
        (pose.position, pose.position_variance, pose.north),
        (Vec3::new(1.0, 2.0, 3.0), None, true)
    );
    turned_alike(pose.attitude, Quat::from_euler(0.0, 0.0, 1.0));
    let mocap = ATT_POS_MOCAP_DATA {
        q: [0.0, 0.0, 0.0, 1.0],
        x: 1.0,
        ..Default::default()
    };
    let pose = taken(&mocap).pose;
    near(
        pose.attitude.unwrap().rotate(Vec3::new(1.0, 0.0, 0.0)),
        Vec3::new(-1.0, 0.0, 0.0),
    );
    assert_eq!(
        refused(&VISION_POSITION_ESTIMATE_DATA {
            pitch: 7.0,
            ..vision.clone()
        }),
        [0, 1, 0]
    );
    assert_eq!(
        refused(&VISION_POSITION_ESTIMATE_DATA {
            y: f32::INFINITY,
            ..vision
        }),
        [0, 1, 0]
    );
    assert_eq!(refused(&ATT_POS_MOCAP_DATA { q: [0.0; 4], ..mocap }), [0, 1, 0]);
}

#[test]
fn no_number_and_no_sense_are_refused() {
    let good = odometry();
    let mut covariance = NAN;
    for (first, other) in [(-1.0, 0.0), (1.0, f32::NAN), (f32::INFINITY, 1.0), (1e7, 1.0)] {
        covariance[0] = first;
        covariance[6] = other;
        covariance[11] = 0.0;
        (covariance[15], covariance[18], covariance[20]) = (0.0, 0.0, 0.0);
        assert_eq!(
            refused(&ODOMETRY_DATA {
                pose_covariance: covariance,
                ..good.clone()
            }),
            [0, 1, 0]
        );
        assert_eq!(
            refused(&ODOMETRY_DATA {
                velocity_covariance: covariance,
                ..good.clone()
            }),
            [0, 1, 0]
        );
    }
    for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, 10_001.0, -10_001.0] {
        assert_eq!(
            refused(&ODOMETRY_DATA {
                z: bad,
                ..good.clone()
            }),
            [0, 1, 0],
            "{bad}"
        );
        assert_eq!(
            refused(&ODOMETRY_DATA {
                vy: bad,
                ..good.clone()
            }),
            [0, 1, 0],
            "{bad}"
        );
        assert_eq!(
            refused(&ODOMETRY_DATA {
                q: [1.0, 0.0, bad, 0.0],
                ..good.clone()
            }),
            [0, 1, 0],
            "{bad}"
        );
    }
    assert_eq!(
        refused(&ODOMETRY_DATA {
            quality: -1,
            ..good.clone()
        }),
        [0, 1, 0]
    );
    assert_eq!(
        refused(&ODOMETRY_DATA {
            q: [1.02, 0.0, 0.0, 0.0],
            ..good
        }),
        [0, 1, 0]
    );
}

/// Sends a pose that the sender's clock dates `usec`; when it was measured, and how that is known.
fn dated(station: &mut Station, usec: u64) -> Option<(u64, TimeSource)> {
    station.say(&frame(&ODOMETRY_DATA {
        time_usec: usec,
        ..odometry()
    }));
    let pose = station.inputs.take_pose()?;
    assert_eq!(pose.received_at, station.now);
    Some((pose.measured_at, pose.clock))
}

#[test]
fn the_time_of_measurement_is_the_senders_once_its_clock_is_known() {
    const DATE: u64 = 1_800_000_000_000_000;
    let mut station = Station::new();
    station.now = 5_000_000;
    assert_eq!(dated(&mut station, DATE), Some((5_000_000, TimeSource::Receipt)));
    // It is asked for its time, and answers after 20 ms: its clock shows DATE at 5.03 s.
    station.run(20);
    let asked = station.got::<TIMESYNC_DATA>();
    assert_eq!(asked.len(), 1);
    assert_eq!(
        (asked[0].tc1, asked[0].target_system, asked[0].target_component),
        (0, 1, 190)
    );
    let answer = TIMESYNC_DATA {
        tc1: DATE as i64 * 1000,
        target_system: 1,
        target_component: 1,
        ..asked[0].clone()
    };
    station.now += 20_000;
    // Another's answer, and one to another question, say nothing.
    station.say(&frame_by(
        1,
        7,
        &TIMESYNC_DATA {
            tc1: 1,
            ..answer.clone()
        },
    ));
    station.say(&frame(&TIMESYNC_DATA {
        ts1: answer.ts1 + 1,
        tc1: 1,
        ..answer.clone()
    }));
    station.say(&frame(&answer));
    // 5.04 s now: what was dated 40 ms after that was measured at 5.07 s at the latest: now.
    assert_eq!(
        dated(&mut station, DATE - 10_000),
        Some((5_020_000, TimeSource::Offset))
    );
    assert_eq!(
        dated(&mut station, DATE + 40_000),
        Some((5_040_000, TimeSource::Offset))
    );
    assert_eq!(dated(&mut station, DATE - 2_000_000), None, "too old");
    assert_eq!(dated(&mut station, DATE), None, "not after the one before");
    assert_eq!(station.inputs.counts().late, 2);
    // Asked again after a second, not before.
    station.run(900);
    dated(&mut station, DATE + 900_000);
    station.run(300);
    dated(&mut station, DATE + 1_200_000);
    station.run(100);
    assert_eq!(station.got::<TIMESYNC_DATA>().len(), 2);
}

#[test]
fn a_sender_that_keeps_the_vehicles_time_is_accepted() {
    let mut station = Station::new();
    station.now = 5_000_000;
    assert_eq!(
        dated(&mut station, 4_900_000),
        Some((4_900_000, TimeSource::Vehicle))
    );
    assert_eq!(dated(&mut station, 4_900_000), None);
    assert_eq!(
        dated(&mut station, 4_900_001),
        Some((4_900_001, TimeSource::Vehicle))
    );
}

/// 0.02 rad forward in 20 ms, 1.5 m over the ground, measured 4 ms before.
fn flow() -> OPTICAL_FLOW_RAD_DATA {
    OPTICAL_FLOW_RAD_DATA {
        time_usec: 4_990_000,
        integration_time_us: 20_000,
        integrated_x: -0.01,
        integrated_y: 0.02,
        quality: 90,
        time_delta_distance_us: 4_000,
        distance: 1.5,
        ..OPTICAL_FLOW_RAD_DATA::DEFAULT
    }
}

/// 1.2 m down, of 0.1 to 8 m.
fn range() -> DISTANCE_SENSOR_DATA {
    DISTANCE_SENSOR_DATA {
        time_boot_ms: 4_995,
        min_distance: 10,
        max_distance: 800,
        current_distance: 120,
        orientation: 25,
        ..DISTANCE_SENSOR_DATA::DEFAULT
    }
}

/// What is seen after `message`, and the counts of frame, value, late and taken.
fn seen<M: MessageData>(message: &M) -> (Option<GroundView>, [u32; 4]) {
    let mut station = Station::new();
    station.now = 5_000_000;
    station.say(&frame(message));
    let inputs = &mut station.inputs;
    let counts = inputs.counts();
    let view = inputs.take_ground();
    assert!(inputs.take_ground().is_none(), "taken once");
    (view, [counts.frame, counts.value, counts.late, counts.views])
}

#[test]
fn flow_and_range_are_taken_with_the_time_of_their_measurement() {
    let (view, counts) = seen(&flow());
    let view = view.unwrap();
    let (f, r) = (view.flow.unwrap(), view.range.unwrap());
    assert_eq!((f.until_us, f.angle, f.quality), (4_990_000, [-0.01, 0.02], 90));
    assert!((f.seconds - 0.02).abs() < 1e-6);
    assert_eq!((r.at_us, r.distance), (4_986_000, Some(1.5)));
    assert_eq!(counts, [0, 0, 0, 1]);

    let (view, counts) = seen(&range());
    let r = view.unwrap().range.unwrap();
    assert_eq!((r.at_us, r.distance), (4_995_000, Some(1.2)));
    assert!((r.reach.0 - 0.1).abs() < 1e-6 && (r.reach.1 - 8.0).abs() < 1e-6);
    assert_eq!(counts, [0, 0, 0, 1]);
}

#[test]
fn what_is_no_flow_looks_elsewhere_or_is_old_is_refused_and_counted() {
    let flows = [
        OPTICAL_FLOW_RAD_DATA {
            integrated_x: f32::NAN,
            ..flow()
        },
        OPTICAL_FLOW_RAD_DATA {
            integrated_y: 1.0,
            ..flow()
        },
        OPTICAL_FLOW_RAD_DATA {
            integration_time_us: 0,
            ..flow()
        },
    ];
    for m in flows {
        assert_eq!(seen(&m), (None, [0, 1, 0, 0]));
    }
    let forward = DISTANCE_SENSOR_DATA {
        orientation: 0,
        ..range()
    };
    assert_eq!(seen(&forward), (None, [1, 0, 0, 0]));
    let inside_out = DISTANCE_SENSOR_DATA {
        min_distance: 900,
        ..range()
    };
    assert_eq!(seen(&inside_out), (None, [0, 1, 0, 0]));

    let mut station = Station::new();
    station.now = 5_000_000;
    station.say(&frame(&flow()));
    station.say(&frame(&flow()));
    let counts = station.inputs.counts();
    assert_eq!((counts.views, counts.late), (1, 1));
}

#[test]
fn a_distance_of_zero_or_without_limits_is_no_measurement() {
    // Many sensors say 0 where they see nothing: from 0 on none measures.
    for (distance, seen_at) in [(0, None), (1, None), (120, Some(1.2))] {
        let m = DISTANCE_SENSOR_DATA {
            min_distance: 0,
            current_distance: distance,
            ..range()
        };
        assert_eq!(seen(&m).0.unwrap().range.unwrap().distance, seen_at);
    }
    // Without its far end, nothing within reach cannot be known.
    let endless = DISTANCE_SENSOR_DATA {
        min_distance: 0,
        max_distance: 0,
        ..range()
    };
    assert_eq!(seen(&endless), (None, [0, 1, 0, 0]));
}

#[test]
fn a_range_without_a_target_in_reach_has_no_distance() {
    let none = [
        DISTANCE_SENSOR_DATA {
            current_distance: 800,
            ..range()
        },
        DISTANCE_SENSOR_DATA {
            current_distance: 5,
            ..range()
        },
        DISTANCE_SENSOR_DATA {
            signal_quality: 1,
            ..range()
        },
    ];
    for m in none {
        assert_eq!(seen(&m).0.unwrap().range.unwrap().distance, None);
    }
    // A flow without a distance has none.
    let alone = OPTICAL_FLOW_RAD_DATA {
        distance: -1.0,
        ..flow()
    };
    let view = seen(&alone).0.unwrap();
    assert!(view.flow.is_some() && view.range.is_none());
}

/// A pipe that runs north-east, its crown 2 m north of the poses' origin and 1.5 m up.
fn pipe() -> LANDING_TARGET_DATA {
    let half = 0.125 * core::f32::consts::PI;
    LANDING_TARGET_DATA {
        time_usec: 4_990_000,
        frame: 1,
        x: 2.0,
        y: 0.0,
        z: -1.5,
        q: [half.cos(), 0.0, 0.0, half.sin()],
        position_valid: 1,
        ..LANDING_TARGET_DATA::DEFAULT
    }
}

/// The place of the pipe after `message`, and the counts of frame, value, late and taken.
fn placed(message: &LANDING_TARGET_DATA) -> (Option<PipeTarget>, [u32; 4]) {
    let mut station = Station::new();
    station.now = 5_000_000;
    station.say(&frame(message));
    let inputs = &mut station.inputs;
    let counts = inputs.counts();
    let target = inputs.take_target();
    assert!(inputs.take_target().is_none(), "taken once");
    (target, [counts.frame, counts.value, counts.late, counts.targets])
}

#[test]
fn the_place_of_the_pipe_is_taken_with_its_time_and_direction() {
    let (target, counts) = placed(&pipe());
    let target = target.unwrap();
    assert_eq!(
        (target.at_us, target.crown_position.to_array()),
        (4_990_000, [2.0, 0.0, -1.5])
    );
    assert!((target.heading.unwrap() - 0.25 * core::f32::consts::PI).abs() < 1e-3);
    assert_eq!(counts, [0, 0, 0, 1]);
    // Without a direction: zeros, or NaN.
    for q in [[0.0; 4], [f32::NAN, 0.0, 0.0, 0.0]] {
        let (target, _) = placed(&LANDING_TARGET_DATA { q, ..pipe() });
        assert_eq!(target.unwrap().heading, None);
    }
}

#[test]
fn a_place_of_the_pipe_that_cannot_be_is_refused_and_counted() {
    let body = LANDING_TARGET_DATA { frame: 12, ..pipe() };
    assert_eq!(placed(&body), (None, [1, 0, 0, 0]));
    let steep = [0.5_f32.cos(), 0.0, 0.5_f32.sin(), 0.0];
    let wrong = [
        LANDING_TARGET_DATA {
            position_valid: 0,
            ..pipe()
        },
        LANDING_TARGET_DATA {
            x: f32::NAN,
            ..pipe()
        },
        LANDING_TARGET_DATA {
            y: f32::INFINITY,
            ..pipe()
        },
        LANDING_TARGET_DATA {
            z: -20_000.0,
            ..pipe()
        },
        LANDING_TARGET_DATA {
            q: [2.0, 0.0, 0.0, 0.0],
            ..pipe()
        },
        LANDING_TARGET_DATA { q: steep, ..pipe() },
    ];
    for m in wrong {
        assert_eq!(placed(&m), (None, [0, 1, 0, 0]), "{m:?}");
    }
    // One that is said again, with the time that it had, is late.
    let mut station = Station::new();
    station.now = 5_000_000;
    station.say(&frame(&pipe()));
    station.say(&frame(&pipe()));
    let counts = station.inputs.counts();
    assert_eq!((counts.targets, counts.late), (1, 1));
}
