//! What lies where in an FMU: the two standards' archives put together from the checkout and the built libraries.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use glidepolar_archive::{Archive, Limits};

use crate::check_library::is_built_for;
use crate::platform::{PLATFORMS, Platform};
use crate::workspace::Workspace;

/// The models in the library; each has archives of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// In the vertical plane.
    Plane,
    /// In six degrees of freedom.
    Space,
}

impl Model {
    pub const ALL: [Model; 2] = [Model::Plane, Model::Space];

    /// The name of the library inside the archives, as the model descriptions state it.
    fn identifier(self) -> &'static str {
        match self {
            Model::Plane => "UnderwaterGlider",
            Model::Space => "UnderwaterGlider3D",
        }
    }

    /// The folder of its generated files.
    fn folder(self) -> &'static str {
        match self {
            Model::Plane => "modelDescription",
            Model::Space => "modelDescription/space",
        }
    }
}

const DESCRIPTION: &str = "modelDescription.xml";

/// The shared library's bytes for each platform.
pub type Binaries = BTreeMap<&'static Platform, Vec<u8>>;

/// The two versions of the standard; each has an archive of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standard {
    Fmi2,
    Fmi3,
}

use Standard::{Fmi2, Fmi3};

/// Where the parts of an archive come from (a file or a folder, from the checkout's root), which archives they go into
/// and under what name; `""` is the archive's root.
const PARTS: [(&str, &[Standard], &str); 6] = [
    ("modelDescription/icon.png", &[Fmi2], "model.png"),
    ("modelDescription/icon.png", &[Fmi3], "terminalsAndIcons/icon.png"),
    ("vehicles/slocum-graver.toml", &[Fmi2, Fmi3], "resources/vehicle.toml"),
    ("modelDescription/license.txt", &[Fmi2, Fmi3], "documentation/licenses/license.txt"),
    ("LICENSE-MIT", &[Fmi2, Fmi3], "documentation/licenses/LICENSE-MIT.txt"),
    ("LICENSE-APACHE", &[Fmi2, Fmi3], "documentation/licenses/LICENSE-APACHE.txt"),
];

/// The same of the files that are generated, below the model's folder.
const GENERATED: [(&str, &[Standard], &str); 3] =
    [("fmi2", &[Fmi2], ""), ("fmi3", &[Fmi3], ""), ("documentation", &[Fmi2, Fmi3], "documentation")];

/// Files below a model's folder without which there is no archive.
const REQUIRED: [&str; 3] = ["fmi2/modelDescription.xml", "fmi3/modelDescription.xml", "documentation/index.html"];

impl Standard {
    pub fn archive_name(self, model: Model) -> String {
        let suffix = match self {
            Fmi2 => "_fmi2",
            Fmi3 => "",
        };
        format!("{}{suffix}.fmu", model.identifier())
    }

    fn description(self, model: Model) -> String {
        let folder = match self {
            Fmi2 => "fmi2",
            Fmi3 => "fmi3",
        };
        format!("{}/{folder}/{DESCRIPTION}", model.folder())
    }

    fn folder(self, platform: &Platform) -> &'static str {
        match self {
            Fmi2 => platform.fmi2,
            Fmi3 => platform.fmi3,
        }
    }
}

/// Fails, naming every one, if files that belong into the archives are missing from the checkout.
pub fn check_sources(workspace: &Workspace) -> Result<()> {
    let generated = Model::ALL.into_iter().flat_map(|model| REQUIRED.map(|file| format!("{}/{file}", model.folder())));
    let mut missing: Vec<String> = PARTS.iter().map(|(from, ..)| (*from).to_owned()).chain(generated).collect();
    missing.retain(|path| !workspace.path(path).exists());
    missing.dedup();
    if !missing.is_empty() {
        bail!("the FMU cannot be packed, these files are missing from the checkout:\n  {}", missing.join("\n  "));
    }
    Ok(())
}

/// One standard's archive of a model. `notice` is the licence text of what is linked into the library.
pub fn assemble(
    workspace: &Workspace,
    (model, standard): (Model, Standard),
    notice: &str,
    binaries: &Binaries,
) -> Result<Archive> {
    let mut archive = Archive::new();
    archive.insert("documentation/licenses/third-party.txt", notice)?;
    let generated = GENERATED.map(|(from, standards, to)| (format!("{}/{from}", model.folder()), standards, to));
    let parts = PARTS.map(|(from, standards, to)| (from.to_owned(), standards, to));
    for (from, standards, to) in generated.into_iter().chain(parts) {
        if standards.contains(&standard) {
            insert_tree(&mut archive, &workspace.path(from), to)?;
        }
    }
    for (platform, library) in binaries {
        let file = platform.file_name(model.identifier());
        archive.insert(&format!("binaries/{}/{file}", standard.folder(platform)), library.clone())?;
    }
    if standard == Fmi2 {
        insert_for_old_importers(&mut archive, model, binaries)?;
    }
    Ok(archive)
}

/// The binaries that somebody else's archive brings. It must have been packed from the same model description: the
/// library refuses to start under another's token. Whichever standard it was packed for, its library serves both.
pub fn binaries_of(workspace: &Workspace, path: &Path) -> Result<Binaries> {
    let archive = Archive::read(path, &Limits::default())?;
    let description =
        archive.get(DESCRIPTION).with_context(|| format!("{} has no {DESCRIPTION}: it is no FMU", path.display()))?;
    let mut found = None;
    for candidate in Model::ALL.into_iter().flat_map(|model| [(model, Fmi2), (model, Fmi3)]) {
        if same_text(description, &fs::read(workspace.path(candidate.1.description(candidate.0)))?) {
            found = Some(candidate);
        }
    }
    let (model, standard) = found.with_context(|| {
        format!(
            "{} was packed from another state of the project: its {DESCRIPTION} is none of those in \
             modelDescription/. Pack it again from this commit",
            path.display()
        )
    })?;

    let mut binaries = Binaries::new();
    for platform in &PLATFORMS {
        let name = format!("binaries/{}/{}", standard.folder(platform), platform.file_name(model.identifier()));
        match archive.get(&name) {
            // The folder may hold a copy for old importers on another machine.
            Some(library) if is_built_for(library, platform) => {
                binaries.insert(platform, library.to_vec());
            }
            Some(_) => eprintln!("{}: {name} is not for {}, left out", path.display(), platform.fmi3),
            None => {}
        }
    }
    if binaries.is_empty() {
        bail!("{} has no binary of a platform that is known here", path.display());
    }
    Ok(binaries)
}

/// Importers older than FMI 2.0.4 know no folders but those of x86; on other machines they look there.
fn insert_for_old_importers(archive: &mut Archive, model: Model, binaries: &Binaries) -> Result<()> {
    for (platform, library) in binaries {
        let Some(folder) = platform.fmi2_old else {
            continue;
        };
        let name = format!("binaries/{folder}/{}", platform.file_name(model.identifier()));
        if archive.get(&name).is_none() {
            archive.insert(&name, library.clone())?;
        }
    }
    Ok(())
}

fn insert_tree(archive: &mut Archive, from: &Path, to: &str) -> Result<()> {
    if from.is_file() {
        let contents = fs::read(from).with_context(|| format!("cannot read {}", from.display()))?;
        return archive.insert(to, contents).with_context(|| format!("cannot pack {}", from.display()));
    }
    let mut entries: Vec<PathBuf> = fs::read_dir(from)
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect())
        .with_context(|| format!("cannot read {}", from.display()))?;
    entries.sort();
    for entry in entries {
        let name = entry.file_name().and_then(|name| name.to_str()).context("a file name is not UTF-8")?;
        let below = if to.is_empty() { name.to_owned() } else { format!("{to}/{name}") };
        insert_tree(archive, &entry, &below)?;
    }
    Ok(())
}

/// Equal but for the line ends that a checkout on Windows may have changed.
fn same_text(one: &[u8], other: &[u8]) -> bool {
    let letters = |text: &[u8]| text.iter().copied().filter(|byte| *byte != b'\r').collect::<Vec<_>>();
    letters(one) == letters(other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::Platform;

    const NOTICE: &str = "licences of the parts";

    /// A folder with every file that packing wants.
    fn checkout() -> (tempfile::TempDir, Workspace) {
        let folder = tempfile::tempdir().unwrap();
        for path in [
            "modelDescription/fmi2/modelDescription.xml",
            "modelDescription/fmi3/modelDescription.xml",
            "modelDescription/fmi3/terminalsAndIcons/terminalsAndIcons.xml",
            "modelDescription/documentation/index.html",
            "modelDescription/documentation/figures/polar.svg",
            "modelDescription/space/fmi2/modelDescription.xml",
            "modelDescription/space/fmi3/modelDescription.xml",
            "modelDescription/space/documentation/index.html",
            "modelDescription/icon.png",
            "modelDescription/license.txt",
            "vehicles/slocum-graver.toml",
            "LICENSE-MIT",
            "LICENSE-APACHE",
        ] {
            let file = folder.path().join(path);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(&file, path).unwrap();
        }
        let workspace = Workspace::at(folder.path());
        (folder, workspace)
    }

    /// A real binary of this machine: the running test program.
    fn own_binary() -> (&'static Platform, Vec<u8>) {
        (Platform::host().unwrap(), fs::read(std::env::current_exe().unwrap()).unwrap())
    }

    fn names(archive: &Archive) -> Vec<&str> {
        archive.entries().map(|(name, _)| name).collect()
    }

    #[test]
    fn each_part_lies_where_its_standard_wants_it() {
        let (_folder, workspace) = checkout();
        check_sources(&workspace).unwrap();
        let linux = &PLATFORMS[0];
        let binaries = Binaries::from([(linux, b"ELF".to_vec())]);

        let fmi3 = assemble(&workspace, (Model::Plane, Fmi3), NOTICE, &binaries).unwrap();
        assert_eq!(
            names(&fmi3),
            [
                "binaries/x86_64-linux/UnderwaterGlider.so",
                "documentation/figures/polar.svg",
                "documentation/index.html",
                "documentation/licenses/LICENSE-APACHE.txt",
                "documentation/licenses/LICENSE-MIT.txt",
                "documentation/licenses/license.txt",
                "documentation/licenses/third-party.txt",
                "modelDescription.xml",
                "resources/vehicle.toml",
                "terminalsAndIcons/icon.png",
                "terminalsAndIcons/terminalsAndIcons.xml",
            ]
        );
        assert_eq!(fmi3.get("modelDescription.xml"), Some(b"modelDescription/fmi3/modelDescription.xml".as_slice()));

        let fmi2 = assemble(&workspace, (Model::Plane, Fmi2), NOTICE, &binaries).unwrap();
        assert_eq!(fmi2.get("modelDescription.xml"), Some(b"modelDescription/fmi2/modelDescription.xml".as_slice()));
        assert_eq!(fmi2.get("binaries/linux64/UnderwaterGlider.so"), Some(b"ELF".as_slice()));
        assert!(fmi2.get("model.png").is_some());
        assert!(!names(&fmi2).iter().any(|name| name.starts_with("terminalsAndIcons")));

        let space = assemble(&workspace, (Model::Space, Fmi3), NOTICE, &binaries).unwrap();
        assert_eq!(space.get("binaries/x86_64-linux/UnderwaterGlider3D.so"), Some(b"ELF".as_slice()));
        let own = b"modelDescription/space/fmi3/modelDescription.xml".as_slice();
        assert_eq!(space.get("modelDescription.xml"), Some(own));
    }

    #[test]
    fn old_importers_find_a_binary_only_while_no_other_claims_the_folder() {
        let (_folder, workspace) = checkout();
        let [x86, arm] = [&PLATFORMS[0], &PLATFORMS[1]];
        let alone =
            assemble(&workspace, (Model::Plane, Fmi2), NOTICE, &Binaries::from([(arm, b"arm".to_vec())])).unwrap();
        assert_eq!(alone.get("binaries/aarch64-linux/UnderwaterGlider.so"), Some(b"arm".as_slice()));
        assert_eq!(alone.get("binaries/linux64/UnderwaterGlider.so"), Some(b"arm".as_slice()));
        let both = Binaries::from([(arm, b"arm".to_vec()), (x86, b"x86".to_vec())]);
        let both = assemble(&workspace, (Model::Plane, Fmi2), NOTICE, &both).unwrap();
        assert_eq!(both.get("binaries/linux64/UnderwaterGlider.so"), Some(b"x86".as_slice()));
    }

    #[test]
    fn every_missing_file_is_named() {
        let (folder, workspace) = checkout();
        fs::remove_file(folder.path().join("modelDescription/icon.png")).unwrap();
        fs::remove_file(folder.path().join("modelDescription/fmi2/modelDescription.xml")).unwrap();
        let error = check_sources(&workspace).unwrap_err().to_string();
        assert!(error.contains("modelDescription/icon.png"), "{error}");
        assert!(error.contains("modelDescription/fmi2/modelDescription.xml"), "{error}");
        assert!(!error.contains("index.html"), "{error}");
    }

    #[test]
    fn binaries_are_taken_from_an_archive_of_either_standard() {
        let (folder, workspace) = checkout();
        let (host, bytes) = own_binary();
        for of in Model::ALL.into_iter().flat_map(|model| [(model, Fmi2), (model, Fmi3)]) {
            let path = folder.path().join(of.1.archive_name(of.0));
            let mut archive = assemble(&workspace, of, NOTICE, &Binaries::from([(host, bytes.clone())])).unwrap();
            archive.insert("binaries/vax-vms/UnderwaterGlider.so", "for a machine nobody knows").unwrap();
            archive.insert("resources/extra.txt", "not a binary").unwrap();
            archive.write(&path).unwrap();
            assert_eq!(binaries_of(&workspace, &path).unwrap(), Binaries::from([(host, bytes.clone())]));
        }
    }

    #[test]
    fn what_is_no_binary_of_its_folder_is_left_out() {
        let (folder, workspace) = checkout();
        let path = folder.path().join("forged.fmu");
        let all = PLATFORMS.iter().map(|platform| (platform, b"not a program".to_vec())).collect();
        assemble(&workspace, (Model::Plane, Fmi3), NOTICE, &all).unwrap().write(&path).unwrap();
        let error = binaries_of(&workspace, &path).unwrap_err().to_string();
        assert!(error.contains("no binary"), "{error}");
    }

    #[test]
    fn an_archive_of_another_state_of_the_project_is_refused() {
        let (folder, workspace) = checkout();
        let (host, bytes) = own_binary();
        let path = folder.path().join("other.fmu");
        let mut archive = assemble(&workspace, (Model::Plane, Fmi3), NOTICE, &Binaries::from([(host, bytes)])).unwrap();
        archive.insert("modelDescription.xml", "another token").unwrap();
        archive.write(&path).unwrap();
        let error = binaries_of(&workspace, &path).unwrap_err().to_string();
        assert!(error.contains("another state of the project"), "{error}");

        let mut archive = Archive::new();
        archive.insert("notes.txt", "no FMU at all").unwrap();
        archive.write(&path).unwrap();
        assert!(binaries_of(&workspace, &path).unwrap_err().to_string().contains("is no FMU"));
    }

    #[test]
    fn line_ends_do_not_make_another_text() {
        assert!(same_text(b"<a>\r\n</a>\r\n", b"<a>\n</a>\n"));
        assert!(!same_text(b"<a>\n</a>\n", b"<a></a>\n"));
    }
}
