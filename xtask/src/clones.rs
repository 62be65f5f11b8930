//! `cargo xtask clones`: whether two places of the sources say the same at length. What is written twice is corrected
//! once only.
//!
//! Compared are tokens, so that layout and comments do not count. Tests are left out: a test may set out in full what it
//! needs.

mod tokens;

use std::collections::{BTreeSet, HashMap};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use self::tokens::{Token, tokens};
use crate::workspace::Workspace;

/// A run of equal tokens shorter than this is no clone.
const MIN_TOKENS: usize = 100;

/// A run over fewer lines than this is none either: tables and long calls have many tokens to a line.
const MIN_LINES: usize = 12;

/// Folders with sources of what is built, below the checkout's root.
const FOLDERS: [&str; 9] = ["benches", "crates", "examples", "fmu", "fuzz", "src", "tank", "wheel", "xtask"];

/// Fails where two places share [`MIN_LINES`] lines and [`MIN_TOKENS`] tokens or more.
pub fn run(workspace: &Workspace) -> Result<()> {
    let mut files = Vec::new();
    for folder in FOLDERS {
        collect(&workspace.path(folder), &mut files)?;
    }
    files.sort();
    let sources = files
        .iter()
        .map(|file| Ok(tokens(&fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?)))
        .collect::<Result<Vec<_>>>()?;
    let name = |file: usize| workspace.shown(&files[file]).to_string();
    let clones = clones(&sources);
    if !clones.is_empty() {
        let place = |(file, lines): &Place| format!("{}:{}-{}", name(*file), lines.0, lines.1);
        let line = |(one, other): &(Place, Place)| format!("  {} = {}", place(one), place(other));
        bail!(
            "{} places are written twice; let both call one function:\n{}",
            clones.len(),
            clones.iter().map(line).collect::<Vec<_>>().join("\n")
        );
    }
    let n_tokens: usize = sources.iter().map(Vec::len).sum();
    eprintln!("{} files, {n_tokens} tokens: nothing is written twice", files.len());
    Ok(())
}

/// A file, by its number, with a first and a last line.
type Place = (usize, (usize, usize));

/// The pairs of places that are equal, each as long as it goes.
fn clones(sources: &[Vec<Token>]) -> Vec<(Place, Place)> {
    let mut windows: HashMap<u64, Vec<(usize, usize)>> = HashMap::new();
    let mut found = BTreeSet::new();
    for (file, source) in sources.iter().enumerate() {
        let mut at = 0;
        while at + MIN_TOKENS <= source.len() {
            let mut hasher = DefaultHasher::new();
            source[at..at + MIN_TOKENS].iter().for_each(|token| token.hash.hash(&mut hasher));
            let earlier = windows.entry(hasher.finish()).or_default();
            for &(other, start) in earlier.iter() {
                let length = equal_length(&sources[other][start..], &source[at..]);
                // Within one file, a run that repeats itself must not overlap what it repeats.
                let length = if other == file { length.min(at - start) } else { length };
                // The pair that begins one token earlier has it already.
                let is_first = start == 0 || at == 0 || sources[other][start - 1].hash != source[at - 1].hash;
                let (one, two) = (lines(&sources[other][start..], length), lines(&source[at..], length));
                let n_lines = |(first, last): (usize, usize)| last + 1 - first;
                if is_first && length >= MIN_TOKENS && n_lines(one).min(n_lines(two)) >= MIN_LINES {
                    found.insert(((other, one), (file, two)));
                }
            }
            earlier.push((file, at));
            at += 1;
        }
    }
    found.into_iter().collect()
}

fn equal_length(one: &[Token], other: &[Token]) -> usize {
    one.iter().zip(other).take_while(|(a, b)| a.hash == b.hash).count()
}

/// The first and the last line of the first few tokens.
fn lines(tokens: &[Token], length: usize) -> (usize, usize) {
    match &tokens[..length] {
        [first, .., last] => (first.line, last.line),
        _ => (0, 0),
    }
}

/// The sources below a folder, tests and what is built left out.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            if !matches!(name.as_str(), "tests" | "target") {
                collect(&path, files)?;
            }
        } else if name.ends_with(".rs") && name != "tests.rs" {
            files.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A function of some lines, each of nine tokens.
    fn function(name: &str, n_lines: usize) -> String {
        let line = |i| format!("    let x{i} = f({i}, y);\n");
        format!("fn {name}() {{\n{}}}\n", (0..n_lines).map(line).collect::<String>())
    }

    fn found(sources: &[&str]) -> Vec<(Place, Place)> {
        clones(&sources.iter().map(|text| tokens(text)).collect::<Vec<_>>())
    }

    #[test]
    fn what_is_written_twice_is_found_with_its_lines() {
        let (one, other) = (function("one", 13), format!("// A remark.\n\n{}", function("other", 13)));
        assert_eq!(found(&[&one, &other]), [((0, (1, 15)), (1, (3, 17)))]);
        let twice = format!("{one}{}", function("other", 13));
        assert_eq!(found(&[&twice]), [((0, (1, 15)), (0, (16, 30)))]);
    }

    #[test]
    fn layout_and_remarks_do_not_hide_it() {
        let one = function("one", 13);
        let other = one.replace("fn one", "fn other").replace(" = f(", "\n        = f( // so\n");
        assert_eq!(found(&[&one, &other]).len(), 1);
    }

    #[test]
    fn short_runs_and_tests_are_left_alone() {
        assert!(found(&[&function("one", 9), &function("other", 9)]).is_empty());
        let changed = function("other", 13).replace("f(6, y)", "f(6, z)");
        assert!(found(&[&function("one", 13), &changed]).is_empty());
        let long_lines = function("one", 20).replace(";\n", ";");
        assert!(found(&[&long_lines, &long_lines.replace("one", "other")]).is_empty());
        let test = format!("#[cfg(test)]\nmod tests {{\n{}}}\n", function("one", 13));
        assert!(found(&[&test, &test]).is_empty());
    }
}
