//! Positions of sticks and switches: centred, asking for a held position, taking over.

use super::rc::{StickMode, Sticks};

/// Throttle of a centred stick, 0..1.
pub const THROTTLE_CENTRE: f32 = 0.5;
/// Half width of the zone about the centre that commands no climb, share of the travel.
pub const THROTTLE_ZONE: f32 = 0.1;
/// Deflection by which a stick takes over, share of its travel.
const STICK: f32 = 0.12;
/// The same for the throttle, from its centre.
const THROTTLE: f32 = THROTTLE_ZONE + 0.05;

/// The pilot asks for position hold. With the perch switch on he lands on the pipe by hand.
pub fn asks_hold(s: &Sticks) -> bool {
    keeps_hold(s) && !s.perch_switch
}

/// The pilot still asks for position hold. The perch switch then means autonomous perching.
pub fn keeps_hold(s: &Sticks) -> bool {
    s.hold_switch && s.stick_mode == StickMode::Angle
}

/// Every stick is at its centre.
pub fn centred(s: &Sticks) -> bool {
    let most = s.roll.abs().max(s.pitch.abs()).max(s.yaw.abs());
    most <= STICK && (s.throttle - THROTTLE_CENTRE).abs() <= THROTTLE
}
