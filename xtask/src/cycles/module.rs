//! The modules of a crate as its files declare them, what each defines and which paths it names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use syn::visit::Visit;
use syn::{Attribute, Item, UseTree, Visibility};

/// Segments of a path as they are written.
pub type Written = Vec<String>;

/// One module, a file or a part of one.
#[derive(Default)]
pub struct Module {
    pub file: PathBuf,
    pub parent: Option<usize>,
    pub children: BTreeMap<String, usize>,
    /// What it defines itself.
    pub items: BTreeSet<String>,
    /// Names brought in by `use`, re-exports included.
    pub uses: BTreeMap<String, Written>,
    /// Modules all of whose names are brought in.
    pub globs: Vec<Written>,
    /// Every path it names, re-exports apart.
    pub paths: Vec<Written>,
}

/// The modules of one crate; the first is its root.
pub struct Tree(pub Vec<Module>);

impl Tree {
    /// Reads a crate from its first file on.
    pub fn read(root: &Path) -> Result<Tree> {
        let mut tree = Tree(Vec::new());
        let folder = root.parent().unwrap_or(Path::new("")).to_owned();
        tree.read_file(root, &folder, None)?;
        Ok(tree)
    }

    /// Reads a file; the files of its modules lie in `folder`.
    fn read_file(&mut self, file: &Path, folder: &Path, parent: Option<usize>) -> Result<usize> {
        let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
        let parsed = syn::parse_file(&text).with_context(|| format!("cannot parse {}", file.display()))?;
        let place = self.add(file, parent);
        self.read_items(place, &parsed.items, folder)?;
        Ok(place)
    }

    fn add(&mut self, file: &Path, parent: Option<usize>) -> usize {
        self.0.push(Module { file: file.to_owned(), parent, ..Module::default() });
        self.0.len() - 1
    }

    fn read_items(&mut self, place: usize, items: &[Item], folder: &Path) -> Result<()> {
        for item in items.iter().filter(|item| !is_test(attributes(item))) {
            if let Item::Mod(module) = item {
                let name = module.ident.to_string();
                let child = match &module.content {
                    Some((_, items)) => {
                        let child = self.add(&self.0[place].file.clone(), Some(place));
                        self.read_items(child, items, &folder.join(&name))?;
                        child
                    }
                    None => self.read_declared(&name, &module.attrs, folder, place)?,
                };
                self.0[place].children.insert(name, child);
                continue;
            }
            if let Item::Use(item) = item {
                let is_private = matches!(item.vis, Visibility::Inherited);
                self.0[place].take_use(&item.tree, &mut Vec::new(), is_private);
                continue;
            }
            self.0[place].items.extend(name(item));
            Paths(&mut self.0[place].paths).visit_item(item);
        }
        Ok(())
    }

    /// The file of `mod name;`, where it lies by the rules of the language.
    fn read_declared(&mut self, name: &str, attributes: &[Attribute], folder: &Path, parent: usize) -> Result<usize> {
        if let Some(file) = path_attribute(attributes) {
            let from = self.0[parent].file.parent().unwrap_or(Path::new("")).join(file);
            let folder = from.parent().unwrap_or(Path::new("")).to_owned();
            return self.read_file(&from, &folder, Some(parent));
        }
        let flat = folder.join(format!("{name}.rs"));
        let file = if flat.is_file() { flat } else { folder.join(name).join("mod.rs") };
        self.read_file(&file, &folder.join(name), Some(parent))
    }
}

impl Module {
    fn take_use(&mut self, tree: &UseTree, before: &mut Written, is_private: bool) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.take_use(&path.tree, before, is_private);
                before.pop();
            }
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.take_use(tree, before, is_private)),
            UseTree::Glob(_) => {
                self.globs.push(before.clone());
                if is_private {
                    self.paths.push(before.clone());
                }
            }
            UseTree::Name(name) => self.take_name(&name.ident.to_string(), &name.ident.to_string(), before, is_private),
            UseTree::Rename(name) => {
                self.take_name(&name.ident.to_string(), &name.rename.to_string(), before, is_private);
            }
        }
    }

    fn take_name(&mut self, name: &str, known_as: &str, before: &Written, is_private: bool) {
        let mut path = before.clone();
        let mut known_as = known_as;
        if name == "self" {
            known_as = before.last().map_or("self", String::as_str);
        } else {
            path.push(name.to_owned());
        }
        if is_private {
            self.paths.push(path.clone());
        }
        self.uses.insert(known_as.to_owned(), path);
    }
}

/// Collects the paths with `::` of what is not a `use`.
struct Paths<'m>(&'m mut Vec<Written>);

impl<'ast> Visit<'ast> for Paths<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if !is_test(attributes(item)) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() && path.segments.len() > 1 {
            self.0.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        syn::visit::visit_path(self, path);
    }

    /// The arguments of a macro are no syntax tree: their paths are read from the words.
    fn visit_macro(&mut self, called: &'ast syn::Macro) {
        let text = called.tokens.to_string();
        let words: Vec<&str> = text.split_whitespace().collect();
        let is_name = |word: &str| !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || c == '_');
        let mut i = 0;
        while i + 2 < words.len() {
            let mut path = Written::new();
            while is_name(words[i])
                && words.get(i + 1) == Some(&"::")
                && words.get(i + 2).is_some_and(|word| is_name(word))
            {
                path.push(words[i].to_owned());
                i += 2;
            }
            if !path.is_empty() {
                path.push(words[i].to_owned());
                self.0.push(path);
            }
            i += 1;
        }
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("test")
            || attribute.path().is_ident("cfg")
                && attribute.parse_args::<syn::Meta>().is_ok_and(|condition| condition.path().is_ident("test"))
    })
}

fn path_attribute(attributes: &[Attribute]) -> Option<String> {
    attributes.iter().find(|attribute| attribute.path().is_ident("path")).and_then(|attribute| match &attribute.meta {
        syn::Meta::NameValue(syn::MetaNameValue {
            value: syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }),
            ..
        }) => Some(text.value()),
        _ => None,
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn name(item: &Item) -> Option<String> {
    let ident = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(ident.to_string())
}
