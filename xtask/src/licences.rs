//! The licence texts of everything that is linked into what is given to others: their licences ask that they go along.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;

use crate::workspace::{Workspace, capture};

/// The notice for the packages that a package is built from: which there are, under what licence, and each distinct text
/// once with the packages it came with. `subject` is what is built, as the beginning of a sentence: "The library is".
pub fn notice(workspace: &Workspace, package: &str, subject: &str) -> Result<String> {
    let packages = linked_packages(workspace, package)?;
    let mut text = format!(
        "{subject} built from the packages below and from the Rust standard library\n\
         (MIT OR Apache-2.0, The Rust Project Developers). Their licence texts follow.\n\n",
    );
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in &packages {
        text.push_str(&format!("{}: {}\n", package.title, package.licence));
        for file in licence_files(&package.folder)? {
            let contents = fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?;
            let contents = String::from_utf8_lossy(&contents).replace('\r', "").trim().to_owned();
            texts.entry(contents).or_default().push(package.title.clone());
        }
    }
    for (contents, packages) in &texts {
        let line = "-".repeat(80);
        text.push_str(&format!("\n{line}\n{}\n\n{contents}\n", packages.join(", ")));
    }
    Ok(text)
}

/// A package by name and version.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Package {
    title: String,
    licence: String,
    folder: PathBuf,
}

/// The packages that are linked into a package, this project's own and build-time ones apart.
fn linked_packages(workspace: &Workspace, package: &str) -> Result<BTreeSet<Package>> {
    let tree = capture(workspace.cargo().args([
        "tree",
        "--package",
        package,
        "--edges=normal,no-proc-macro",
        "--prefix=none",
        "--format={p}",
    ]))?;
    // NAME vVERSION, more where it is not from the registry
    let linked: BTreeSet<(&str, &str)> = tree
        .lines()
        .filter_map(|line| line.split_once(" v"))
        .map(|(name, rest)| (name, rest.split(' ').next().unwrap_or(rest)))
        .collect();

    let metadata: Value = serde_json::from_str(&capture(workspace.cargo().args(["metadata", "--format-version=1"]))?)?;
    let text = |package: &Value, field: &str| package[field].as_str().unwrap_or_default().to_owned();
    let mut packages = BTreeSet::new();
    for package in metadata["packages"].as_array().context("cargo metadata lists no packages")? {
        let (name, version) = (text(package, "name"), text(package, "version"));
        if package["source"].is_null() || !linked.contains(&(name.as_str(), version.as_str())) {
            continue;
        }
        let manifest = PathBuf::from(text(package, "manifest_path"));
        packages.insert(Package {
            title: format!("{name} {version}"),
            licence: text(package, "license"),
            folder: manifest.parent().context("a package without a folder")?.to_owned(),
        });
    }
    Ok(packages)
}

/// The files in a package's folder that by their names hold its licence, in order.
fn licence_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_ascii_uppercase();
        let is_licence = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"]
            .iter()
            .any(|beginning| name.starts_with(beginning));
        if is_licence && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_notice_names_what_is_linked_and_carries_its_licence() {
        let workspace = Workspace::find().unwrap();
        let notice = notice(&workspace, "glidepolar-fmu", "The library is").unwrap();
        let list = notice.split("\n---").next().unwrap();
        // The equations are generic over nalgebra's and num-dual's numbers; vehicle files are TOML; the rest belongs to the commands.
        for linked in ["\nnalgebra ", "\nnum-dual ", "\ntoml_edit "] {
            assert!(list.contains(linked), "{list}");
        }
        for not_linked in ["\nclap ", "\nplotters ", "\nglidepolar ", "\nserde_json ", "\nstatrs ", "\nnetcdf-reader "]
        {
            assert!(!list.contains(not_linked), "{list}");
        }
        assert!(list.lines().filter(|line| line.contains(": ")).all(|line| !line.ends_with(": ")), "{list}");
        assert!(notice.contains("Permission is hereby granted, free of charge"));
        assert!(notice.contains("Apache License"));
    }
}
