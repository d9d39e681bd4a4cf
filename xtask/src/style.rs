//! Countable rules of style: first words of doc comments, names of functions and types, lengths, and circular imports
//! of files. `cargo xtask style` prints every violation; `xtask/tests/style.rs` limits the counts.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

/// Words with which no doc comment begins, because a noun phrase or a verb belongs there.
const RIDDLES: [&str; 13] = [
    "What", "Who", "Whom", "Whose", "Which", "Whether", "Where", "When", "Why", "How", "Those", "That",
    "The same",
];

/// Prepositions that are not the name of a function, neither alone nor as its first word.
const NO_FIRST_WORDS: [&str; 24] = [
    "of", "at", "by", "on", "off", "for", "than", "beside", "within", "across", "between", "beyond",
    "around", "along", "beneath", "above", "below", "under", "over", "through", "against", "until", "since",
    "among",
];

/// Words that are not the name of a function when they stand alone.
const NO_NAMES: [&str; 51] = [
    "own", "told", "said", "made", "kept", "given", "taken", "wanted", "drawn", "found", "whole", "asked",
    "left", "shown", "known", "gone", "held", "met", "written", "chosen", "seen", "done", "heard", "brought",
    "joined", "gathered", "sorted", "ordered", "counted", "measured", "shifted", "scaled", "moved", "used",
    "called", "named", "placed", "packed", "unpacked", "laid", "thinned", "turned", "stated", "needed",
    "checked", "prepared", "computed", "added", "removed", "noted", "outs",
];

/// Largest number of characters of a line of Markdown that is not a row of a table.
pub const MARKDOWN_WIDTH: usize = 120;
/// Largest number of lines of a function, from its signature to its closing brace.
pub const FUNCTION_LINES: usize = 80;
/// Largest number of arguments of a function, without `self`.
pub const ARGUMENTS: usize = 6;
/// Largest number of modules that define a type of one name.
pub const SAME_TYPE_NAMES: usize = 2;

/// Violations of the rules, one line of text each, by rule.
#[derive(Debug, Default)]
pub struct Violations {
    /// Doc comments that begin with What, Which, Whether and the like.
    pub doc_riddles: Vec<String>,
    /// Number of all doc comments.
    pub n_doc_comments: usize,
    /// Lines of Markdown that are too long.
    pub long_markdown: Vec<String>,
    /// Functions named by a preposition or a participle.
    pub function_names: Vec<String>,
    /// Names of types that too many modules define.
    pub type_names: Vec<String>,
    /// Parameters that are tuples.
    pub tuple_parameters: Vec<String>,
    /// Functions with too many arguments.
    pub many_arguments: Vec<String>,
    /// Functions with too many lines.
    pub long_functions: Vec<String>,
    /// Groups of files of one crate that import each other in a circle and lie in more than one folder.
    pub import_cycles: Vec<String>,
}

impl Violations {
    /// Share of doc comments that begin with What, Which, Whether and the like, in [0, 1].
    pub fn riddle_share(&self) -> f64 {
        self.doc_riddles.len() as f64 / self.n_doc_comments.max(1) as f64
    }

    /// Names of all rules, with their violations.
    pub fn rules(&self) -> [(&'static str, &[String]); 8] {
        [
            ("doc comments that begin with What/Who/Which/…", &self.doc_riddles),
            ("Markdown lines over 120 characters", &self.long_markdown),
            ("functions named by a preposition or participle", &self.function_names),
            ("type names defined in more than two modules", &self.type_names),
            ("tuple parameters", &self.tuple_parameters),
            ("functions with more than six arguments", &self.many_arguments),
            ("functions over 80 lines", &self.long_functions),
            ("import cycles larger than a folder", &self.import_cycles),
        ]
    }
}

/// Checks all tracked files below `folder`, a folder of the repository `root`.
///
/// # Errors
/// A line of text if git does not list the files, or if a file cannot be read or parsed.
pub fn check(root: &Path, folder: &str) -> Result<Violations, String> {
    let listing = std::process::Command::new("git")
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard", "--", folder])
        .current_dir(root)
        .output()
        .map_err(|e| format!("cannot run git: {e}"))?;
    let listing = String::from_utf8_lossy(&listing.stdout).into_owned();
    let mut violations = Violations::default();
    let mut types: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut crates: BTreeMap<PathBuf, Vec<(PathBuf, syn::File)>> = BTreeMap::new();
    for name in listing.split('\0').filter(|name| !name.is_empty()) {
        let path = root.join(name);
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        if !matches!(extension, "rs" | "md" | "ts" | "py") || name.contains("/dist/") || !path.is_file() {
            continue;
        }
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{name}: {e}"))?;
        match extension {
            "md" => check_markdown(name, &text, &mut violations),
            "rs" => {
                check_doc_comments(name, &text, &mut violations);
                let parsed = syn::parse_file(&text).map_err(|e| format!("{name}: {e}"))?;
                if is_test_path(name) {
                    continue;
                }
                let mut visitor = Items { name, violations: &mut violations, types: &mut types };
                visitor.visit_file(&parsed);
                if let Some((package, _)) = name.split_once("/src/") {
                    crates.entry(PathBuf::from(package)).or_default().push((PathBuf::from(name), parsed));
                }
            }
            _ => check_doc_comments(name, &text, &mut violations),
        }
    }
    for (name, files) in types {
        if files.len() > SAME_TYPE_NAMES {
            let files: Vec<String> = files.into_iter().collect();
            violations.type_names.push(format!("{name}: {} modules: {}", files.len(), files.join(" ")));
        }
    }
    for (package, files) in crates {
        violations.import_cycles.extend(import_cycles(&package, &files));
    }
    Ok(violations)
}

fn is_test_path(name: &str) -> bool {
    name.contains("/tests/")
        || name.ends_with("/tests.rs")
        || name.contains("/benches/")
        || name.contains("/examples/")
}

fn check_markdown(name: &str, text: &str, violations: &mut Violations) {
    for (k, line) in text.lines().enumerate() {
        let length = line.chars().count();
        if length > MARKDOWN_WIDTH && !line.trim_start().starts_with('|') {
            violations.long_markdown.push(format!("{name}:{}: {length} characters", k + 1));
        }
    }
}

/// Counts doc comments (`///`, `//!`, `/** */` and docstrings of Python), and lists those that begin with one of
/// [`RIDDLES`].
fn check_doc_comments(name: &str, text: &str, violations: &mut Violations) {
    let extension = Path::new(name).extension().and_then(|e| e.to_str()).unwrap_or_default();
    let is_rust = extension == "rs";
    let mut marker_before = "";
    for (k, line) in text.lines().enumerate() {
        let line = line.trim_start();
        let marker = match line {
            _ if is_rust && line.starts_with("///") => "///",
            _ if is_rust && line.starts_with("//!") => "//!",
            _ if extension == "ts" && line.starts_with("/**") => "/**",
            _ if extension == "py" && line.starts_with("\"\"\"") && line.len() > 3 => "\"\"\"",
            _ => "",
        };
        let begins = !marker.is_empty() && (marker != marker_before || !is_rust);
        marker_before = marker;
        if !begins {
            continue;
        }
        let sentence = line[marker.len()..].trim_start();
        violations.n_doc_comments += 1;
        let is_riddle = RIDDLES.iter().any(|word| {
            sentence.strip_prefix(word).is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()))
        });
        if is_riddle {
            violations.doc_riddles.push(format!("{name}:{}: {sentence}", k + 1));
        }
    }
}

/// Visitor of the items of one file, without its tests.
struct Items<'a> {
    name: &'a str,
    violations: &'a mut Violations,
    types: &'a mut BTreeMap<String, BTreeSet<String>>,
}

fn is_for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|a| {
        let path = a.path();
        path.is_ident("test")
            || path.segments.last().is_some_and(|s| s.ident == "data_test")
            || (path.is_ident("cfg") && a.parse_args::<syn::Ident>().is_ok_and(|i| i == "test"))
    })
}

impl Items<'_> {
    fn check_function(&mut self, signature: &syn::Signature, span: proc_macro2::Span) {
        let name = signature.ident.to_string();
        let place = format!("{}:{}: {name}", self.name, signature.ident.span().start().line);
        let first = name.split('_').next().unwrap_or_default();
        if NO_FIRST_WORDS.contains(&first) || NO_NAMES.contains(&name.as_str()) {
            self.violations.function_names.push(place.clone());
        }
        let arguments = signature.inputs.iter().filter_map(|input| match input {
            syn::FnArg::Typed(argument) => Some(&*argument.ty),
            syn::FnArg::Receiver(_) => None,
        });
        for ty in arguments.clone() {
            let ty = if let syn::Type::Reference(reference) = ty { &*reference.elem } else { ty };
            if matches!(ty, syn::Type::Tuple(tuple) if !tuple.elems.is_empty()) {
                self.violations.tuple_parameters.push(place.clone());
            }
        }
        let n = arguments.count();
        if n > ARGUMENTS {
            self.violations.many_arguments.push(format!("{place}: {n} arguments"));
        }
        let lines = span.end().line + 1 - signature.fn_token.span.start().line;
        if lines > FUNCTION_LINES && !self.name.contains("/adwave-reproduce/") {
            self.violations.long_functions.push(format!("{place}: {lines} lines"));
        }
    }

    fn add_type(&mut self, ident: &syn::Ident) {
        self.types.entry(ident.to_string()).or_default().insert(self.name.to_owned());
    }
}

impl<'ast> Visit<'ast> for Items<'_> {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_for_tests(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }
    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if !is_for_tests(&item.attrs) {
            self.check_function(&item.sig, item.span());
            visit::visit_item_fn(self, item);
        }
    }
    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if !is_for_tests(&item.attrs) {
            self.check_function(&item.sig, item.span());
            visit::visit_impl_item_fn(self, item);
        }
    }
    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        self.check_function(&item.sig, item.span());
        visit::visit_trait_item_fn(self, item);
    }
    fn visit_item_struct(&mut self, item: &'ast syn::ItemStruct) {
        self.add_type(&item.ident);
    }
    fn visit_item_enum(&mut self, item: &'ast syn::ItemEnum) {
        self.add_type(&item.ident);
    }
    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        self.add_type(&item.ident);
        visit::visit_item_trait(self, item);
    }
    fn visit_item_type(&mut self, item: &'ast syn::ItemType) {
        self.add_type(&item.ident);
    }
}

/// Path of identifiers from the root of a crate.
type ModulePath = Vec<String>;

/// Paths that a file imports from `crate`, `super` and `self`, and names that it re-exports from other files.
#[derive(Default)]
struct Imports {
    used: BTreeSet<ModulePath>,
    reexported: BTreeMap<String, ModulePath>,
}

/// Collector of the imports of the module at `module`.
struct ImportVisitor<'a> {
    module: &'a [String],
    imports: Imports,
}

impl ImportVisitor<'_> {
    /// Returns the path from the root of the crate, if `path` begins with `crate`, `super` or `self`.
    fn resolve(&self, path: &[String]) -> Option<ModulePath> {
        let mut resolved = self.module.to_vec();
        match path.first()?.as_str() {
            "crate" => resolved.clear(),
            "self" => {}
            "super" => {
                let n = path.iter().take_while(|s| *s == "super").count();
                resolved.truncate(resolved.len().checked_sub(n)?);
                resolved.extend_from_slice(&path[n..]);
                return Some(resolved);
            }
            _ => return None,
        }
        resolved.extend_from_slice(&path[1..]);
        Some(resolved)
    }

    fn visit_tree(&mut self, tree: &syn::UseTree, prefix: &mut Vec<String>, is_public: bool) {
        match tree {
            syn::UseTree::Path(path) => {
                prefix.push(path.ident.to_string());
                self.visit_tree(&path.tree, prefix, is_public);
                prefix.pop();
            }
            syn::UseTree::Group(group) => {
                for item in &group.items {
                    self.visit_tree(item, prefix, is_public);
                }
            }
            syn::UseTree::Glob(_) => self.add(prefix, None),
            syn::UseTree::Name(name) => {
                let mut path = prefix.clone();
                if name.ident != "self" {
                    path.push(name.ident.to_string());
                }
                self.add(&path, is_public.then(|| name.ident.to_string()));
            }
            syn::UseTree::Rename(rename) => {
                let mut path = prefix.clone();
                path.push(rename.ident.to_string());
                self.add(&path, is_public.then(|| rename.rename.to_string()));
            }
        }
    }

    fn add(&mut self, path: &[String], reexported_as: Option<String>) {
        let child = || [&["self".to_owned()], path].concat();
        match reexported_as {
            Some(name) => {
                let target = self.resolve(path).or_else(|| self.resolve(&child()));
                self.imports.reexported.extend(target.map(|target| (name, target)));
            }
            None => self.imports.used.extend(self.resolve(path)),
        }
    }
}

impl<'ast> Visit<'ast> for ImportVisitor<'_> {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_for_tests(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        let is_public = !matches!(item.vis, syn::Visibility::Inherited);
        self.visit_tree(&item.tree, &mut Vec::new(), is_public);
    }
    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if segments.len() > 1 {
            self.imports.used.extend(self.resolve(&segments));
        }
        visit::visit_path(self, path);
    }
}

/// Returns the path of the module in a file of the crate `package`.
fn module_of(package: &Path, file: &Path) -> ModulePath {
    let within = file.strip_prefix(package.join("src")).expect("a file of the crate").with_extension("");
    let mut module: ModulePath = within.iter().map(|s| s.to_string_lossy().into_owned()).collect();
    if matches!(module.last().map(String::as_str), Some("mod" | "lib" | "main")) {
        module.pop();
    }
    module
}

/// Lists the imports from file to file; re-exports are followed to the file that defines the name.
pub fn import_edges(package: &Path, files: &[(PathBuf, syn::File)]) -> BTreeMap<PathBuf, BTreeSet<PathBuf>> {
    let mut modules: BTreeMap<ModulePath, (PathBuf, Imports)> = BTreeMap::new();
    for (path, parsed) in files {
        let module = module_of(package, path);
        let mut visitor = ImportVisitor { module: &module, imports: Imports::default() };
        visitor.visit_file(parsed);
        let imports = visitor.imports;
        modules.insert(module, (path.clone(), imports));
    }
    let definition = |path: &ModulePath| {
        let mut path = path.clone();
        for _ in 0..8 {
            let n = (0..=path.len()).rev().find(|&n| modules.contains_key(&path[..n]))?;
            let (file, imports) = &modules[&path[..n]];
            match path.get(n).and_then(|name| imports.reexported.get(name)) {
                Some(target) if *target != path => path = [target, &path[n + 1..]].concat(),
                _ => return Some(file.clone()),
            }
        }
        None
    };
    modules
        .values()
        .map(|(file, imports)| {
            let mut targets: BTreeSet<PathBuf> = imports.used.iter().filter_map(definition).collect();
            targets.remove(file);
            (file.clone(), targets)
        })
        .collect()
}

/// Lists the imports of the crate in the folder `package` that point from a layer to a higher one, as `file -> file`. A
/// layer is a list of modules at the root of the crate; `layers` begins at the bottom. Modules of one layer may import
/// each other.
///
/// # Errors
/// A line of text if a file cannot be read or parsed, or if its module is in no layer.
pub fn upward_imports(root: &Path, package: &str, layers: &[&[&str]]) -> Result<Vec<String>, String> {
    let (mut files, mut folders) = (Vec::new(), vec![root.join(package).join("src")]);
    while let Some(folder) = folders.pop() {
        let entries = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        for path in entries.flatten().map(|entry| entry.path()) {
            let name = path.strip_prefix(root).unwrap_or(&path).to_owned();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") && !is_test_path(&name.to_string_lossy()) {
                let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", name.display()))?;
                files.push((
                    name.clone(),
                    syn::parse_file(&text).map_err(|e| format!("{}: {e}", name.display()))?,
                ));
            }
        }
    }
    let layer = |file: &Path| {
        let module = module_of(Path::new(package), file);
        let Some(first) = module.first() else { return Ok(layers.len()) };
        let found = layers.iter().position(|layer| layer.contains(&first.as_str()));
        found.ok_or_else(|| format!("state in this test in which layer of {package} the module {first} is"))
    };
    let mut upward = Vec::new();
    for (file, targets) in import_edges(Path::new(package), &files) {
        for target in targets {
            if layer(&target)? > layer(&file)? {
                upward.push(format!("{} -> {}", file.display(), target.display()));
            }
        }
    }
    Ok(upward)
}

/// Lists the groups of files that import each other in a circle and do not lie in one folder.
fn import_cycles(package: &Path, files: &[(PathBuf, syn::File)]) -> Vec<String> {
    let edges = import_edges(package, files);
    let reachable = |start: &PathBuf| {
        let (mut seen, mut stack) = (BTreeSet::new(), vec![start]);
        while let Some(file) = stack.pop() {
            for next in edges.get(file).into_iter().flatten() {
                if seen.insert(next.clone()) {
                    stack.push(next);
                }
            }
        }
        seen
    };
    let reach: BTreeMap<&PathBuf, BTreeSet<PathBuf>> =
        edges.keys().map(|file| (file, reachable(file))).collect();
    let (mut cycles, mut grouped) = (Vec::new(), BTreeSet::new());
    for (file, targets) in &reach {
        if grouped.contains(*file) || !targets.contains(*file) {
            continue;
        }
        let group: Vec<&PathBuf> = targets.iter().filter(|t| reach[t].contains(*file)).collect();
        grouped.extend(group.iter().copied().cloned());
        let folders: BTreeSet<_> = group.iter().map(|f| f.parent()).collect();
        if folders.len() > 1 {
            let names: Vec<String> = group.iter().map(|f| f.display().to_string()).collect();
            cycles.push(format!("{}: {} files: {}", package.display(), names.len(), names.join(" ")));
            for f in &group {
                let inside = edges[*f].iter().filter(|t| group.contains(t)).map(|t| t.display().to_string());
                cycles.push(format!("    {} -> {}", f.display(), inside.collect::<Vec<_>>().join(" ")));
            }
        }
    }
    cycles
}
