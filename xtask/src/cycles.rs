//! Whether the files of each crate depend on each other in one direction only.
//!
//! A file depends on another where it names something that the other defines: in a `use`, or in a path with `::`. A
//! re-export (`pub use`) is no dependency, since a module that only collects names needs nothing of what it collects;
//! whoever takes such a name depends on the file that defines it. A module may define what its parts share: a part that
//! takes something from a module around it does not depend on it. Tests may name what they like.

mod graph;
mod module;

use std::path::PathBuf;

use anyhow::{Result, bail};
use serde_json::Value;

use crate::workspace::{Workspace, capture};

/// Reads every library and program of the workspace, but for these packages, and fails where files depend on each other in a
/// circle.
pub fn run(workspace: &Workspace, except: &[String]) -> Result<()> {
    let metadata = capture(workspace.cargo().args(["metadata", "--no-deps", "--format-version", "1"]))?;
    let roots = roots(&serde_json::from_str(&metadata)?, except);
    let mut found = Vec::new();
    let mut n_files = 0;
    for root in &roots {
        let tree = module::Tree::read(root)?;
        let graph = graph::Graph::new(&tree);
        n_files += graph.n_files();
        found.extend(graph.circles().into_iter().map(|circle| described(workspace, &circle)));
    }
    if !found.is_empty() {
        bail!(
            "{} circles of files that depend on each other; move what both need into a file below them:\n{}",
            found.len(),
            found.join("\n")
        );
    }
    eprintln!("{n_files} files of {} libraries and programs: no circle", roots.len());
    Ok(())
}

/// The first file of every library and program.
fn roots(metadata: &Value, except: &[String]) -> Vec<PathBuf> {
    let is_read =
        |package: &&Value| !package["name"].as_str().is_some_and(|name| except.iter().any(|other| other == name));
    let targets = metadata["packages"]
        .as_array()
        .into_iter()
        .flatten()
        .filter(is_read)
        .flat_map(|package| package["targets"].as_array());
    let is_built = |target: &&Value| {
        let kinds = target["kind"].as_array().into_iter().flatten().filter_map(Value::as_str);
        kinds.into_iter().any(|kind| !matches!(kind, "example" | "test" | "bench" | "custom-build"))
    };
    let mut roots: Vec<PathBuf> = targets
        .flatten()
        .filter(is_built)
        .filter_map(|target| target["src_path"].as_str())
        .map(PathBuf::from)
        .collect();
    roots.sort();
    roots.dedup();
    roots
}

fn described(workspace: &Workspace, circle: &[graph::Edge]) -> String {
    let line = |edge: &graph::Edge| {
        let names = edge.names.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
        format!("  {} -> {}: {names}", workspace.shown(&edge.from), workspace.shown(&edge.to))
    };
    format!("circle:\n{}", circle.iter().map(line).collect::<Vec<_>>().join("\n"))
}
