//! Permitted gaps of the emulator: those in `allowed_gaps.toml`, with reasons.

use serde::Deserialize;

use crate::wires::Gap;

const ALLOWED: &str = include_str!("../allowed_gaps.toml");

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    gap: Vec<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    kind: String,
    at: String,
    reason: String,
}

/// The gaps of `found` that no entry allows.
///
/// # Errors
/// One line: the list cannot be read, or an entry has no reason.
pub fn not_allowed(found: &[Gap]) -> Result<Vec<&Gap>, String> {
    judged(ALLOWED, found)
}

fn judged<'a>(list: &str, found: &'a [Gap]) -> Result<Vec<&'a Gap>, String> {
    let list: List = toml::from_str(list).map_err(|e| format!("allowed_gaps.toml: {}", e.message()))?;
    if let Some(entry) = list.gap.iter().find(|e| e.reason.trim().is_empty()) {
        return Err(format!(
            "allowed_gaps.toml: {} {}: reason is empty: allowed is a sentence",
            entry.kind, entry.at
        ));
    }
    let allowed = |gap: &&Gap| list.gap.iter().any(|e| e.kind == gap.kind && e.at == gap.at);
    Ok(found.iter().filter(|gap| !allowed(gap)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gap(at: &str) -> Gap {
        Gap {
            kind: "unimplemented",
            at: at.to_owned(),
            what: "1 writes".to_owned(),
        }
    }

    #[test]
    fn only_a_gap_listed_with_a_reason_is_allowed() {
        let found = [gap("TIM1.CR1"), gap("TIM8.CR1")];
        let list = "[[gap]]\nkind = 'unimplemented'\nat = 'TIM1.CR1'\nreason = 'unused'";
        assert_eq!(judged(list, &found).unwrap(), [&found[1]]);
        assert_eq!(judged("gap = []", &found).unwrap().len(), 2);
        let complaint = judged(&list.replace("unused", " "), &found).unwrap_err();
        assert!(complaint.contains("TIM1.CR1: reason is empty"), "{complaint}");
        assert!(judged("gap = 1", &found).is_err());
    }

    #[test]
    fn the_list_that_is_built_in_can_be_read() {
        assert!(not_allowed(&[]).unwrap().is_empty());
    }
}
