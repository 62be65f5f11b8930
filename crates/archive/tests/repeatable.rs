//! What is written: repeatable, readable by another program, and never half there.

use std::io::{self, Write};

use glidepolar_archive::{Archive, Limits, write_whole};

fn glider() -> Archive {
    let mut archive = Archive::new();
    archive.insert("resources/vehicle.toml", "name = \"rogue\"").unwrap();
    archive.insert("modelDescription.xml", "<fmiModelDescription/>").unwrap();
    archive.insert("binaries/linux64/UnderwaterGlider.so", vec![7u8; 100_000]).unwrap();
    archive
}

#[test]
fn the_same_contents_give_the_same_bytes_in_any_order() {
    let bytes = |archive: &Archive| {
        let mut sink = io::Cursor::new(Vec::new());
        archive.write_to(&mut sink).unwrap();
        sink.into_inner()
    };
    let mut reversed = Archive::new();
    for (name, contents) in glider().entries().collect::<Vec<_>>().into_iter().rev() {
        reversed.insert(name, contents).unwrap();
    }
    assert_eq!(bytes(&glider()), bytes(&reversed));
}

#[test]
fn the_zip_crate_finds_sorted_names_and_the_fixed_time() {
    let mut sink = io::Cursor::new(Vec::new());
    glider().write_to(&mut sink).unwrap();
    let mut zip = zip::ZipArchive::new(sink).unwrap();
    let mut names = Vec::new();
    for index in 0..zip.len() {
        let entry = zip.by_index(index).unwrap();
        assert_eq!(entry.last_modified(), Some(zip::DateTime::default()));
        assert_eq!(entry.unix_mode().map(|mode| mode & 0o777), Some(0o644));
        names.push(entry.name().unwrap().into_owned());
    }
    assert_eq!(names, ["binaries/linux64/UnderwaterGlider.so", "modelDescription.xml", "resources/vehicle.toml"]);
}

#[test]
fn what_was_written_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new/folder/glider.fmu");
    glider().write(&path).unwrap();
    assert_eq!(Archive::read(&path, &Limits::default()).unwrap(), glider());
}

#[test]
fn a_failure_half_way_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("report.html");
    write_whole(&path, |file| file.write_all(b"old")).unwrap();
    let failed = write_whole(&path, |file| {
        file.write_all(b"half of the new")?;
        Err(io::Error::other("the disk is full"))
    });
    assert_eq!(failed.unwrap_err().to_string(), "the disk is full");
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "a temporary file was left behind");
}

#[cfg(unix)]
#[test]
fn the_file_has_the_rights_of_any_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
    write_whole(&ours, |file| file.write_all(b"x")).unwrap();
    std::fs::write(&plain, b"x").unwrap();
    let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&plain));
}
