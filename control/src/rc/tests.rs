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
    assert_eq!(frame(|c| c[2] = 0), Err(ChannelError { channel: 3, raw: 0 }));
    assert_eq!(
        frame(|c| c[7] = 2047),
        Err(ChannelError {
            channel: 8,
            raw: 2047
        })
    );
    assert!(frame(|c| c[8] = 2047).is_ok(), "channel 9 means nothing");
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
