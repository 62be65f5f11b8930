//! Which file needs which, and the circles among them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::module::{Module, Tree};

/// How many names are followed from re-export to re-export.
const MAX_HOPS: usize = 16;

/// One file that needs another, and the names that it takes from it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edge {
    pub from: PathBuf,
    pub to: PathBuf,
    pub names: BTreeSet<String>,
}

/// The files of a crate and what they need of each other.
pub struct Graph {
    files: BTreeSet<PathBuf>,
    needs: BTreeMap<(PathBuf, PathBuf), BTreeSet<String>>,
}

impl Graph {
    /// The graph of a crate's modules.
    pub fn new(tree: &Tree) -> Graph {
        let mut needs: BTreeMap<(PathBuf, PathBuf), BTreeSet<String>> = BTreeMap::new();
        for (place, module) in tree.0.iter().enumerate() {
            for path in &module.paths {
                let Some(target) = defined_in(tree, place, path, MAX_HOPS) else { continue };
                let to = &tree.0[target].file;
                if *to != module.file && !is_ancestor(tree, target, place) {
                    let names = needs.entry((module.file.clone(), to.clone())).or_default();
                    names.extend(path.last().cloned());
                }
            }
        }
        Graph { files: tree.0.iter().map(|module| module.file.clone()).collect(), needs }
    }

    /// How many files there are.
    pub fn n_files(&self) -> usize {
        self.files.len()
    }

    /// The circles, each with everything that its files take from each other.
    pub fn circles(&self) -> Vec<Vec<Edge>> {
        let reached: BTreeMap<&Path, BTreeSet<&Path>> =
            self.files.iter().map(|file| (file.as_path(), self.reached_from(file))).collect();
        let are_mutual = |a: &Path, b: &Path| reached[a].contains(b) && reached[b].contains(a);
        let mut listed: BTreeSet<&Path> = BTreeSet::new();
        let mut circles = Vec::new();
        for file in &self.files {
            if !reached[file.as_path()].contains(file.as_path()) || listed.contains(file.as_path()) {
                continue;
            }
            let members: BTreeSet<&Path> =
                self.files.iter().map(PathBuf::as_path).filter(|other| are_mutual(file, other)).collect();
            let inside = self
                .needs
                .iter()
                .filter(|((from, to), _)| members.contains(from.as_path()) && members.contains(to.as_path()));
            let edge = |((from, to), names): (&(PathBuf, PathBuf), &BTreeSet<String>)| Edge {
                from: from.clone(),
                to: to.clone(),
                names: names.clone(),
            };
            circles.push(inside.map(edge).collect());
            listed.extend(members);
        }
        circles
    }

    /// The files that a file needs, directly or by others.
    fn reached_from<'g>(&'g self, file: &'g Path) -> BTreeSet<&'g Path> {
        let mut reached: BTreeSet<&Path> = BTreeSet::new();
        let mut next = vec![file];
        while let Some(from) = next.pop() {
            let needed = self.needs.keys().filter(|(user, _)| user == from).map(|(_, to)| to.as_path());
            next.extend(needed.filter(|to| reached.insert(to)));
        }
        reached
    }
}

/// Whether a module lies inside another: a module may define what its parts share.
fn is_ancestor(tree: &Tree, outer: usize, inner: usize) -> bool {
    let parents = std::iter::successors(tree.0[inner].parent, |place| tree.0[*place].parent);
    parents.into_iter().any(|place| tree.0[place].file == tree.0[outer].file)
}

/// The module that defines what a path names, as seen from a module; none where it is of another crate.
fn defined_in(tree: &Tree, from: usize, path: &[String], hops: usize) -> Option<usize> {
    let hops = hops.checked_sub(1)?;
    let (first, mut rest) = path.split_first()?;
    let module = &tree.0[from];
    let mut here = match first.as_str() {
        "crate" => 0,
        "self" => from,
        "super" => module.parent?,
        name if module.children.contains_key(name) => module.children[name],
        name => {
            let used = module.uses.get(name).filter(|used| used.first() != Some(first) || used.len() > 1)?;
            let whole: Vec<String> = used.iter().chain(rest).cloned().collect();
            return defined_in(tree, from, &whole, hops);
        }
    };
    while let Some((segment, after)) = rest.split_first() {
        let module = &tree.0[here];
        here = match segment.as_str() {
            "super" => module.parent?,
            name if module.children.contains_key(name) => module.children[name],
            name => return named_in(tree, here, module, name, after, hops).or(Some(here)),
        };
        rest = after;
    }
    Some(here)
}

/// The module that defines a name which a module knows, by its own definition or by a re-export.
fn named_in(tree: &Tree, here: usize, module: &Module, name: &str, after: &[String], hops: usize) -> Option<usize> {
    if module.items.contains(name) {
        return Some(here);
    }
    if let Some(used) = module.uses.get(name) {
        let whole: Vec<String> = used.iter().chain(after).cloned().collect();
        return defined_in(tree, here, &whole, hops);
    }
    let by_glob = |glob: &Vec<String>| {
        let target = defined_in(tree, here, glob, hops)?;
        tree.0[target].items.contains(name).then_some(target)
    };
    module.globs.iter().find_map(by_glob)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// The circles of a crate of these files, as the names of the files that take part.
    fn circles(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let graph = Graph::new(&Tree::read(&folder.path().join("lib.rs")).unwrap());
        let name = |file: &Path| file.strip_prefix(folder.path()).unwrap().display().to_string();
        let members = |circle: Vec<Edge>| {
            let names: BTreeSet<String> = circle.iter().flat_map(|edge| [name(&edge.from), name(&edge.to)]).collect();
            names.into_iter().collect()
        };
        graph.circles().into_iter().map(members).collect()
    }

    #[test]
    fn two_files_that_need_each_other_are_a_circle_by_whatever_path() {
        let lib = ("lib.rs", "mod a; mod b; pub use b::B;");
        let b = ("b.rs", "use super::a::helper; pub struct B; fn f() { helper() }");
        for a in [
            "use super::b::B; pub fn helper() {}",
            "use crate::B; pub fn helper() {}",
            "pub fn helper() { let _ = crate::b::B; }",
            "pub fn helper() { println!(\"{:?}\", super::b::B); }",
        ] {
            assert_eq!(circles(&[lib, ("a.rs", a), b]), [["a.rs", "b.rs"]], "{a}");
        }
    }

    #[test]
    fn a_circle_may_be_long() {
        let files = [
            ("lib.rs", "mod a; mod b; mod c; mod d;"),
            ("a.rs", "use crate::b::x; pub fn w() { x() }"),
            ("b.rs", "use crate::c::y; pub fn x() { y() }"),
            ("c.rs", "use crate::a::w; pub fn y() { w() }"),
            ("d.rs", "use crate::a::w;"),
        ];
        assert_eq!(circles(&files), [["a.rs", "b.rs", "c.rs"]]);
    }

    #[test]
    fn a_module_that_collects_names_needs_none_of_them() {
        let files = [
            ("lib.rs", "pub mod part;"),
            ("part/mod.rs", "mod one; mod two; pub use one::One; pub use two::*;"),
            ("part/one.rs", "use super::Two; pub struct One(Two);"),
            ("part/two.rs", "pub struct Two;"),
        ];
        assert!(circles(&files).is_empty());
        // What it defines itself its parts may share.
        let files = [
            ("lib.rs", "pub mod part;"),
            ("part/mod.rs", "mod one; pub use one::One; pub struct Two; fn f() -> one::One { one::One(Two) }"),
            ("part/one.rs", "use super::Two; pub struct One(pub Two);"),
        ];
        assert!(circles(&files).is_empty());
        // Whoever else needs the module and is needed by a part of it stands in a circle.
        let files = [
            ("lib.rs", "pub mod other; pub mod part;"),
            ("other.rs", "use crate::part::Two; pub struct Three(Two);"),
            ("part/mod.rs", "mod one; pub struct Two(one::One);"),
            ("part/one.rs", "use crate::other::Three; pub struct One(Box<Three>);"),
        ];
        assert_eq!(circles(&files), [["other.rs", "part/mod.rs", "part/one.rs"]]);
    }

    #[test]
    fn tests_may_name_what_they_like() {
        let files = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "pub struct A; #[cfg(test)] mod tests { use crate::b::B; }"),
            ("b.rs", "use crate::a::A; pub struct B(A);"),
        ];
        assert!(circles(&files).is_empty());
    }
}
