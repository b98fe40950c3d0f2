//! Imports between the files of a crate: `use` trees and paths, resolved to files.

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    path::{Path, PathBuf},
};

/// A module path: `src/a/b.rs` is `["a", "b"]`, the crate's root is empty.
pub type Module = Vec<String>;

/// The modules of a crate and their imports.
pub struct Crate {
    texts: BTreeMap<Module, String>,
    /// Names bound by a module's `use` items, with full paths.
    aliases: HashMap<Module, HashMap<String, Module>>,
}

impl Crate {
    /// Modules of the files below `root`, with their texts; test modules are left out.
    pub fn new(root: &Path, files: Vec<(PathBuf, String)>) -> Self {
        let mut texts = BTreeMap::new();
        for (path, text) in files {
            let module = module_of(path.strip_prefix(root).expect("below the root"));
            let is_test = |name: &String| name == "tests" || name.ends_with("_tests");
            if !module.iter().any(is_test) {
                texts.insert(module, code_of(&text));
            }
        }
        let mut all = Self {
            texts,
            aliases: HashMap::new(),
        };
        for (module, text) in &all.texts {
            let used = use_items(text).into_iter().filter_map(|(name, path)| {
                let path = all.absolute(module, &path)?;
                Some((name, path))
            });
            let used = used.collect();
            all.aliases.insert(module.clone(), used);
        }
        all
    }

    /// All pairs of modules of which the first imports the second.
    pub fn edges(&self) -> BTreeSet<(Module, Module)> {
        let mut edges = BTreeSet::new();
        for (module, text) in &self.texts {
            let used = use_items(text).into_iter().map(|(_, path)| path);
            for path in used.chain(inline_paths(text)) {
                let Some(path) = self.absolute(module, &path) else {
                    continue;
                };
                let target = self.resolve(&path, 0);
                if target != *module {
                    edges.insert((module.clone(), target));
                }
            }
        }
        edges
    }

    /// Full path from the crate's root; none for other crates.
    fn absolute(&self, module: &Module, path: &[String]) -> Option<Module> {
        let (first, rest) = path.split_first()?;
        let mut base = match first.as_str() {
            "crate" => Module::new(),
            "self" => module.clone(),
            "super" => module[..module.len().checked_sub(1)?].to_vec(),
            child => {
                let below: Module = module.iter().cloned().chain([child.to_owned()]).collect();
                self.texts.contains_key(&below).then_some(below)?
            }
        };
        for name in rest {
            if name == "super" {
                base.pop()?;
            } else {
                base.push(name.clone());
            }
        }
        Some(base)
    }

    /// Module that defines the item of a full path, found through `use` items on the way.
    fn resolve(&self, path: &Module, depth: usize) -> Module {
        let known = (0..=path.len())
            .rev()
            .find(|n| self.texts.contains_key(&path[..*n]));
        let (module, rest) = path.split_at(known.unwrap_or(0));
        let module = module.to_vec();
        let alias = rest
            .first()
            .and_then(|name| self.aliases.get(&module)?.get(name));
        match alias {
            // A `use` of itself would never end.
            Some(alias) if depth < 8 && alias != path => {
                let path: Module = alias.iter().chain(&rest[1..]).cloned().collect();
                self.resolve(&path, depth + 1)
            }
            _ => module,
        }
    }
}

/// Module path of a file: `a/b.rs` and `a/b/mod.rs` are both `["a", "b"]`.
fn module_of(file: &Path) -> Module {
    let names = file.with_extension("");
    let mut module: Module = names
        .iter()
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    if module
        .last()
        .is_some_and(|name| name == "mod" || name == "lib")
    {
        module.pop();
    }
    module
}

/// Text without comments, strings and the tests at its end.
fn code_of(text: &str) -> String {
    let text = text.split(")]\nmod tests {").next().unwrap_or("");
    let mut code = String::new();
    for line in text.lines() {
        let mut in_string = false;
        let mut chars = line.chars().peekable();
        while let Some(c) = chars.next() {
            match c {
                '\\' if in_string => {
                    chars.next();
                }
                '"' => in_string = !in_string,
                '/' if !in_string && chars.peek() == Some(&'/') => break,
                c if !in_string => code.push(c),
                _ => {}
            }
        }
        code.push('\n');
    }
    code
}

/// All names that `use` items bring in, with their paths.
fn use_items(code: &str) -> Vec<(String, Vec<String>)> {
    let mut items = Vec::new();
    let is_start = |before: &str| before.is_empty() || before.ends_with([' ', '\n', ')', ';', '{']);
    for (at, _) in code.match_indices("use ") {
        if !is_start(&code[..at]) {
            continue;
        }
        let tree = code[at + 4..].split(';').next().unwrap_or("");
        let tree: String = tree.split_whitespace().collect::<Vec<_>>().join(" ");
        expand(&tree, &[], &mut items);
    }
    items
}

fn expand(tree: &str, before: &[String], items: &mut Vec<(String, Vec<String>)>) {
    let tree = tree.trim();
    let joined = |path: &str| -> Vec<String> {
        let names = path.split("::").map(str::trim).filter(|n| !n.is_empty());
        let names = names.map(str::to_owned);
        before.iter().cloned().chain(names).collect()
    };
    if let Some((head, list)) = tree.split_once('{') {
        let before = joined(head);
        let list = list.trim_end().strip_suffix('}').unwrap_or(list);
        for part in split_list(list) {
            expand(part, &before, items);
        }
        return;
    }
    let renamed = tree.split_once(" as ");
    let (path, name) = renamed.map_or((tree, None), |(p, n)| (p, Some(n)));
    let mut path = joined(path);
    let last = path.last().map(String::as_str);
    if path.len() > 1 && matches!(last, Some("self" | "*")) {
        path.pop();
    }
    if let Some(last) = path.last() {
        items.push((name.unwrap_or(last).trim().to_owned(), path.clone()));
    }
}

/// Parts of a list between commas that are not inside an inner list.
fn split_list(list: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&list[start..]);
    parts.retain(|part| !part.trim().is_empty());
    parts
}

/// Paths in the code that begin with `crate`, `self`, `super` or another lower-case name.
fn inline_paths(code: &str) -> Vec<Vec<String>> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ':';
    let words = code.split(|c: char| !is_part(c));
    words
        .filter(|word| word.contains("::") && word.starts_with(|c: char| c.is_ascii_lowercase()))
        .map(|word| {
            word.split("::")
                .filter(|name| !name.is_empty())
                .map(str::to_owned)
                .collect()
        })
        .collect()
}
