#![doc = include_str!("../README.md")]

mod answer;
mod controls;
mod error;
mod guard;
mod http;
mod query;
mod server;
mod trace;

pub use error::ExploreError;
pub use server::Explorer;

/// The command line that traces what the page shows.
fn words(command: &[String], set: &[String]) -> String {
    let mut line = "arclen trace".to_owned();
    for word in command {
        line = format!("{line} {}", quoted(word));
    }
    for text in set {
        line = format!("{line} --set {}", quoted(text));
    }
    line
}

/// A word as a shell reads it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_quoted_for_a_shell() {
        let command = ["my case.toml".to_owned(), "--elements".to_owned(), "60".to_owned()];
        let set = ["physical.film=\"40 nm\"".to_owned(), "shell.law=skalak".to_owned()];
        assert_eq!(
            words(&command, &set),
            "arclen trace 'my case.toml' --elements 60 --set 'physical.film=\"40 nm\"' \
             --set shell.law=skalak"
        );
        assert_eq!(quoted("it's"), "'it'\\''s'");
    }
}
