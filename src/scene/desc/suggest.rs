//! "Did you mean": the known name nearest to a mistyped one.

/// Names listed in full before a message only counts the rest.
const LISTED: usize = 8;
/// Longer names are not compared: the comparison is quadratic in the length.
const COMPARED_LENGTH: usize = 64;

/// The end of a message about an unknown name: the nearest known one, else all of them, else why there is none.
pub fn hint<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    if let Some(nearest) = nearest(name, &known) {
        return format!("did you mean \"{nearest}\"?");
    }
    match known.len() {
        0 => "none is known here".to_owned(),
        n if n <= LISTED => format!("known: {}", known.join(", ")),
        n => format!("known: {} and {} more", known[..LISTED].join(", "), n - LISTED),
    }
}

/// The known name within a third of the name's length in edits, if any.
pub fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let allowed = (name.chars().count() / 3).max(1);
    known
        .iter()
        .filter(|k| k.len() <= COMPARED_LENGTH && name.len() <= COMPARED_LENGTH)
        .map(|k| (distance(name, k), *k))
        .filter(|(edits, _)| *edits <= allowed)
        .min_by_key(|(edits, _)| *edits)
        .map(|(_, k)| k)
}

/// Characters inserted, removed, replaced or swapped with their neighbour, without regard to case
/// (optimal string alignment).
fn distance(a: &str, b: &str) -> usize {
    let [a, b] = [a, b].map(|s| s.to_lowercase().chars().collect::<Vec<char>>());
    let mut two_back: Vec<usize> = Vec::new();
    let mut back: Vec<usize> = (0..=b.len()).collect();
    for i in 0..a.len() {
        let mut row = vec![i + 1];
        for j in 0..b.len() {
            let replaced = back[j] + usize::from(a[i] != b[j]);
            let mut edits = replaced.min(back[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] {
                edits = edits.min(two_back[j - 1] + 1);
            }
            row.push(edits);
        }
        two_back = std::mem::replace(&mut back, row);
    }
    back[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_edits() {
        assert_eq!(distance("radius", "radius"), 0);
        assert_eq!(distance("raduis", "radius"), 1);
        assert_eq!(distance("", "abc"), 3);
    }

    #[test]
    fn suggests_what_is_near_and_lists_what_is_not() {
        assert_eq!(hint("raduis", ["center", "radius"]), "did you mean \"radius\"?");
        assert_eq!(hint("Colour", ["color", "ior"]), "did you mean \"color\"?");
        assert_eq!(hint("zzz", ["center", "radius"]), "known: center, radius");
        assert_eq!(hint("zzz", []), "none is known here");
    }
}
