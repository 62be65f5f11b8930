//! Archives that somebody else packed.

use glidepolar_archive::{Archive, Limits};

use crate::Target;
use crate::files::Folder;

pub const ARCHIVE: Target = Target {
    name: "archive",
    what: "an FMU archive of unknown origin",
    run: archive,
    seeds: archives,
    catches_panics: false,
};

const LIMITS: Limits = Limits { entries: 100, entry_bytes: 1 << 20, total_bytes: 4 << 20 };

fn archive(data: &[u8]) {
    let folder = Folder::new();
    let path = folder.write("other.fmu", data);
    match Archive::read(&path, &LIMITS) {
        Err(error) => drop(error.to_string()),
        Ok(archive) => {
            let bytes: u64 = archive.entries().map(|(_, contents)| contents.len() as u64).sum();
            assert!(bytes <= LIMITS.total_bytes);
            let again = folder.path("again.fmu");
            archive.write(&again).expect("what was read can be packed");
            assert_eq!(Archive::read(&again, &LIMITS).expect("what was packed can be read"), archive);
        }
    }
}

fn archives() -> Vec<Vec<u8>> {
    let packed = |entries: &[(&str, &[u8])]| {
        let folder = Folder::new();
        let path = folder.path("seed.fmu");
        let mut archive = Archive::new();
        for (name, contents) in entries {
            archive.insert(name, *contents).expect("a plain name");
        }
        archive.write(&path).expect("room for a temporary file");
        std::fs::read(path).expect("it was just written")
    };
    vec![
        packed(&[]),
        packed(&[("modelDescription.xml", b"<fmiModelDescription fmiVersion=\"3.0\"/>")]),
        packed(&[("binaries/x86_64-linux/UnderwaterGlider.so", &[0x7f; 3000]), ("documentation/index.html", b"<p>")]),
    ]
}
