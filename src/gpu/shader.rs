//! Shader sources: library folders, `#import` resolution, and mapping of errors to source lines.

use std::{borrow::Cow, collections::BTreeMap, fmt, fs, path::Path, sync::Arc};

use reflet_base::files::read_text;

use crate::shader_folders::shader_folders;

/// Largest shader, bytes.
const MAX_SHADER_BYTES: u64 = 1 << 20;

/// `(path below shaders/, text)` of every shader, made by `build.rs`.
const EMBEDDED: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// A location in a source file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// Path of the file, such as `shaders/lib/bvh.wgsl`.
    pub file: Arc<str>,
    /// Line number, from 1.
    pub line: u32,
    /// Column, from 1, in bytes; 0 where only the line is known.
    pub column: u32,
    /// Text of the line.
    pub text: String,
    /// Length of the marked range, bytes, at least 1.
    pub length: u32,
}

/// A shader error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShaderError {
    /// File or folder of the shader, without a location.
    pub file: Arc<str>,
    /// Error message.
    pub message: String,
    /// Location in a source file, if any.
    pub location: Option<Location>,
    /// Further compiler notes.
    pub notes: Vec<String>,
}

impl ShaderError {
    pub(crate) fn new(file: &Arc<str>, message: impl Into<String>) -> Self {
        Self {
            file: file.clone(),
            message: message.into(),
            location: None,
            notes: Vec::new(),
        }
    }
}

impl fmt::Display for ShaderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.location {
            None => write!(f, "{}: {}", self.file, self.message)?,
            Some(at) => {
                write!(f, "{}:{}", at.file, at.line)?;
                if at.column > 0 {
                    write!(f, ":{}", at.column)?;
                }
                let number = at.line.to_string();
                // Tabs keep their width, so that the caret stays under its word.
                let lead: String = at
                    .text
                    .get(..at.column.saturating_sub(1) as usize)
                    .unwrap_or("")
                    .chars()
                    .map(|c| if c == '\t' { '\t' } else { ' ' })
                    .collect();
                write!(f, ": {}\n{number} | {}", self.message, at.text)?;
                if at.column > 0 {
                    let gap = " ".repeat(number.len());
                    let marks = "^".repeat(at.length.max(1) as usize);
                    write!(f, "\n{gap} | {lead}{marks}")?;
                }
            }
        }
        self.notes
            .iter()
            .try_for_each(|note| write!(f, "\n  note: {note}"))
    }
}

impl std::error::Error for ShaderError {}

/// An assembled shader with all its imports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShaderSource {
    /// Name of the shader, such as `ssr`.
    pub name: String,
    /// The shader's own file, for messages.
    pub file: Arc<str>,
    /// The whole WGSL text.
    pub text: Arc<str>,
    /// Whether the whole text was built into this program.
    pub embedded: bool,
    /// Source file and line number of every line of `text`.
    lines: Arc<[(Arc<str>, u32)]>,
    /// Byte offsets of the ends of all lines of `text`.
    newlines: Arc<[usize]>,
}

impl ShaderSource {
    /// Source location of a byte range of [`ShaderSource::text`].
    pub fn locate(&self, range: std::ops::Range<usize>) -> Option<Location> {
        let newlines = &self.newlines;
        let index = newlines.partition_point(|newline| *newline < range.start);
        let start = index.checked_sub(1).map_or(0, |last| newlines[last] + 1);
        let text = self.text.get(start..)?.lines().next().unwrap_or("");
        let (file, line) = self.lines.get(index)?.clone();
        let column = range.start - start;
        let rest = text.len().saturating_sub(column).max(1);
        Some(Location {
            file,
            line,
            column: column as u32 + 1,
            text: text.to_owned(),
            length: range.len().clamp(1, rest) as u32,
        })
    }
}

/// All shaders of a folder: passes at the top, shared code in `lib/`, and both again for each method in
/// `methods/NAME/`.
#[derive(Clone, Debug)]
pub struct ShaderLibrary {
    /// Prefix of file names in messages.
    root: String,
    /// Path below the root, and text, by [`key`].
    files: BTreeMap<String, (String, Cow<'static, str>)>,
    /// Generated texts by path, such as `lib/constants.wgsl`.
    generated: BTreeMap<String, String>,
    embedded: bool,
}

impl ShaderLibrary {
    /// The shaders that were built into this program.
    pub fn embedded() -> Self {
        Self {
            root: "shaders".to_owned(),
            files: EMBEDDED
                .iter()
                .map(|&(path, text)| (key(path), (path.to_owned(), Cow::Borrowed(text))))
                .collect(),
            generated: BTreeMap::new(),
            embedded: true,
        }
    }

    /// Reads the `.wgsl` files of [`shader_folders`].
    ///
    /// # Errors
    /// A folder or file that cannot be read, a folder without shaders, or two files of one name.
    pub fn from_dir(path: &Path) -> Result<Self, ShaderError> {
        let root = path.display().to_string();
        let mut files = BTreeMap::new();
        for dir in shader_folders(path) {
            if dir != path && !dir.is_dir() {
                continue;
            }
            let entries = fs::read_dir(&dir).map_err(|error| unreadable(&dir, &error))?;
            for entry in entries {
                let file = entry.map_err(|error| unreadable(&dir, &error))?.path();
                let below = file
                    .strip_prefix(path)
                    .ok()
                    .and_then(|below| below.to_str());
                if let Some(below) = below.filter(|name| name.ends_with(".wgsl")) {
                    let text =
                        read_text(&file, MAX_SHADER_BYTES).map_err(|e| unreadable(&file, &e))?;
                    let below = below.replace('\\', "/");
                    if let Some((other, _)) = files.insert(key(&below), (below, Cow::Owned(text))) {
                        let message = format!("has the name of {other}; give one of them another");
                        return Err(ShaderError::new(
                            &file.display().to_string().into(),
                            message,
                        ));
                    }
                }
            }
        }
        if files.is_empty() {
            return Err(ShaderError::new(
                &root.into(),
                "no .wgsl files here; --shaders expects a copy of Reflet's shaders folder",
            ));
        }
        Ok(Self {
            root,
            files,
            generated: BTreeMap::new(),
            embedded: false,
        })
    }

    #[cfg(test)]
    pub(crate) fn from_texts(texts: &[(&str, &str)]) -> Self {
        Self {
            root: "shaders".to_owned(),
            files: texts
                .iter()
                .map(|&(path, text)| (key(path), (path.to_owned(), text.to_owned().into())))
                .collect(),
            generated: BTreeMap::new(),
            embedded: false,
        }
    }

    /// The library with a generated `lib/NAME.wgsl`.
    ///
    /// # Errors
    /// The folder has a file with that name.
    pub fn with_generated(mut self, name: &str, text: String) -> Result<Self, ShaderError> {
        let path = format!("lib/{name}.wgsl");
        if self.files.contains_key(&path) {
            let file = format!("{}/{path}", self.root).into();
            let message = "is generated by the program; remove this file";
            return Err(ShaderError::new(&file, message));
        }
        self.generated.insert(path, text);
        Ok(self)
    }

    /// Name for messages, and text, of the file of a [`key`].
    fn find(&self, path: &str) -> Option<(Arc<str>, Cow<'static, str>)> {
        if let Some(text) = self.generated.get(path) {
            return Some((format!("generated {path}").into(), text.clone().into()));
        }
        let (path, text) = self.files.get(path)?;
        Some((format!("{}/{path}", self.root).into(), text.clone()))
    }

    /// Path below the root and text of every file, sorted; without generated files.
    pub fn texts(&self) -> impl Iterator<Item = (&str, &str)> {
        let files = self.files.values();
        files.map(|(path, text)| (path.as_str(), text.as_ref()))
    }

    /// Names of all shaders that are not libraries, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files
            .keys()
            .filter(|path| !path.contains('/'))
            .filter_map(|path| path.strip_suffix(".wgsl"))
    }

    /// Names of all importable libraries, sorted.
    pub fn lib_names(&self) -> impl Iterator<Item = &str> {
        let mut paths: Vec<&String> = self.files.keys().chain(self.generated.keys()).collect();
        paths.sort();
        paths
            .into_iter()
            .filter_map(|path| path.strip_prefix("lib/")?.strip_suffix(".wgsl"))
    }

    /// Assembles `NAME.wgsl` with every import included once.
    ///
    /// # Errors
    /// Unknown shader, unknown import, an import that is not a plain name, a cycle.
    pub fn source(&self, name: &str) -> Result<ShaderSource, ShaderError> {
        self.assemble(name, &format!("{name}.wgsl"))
    }

    /// Assembles `lib/NAME.wgsl` on its own with its imports, so that a test can check it alone.
    ///
    /// # Errors
    /// Same errors as [`ShaderLibrary::source`].
    pub fn lib_source(&self, name: &str) -> Result<ShaderSource, ShaderError> {
        self.assemble(name, &format!("lib/{name}.wgsl"))
    }

    fn assemble(&self, name: &str, path: &str) -> Result<ShaderSource, ShaderError> {
        let Some((file, _)) = self.find(path) else {
            let file = format!("{}/{path}", self.root).into();
            return Err(ShaderError::new(&file, "no such shader"));
        };
        let mut assembly = Assembly {
            library: self,
            text: String::new(),
            lines: Vec::new(),
            open: Vec::new(),
            done: Vec::new(),
        };
        assembly.include(path)?;
        let newlines = assembly.text.match_indices('\n').map(|(at, _)| at);
        Ok(ShaderSource {
            newlines: newlines.collect(),
            name: name.to_owned(),
            file,
            text: assembly.text.into(),
            embedded: self.embedded,
            lines: assembly.lines.into(),
        })
    }
}

/// A shader being assembled.
struct Assembly<'a> {
    library: &'a ShaderLibrary,
    text: String,
    lines: Vec<(Arc<str>, u32)>,
    /// Paths being included, outermost first.
    open: Vec<String>,
    /// Paths included so far.
    done: Vec<String>,
}

impl Assembly<'_> {
    fn include(&mut self, path: &str) -> Result<(), ShaderError> {
        let Some((file, text)) = self.library.find(path) else {
            return Ok(());
        };
        self.open.push(path.to_owned());
        for (index, line) in text.lines().enumerate() {
            if let Some(rest) = line.trim_start().strip_prefix("#import") {
                let location = Location {
                    file: file.clone(),
                    line: index as u32 + 1,
                    column: 0,
                    text: line.to_owned(),
                    length: 1,
                };
                self.import(rest, location)?;
            } else if line.starts_with("enable ") {
                // WGSL has these before all else, wherever the library is imported.
                self.text.insert_str(0, &format!("{line}\n"));
                (self.lines).insert(0, (file.clone(), index as u32 + 1));
            } else {
                self.text.push_str(line);
                self.text.push('\n');
                self.lines.push((file.clone(), index as u32 + 1));
            }
        }
        self.open.pop();
        self.done.push(path.to_owned());
        Ok(())
    }

    fn import(&mut self, rest: &str, location: Location) -> Result<(), ShaderError> {
        let refuse = |message: String| {
            Err(ShaderError {
                file: location.file.clone(),
                message,
                location: Some(location.clone()),
                notes: Vec::new(),
            })
        };
        let name = rest.split("//").next().unwrap_or("").trim();
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if name.is_empty() || !rest.starts_with([' ', '\t']) || !name.chars().all(is_name) {
            return refuse(format!(
                "expected `#import NAME` with the name of a file in lib/, found `{name}`"
            ));
        }
        let path = format!("lib/{name}.wgsl");
        if let Some(first) = self.open.iter().position(|open| *open == path) {
            let mut circle = self.open[first..].to_vec();
            circle.push(path);
            return refuse(format!("import cycle: {}", circle.join(" -> ")));
        }
        if self.done.contains(&path) {
            return Ok(());
        }
        if self.library.find(&path).is_none() {
            let known: Vec<&str> = self.library.lib_names().collect();
            return refuse(format!(
                "no lib/{name}.wgsl; lib/ has: {}",
                known.join(", ")
            ));
        }
        self.include(&path)
    }
}

/// Name by which a shader is found: `NAME.wgsl` for passes, `lib/NAME.wgsl` for libraries, wherever they are.
fn key(path: &str) -> String {
    let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
    let is_lib = folder.rsplit('/').next() == Some("lib");
    format!("{}{name}", if is_lib { "lib/" } else { "" })
}

fn unreadable(path: &Path, error: &std::io::Error) -> ShaderError {
    ShaderError::new(
        &path.display().to_string().into(),
        format!("cannot read: {error}"),
    )
}

#[cfg(test)]
#[path = "shader_tests.rs"]
mod tests;
