//! The firmware's start-up checks of the chip, as logged.

use serde::Serialize;
use sophie_ports::stack_use::{AT_START, SINCE, StackUse};

use crate::log::Line;

/// A check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Look {
    /// Name.
    pub name: String,
    /// Value read.
    pub read: String,
    /// Value expected.
    pub expected: String,
    /// Passed.
    pub ok: bool,
}

/// Parses `silicon: NAME: READ, expected EXPECTED: ok`, or `: not ok`.
#[must_use]
pub fn parse(text: &str) -> Option<Look> {
    let (name, rest) = text.strip_prefix("silicon: ")?.split_once(": ")?;
    let (read, rest) = rest.split_once(", expected ")?;
    let (expected, verdict) = rest.rsplit_once(": ")?;
    Some(Look {
        name: name.to_owned(),
        read: read.to_owned(),
        expected: expected.to_owned(),
        ok: verdict == "ok",
    })
}

/// The last row of each name in `lines`, in the order in which they came first: those of the stack come again as it grows.
#[must_use]
pub fn rows(lines: &[Line]) -> Vec<Look> {
    let mut rows = Vec::<Look>::new();
    for look in lines.iter().filter_map(|line| parse(&line.text)) {
        match rows.iter_mut().find(|row| row.name == look.name) {
            Some(row) => *row = look,
            None => rows.push(look),
        }
    }
    rows
}

/// The greatest depths of the stack in `lines`, over every start; `None` before both are logged.
#[must_use]
pub fn stack_use(lines: &[Line]) -> Option<StackUse> {
    let looks = || lines.iter().filter_map(|line| parse(&line.text));
    let deepest = |name| {
        let used = looks()
            .filter(|look| look.name == name)
            .filter_map(|look| of(&look.read));
        used.max()
    };
    let ((start, bytes), (flight, _)) = deepest(AT_START).zip(deepest(SINCE))?;
    Some(StackUse { bytes, start, flight })
}

/// Parses `USED of SIZE bytes`.
fn of(read: &str) -> Option<(u32, u32)> {
    let (used, size) = read.strip_suffix(" bytes")?.split_once(" of ")?;
    Some((used.parse().ok()?, size.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_the_stacks_rows_the_deepest_of_every_start_counts() {
        let line = |text: &str| Line {
            ms: 0,
            stamp: String::new(),
            level: "",
            text: text.to_owned(),
        };
        let lines = [
            "silicon: bus clock: 168 MHz, PLL on crystal, expected PLL on crystal: ok",
            "silicon: stack at start-up: 22668 of 65536 bytes, expected a quarter left: ok",
            "silicon: stack since: 8736 of 65536 bytes, expected a quarter left: ok",
            "silicon: stack since: 9736 of 65536 bytes, expected a quarter left: ok",
            "silicon: stack at start-up: 21000 of 65536 bytes, expected a quarter left: ok",
            "silicon: stack since: 1588 of 65536 bytes, expected a quarter left: ok",
        ]
        .map(line);
        let expected = StackUse {
            bytes: 65_536,
            start: 22_668,
            flight: 9736,
        };
        assert_eq!(stack_use(&lines), Some(expected));
        assert_eq!(stack_use(&lines[..2]), None);
        let rows = rows(&lines);
        assert_eq!(rows.len(), 3);
        assert_eq!(rows[2].read, "1588 of 65536 bytes");
    }

    #[test]
    fn a_line_of_the_log_is_understood() {
        let look = parse("silicon: bus clock: 168 MHz, PLL on crystal, expected PLL on crystal: ok").unwrap();
        assert_eq!(
            (look.name.as_str(), look.read.as_str()),
            ("bus clock", "168 MHz, PLL on crystal")
        );
        assert!(look.ok);
        let look = parse("silicon: read-out protection: level 1, expected level 0: a probe can read: not ok")
            .unwrap();
        assert_eq!(
            (look.expected.as_str(), look.ok),
            ("level 0: a probe can read", false)
        );
        assert_eq!(parse("started in 72 ms"), None);
    }
}
