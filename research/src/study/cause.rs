//! What ended flights, in words that are equal for equal ends.

/// The first clause of a reason without its numbers, so that equal failures have equal words.
#[must_use]
pub fn cause(reason: &str) -> String {
    let clause = reason.split([';', ',']).next().unwrap_or(reason);
    let clause = clause.split(" (at ").next().unwrap_or(clause);
    let parts: Vec<&str> = clause.splitn(3, ": ").take(2).collect();
    let clause = parts.join(": ");
    let mut words = Vec::new();
    for word in clause.split_whitespace() {
        let number = word.starts_with(|c: char| c.is_ascii_digit() || c == '+' || c == '-');
        words.push(if number { "…" } else { word });
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::cause;

    #[test]
    fn equal_failures_have_equal_causes() {
        for (reason, wanted) in [
            (
                "pressure on arm 2 reached 1507 N/m2, allowed 1500 (at 71.2 s)",
                "pressure on arm … reached … N/m2",
            ),
            (
                "fly-to-pipe: not done after 60 s: 0.21 m off; check: grip",
                "fly-to-pipe: not done after … s",
            ),
            ("perch: no proven grip", "perch: no proven grip"),
            (
                "rolled to +17.1 and -20.0 deg, wanted 25",
                "rolled to … and … deg",
            ),
        ] {
            assert_eq!(cause(reason), wanted);
        }
    }
}
