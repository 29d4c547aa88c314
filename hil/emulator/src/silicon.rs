//! The firmware's start-up checks of the chip, as logged.

use serde::Serialize;
use sophie_ports::stack_use::{AT_START, SINCE, StackUse};

use crate::log::Line;

/// A start-up check of the chip.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SiliconCheck {
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
pub fn parse(text: &str) -> Option<SiliconCheck> {
    let (name, rest) = text.strip_prefix("silicon: ")?.split_once(": ")?;
    let (read, rest) = rest.split_once(", expected ")?;
    let (expected, verdict) = rest.rsplit_once(": ")?;
    Some(SiliconCheck {
        name: name.to_owned(),
        read: read.to_owned(),
        expected: expected.to_owned(),
        ok: verdict == "ok",
    })
}

/// The last row of each name in `lines`, ordered by first appearance. The stack's rows repeat as its depth grows.
#[must_use]
pub fn rows(lines: &[Line]) -> Vec<SiliconCheck> {
    let mut rows = Vec::<SiliconCheck>::new();
    for check in lines.iter().filter_map(|line| parse(&line.text)) {
        match rows.iter_mut().find(|row| row.name == check.name) {
            Some(row) => *row = check,
            None => rows.push(check),
        }
    }
    rows
}

/// The greatest depths of the stack in `lines`, over every start; `None` before both are logged.
#[must_use]
pub fn stack_use(lines: &[Line]) -> Option<StackUse> {
    let checks = || lines.iter().filter_map(|line| parse(&line.text));
    let deepest = |name| {
        let used = checks()
            .filter(|check| check.name == name)
            .filter_map(|check| of(&check.read));
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
    fn the_deepest_stack_use_over_all_starts_counts() {
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
        let check =
            parse("silicon: bus clock: 168 MHz, PLL on crystal, expected PLL on crystal: ok").unwrap();
        assert_eq!(
            (check.name.as_str(), check.read.as_str()),
            ("bus clock", "168 MHz, PLL on crystal")
        );
        assert!(check.ok);
        let check =
            parse("silicon: read-out protection: level 1, expected level 0: a probe can read: not ok")
                .unwrap();
        assert_eq!(
            (check.expected.as_str(), check.ok),
            ("level 0: a probe can read", false)
        );
        assert_eq!(parse("started in 72 ms"), None);
    }
}
