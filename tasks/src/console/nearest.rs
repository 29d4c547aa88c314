//! Suggests a name for a misspelt one.

/// Longest name compared, bytes.
const LENGTH: usize = 32;

/// First of the `names` nearest to `word`, at most two typing errors and less than half of the word away.
pub(super) fn nearest(word: &str, names: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    names
        .filter_map(|name| Some((edits(word.as_bytes(), name.as_bytes())?, name)))
        .filter(|(edits, _)| *edits <= 2 && 2 * edits < word.len())
        .min_by_key(|(edits, _)| *edits)
        .map(|(_, name)| name)
}

/// Bytes to insert, delete or replace to turn `a` into `b`; `None` if one exceeds 32 bytes, as no name does.
pub fn edits(a: &[u8], b: &[u8]) -> Option<usize> {
    let mut row = [0; LENGTH + 1];
    let row = row.get_mut(..=b.len())?;
    if a.len() > LENGTH {
        return None;
    }
    for (count, slot) in row.iter_mut().enumerate() {
        *slot = count;
    }
    for (i, from) in a.iter().enumerate() {
        // `diagonal` is the slot above and to the left, `left` the one to the left.
        let (mut diagonal, mut left) = (i, i + 1);
        let (first, rest) = row.split_first_mut()?;
        *first = left;
        for (slot, to) in rest.iter_mut().zip(b) {
            let replaced = diagonal + usize::from(from != to);
            diagonal = *slot;
            left = replaced.min(diagonal + 1).min(left + 1);
            *slot = left;
        }
    }
    row.last().copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_counted() {
        let count = |a: &str, b: &str| edits(a.as_bytes(), b.as_bytes());
        assert_eq!(count("infill", "infill"), Some(0));
        assert_eq!(count("infil", "infill"), Some(1));
        assert_eq!(count("kitten", "sitting"), Some(3));
        assert_eq!(count("", "abc"), Some(3));
        assert_eq!(count("abc", ""), Some(3));
        assert_eq!(count(&"x".repeat(33), "abc"), None);
        assert_eq!(count("abc", &"x".repeat(33)), None);
    }

    #[test]
    fn only_a_likely_meaning_is_offered() {
        let names = || ["infill", "rate_pitch_p", "rate_pitch_i", "save", "set"].into_iter();
        assert_eq!(nearest("infil", names()), Some("infill"));
        assert_eq!(nearest("rate_pitch_q", names()), Some("rate_pitch_p"));
        assert_eq!(nearest("svae", names()), None, "half of it is wrong");
        assert_eq!(nearest("saves", names()), Some("save"));
        assert_eq!(nearest("elephant", names()), None);
    }
}
