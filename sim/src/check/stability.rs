//! Check rows of the control loops: their margins, and the arms' bending mode.

use super::hover::Built;
use super::loops::{AXES, Margins};
use super::row::{Limit, Row};

/// Inertias are known to 30 %, and 0.7 of one is 1.43 of the gain.
const GAIN_MARGIN: f64 = 1.0 / 0.7;
/// Degrees: an ESC frame, bus and frame interval of 4 ms outside the model take 9 at a crossover of 40 rad/s, a motor
/// 30 % slower than stated as much again.
const PHASE_MARGIN: f64 = 18.0;
const GAINS: [&str; 3] = ["rate_roll_p", "rate_pitch_p", "rate_yaw_p"];
/// Parameters that set the attitude's share in the gain.
const ATTITUDE_GAINS: [&str; 3] = ["attitude_p", "attitude_p", "attitude_yaw_p"];

/// All rows of the loops with `margins` about roll, pitch and yaw.
pub fn rows(margins: &[Margins; 3], built: &Built) -> Vec<Row> {
    let mut rows = Vec::new();
    for (axis, margin) in margins.iter().enumerate() {
        let name = AXES[axis];
        rows.push(
            Row::new(
                format!("{name} gain margin"),
                margin.gain.min(100.0),
                "",
                Limit::AtLeast(GAIN_MARGIN),
            )
            .advise(format!(
                "lower {}, make motors or arms faster, or state the inertia as it is",
                GAINS[axis]
            )),
        );
        // A loop whose gain never reaches 1 controls nothing.
        let phase = if margin.crossover > 0.0 {
            margin.phase.to_degrees()
        } else {
            f64::NAN
        };
        rows.push(
            Row::new(
                format!("{name} phase margin"),
                phase,
                "deg",
                Limit::AtLeast(PHASE_MARGIN),
            )
            .advise(format!(
                "lower {} against {}, raise gyro_cutoff, or fit faster motors",
                ATTITUDE_GAINS[axis], GAINS[axis]
            )),
        );
    }
    rows.push(arm_mode(margins, built));
    rows
}

/// The lesser margin of the hold, forward and to the right: the factor by which a tilt may accelerate the vehicle more or less. What
/// calibrations leave, 30 % of the inertias, 13 % of the motors' lag, 4 % of the torsion, takes 14 % of it.
pub fn hold([forward, right]: &[Margins; 2]) -> Row {
    Row::new(
        "hold gain margin".to_owned(),
        forward.gain.min(right.gain).min(100.0),
        "",
        Limit::AtLeast(1.0),
    )
    .advise("fit arms that twist less, measure motor_tau, or fly without hold")
}

/// √(k/m)/2π of the softest arm, body held, Hz, against the bandwidth of roll and pitch: beyond the mode the
/// tips lag by half a turn, and a loop of more bandwidth shakes the body between them.
fn arm_mode(margins: &[Margins; 3], built: &Built) -> Row {
    let [roll, pitch, _] = margins;
    let bandwidth = roll.crossover.max(pitch.crossover) / std::f64::consts::TAU;
    Row::new("arm mode", built.arm_mode(), "Hz", Limit::AtLeast(bandwidth))
        .advise("fit stiffer arms, or lower rate_roll_p and rate_pitch_p")
}

#[cfg(test)]
mod tests {
    use super::super::loops::margins;
    use super::*;
    use crate::scenario::Scenario;

    fn failing(change: impl Fn(&mut Scenario)) -> Vec<String> {
        let mut s = Scenario::default_mission();
        change(&mut s);
        let rows = rows(&margins(&s), &Built::of(&s));
        let failed = rows.into_iter().filter(|row| !row.pass);
        failed.map(|row| row.name).collect()
    }

    #[test]
    fn the_default_gains_pass_and_one_that_oscillates_fails() {
        assert_eq!(failing(|_| ()), Vec::<String>::new());
        let failed = failing(|s| s.params.rate_pitch_p = 30.0);
        assert!(
            failed.iter().any(|name| name == "pitch gain margin"),
            "{failed:?}"
        );
    }

    #[test]
    fn a_loop_without_gain_and_one_that_only_turns_back_fail() {
        let failed = failing(|s| (s.params.rate_roll_p, s.params.rate_roll_i) = (0.0, 0.0));
        assert!(
            failed.iter().any(|name| name == "roll phase margin"),
            "{failed:?}"
        );
        let failed = failing(|s| (s.params.rate_roll_p, s.params.attitude_p) = (4.0, 12.0));
        assert!(
            failed.iter().any(|name| name == "roll phase margin"),
            "{failed:?}"
        );
    }
}
