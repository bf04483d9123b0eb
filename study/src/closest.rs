//! "Did you mean …": the nearest of a few known words.

/// The known word nearest to `word`, if it is near enough to be a slip of the finger.
pub(crate) fn closest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = word.chars().count();
    if !(2..=64).contains(&length) {
        return None;
    }
    let limit = (length / 3).clamp(1, 3);
    known
        .into_iter()
        .map(|candidate| (distance(&word.to_lowercase(), &candidate.to_lowercase()), candidate))
        .filter(|(d, _)| *d <= limit)
        .min_by_key(|(d, _)| *d)
        .map(|(_, candidate)| candidate)
}

/// Edit distance: insertions, deletions, substitutions and swaps of neighbours.
fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    let width = b.len() + 1;
    let mut table = vec![0; (a.len() + 1) * width];
    for j in 0..width {
        table[j] = j;
    }
    for i in 1..=a.len() {
        table[i * width] = i;
        for j in 1..width {
            let differs = usize::from(a[i - 1] != b[j - 1]);
            let mut best = (table[(i - 1) * width + j] + 1)
                .min(table[i * width + j - 1] + 1)
                .min(table[(i - 1) * width + j - 1] + differs);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(table[(i - 2) * width + j - 2] + 1);
            }
            table[i * width + j] = best;
        }
    }
    table[a.len() * width + b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_slips_and_nothing_else() {
        assert_eq!(closest("possion", ["law", "poisson", "b"]), Some("poisson"));
        assert_eq!(closest("adhesoin", ["bending", "adhesion"]), Some("adhesion"));
        assert_eq!(closest("banana", ["bending", "adhesion"]), None);
        assert_eq!(closest("", ["b"]), None);
        assert_eq!(closest("c", ["b"]), None);
        assert_eq!(closest("élements", ["elements"]), Some("elements"));
    }
}
