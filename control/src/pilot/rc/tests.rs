//! Decoding frames, and agreement with their encoding.

use proptest::prelude::*;

use super::*;

fn frame(edit: impl Fn(&mut [u16; CHANNELS])) -> Result<Sticks, ChannelError> {
    let mut channels = Sticks::default().to_channels();
    edit(&mut channels);
    Sticks::from_channels(&channels)
}

#[test]
fn centred_sticks_and_switches_off_are_the_default() {
    assert_eq!(frame(|_| ()), Ok(Sticks::default()));
}

#[test]
fn a_stick_to_the_right_or_pulled_is_positive() {
    let s = frame(|c| (c[0], c[1], c[2], c[3]) = (1811, 172, 1811, 1811)).unwrap();
    assert!(
        s.roll > 0.999 && s.pitch > 0.999 && s.throttle > 0.999 && s.yaw > 0.999,
        "{s:?}"
    );
    let s = frame(|c| (c[0], c[1], c[2], c[3]) = (172, 1811, 172, 172)).unwrap();
    assert!(
        s.roll < -0.999 && s.pitch < -0.999 && s.throttle == 0.0 && s.yaw < -0.999,
        "{s:?}"
    );
}

#[test]
fn the_deadband_swallows_a_gimbals_slack_and_nothing_more() {
    for slack in [985, 992, 999] {
        assert!(frame(|c| c[0] = slack).unwrap().roll == 0.0, "{slack}");
    }
    let edge = frame(|c| c[0] = 1002).unwrap().roll;
    assert!(edge > 0.0 && edge < 0.005, "no step at the edge: {edge}");
    assert!(frame(|c| c[2] = 185).unwrap().throttle == 0.0);
}

#[test]
fn switches_have_two_or_three_positions() {
    let s = frame(|c| (c[4], c[5], c[6], c[7]) = (1811, 992, 1811, 992)).unwrap();
    assert!(s.arm_switch && s.perch_switch);
    assert_eq!((s.stick_mode, s.arms), (StickMode::Rate, ArmChoice::Front));
    let s = frame(|c| (c[4], c[5], c[6], c[7]) = (992, 1811, 992, 1811)).unwrap();
    assert!(!s.arm_switch && !s.perch_switch, "a switch in between is off");
    assert_eq!((s.stick_mode, s.arms), (StickMode::Direct, ArmChoice::Rear));
}

#[test]
fn a_dead_receivers_counts_are_refused_and_named() {
    for (channel, at) in (1..).zip(0..5) {
        for raw in [0, 7] {
            assert_eq!(frame(|c| c[at] = raw), Err(ChannelError { channel, raw }));
        }
        assert!(frame(|c| c[at] = 8).is_ok());
    }
    // The perch switch, which lets go.
    assert_eq!(frame(|c| c[6] = 0), Err(ChannelError { channel: 7, raw: 0 }));
    assert_eq!(
        frame(|c| *c = [0; CHANNELS]),
        Err(ChannelError { channel: 1, raw: 0 })
    );
}

#[test]
fn a_stick_beyond_its_end_is_at_its_end_and_a_switch_too() {
    for raw in [1812, 1976, 1977, 1984, 2047] {
        let s = frame(|c| (c[0], c[1], c[2], c[3]) = (raw, raw, raw, raw)).unwrap();
        assert_eq!(
            (s.roll, s.pitch, s.throttle, s.yaw),
            (1.0, -1.0, 1.0, 1.0),
            "{raw}"
        );
        let s = frame(|c| (c[4], c[5], c[6], c[7], c[8]) = (raw, raw, raw, raw, raw)).unwrap();
        assert!(s.arm_switch && s.perch_switch && s.hold_switch, "{raw}");
        assert_eq!((s.stick_mode, s.arms), (StickMode::Direct, ArmChoice::Rear));
    }
}

#[test]
fn a_channel_that_nothing_hangs_on_costs_itself_alone() {
    let sticks = frame(|c| (c[0], c[8]) = (1500, 1811)).unwrap();
    assert!(sticks.hold_switch);
    for raw in [0, 7] {
        // Without a pulse the stick mode is angle, and all arms close.
        let s = frame(|c| (c[0], c[5], c[7], c[8]) = (1500, raw, raw, 1811)).unwrap();
        assert_eq!(s, sticks);
        let s = frame(|c| (c[0], c[8], c[9], c[15]) = (1500, raw, raw, raw)).unwrap();
        assert_eq!(
            s,
            Sticks {
                hold_switch: false,
                ..sticks
            }
        );
    }
}

proptest! {
    #[test]
    fn any_frame_gives_values_in_range(raw in prop::array::uniform16(0u16..2048)) {
        if let Ok(s) = Sticks::from_channels(&raw) {
            for x in [s.roll, s.pitch, s.yaw] {
                prop_assert!((-1.0..=1.0).contains(&x));
            }
            prop_assert!((0.0..=1.0).contains(&s.throttle));
        }
    }

    #[test]
    fn what_is_sent_is_understood(
        roll in -1.0f32..1.0, pitch in -1.0f32..1.0, yaw in -1.0f32..1.0, throttle in 0.0f32..1.0,
        arm_switch: bool, perch_switch: bool,
    ) {
        let sent = Sticks { roll, pitch, yaw, throttle, arm_switch, perch_switch, ..Default::default() };
        let got = Sticks::from_channels(&sent.to_channels()).unwrap();
        // One count of a half travel, plus rounding.
        for (a, b) in [(roll, got.roll), (pitch, got.pitch), (yaw, got.yaw), (throttle, got.throttle)] {
            prop_assert!((a - b).abs() < 1.6e-3, "{a} {b}");
        }
        prop_assert!(got.arm_switch == arm_switch && got.perch_switch == perch_switch);
    }
}
