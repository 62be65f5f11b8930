//! `cargo xtask dependencies`: whether all that the project is built from may be built from, by licence and by source, and
//! whether the lists of it are up to date.
//!
//! Known vulnerabilities are another question: `cargo audit` answers it with a database that it downloads.

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::workspace::{Workspace, capture};

/// The manifests with a list of packages of their own. Only the first is of what is given to others.
const MANIFESTS: [&str; 3] = ["Cargo.toml", "tests/importers/Cargo.toml", "fuzz/libfuzzer/Cargo.toml"];

/// Licences under which a package may be linked into what is given to others: they ask for no more than their own text.
const ALLOWED: [&str; 9] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "MIT",
    "Unicode-3.0",
    "Zlib",
];

/// Where packages come from.
const SOURCE: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// Fails where a list of packages is out of date, or names a package of another source or licence.
pub fn run(workspace: &Workspace) -> Result<()> {
    let mut faults = Vec::new();
    let mut n_packages = 0;
    for (number, manifest) in MANIFESTS.into_iter().enumerate() {
        let arguments = ["metadata", "--locked", "--format-version=1", "--manifest-path", manifest];
        let metadata: Value = serde_json::from_str(&capture(workspace.cargo().args(arguments))?)?;
        for package in metadata["packages"].as_array().context("cargo metadata lists no packages")? {
            n_packages += 1;
            faults.extend(fault(package, number == 0).map(|fault| format!("  {manifest}: {fault}")));
        }
    }
    if !faults.is_empty() {
        bail!("{} packages may not be used:\n{}", faults.len(), faults.join("\n"));
    }
    eprintln!("{n_packages} packages: sources known, lists up to date, licences of what is given to others allowed");
    Ok(())
}

/// What is wrong with a package that comes from elsewhere.
fn fault(package: &Value, is_given_to_others: bool) -> Option<String> {
    let source = package["source"].as_str()?;
    let title = format!("{} {}", package["name"].as_str()?, package["version"].as_str()?);
    let licence = package["license"].as_str().unwrap_or("none stated");
    if source != SOURCE {
        return Some(format!("{title} comes from {source}, not from crates.io"));
    }
    (is_given_to_others && !is_allowed(licence)).then(|| format!("{title} has the licence {licence}"))
}

/// Whether an SPDX expression (`A OR B`, `(A OR B) AND C`, the old `A/B`) leaves a choice that is allowed.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.trim();
    let parts = |separator: &str| at_top_level(expression, separator);
    if let Some((one, other)) = parts(" OR ").or_else(|| parts("/")) {
        return is_allowed(one) || is_allowed(other);
    }
    if let Some((one, other)) = parts(" AND ") {
        return is_allowed(one) && is_allowed(other);
    }
    match expression.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')) {
        Some(inner) => is_allowed(inner),
        None => ALLOWED.contains(&expression),
    }
}

/// An expression before and behind the first separator that stands in no brackets.
fn at_top_level<'e>(expression: &'e str, separator: &str) -> Option<(&'e str, &'e str)> {
    let is_open = |text: &str| text.matches('(').count() > text.matches(')').count();
    let place = expression.match_indices(separator).map(|(place, _)| place).find(|at| !is_open(&expression[..*at]))?;
    Some((&expression[..place], &expression[place + separator.len()..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_licence_is_allowed_where_one_choice_of_it_is() {
        for allowed in [
            "MIT",
            "Unlicense/MIT",
            "MIT OR Apache-2.0 OR LGPL-2.1-or-later",
            "(MIT OR GPL-3.0) AND Unicode-3.0",
            "(MIT AND Zlib)",
            "Apache-2.0 WITH LLVM-exception OR GPL-2.0",
        ] {
            assert!(is_allowed(allowed), "{allowed}");
        }
        for other in ["GPL-3.0", "MIT AND GPL-3.0", "MPL-2.0", "(MIT OR Apache-2.0) AND MPL-2.0", "", "none stated"] {
            assert!(!is_allowed(other), "{other}");
        }
    }

    #[test]
    fn a_package_of_another_source_is_a_fault() {
        let package =
            |source: Value| serde_json::json!({"name": "x", "version": "1.0.0", "license": "MIT", "source": source});
        assert_eq!(fault(&package(Value::Null), true), None);
        assert_eq!(fault(&package(SOURCE.into()), true), None);
        assert!(fault(&package("git+https://example.org/x".into()), false).is_some_and(|text| text.contains("git+")));
    }
}
