//! Largest attitude errors: with the setpoint at rest (control error) and moving (lag).

use sophie_sim::record::{FlightRecord, SAMPLE_HZ, Sample};

/// s: twice that of a roll of 25°.
const SETTLE: f64 = 1.0;
/// Largest change of a resting setpoint meanwhile, rad: 2°, more than stick noise.
const REST: f64 = 0.035;
/// Thrust asked of a rotor in flight, N, as in the steps' table.
const FLOWN: f64 = 1.0;

const AXES: [&str; 2] = ["roll", "pitch"];

/// A largest error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst<'a> {
    /// Angle between true and wanted attitude, rad.
    pub angle: f64,
    /// `roll` or `pitch`.
    pub axis: &'static str,
    /// When, s.
    pub t: f64,
    /// Number from 1, and name; none between steps.
    pub step: Option<(usize, &'a str)>,
}

/// Both kinds, if they occurred.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttitudeErrors<'a> {
    /// Setpoint at rest.
    pub held: Option<Worst<'a>>,
    /// Setpoint moving or just at rest.
    pub following: Option<Worst<'a>>,
}

/// Largest errors of a flight.
pub fn attitude_errors(record: &FlightRecord) -> AttitudeErrors<'_> {
    let mut errors = AttitudeErrors::default();
    for (axis, name) in AXES.into_iter().enumerate() {
        let of = |s: &Sample| s.attitude_setpoint.get(axis).copied().unwrap_or(f64::NAN);
        // Start of rest, and the setpoint then.
        let mut rested: Option<(f64, f64)> = None;
        for s in &record.samples {
            let setpoint = of(s);
            rested = rested
                .filter(|(level, _)| (setpoint - level).abs() < REST)
                .or(Some((setpoint, s.t)));
            if !s.thrust_asked.iter().any(|t| *t > FLOWN) {
                continue;
            }
            let angle = (s.attitude.get(axis).copied().unwrap_or(f64::NAN) - setpoint).abs();
            let resting = rested.is_some_and(|(_, since)| s.t - since > SETTLE - 0.5 / SAMPLE_HZ);
            let kind = if resting {
                &mut errors.held
            } else {
                &mut errors.following
            };
            if angle > kind.map_or(0.0, |worst| worst.angle) {
                let at = record
                    .phases
                    .iter()
                    .position(|p| (p.start..=p.end).contains(&s.t));
                let step = at.and_then(|i| Some((i + 1, record.phases.get(i)?.name.as_str())));
                *kind = Some(Worst {
                    angle,
                    axis: name,
                    t: s.t,
                    step,
                });
            }
        }
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::super::synthetic;
    use super::*;

    /// Roll setpoint steps by 0.8 rad at 20 s, followed with 0.1 s lag and 0.05 rad error; gust of 0.2 rad at 30 s.
    fn stepped() -> FlightRecord {
        let mut record = synthetic::record();
        for s in &mut record.samples {
            let target = |t: f64| 0.8 * f64::from(u8::from(t > 20.0));
            let since = (s.t - 20.0).max(0.0);
            let gust = if (30.0..30.2).contains(&s.t) { 0.2 } else { 0.0 };
            s.attitude_setpoint = [target(s.t), 0.0, 0.0];
            s.attitude = [
                0.75 * f64::from(u8::from(since > 0.0)) * (1.0 - (-since / 0.1).exp()) + gust,
                0.0,
                0.0,
            ];
            s.thrust_asked = [4.0; 4];
        }
        record
    }

    #[test]
    fn lag_behind_a_command_is_told_from_an_error_at_rest() {
        let record = stepped();
        let errors = attitude_errors(&record);
        let (held, following) = (errors.held.unwrap(), errors.following.unwrap());
        assert!(
            (following.angle - 0.8).abs() < 0.08 && (following.t - 20.0).abs() < 0.05,
            "{following:?}"
        );
        assert!(
            (held.angle - 0.15).abs() < 0.01 && (30.0..30.3).contains(&held.t),
            "{held:?}"
        );
        assert_eq!((held.axis, following.axis), ("roll", "roll"));
        let name = |w: Worst<'_>| w.step.map(|(n, name)| (n, name.to_owned()));
        let expected = |t: f64| {
            let at = record
                .phases
                .iter()
                .position(|p| (p.start..=p.end).contains(&t))
                .unwrap();
            Some((at + 1, record.phases[at].name.clone()))
        };
        assert_eq!(
            (name(held), name(following)),
            (expected(held.t), expected(following.t))
        );
    }

    #[test]
    fn what_is_not_flown_has_no_error() {
        let mut record = stepped();
        record.samples.iter_mut().for_each(|s| s.thrust_asked = [0.0; 4]);
        assert_eq!(attitude_errors(&record), AttitudeErrors::default());
    }
}
