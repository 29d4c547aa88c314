//! The firmware's start-up checks of the chip, as logged.

use serde::Serialize;

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

#[cfg(test)]
mod tests {
    use super::*;

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
