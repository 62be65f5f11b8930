//! Archives as an attacker, or a careless tool, would make them. They are built here with the zip crate's own writer
//! and by changing bytes, not with the code under test.

use std::io::{Cursor, Write};
use std::path::PathBuf;

use glidepolar_archive::{Archive, ArchiveError, EntryFault, Limits, NameFault};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// A file in a folder of its own, which goes away with it.
struct Sample {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

fn sample(bytes: &[u8]) -> Sample {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("stranger.fmu");
    std::fs::write(&path, bytes).unwrap();
    Sample { _folder: folder, path }
}

fn zip_with(build: impl FnOnce(&mut ZipWriter<Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    build(&mut zip);
    zip.finish().unwrap().into_inner()
}

fn zip_of(names: &[&str]) -> Vec<u8> {
    zip_with(|zip| {
        for name in names {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(b"contents").unwrap();
        }
    })
}

fn replace_all(bytes: &mut [u8], from: &[u8], to: &[u8]) {
    assert_eq!(from.len(), to.len());
    let places: Vec<usize> =
        bytes.windows(from.len()).enumerate().filter(|(_, w)| *w == from).map(|(i, _)| i).collect();
    assert!(!places.is_empty());
    for place in places {
        bytes[place..place + to.len()].copy_from_slice(to);
    }
}

fn read(bytes: &[u8]) -> Result<Archive, ArchiveError> {
    Archive::read(&sample(bytes).path, &Limits::default())
}

#[test]
fn an_ordinary_archive_with_folders_is_read() {
    let bytes = zip_with(|zip| {
        zip.add_directory("binaries/", SimpleFileOptions::default()).unwrap();
        zip.start_file("binaries/x.so", SimpleFileOptions::default()).unwrap();
        zip.write_all(b"ELF").unwrap();
    });
    let archive = read(&bytes).unwrap();
    assert_eq!(archive.entries().collect::<Vec<_>>(), [("binaries/x.so", b"ELF".as_slice())]);
}

#[test]
fn names_that_lead_out_of_the_archive_are_refused() {
    // The writer would mend some of them, so they are put in place of a harmless name of the same length.
    for (bad, fault) in [
        ("../evil.so", NameFault::Wandering),
        ("a/../../evil.so", NameFault::Wandering),
        ("/tmp/evil.so", NameFault::Absolute),
        ("C:/evil.so", NameFault::Character(':')),
        (r"..\evil.so", NameFault::Character('\\')),
    ] {
        let harmless = "x".repeat(bad.len());
        let mut bytes = zip_of(&[&harmless]);
        replace_all(&mut bytes, harmless.as_bytes(), bad.as_bytes());
        match read(&bytes) {
            Err(ArchiveError::Entry { entry, fault: EntryFault::Name(found), .. }) => {
                assert_eq!((entry.as_str(), found), (bad, fault));
            }
            other => panic!("{bad}: {other:?}"),
        }
    }
}

#[test]
fn a_link_is_refused() {
    let bytes = zip_with(|zip| {
        zip.add_symlink("binaries/x.so", "/etc/passwd", SimpleFileOptions::default()).unwrap();
    });
    assert!(matches!(read(&bytes), Err(ArchiveError::Entry { fault: EntryFault::Link, .. })));
}

#[test]
fn two_entries_of_one_name_are_refused() {
    // What one program checks and another unpacks could be different files.
    let mut bytes = zip_of(&["model-a.xml", "model-b.xml"]);
    replace_all(&mut bytes, b"model-b.xml", b"model-a.xml");
    let error = read(&bytes).unwrap_err().to_string();
    assert!(error.contains("same name"), "{error}");
}

#[test]
fn a_bomb_is_not_unpacked() {
    let bytes = zip_with(|zip| {
        zip.start_file("bomb", SimpleFileOptions::default()).unwrap();
        zip.write_all(&vec![0; 4 << 20]).unwrap();
    });
    assert!(bytes.len() < 10_000, "4 MiB of zeros pack to {} bytes", bytes.len());
    let limits = Limits { entry_bytes: 1 << 20, ..Limits::default() };
    let error = Archive::read(&sample(&bytes).path, &limits).unwrap_err();
    assert!(matches!(error, ArchiveError::Entry { fault: EntryFault::TooLarge(limit), .. } if limit == 1 << 20));
}

#[test]
fn a_bomb_that_lies_about_its_size_is_not_unpacked() {
    let size = 4u32 << 20;
    let mut bytes = zip_with(|zip| {
        zip.start_file("bomb", SimpleFileOptions::default()).unwrap();
        zip.write_all(&vec![0; size as usize]).unwrap();
    });
    replace_all(&mut bytes, &size.to_le_bytes(), &16u32.to_le_bytes());
    let limits = Limits { entry_bytes: 1 << 20, ..Limits::default() };
    // Refused as damaged or as too large: either way no more than the limit is ever held.
    assert!(Archive::read(&sample(&bytes).path, &limits).is_err());
}

#[test]
fn many_files_that_are_large_together_are_refused() {
    let bytes = zip_with(|zip| {
        for index in 0..8 {
            zip.start_file(format!("part-{index}"), SimpleFileOptions::default()).unwrap();
            zip.write_all(&vec![0; 1 << 20]).unwrap();
        }
    });
    let limits = Limits { entry_bytes: 2 << 20, total_bytes: 4 << 20, ..Limits::default() };
    let error = Archive::read(&sample(&bytes).path, &limits).unwrap_err();
    assert!(matches!(error, ArchiveError::TooLarge { what: "bytes", .. }), "{error}");

    let limits = Limits { entries: 7, ..Limits::default() };
    let error = Archive::read(&sample(&bytes).path, &limits).unwrap_err();
    assert!(matches!(error, ArchiveError::TooLarge { what: "files", .. }), "{error}");
}

#[test]
fn a_damaged_byte_is_noticed() {
    let text = b"the glide polar is the curve that decides how a glider flies";
    let mut bytes = zip_with(|zip| {
        let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        zip.start_file("notes.txt", stored).unwrap();
        zip.write_all(text).unwrap();
    });
    replace_all(&mut bytes, b"glide polar", b"glide_polar");
    assert!(matches!(read(&bytes), Err(ArchiveError::Entry { fault: EntryFault::Damaged(_), .. })));
}

#[test]
fn no_archive_at_all_and_every_truncation_are_errors_not_panics() {
    assert!(matches!(read(b"not a zip"), Err(ArchiveError::NotAnArchive { .. })));
    assert!(matches!(read(b""), Err(ArchiveError::NotAnArchive { .. })));
    let bytes = zip_of(&["a/b.txt", "c.txt"]);
    for length in 0..bytes.len() {
        assert!(read(&bytes[..length]).is_err(), "cut after {length} bytes");
    }
    let missing = Archive::read(&PathBuf::from("no/such/file.fmu"), &Limits::default()).unwrap_err();
    assert!(missing.to_string().contains("no/such/file.fmu"));
}
