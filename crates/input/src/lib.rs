//! What every reader of files says when it cannot go on: where, what was found, what was expected, what to do.

#![allow(non_snake_case, reason = "units stand in names as they are written: N, Pa, C, J")]

pub mod lines;
pub mod memory;
pub mod toml;

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A place in a file. Lines and columns count from 1; a column counts characters in text files and cells in tables.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file, as the user named it.
    pub file: PathBuf,
    /// Line, where one is to blame.
    pub line: Option<usize>,
    /// Column, where one is to blame.
    pub column: Option<usize>,
}

impl Place {
    /// The file as a whole.
    pub fn file(file: impl AsRef<Path>) -> Self {
        Place { file: file.as_ref().to_owned(), line: None, column: None }
    }

    /// One line of it, from 1.
    pub fn line(file: impl AsRef<Path>, line: usize) -> Self {
        Place { line: Some(line), ..Place::file(file) }
    }

    /// The line and column of a byte offset in the text of the file.
    pub fn offset(file: impl AsRef<Path>, text: &str, offset: usize) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let start = before.rfind('\n').map_or(0, |i| i + 1);
        let column = before.get(start..).unwrap_or("").chars().count() + 1;
        Place { line: Some(before.matches('\n').count() + 1), column: Some(column), ..Place::file(file) }
    }

    /// The same place, with a column.
    pub fn column(self, column: usize) -> Self {
        Place { column: Some(column), ..self }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", printable(&self.file.to_string_lossy()))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(column) = self.column {
            write!(f, ":{column}")?;
        }
        Ok(())
    }
}

/// Input that cannot be used: one message with the place, and what to do about it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place}: {problem}{}", .help.as_ref().map(|h| format!("; {h}")).unwrap_or_default())]
pub struct InputError {
    /// Where.
    pub place: Place,
    /// What was found and what was expected.
    pub problem: String,
    /// What to do.
    pub help: Option<String>,
}

impl InputError {
    /// An error at a place. Text from files goes into `problem` through [`printable`].
    pub fn new(place: Place, problem: impl Into<String>) -> Self {
        InputError { place, problem: problem.into(), help: None }
    }

    /// With a next step.
    pub fn help(self, help: impl Into<String>) -> Self {
        InputError { help: Some(help.into()), ..self }
    }

    /// With what was warned of before the error, which may be its cause; what the error itself says is not said twice.
    pub fn beside(self, warnings: &[String]) -> Self {
        /// Warnings that an error repeats.
        const MOST: usize = 4;
        let own = self.to_string();
        let others: Vec<&str> = warnings.iter().map(String::as_str).filter(|warning| !warning.contains(&own)).collect();
        if others.is_empty() {
            return self;
        }
        let shown = others[..others.len().min(MOST)].join("; ");
        let more = others.len().saturating_sub(MOST);
        let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
        let before = self.help.as_ref().map(|help| format!("{help}; ")).unwrap_or_default();
        self.help(format!("{before}the reading warned before: {shown}{rest}"))
    }

    /// A file that could not be read or written at all.
    pub fn io(file: impl AsRef<Path>, error: &std::io::Error) -> Self {
        let path = file.as_ref();
        let plain = InputError::new(Place::file(path), error.to_string());
        match error.kind() {
            ErrorKind::NotFound => match neighbour(path) {
                Some(near) => plain.help(format!("did you mean {}?", printable(&near.to_string_lossy()))),
                None => plain,
            },
            ErrorKind::IsADirectory => plain.help("a file is needed here, and this is a folder: name the files in it"),
            _ => plain,
        }
    }
}

/// The file beside a missing one whose name is nearest to it.
fn neighbour(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?;
    let names: Vec<String> = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok()).collect();
    let near = nearest(path.file_name()?.to_str()?, names.iter().map(String::as_str))?;
    Some(folder.map_or_else(|| PathBuf::from(near), |folder| folder.join(near)))
}

/// Text from outside made fit for a terminal: control characters escaped, and those that turn the direction of text
/// round; length bounded.
pub fn printable(text: &str) -> String {
    const MAX: usize = 120;
    let escaped: String = text
        .chars()
        .take(MAX)
        .flat_map(|c| if c.is_control() || turns(c) { c.escape_default().collect() } else { vec![c] })
        .collect();
    if text.chars().nth(MAX).is_some() { escaped + "..." } else { escaped }
}

/// Whether a character turns the direction of the text after it, and can make it read as something else.
pub fn turns(c: char) -> bool {
    matches!(c, '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}')
}

/// The known name nearest to a misspelt one, if any is near.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let score = |k: &str| strsim::jaro_winkler(&name.to_lowercase(), &k.to_lowercase());
    let (best, candidate) = known.into_iter().map(|k| (score(k), k)).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best > 0.8).then_some(candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_becomes_line_and_column() {
        let text = "a = 1\nüb = 2\n";
        assert_eq!(Place::offset("f", text, 0).to_string(), "f:1:1");
        assert_eq!(Place::offset("f", text, 8).to_string(), "f:2:2");
        assert_eq!(Place::offset("f", text, 999).line, Some(3));
    }

    #[test]
    fn an_error_keeps_the_warnings_before_it_and_says_nothing_twice() {
        let error = InputError::new(Place::file("a.dbd"), "no density").help("give it");
        assert_eq!(error.clone().beside(&["left out: a.dbd: no density; give it".to_owned()]), error);
        let warnings: Vec<String> = (0..6).map(|i| format!("left out: {i}.ebd")).collect();
        let said = error.beside(&warnings).to_string();
        assert!(
            said.contains("give it; the reading warned before: left out: 0.ebd; ") && said.ends_with("and 2 more"),
            "{said}"
        );
    }

    #[test]
    fn a_missing_file_is_reported_with_the_one_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("flight_2016.csv"), "").unwrap();
        let missing = |name: &str| {
            let path = folder.path().join(name);
            InputError::io(&path, &std::fs::File::open(&path).unwrap_err()).help
        };
        assert!(missing("flihgt_2016.csv").unwrap().contains("flight_2016.csv"));
        assert_eq!(missing("something else"), None);
    }

    #[test]
    fn terminal_escapes_do_not_survive() {
        assert_eq!(printable("\u{1b}[31mred"), "\\u{1b}[31mred");
        assert_eq!(printable("a\u{202e}b"), "a\\u{202e}b");
        assert!(printable(&"x".repeat(1000)).len() < 200);
    }
}
