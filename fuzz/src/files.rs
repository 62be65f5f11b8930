//! Bytes as files: a folder that is used again and again, several files in one input.

use std::path::{Path, PathBuf};

use tempfile::TempDir;

/// What parts the files of one input: a line of its own.
pub const MARK: &str = "\n%%\n";

/// A folder of this thread, on a file system in memory where there is one.
pub struct Folder(TempDir);

impl Folder {
    /// A fresh one.
    pub fn new() -> Self {
        let memory = Path::new("/dev/shm");
        let made = if memory.is_dir() { TempDir::new_in(memory) } else { TempDir::new() };
        Folder(made.expect("a folder for temporary files"))
    }

    /// A path in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The folder itself.
    pub fn root(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file.
    pub fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).expect("room for a temporary file");
        path
    }

    /// Writes the files of one input under these names; those that it has not are taken away.
    pub fn write_parts(&self, data: &[u8], names: &[&str]) {
        let mut parts = parts(data);
        for name in names {
            match parts.next() {
                Some(part) => drop(self.write(name, part)),
                None => drop(std::fs::remove_file(self.path(name))),
            }
        }
    }
}

/// The files in one input.
pub fn parts(data: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mark = MARK.as_bytes();
    let mut rest = Some(data);
    std::iter::from_fn(move || {
        let here = rest?;
        match here.windows(mark.len()).position(|window| window == mark) {
            Some(at) => {
                rest = Some(&here[at + mark.len()..]);
                Some(&here[..at])
            }
            None => rest.take(),
        }
    })
}

/// One input of several files.
pub fn joined<T: AsRef<[u8]>>(parts: &[T]) -> Vec<u8> {
    let parts: Vec<&[u8]> = parts.iter().map(AsRef::as_ref).collect();
    parts.join(MARK.as_bytes())
}

/// A table with every `nth` row below its header: small enough to be changed a million times.
#[cfg(any(feature = "logs", test))]
pub fn thinned(table: &str, nth: usize) -> String {
    let (remarks, rows): (Vec<&str>, Vec<&str>) = table.lines().partition(|line| line.starts_with('#'));
    let header = rows.first().copied().unwrap_or_default();
    let kept = rows.iter().skip(1).step_by(nth.max(1)).copied();
    let lines: Vec<&str> = remarks.into_iter().chain([header]).chain(kept).collect();
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_are_taken_apart_as_they_were_put_together() {
        let files = ["a\nb\n", "", "%%", "last"];
        let input = joined(&files);
        let found: Vec<&[u8]> = parts(&input).collect();
        assert_eq!(found, files.map(str::as_bytes));
        assert_eq!(thinned("# r\nt,x\n0,1\n1,2\n2,3\n", 2), "# r\nt,x\n0,1\n2,3\n");
    }
}
