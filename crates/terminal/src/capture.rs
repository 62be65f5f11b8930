//! What a command prints, kept for a program that does the command's work itself instead of starting it.
//!
//! Holds for the thread that does the work, so that several may work at once.

use std::cell::RefCell;
use std::fmt::{Arguments, Display};

/// What a command would have printed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Captured {
    /// The tables, line by line.
    pub lines: String,
    /// What the result is to be read with.
    pub warnings: Vec<String>,
    /// The result, where `--json -` asked for it.
    pub json: Option<String>,
}

thread_local! {
    static CAPTURED: RefCell<Option<Captured>> = const { RefCell::new(None) };
}

/// Does some work and keeps what it would have printed from this thread.
pub fn captured<T>(work: impl FnOnce() -> T) -> (T, Captured) {
    let before = CAPTURED.replace(Some(Captured::default()));
    let done = work();
    let captured = CAPTURED.replace(before).unwrap_or_default();
    (done, captured)
}

/// Keeps a line; false where nothing is kept.
pub(crate) fn line(line: Arguments) -> bool {
    keep(|captured| {
        captured.lines.push_str(&line.to_string());
        captured.lines.push('\n');
    })
}

/// Keeps a warning; false where nothing is kept.
pub(crate) fn warning(warning: &impl Display) -> bool {
    keep(|captured| captured.warnings.push(warning.to_string()))
}

/// Keeps a result; false where nothing is kept.
pub(crate) fn json(text: &str) -> bool {
    keep(|captured| captured.json = Some(text.to_owned()))
}

fn keep(add: impl FnOnce(&mut Captured)) -> bool {
    CAPTURED.with_borrow_mut(|captured| captured.as_mut().map(add).is_some())
}

#[cfg(test)]
mod tests {
    use super::captured;
    use crate::{Output, print_line, warn};

    #[test]
    fn what_is_printed_is_kept_and_nothing_after_it() {
        let output = Output { json: Some("-".into()), quiet: true, force: false };
        let (done, kept) = captured(|| {
            print_line(format_args!("a {}", "table"));
            warn(["mind the step"]);
            output.write_json(&[1.5, 2.0])
        });
        assert!(done.is_ok());
        assert_eq!((kept.lines.as_str(), kept.warnings.as_slice()), ("a table\n", &["mind the step".to_owned()][..]));
        assert_eq!(kept.json.as_deref(), Some("[\n  1.5,\n  2.0\n]\n"));
        assert_eq!(captured(|| ()).1, super::Captured::default());
    }
}
