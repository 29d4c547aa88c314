//! The drawn moments of a flight.

use sophie_sim::record::{FlightRecord, Phase, Sample};
use sophie_sim::scenario::Step;

/// One moment.
#[derive(Clone, Debug)]
pub struct KeyMoment<'a> {
    /// Its title.
    pub title: String,
    /// The vehicle then.
    pub sample: &'a Sample,
    /// Sideways push then, N.
    pub push: f64,
    /// View centred on the pipe instead of the vehicle.
    pub at_pipe: bool,
}

/// Hover, roll, touch, clamped, hold and released, as far as flown; the end of a failed flight.
pub fn key_moments(record: &FlightRecord) -> Vec<KeyMoment<'_>> {
    type Pick = fn(&FlightRecord, &Phase) -> Option<usize>;
    let wanted: [(&str, &str, bool, Pick); 6] = [
        ("hover", "Hover", false, middle),
        ("roll", "Roll manoeuvre", false, steepest),
        ("touch", "Touch", true, end),
        ("perch", "Clamped", true, end),
        ("hold", "Hold", true, middle),
        ("release", "Released", true, lifted_off),
    ];
    let mut moments = vec![];
    for (step, title, at_pipe, pick) in wanted {
        let phase = record.phases.iter().find(|p| p.name == step && p.done);
        let index = phase.and_then(|p| pick(record, p));
        if let Some(sample) = index.and_then(|i| record.samples.get(i)) {
            moments.push(KeyMoment {
                title: title.to_owned(),
                sample,
                push: 0.0,
                at_pipe,
            });
        }
    }
    let push = record.scenario.steps.iter().find_map(|s| match s {
        Step::Hold { push, .. } => Some(*push),
        _ => None,
    });
    if let (Some(hold), Some(push)) = (moments.iter_mut().find(|m| m.title == "Hold"), push) {
        hold.push = push;
        if push > 0.0 {
            hold.title = format!("Hold, pushed with {push} N");
        }
    }
    if !record.outcome.accomplished
        && let Some(sample) = record.samples.last()
    {
        moments.push(KeyMoment {
            title: "End of the flight".to_owned(),
            sample,
            push: 0.0,
            at_pipe: false,
        });
    }
    moments
}

fn at(record: &FlightRecord, t: f64) -> Option<usize> {
    let last = record.samples.len().checked_sub(1)?;
    Some(record.samples.partition_point(|s| s.t < t).min(last))
}

fn middle(record: &FlightRecord, phase: &Phase) -> Option<usize> {
    at(record, 0.5 * (phase.start + phase.end))
}

fn end(record: &FlightRecord, phase: &Phase) -> Option<usize> {
    at(record, phase.end)
}

fn during<'a>(record: &'a FlightRecord, phase: &Phase) -> impl Iterator<Item = (usize, &'a Sample)> {
    let (start, end) = (phase.start, phase.end);
    record
        .samples
        .iter()
        .enumerate()
        .filter(move |(_, s)| (start..=end).contains(&s.t))
}

fn steepest(record: &FlightRecord, phase: &Phase) -> Option<usize> {
    let roll = |s: &Sample| s.attitude[0].abs();
    during(record, phase)
        .max_by(|(_, a), (_, b)| roll(a).total_cmp(&roll(b)))
        .map(|(i, _)| i)
}

fn lifted_off(record: &FlightRecord, phase: &Phase) -> Option<usize> {
    let close = record.scenario.world.pipe_top + 0.16;
    let near = during(record, phase)
        .take_while(|(_, s)| -s.position[2] < close)
        .last();
    near.map(|(i, _)| i).or_else(|| end(record, phase))
}

#[cfg(test)]
mod tests {
    use super::super::synthetic;
    use super::*;

    #[test]
    fn a_whole_mission_has_six_moments() {
        let record = synthetic::record();
        let moments = key_moments(&record);
        let titles: Vec<&str> = moments.iter().map(|m| m.title.as_str()).collect();
        assert_eq!(
            titles,
            [
                "Hover",
                "Roll manoeuvre",
                "Touch",
                "Clamped",
                "Hold, pushed with 1.5 N",
                "Released"
            ]
        );
        assert!(moments[1].sample.attitude[0].abs() > 0.4);
        assert!(moments[5].sample.position[2] > -1.7);
    }

    #[test]
    fn a_failed_flight_shows_how_far_it_came() {
        let mut record = synthetic::record();
        record.outcome.accomplished = false;
        record.phases.truncate(4);
        record.phases[3].done = false;
        let titles: Vec<String> = key_moments(&record).into_iter().map(|m| m.title).collect();
        assert_eq!(titles, ["Hover", "End of the flight"]);
    }
}
