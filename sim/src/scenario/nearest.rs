//! The allowed keys nearest to a mistyped one.

/// Up to three of `candidates` nearest to `key` (both with their table, as in `vehicle.infill`), nearest first; at
/// least one if there are any.
pub(super) fn nearest<'a>(key: &str, candidates: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut ranked: Vec<(usize, &str)> = candidates.map(|c| (distance(key, c), c)).collect();
    ranked.sort();
    let Some(&(best, _)) = ranked.first() else {
        return Vec::new();
    };
    // Two errors more than the best are unlikely.
    ranked
        .iter()
        .filter(|(d, _)| *d <= best + 2)
        .take(3)
        .map(|(_, c)| (*c).to_owned())
        .collect()
}

fn distance(a: &str, b: &str) -> usize {
    let split = |key| <str>::rsplit_once(key, '.').unwrap_or(("", key));
    let ((table_a, name_a), (table_b, name_b)) = (split(a), split(b));
    edits(name_a, name_b) + usize::from(table_a != table_b)
}

/// Edits (insert, delete, replace) from `a` to `b`; an added unit counts one, a name too long for a typing error its
/// letters.
fn edits(a: &str, b: &str) -> usize {
    if b.strip_prefix(a).is_some_and(|rest| rest.starts_with('_')) {
        return 1;
    }
    sophie_tasks::console::edits(a.as_bytes(), b.as_bytes()).unwrap_or(a.len().max(b.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_counted() {
        assert_eq!(edits("infill", "infill"), 0);
        assert_eq!(edits("infil", "infill"), 1);
        assert_eq!(edits("kitten", "sitting"), 3);
        assert_eq!(edits("", "abc"), 3);
        assert_eq!(edits("pipe_top", "pipe_top_m"), 1);
    }

    #[test]
    fn the_likely_meaning_comes_first() {
        let keys = [
            "vehicle.infill",
            "vehicle.gain_k",
            "world.pipe_top_m",
            "params.infill",
        ];
        assert_eq!(
            nearest("vehicle.infil", keys.into_iter()).first().unwrap(),
            "vehicle.infill"
        );
        assert_eq!(nearest("world.pipe_top", keys.into_iter()), ["world.pipe_top_m"]);
        assert!(!nearest("qqqqqqqqqqqqqqq", keys.into_iter()).is_empty());
        assert!(nearest("x", [].into_iter()).is_empty());
    }
}
