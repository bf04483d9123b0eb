//! What a case file says it is.

/// The first sentence of a case file's opening comment.
pub fn headline(text: &str) -> String {
    let comment: Vec<&str> =
        text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim).collect();
    let comment = comment.join(" ");
    let end = comment
        .match_indices(". ")
        .map(|(at, _)| at)
        .find(|at| !comment[..*at].ends_with("Fig"))
        .unwrap_or(comment.trim_end_matches('.').len());
    comment[..end].to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{SHIPPED, SWEEPS};

    #[test]
    fn every_shipped_case_says_what_it_is_in_a_line() {
        for (name, text) in SHIPPED.iter().chain(SWEEPS) {
            let line = headline(text);
            assert!((20..110).contains(&line.len()), "{name}: {line}");
        }
        assert_eq!(headline("# One (Fig. 3). Two.\na = 1"), "One (Fig. 3)");
        assert_eq!(headline("# One.\n# Two.\n"), "One");
        assert_eq!(headline("a = 1"), "");
    }
}
