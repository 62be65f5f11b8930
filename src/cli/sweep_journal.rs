//! What a sweep has finished, row by row in a file beside its table, so that an interrupted sweep can go on (`--resume`).
//!
//! `results.csv` is written beside `results.csv.unfinished`: a line that says of which sweep it is, then the finished rows of
//! the table. A sweep that comes to its end removes it.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::cli::CliError;
use crate::input::{InputError, Place};
use crate::report::InputFile;

/// The file of finished rows of one sweep.
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    /// Finished rows, each with its end of line.
    rows: String,
}

impl Journal {
    /// Begins anew, or, to resume, with the rows that an interrupted sweep of the same question left. `question` is all that
    /// the rows depend on.
    ///
    /// # Errors
    /// Where the file cannot be written, or to resume is of another sweep.
    pub fn open(table: &Path, question: &str, resumes: bool) -> Result<Journal, CliError> {
        let path = PathBuf::from(format!("{}.unfinished", table.display()));
        let mark = format!("# finished rows of the sweep {}\n", InputFile::new("", question.as_bytes()).sha256);
        let rows = if resumes { finished(&path, &mark)? } else { String::new() };
        // Written again without a row that was cut off.
        let begun = File::create(&path).and_then(|mut file| {
            file.write_all(mark.as_bytes())?;
            file.write_all(rows.as_bytes())?;
            Ok(file)
        });
        let file = begun.map_err(|error| unwritten(&path, &error))?;
        Ok(Journal { path, file, rows })
    }

    /// How many rows are finished.
    pub fn len(&self) -> usize {
        self.rows.lines().count()
    }

    /// The finished rows.
    pub fn rows(&self) -> &str {
        &self.rows
    }

    /// Keeps some more rows, on the disk at once.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn push(&mut self, rows: &str) -> Result<(), CliError> {
        self.rows.push_str(rows);
        self.file.write_all(rows.as_bytes()).map_err(|error| unwritten(&self.path, &error))
    }

    /// Removes the file: its rows stand in the table.
    pub fn close(self) {
        // One that stays does no harm: a new sweep begins it anew.
        let _ = fs::remove_file(&self.path);
    }
}

/// The whole rows that an interrupted sweep left; none where there is no file.
fn finished(path: &Path, mark: &str) -> Result<String, CliError> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(String::new()),
        Err(error) => return Err(InputError::io(path, &error).into()),
    };
    let Some(rows) = text.strip_prefix(mark) else {
        let error =
            InputError::new(Place::file(path), "is what another sweep left: its table, vehicle or options differ");
        return Err(error.help("repeat that sweep's command, or begin anew without --resume").into());
    };
    Ok(rows[..rows.rfind('\n').map_or(0, |end| end + 1)].to_owned())
}

fn unwritten(path: &Path, error: &io::Error) -> CliError {
    CliError::Failed(format!("{}: cannot be written: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::Journal;
    use std::fs;

    #[test]
    fn what_was_finished_is_there_again_without_a_row_that_was_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let table = folder.path().join("ends.csv");
        let mut journal = Journal::open(&table, "this sweep", false).unwrap();
        journal.push("1,2\n3,4\n").unwrap();
        journal.push("5,").unwrap();
        drop(journal);
        let again = Journal::open(&table, "this sweep", true).unwrap();
        assert_eq!((again.len(), again.rows()), (2, "1,2\n3,4\n"));
        drop(again);
        let Err(error) = Journal::open(&table, "another sweep", true) else { panic!("it is of another sweep") };
        assert!(error.to_string().contains("another sweep left"), "{error}");
        let anew = Journal::open(&table, "another sweep", false).unwrap();
        assert_eq!(anew.len(), 0);
        anew.close();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
