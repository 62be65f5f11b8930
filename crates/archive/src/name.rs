//! Which names a file in an archive may have.

use std::path::Path;

/// Why a name inside an archive is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NameFault {
    /// Nothing is left of the name.
    #[error("the name is empty")]
    Empty,
    /// It begins at the root of a disk.
    #[error("the name is an absolute path; names in an archive are relative to its root")]
    Absolute,
    /// It has `.` or `..` in it, or an empty part.
    #[error("the name has a part that is empty, '.' or '..'; it could lead out of the folder it is unpacked to")]
    Wandering,
    /// It has a character that some system takes for a separator, a drive or an end.
    #[error("the name has a {0:?}, which some systems read as a separator, a drive or an end; use '/' between folders")]
    Character(char),
}

/// Checks that a name is a plain relative path with forward slashes, on any system: unpacked below a folder it stays
/// there.
pub fn check_name(name: &str) -> Result<(), NameFault> {
    if name.is_empty() {
        return Err(NameFault::Empty);
    }
    if name.starts_with('/') || Path::new(name).is_absolute() {
        return Err(NameFault::Absolute);
    }
    if let Some(bad) = name.chars().find(|c| matches!(c, '\\' | ':') || c.is_control()) {
        return Err(NameFault::Character(bad));
    }
    if name.split('/').any(|part| matches!(part, "" | "." | "..")) {
        return Err(NameFault::Wandering);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_relative_names_are_allowed() {
        for name in ["modelDescription.xml", "binaries/x86_64-linux/UnderwaterGlider.so", "a..b/c.d", "été/ü"] {
            assert_eq!(check_name(name), Ok(()), "{name}");
        }
    }

    #[test]
    fn names_that_lead_elsewhere_are_refused() {
        for (name, fault) in [
            ("", NameFault::Empty),
            ("/etc/passwd", NameFault::Absolute),
            ("..", NameFault::Wandering),
            ("../evil.so", NameFault::Wandering),
            ("binaries/../../evil.so", NameFault::Wandering),
            ("binaries/./x.so", NameFault::Wandering),
            ("binaries//x.so", NameFault::Wandering),
            ("binaries/", NameFault::Wandering),
            (r"binaries\..\..\evil.dll", NameFault::Character('\\')),
            (r"\\server\share\evil.dll", NameFault::Character('\\')),
            ("C:/evil.dll", NameFault::Character(':')),
            ("model.xml:stream", NameFault::Character(':')),
            ("evil.so\0.txt", NameFault::Character('\0')),
            ("line\nbreak", NameFault::Character('\n')),
        ] {
            assert_eq!(check_name(name), Err(fault), "{name:?}");
        }
    }
}
