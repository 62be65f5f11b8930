//! The stamp of a Python environment: what it was made from, so that it is made again when that changes.

use sha2::{Digest, Sha256};

/// What the environment was made from, in one line: the requirements file, the Python that made it and the folder it
/// lies in (an environment that was moved no longer works).
pub fn stamp(requirements: &[u8], python_version: &str, folder: &std::path::Path) -> String {
    let mut hash = Sha256::new();
    for part in [requirements, python_version.as_bytes(), folder.as_os_str().as_encoded_bytes()] {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    hex(&hash.finalize())
}

/// Bytes as lower-case hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_stamp_changes_with_each_thing_it_stands_for_and_with_nothing_else() {
        let base = stamp(b"fmpy==0.3.32\n", "3.11.7", Path::new("/a"));
        assert_eq!(base, stamp(b"fmpy==0.3.32\n", "3.11.7", Path::new("/a")));
        assert_eq!(base.len(), 64);
        assert_ne!(base, stamp(b"fmpy==0.3.33\n", "3.11.7", Path::new("/a")));
        assert_ne!(base, stamp(b"fmpy==0.3.32\n", "3.12.0", Path::new("/a")));
        assert_ne!(base, stamp(b"fmpy==0.3.32\n", "3.11.7", Path::new("/b")));
        // Where one part ends and the next begins matters, too.
        assert_ne!(stamp(b"ab", "c", Path::new("")), stamp(b"a", "bc", Path::new("")));
    }

    #[test]
    fn every_requirement_is_pinned() {
        let list = include_str!("../../tests/python/requirements.txt");
        let mut pinned = 0;
        for line in list.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#')) {
            let requirement = line.split([';', '#']).next().unwrap().trim();
            let (name, version) = requirement.split_once("==").unwrap_or_else(|| panic!("{line} is not pinned"));
            assert!(!name.is_empty() && version.starts_with(|c: char| c.is_ascii_digit()), "{line}");
            pinned += 1;
        }
        assert!(pinned > 10);
    }
}
