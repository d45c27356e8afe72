//! Circles between the files of a crate: what a file needs, and who needs the file, can only be read one after the other
//! if no chain of uses comes back to where it began.
//!
//! The rule. A file uses another one if a path in it, in a `use` line or in the code, leads to something that the other
//! one defines: a type, a function, a constant, a macro's output. Re-exports are followed to where a thing is defined, so
//! that who goes through a `mod.rs` that only declares and re-exports its children uses the child alone, and a `mod.rs`
//! that only declares and re-exports uses nobody. A parent that names what a child defines and a child that names what
//! the parent defines (`super::Thing`) are a circle like any other. A method called on a value is no path and isn't
//! seen. Code under `#[cfg(test)]` doesn't count: a test may look at whoever uses what it tests.

use proc_macro2::{TokenStream, TokenTree};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use syn::{
    Attribute, File, Item, ItemMod, ItemUse, UseTree, Visibility,
    visit::{self, Visit},
};

/// The files of a crate with their text, by path below `src`.
pub(crate) type Sources = BTreeMap<PathBuf, String>;

/// Files that use each other in a circle, and of each pair of them the first use.
#[derive(Debug, PartialEq)]
pub(crate) struct Circle {
    pub(crate) files: Vec<PathBuf>,
    pub(crate) uses: Vec<String>,
}

/// All circles of the crate whose root is `lib.rs`.
pub(crate) fn circles(sources: &Sources) -> Vec<Circle> {
    let tree = Tree::of(sources);
    let mut uses = Vec::new();
    for (place, module) in tree.modules.iter().enumerate() {
        for reference in &module.references {
            if let Some(to) = tree.used_file(place, reference)
                && to != module.file
            {
                uses.push((module.file.clone(), to, reference));
            }
        }
    }
    let mut next: BTreeMap<&Path, BTreeSet<&Path>> = BTreeMap::new();
    for (from, to, _) in &uses {
        next.entry(from).or_default().insert(to);
    }
    let mut seen: BTreeSet<&Path> = BTreeSet::new();
    let mut found = Vec::new();
    for &file in next.keys() {
        let circle: BTreeSet<&Path> =
            reached(&next, file).into_iter().filter(|other| reached(&next, other).contains(file)).collect();
        if circle.is_empty() || seen.contains(file) {
            continue;
        }
        seen.extend(&circle);
        let among = uses.iter().filter(|(from, to, _)| circle.contains(&**from) && circle.contains(&**to));
        let mut first: BTreeMap<(&Path, &Path), &Reference> = BTreeMap::new();
        for (from, to, reference) in among {
            first.entry((from, to)).or_insert(reference);
        }
        let lines = first.into_iter().map(|((from, to), reference)| {
            let path = reference.path.join("::");
            format!("{}:{} uses {path} of {}", from.display(), reference.line, to.display())
        });
        found.push(Circle { files: circle.into_iter().map(Path::to_owned).collect(), uses: lines.collect() });
    }
    found
}

/// Everything that can be reached from `start` by one step or more.
fn reached<'a>(next: &BTreeMap<&'a Path, BTreeSet<&'a Path>>, start: &Path) -> BTreeSet<&'a Path> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&Path> = vec![start];
    while let Some(file) = open.pop() {
        for &other in next.get(file).into_iter().flatten() {
            if reached.insert(other) {
                open.push(other);
            }
        }
    }
    reached
}

/// A path as it stands in a file.
#[derive(Debug, Clone)]
struct Reference {
    path: Vec<String>,
    line: usize,
    /// Whether it ends in `*`.
    is_glob: bool,
}

/// A module: a file, or a part of one in braces.
#[derive(Default)]
struct Module {
    file: PathBuf,
    parent: Option<usize>,
    children: BTreeMap<String, usize>,
    defined: BTreeSet<String>,
    /// Names that `use` lines bring in.
    imported: BTreeMap<String, Vec<String>>,
    /// Modules of which `use` lines bring in all names.
    globs: Vec<Vec<String>>,
    /// Paths that count as a use.
    references: Vec<Reference>,
}

/// Target of a path.
enum Target {
    Module(usize),
    /// Something that a module defines.
    Thing(usize),
}

/// How often a path may go from one `use` line to the next.
const MAX_STEPS: usize = 16;

/// The modules of a crate, the root first.
struct Tree {
    modules: Vec<Module>,
}

impl Tree {
    fn of(sources: &Sources) -> Self {
        let mut tree = Self { modules: Vec::new() };
        tree.add_file(sources, Path::new("lib.rs"), None);
        tree
    }

    fn add_file(&mut self, sources: &Sources, file: &Path, parent: Option<usize>) -> usize {
        let parsed: File =
            syn::parse_file(&sources[file]).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let folder = file.parent().unwrap_or(Path::new(""));
        let stem = file.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
        let below = if matches!(stem, "lib" | "mod") { folder.to_owned() } else { folder.join(stem) };
        self.add(sources, file, &below, parent, &parsed.items)
    }

    /// Adds a module of these items whose children's files lie in the folder `below`.
    fn add(&mut self, sources: &Sources, file: &Path, below: &Path, parent: Option<usize>, items: &[Item]) -> usize {
        let place = self.modules.len();
        self.modules.push(Module { file: file.to_owned(), parent, ..Module::default() });
        let mut reader = Reader::default();
        for item in items {
            reader.visit_item(item);
        }
        for item in reader.inner {
            let name = item.ident.to_string();
            let child = match &item.content {
                Some((_, items)) => self.add(sources, file, &below.join(&name), Some(place), items),
                None => {
                    let files = [below.join(format!("{name}.rs")), below.join(&name).join("mod.rs")];
                    let inner = files.iter().find(|file| sources.contains_key(*file));
                    let inner = inner.unwrap_or_else(|| panic!("{}: `mod {name}` has no file", file.display()));
                    self.add_file(sources, inner, Some(place))
                }
            };
            self.modules[place].children.insert(name, child);
        }
        let Reader { defined, imported, globs, references, .. } = reader;
        let module = &mut self.modules[place];
        (module.defined, module.imported, module.globs, module.references) = (defined, imported, globs, references);
        place
    }

    /// The file that defines what `reference` leads to; `None` if that is a module or lies in another crate.
    fn used_file(&self, from: usize, reference: &Reference) -> Option<PathBuf> {
        let module = match self.resolve(from, &reference.path, MAX_STEPS)? {
            // All names of a module that defines some.
            Target::Module(module) if reference.is_glob && !self.modules[module].defined.is_empty() => module,
            Target::Module(_) => return None,
            Target::Thing(module) => module,
        };
        Some(self.modules[module].file.clone())
    }

    fn resolve(&self, from: usize, path: &[String], steps: usize) -> Option<Target> {
        let (first, rest) = path.split_first()?;
        let start = match first.as_str() {
            "crate" => Target::Module(0),
            "self" => Target::Module(from),
            "super" => Target::Module(self.modules[from].parent?),
            name => self.named(from, name, steps)?,
        };
        rest.iter().try_fold(start, |target, name| match target {
            Target::Module(module) if name == "super" => Some(Target::Module(self.modules[module].parent?)),
            // Items made by a macro have no name here.
            Target::Module(module) => Some(self.named(module, name, steps).unwrap_or(Target::Thing(module))),
            // An enum's variant, a type's function.
            thing => Some(thing),
        })
    }

    /// Resolves `name` in a module.
    fn named(&self, module: usize, name: &str, steps: usize) -> Option<Target> {
        let steps = steps.checked_sub(1)?;
        let Module { children, defined, imported, globs, .. } = &self.modules[module];
        if let Some(child) = children.get(name) {
            return Some(Target::Module(*child));
        }
        if defined.contains(name) {
            return Some(Target::Thing(module));
        }
        if let Some(path) = imported.get(name) {
            // `use name::..` of another crate brings in a name that leads back to itself.
            return self.resolve(module, path, steps);
        }
        globs.iter().find_map(|glob| match self.resolve(module, glob, steps)? {
            Target::Module(other) if other != module => self.named(other, name, steps),
            _ => None,
        })
    }
}

/// Reads what a module defines, brings in and uses; modules within it are left for later.
#[derive(Default)]
struct Reader<'a> {
    inner: Vec<&'a ItemMod>,
    defined: BTreeSet<String>,
    imported: BTreeMap<String, Vec<String>>,
    globs: Vec<Vec<String>>,
    references: Vec<Reference>,
}

impl Reader<'_> {
    fn import(&mut self, tree: &UseTree, before: &[String], is_reexport: bool) {
        let with = |name: &proc_macro2::Ident| before.iter().cloned().chain([name.to_string()]).collect::<Vec<_>>();
        let mut used = |path: Vec<String>, span: proc_macro2::Span, is_glob| {
            if !is_reexport {
                self.references.push(Reference { path, line: span.start().line, is_glob });
            }
        };
        match tree {
            UseTree::Path(path) => self.import(&path.tree, &with(&path.ident), is_reexport),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.import(tree, before, is_reexport)),
            // `use a::b::{self}`.
            UseTree::Name(name) if name.ident == "self" => {
                if let Some(last) = before.last() {
                    self.imported.insert(last.clone(), before.to_vec());
                }
            }
            UseTree::Name(name) => {
                let path = with(&name.ident);
                used(path.clone(), name.ident.span(), false);
                self.imported.insert(name.ident.to_string(), path);
            }
            UseTree::Rename(name) => {
                let path = if name.ident == "self" { before.to_vec() } else { with(&name.ident) };
                used(path.clone(), name.ident.span(), false);
                self.imported.insert(name.rename.to_string(), path);
            }
            UseTree::Glob(glob) => {
                used(before.to_vec(), glob.star_token.spans[0], true);
                self.globs.push(before.to_vec());
            }
        }
    }

    /// Paths within what a macro is given, which is not parsed.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        let mut line = 0;
        let mut flush = |path: &mut Vec<String>, line| {
            if !path.is_empty() {
                self.references.push(Reference { path: std::mem::take(path), line, is_glob: false });
            }
        };
        let mut groups = Vec::new();
        for token in tokens {
            match token {
                TokenTree::Ident(name) => {
                    if colons != 2 {
                        flush(&mut path, line);
                        line = name.span().start().line;
                    }
                    path.push(name.to_string());
                    colons = 0;
                }
                TokenTree::Punct(sign) if sign.as_char() == ':' => colons += 1,
                other => {
                    flush(&mut path, line);
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        groups.push(group.stream());
                    }
                }
            }
        }
        flush(&mut path, line);
        groups.into_iter().for_each(|tokens| self.tokens(tokens));
    }
}

/// Whether an item is there in tests only.
fn is_test(attributes: &[Attribute]) -> bool {
    let is_test = |attribute: &Attribute| {
        attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Path>().is_ok_and(|it| it.is_ident("test"))
    };
    attributes.iter().any(is_test)
}

impl<'a> Visit<'a> for Reader<'a> {
    fn visit_item(&mut self, item: &'a Item) {
        let (attributes, name) = match item {
            Item::Const(it) => (&it.attrs, Some(&it.ident)),
            Item::Enum(it) => (&it.attrs, Some(&it.ident)),
            Item::Fn(it) => (&it.attrs, Some(&it.sig.ident)),
            Item::Impl(it) => (&it.attrs, None),
            Item::Macro(it) => (&it.attrs, it.ident.as_ref()),
            Item::Mod(it) => (&it.attrs, None),
            Item::Static(it) => (&it.attrs, Some(&it.ident)),
            Item::Struct(it) => (&it.attrs, Some(&it.ident)),
            Item::Trait(it) => (&it.attrs, Some(&it.ident)),
            Item::Type(it) => (&it.attrs, Some(&it.ident)),
            Item::Use(it) => (&it.attrs, None),
            _ => panic!("an item that the rule doesn't know"),
        };
        if is_test(attributes) {
            return;
        }
        self.defined.extend(name.map(ToString::to_string));
        visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, item: &'a ItemMod) {
        self.inner.push(item);
    }

    fn visit_item_use(&mut self, item: &'a ItemUse) {
        self.import(&item.tree, &[], !matches!(item.vis, Visibility::Inherited));
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        if let Some(first) = path.segments.first().filter(|_| path.leading_colon.is_none()) {
            let names = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            self.references.push(Reference { path: names, line: first.ident.span().start().line, is_glob: false });
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'a syn::Macro) {
        self.tokens(call.tokens.clone());
        visit::visit_macro(self, call);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The files of each circle of a made-up crate.
    fn found(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let sources = files.iter().map(|(path, text)| (PathBuf::from(path), (*text).to_owned())).collect();
        let names = |circle: Circle| circle.files.iter().map(|file| file.display().to_string()).collect();
        circles(&sources).into_iter().map(names).collect()
    }

    #[test]
    fn two_files_that_use_each_other_are_a_circle_and_its_lines_are_named() {
        let sources = Sources::from([
            ("lib.rs".into(), "mod a;\nmod b;\nmod c;\n".into()),
            ("a.rs".into(), "use crate::{c::{self, C}, b::B};\npub struct A(B, C);\n".into()),
            ("b.rs".into(), "\nuse super::a::A;\npub struct B(Box<A>);".into()),
            ("c.rs".into(), "pub struct C;".into()),
        ]);
        let [circle] = &circles(&sources)[..] else { panic!("one circle") };
        assert_eq!(circle.files, [Path::new("a.rs"), Path::new("b.rs")]);
        assert!(circle.uses.contains(&"a.rs:1 uses crate::b::B of b.rs".to_owned()), "{:?}", circle.uses);
        assert!(circle.uses.contains(&"b.rs:2 uses super::a::A of a.rs".to_owned()), "{:?}", circle.uses);
    }

    #[test]
    fn a_chain_that_comes_back_is_one() {
        let files = [
            ("lib.rs", "mod a; mod b; mod c;"),
            ("a.rs", "pub fn a() { crate::b::b() }"),
            ("b.rs", "use crate::c; pub fn b() { c::c() }"),
            ("c.rs", "pub fn c() { println!(\"{}\", crate::a::a()) }"),
        ];
        assert_eq!(found(&files), [["a.rs", "b.rs", "c.rs"]]);
        assert!(found(&files[..3].iter().copied().chain([("c.rs", "pub fn c() {}")]).collect::<Vec<_>>()).is_empty());
    }

    #[test]
    fn a_parent_and_a_child_are_one_if_both_name_what_the_other_defines() {
        let child = ("a/b.rs", "use super::Thing; pub fn b(_: Thing) {}");
        for parent in [
            "mod b; pub struct Thing; fn f() { b::b(Thing) }",
            "mod b; use b::b; pub struct Thing; fn f() { b(Thing) }",
        ] {
            assert_eq!(found(&[("lib.rs", "mod a;"), ("a/mod.rs", parent), child]), [["a/b.rs", "a/mod.rs"]]);
        }
        // One that only re-exports uses nobody; what it defines may be used.
        let parent = "mod b; pub use b::b; pub struct Thing;";
        assert!(found(&[("lib.rs", "mod a; pub use a::*;"), ("a.rs", parent), child]).is_empty());
        let root = ("lib.rs", "mod a; pub const ONE: u32 = 1; pub fn f() { a::f() }");
        assert_eq!(found(&[root, ("a.rs", "pub fn f() -> u32 { crate::ONE }")]), [["a.rs", "lib.rs"]]);
    }

    #[test]
    fn re_exports_are_followed_to_where_a_thing_is_defined() {
        let root = ("lib.rs", "mod a; mod b; pub use a::*; pub use b::{B as Bee, b};");
        let a = "pub mod inner; pub use inner::A;";
        let files = |inner: &'static str, b: &'static str| [root, ("a/mod.rs", a), ("a/inner.rs", inner), ("b.rs", b)];
        let inner = "use crate::Bee; pub struct A(Bee);";
        assert_eq!(found(&files(inner, "pub struct B; pub fn b(_: crate::A) {}")), [["a/inner.rs", "b.rs"]]);
        assert!(found(&files(inner, "pub struct B; pub fn b() {}")).is_empty());
        // Names of all that is in a module.
        assert_eq!(
            found(&files("use crate::b::*; pub struct A;", "use crate::A; pub struct B(A); pub fn b() {}")).len(),
            1
        );
    }

    #[test]
    fn tests_other_crates_and_modules_in_braces_make_none() {
        let files = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "use b::B; use std::fmt; pub struct A; #[cfg(test)] mod tests { use crate::b::B; }"),
            (
                "b.rs",
                "use crate::a::A; pub struct B(A); mod inner { use super::B; fn f(_: B) {} } fn g() { inner::f() }",
            ),
        ];
        assert!(found(&files).is_empty());
    }
}
