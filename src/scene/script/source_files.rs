//! Files of a script: read only below the scene's folder and asset folders, and kept for messages.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use rhai::{Dynamic, EvalAltResult, ImmutableString, Position, Scope, Shared};

use super::{
    call_limits::compile,
    limits::{FILE_BYTES, NESTED},
    nested_values::is_deeper,
    tokens::{Token, tokens},
};
use crate::{
    confined_read::{self, Found, Kind, Problem},
    dependencies::Dependencies,
    diagnostic::{Source, Span},
    fonts::Fonts,
    reach::Reach,
    suggest,
};

/// Extension of a file, if people write scripts of another language in such files.
fn foreign_ending(file: &str) -> Option<&str> {
    const ENDINGS: [&str; 10] = [
        "js", "lua", "mel", "osl", "py", "rb", "rs", "ts", "vex", "wgsl",
    ];
    let ending = Path::new(file).extension()?.to_str()?;
    ENDINGS.contains(&ending).then_some(ending)
}

/// Texts of a script and its imports.
#[derive(Debug, Default)]
pub struct Sources {
    /// Folders in which scripts are searched, the scene's first; without one no file can be read.
    reach: Reach,
    /// Fonts in the folders of the scene.
    fonts: Fonts,
    /// Record of all files that were searched.
    dependencies: Dependencies,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    texts: Vec<(String, Arc<Source>)>,
    files: Vec<PathBuf>,
    /// Files of the modules that are being loaded, outermost first, with symbolic links resolved.
    open: Vec<PathBuf>,
    /// Loaded modules, with the paths of their files, symbolic links resolved.
    modules: Vec<(PathBuf, Shared<rhai::Module>)>,
    /// Names of imports that were found, and the paths of their files.
    found: Vec<(String, PathBuf)>,
    /// Fonts that were read, by their names.
    fonts: Vec<(String, Arc<[u8]>)>,
    /// Whether all imports were read.
    sealed: bool,
    /// Whether frames are posed, which read no files.
    poses: bool,
    /// First import that the running call was refused: message, file and position.
    refused: Option<(String, String, Position)>,
}

/// Words for messages about script files.
const SCRIPTS: Kind = Kind {
    one: "a script",
    names: "file names of scripts start from the scene's folder or an asset folder and end in .rhai",
    inside: "scripts are read only from the scene's folder, asset folders, and the folders below",
    most_mib: FILE_BYTES >> 20,
};

impl Problem {
    /// Error of the import at the position `at`.
    fn in_import(self, sources: &Sources, at: Position) -> Box<EvalAltResult> {
        let text = format!("{}; {}", self.message, self.help);
        let Some(Span { source, range }) = self.inside else {
            return EvalAltResult::ErrorRuntime(text.into(), at).into();
        };
        let source = source.expect("it is in a file");
        let (name, place) = (source.path.display().to_string(), source.place(range.start));
        sources.state().texts.push((name.clone(), source));
        let [line, column] =
            [place.line, place.column].map(|n| u16::try_from(n).unwrap_or(u16::MAX));
        let wrong = EvalAltResult::ErrorRuntime(text.into(), Position::new(line, column));
        EvalAltResult::ErrorInModule(name, wrong.into(), at).into()
    }
}

impl Sources {
    /// Sources of a script that may read files within `reach`; every file that is searched is added to
    /// `dependencies`.
    pub fn new(reach: &Reach, dependencies: &Dependencies) -> Self {
        Self {
            reach: reach.of_scripts(),
            fonts: Fonts::new(reach, dependencies),
            dependencies: dependencies.clone(),
            ..Self::default()
        }
    }

    /// Sources of a script text that is no file; it can import nothing.
    pub fn without_files() -> Self {
        Self::default()
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps a text under a name.
    pub fn add(&self, name: &str, text: &str) {
        let source = Source::new(name, text);
        self.state().texts.push((name.to_owned(), Arc::new(source)));
    }

    /// Reads the script itself; gives its name in messages, and its text.
    pub fn read(&self, file: &str) -> Result<(String, String), Problem> {
        if let Some(ending) = foreign_ending(file) {
            let message = format!(
                "scripts are `.rhai` files, written in Rhai, and this is a `.{ending}` file"
            );
            let help = "write it as a `.rhai` file; `reflet scripting` prints the manual";
            return Err(Problem::new(message, help));
        }
        let found = self.find(file)?;
        self.state().open.push(found.real.clone());
        Ok(self.keep(found))
    }

    /// Reads a file below one of the folders.
    fn find(&self, file: &str) -> Result<Found, Problem> {
        if self.reach.folders().is_empty() {
            let message = format!("{} cannot be read here", suggest::text(file));
            return Err(Problem::new(message, ""));
        }
        confined_read::read(&self.reach, file, &SCRIPTS, &self.dependencies)
    }

    /// Bytes of a font, which is read once.
    pub fn font(&self, file: &str) -> Result<Arc<[u8]>, Problem> {
        let mut state = self.state();
        if let Some((_, font)) = state.fonts.iter().find(|(name, _)| name == file) {
            return Ok(Arc::clone(font));
        }
        if state.poses || self.fonts.is_nowhere() {
            let message = format!("font {} cannot be read here", suggest::text(file));
            let help =
                "`frame` reads no files: measure a text in this font in `setup`, or in a `const`";
            return Err(Problem::new(message, help));
        }
        let found = self.fonts.read(file)?;
        let font: Arc<[u8]> = found.data.into();
        state.fonts.push((file.to_owned(), Arc::clone(&font)));
        state.files.push(found.real);
        Ok(font)
    }

    /// Keeps a file that was read; gives its name in messages, and its text.
    fn keep(&self, found: Found) -> (String, String) {
        let name = found.path.display().to_string();
        let text = without_mark(&found.data).to_owned();
        self.add(&name, &text);
        self.state().files.push(found.real);
        (name, text)
    }

    /// Result of a call; the error of a refused import takes its place even if the script has caught it.
    pub fn or_refused<T>(
        &self,
        result: Result<T, Box<EvalAltResult>>,
    ) -> Result<T, Box<EvalAltResult>> {
        match (result, self.state().refused.take()) {
            (Ok(_), Some((text, file, at))) => {
                let wrong = EvalAltResult::ErrorRuntime(text.into(), at);
                let at = Position::NONE;
                Err(EvalAltResult::ErrorInModule(file, wrong.into(), at).into())
            }
            (result, _) => result,
        }
    }

    /// Forbids to read any more files.
    pub fn seal(&self) {
        self.state().sealed = true;
    }

    /// Forbids to read fonts.
    pub fn begin_poses(&self) {
        self.state().poses = true;
    }

    /// Name and text of each file, the script itself first.
    pub fn texts(&self) -> Vec<(String, String)> {
        let state = self.state();
        let texts = state.texts.iter();
        texts
            .map(|(name, s)| (name.clone(), s.text.clone()))
            .collect()
    }

    /// All files as sources, the script itself first.
    pub fn all(&self) -> Vec<Arc<Source>> {
        let state = self.state();
        state.texts.iter().map(|(_, s)| Arc::clone(s)).collect()
    }

    /// Paths of the files, with symbolic links resolved.
    pub fn files(&self) -> Vec<PathBuf> {
        self.state().files.clone()
    }

    fn source(&self, name: &str) -> Option<Arc<Source>> {
        let state = self.state();
        let found = state.texts.iter().find(|(known, _)| known == name);
        found.map(|(_, source)| Arc::clone(source))
    }

    /// Span of a position in a text: the word that begins there, or one character.
    pub fn span(&self, name: &str, at: Position) -> Option<Span> {
        let source = self.source(name)?;
        let line = at.line()?;
        let start: usize = source
            .text
            .split_inclusive('\n')
            .take(line - 1)
            .map(str::len)
            .sum();
        let rest = source.text.get(start..)?;
        let column = at.position().unwrap_or(1).saturating_sub(1);
        let skipped: usize = rest.chars().take(column).map(char::len_utf8).sum();
        let begin = start + skipped;
        let word: usize = source.text[begin..]
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .map(char::len_utf8)
            .sum();
        let end = (begin + word.max(1)).min(source.text.len());
        Some(Span {
            range: begin.min(end)..end,
            source: Some(source),
        })
    }

    /// Empty span at the beginning of a text.
    pub fn start_of(&self, name: &str) -> Span {
        Span {
            source: self.source(name),
            range: 0..0,
        }
    }

    /// Span of `fn NAME` where a function is defined; the beginning of the text if it is not found.
    pub fn start_of_function(&self, name: &str, function: &str) -> Span {
        let mut span = self.start_of(name);
        let text = span.source.as_ref().map_or("", |source| &source.text);
        let tokens = tokens(text);
        let is_definition = |pair: &&[Token]| pair[0].text == "fn" && pair[1].text == function;
        if let Some([keyword, name]) = tokens.windows(2).find(is_definition) {
            span.range = keyword.at.start..name.at.end;
        }
        span
    }

    /// Span of the last line of a function, which gives its result; its definition if braces are not balanced.
    pub fn end_of_function(&self, name: &str, function: &str) -> Span {
        let start = self.start_of_function(name, function);
        let Some(source) = &start.source else {
            return start;
        };
        let tokens = tokens(&source.text[start.range.end..]);
        let mut depth = 0_usize;
        let mut last: Option<Range<usize>> = None;
        for token in tokens {
            match token.text {
                "{" | "#{" => depth += 1,
                "}" if depth == 1 => break,
                "}" => depth = depth.saturating_sub(1),
                _ if depth == 0 => continue,
                _ => {}
            }
            // Tokens of the newest line so far.
            let at = start.range.end + token.at.start..start.range.end + token.at.end;
            let is_same_line = |old: &Range<usize>| !source.text[old.end..at.start].contains('\n');
            match &mut last {
                _ if token.text == "{" && depth == 1 => {}
                Some(old) if is_same_line(old) => old.end = at.end,
                _ => last = Some(at),
            }
        }
        let range = last.unwrap_or(start.range.clone());
        Span { range, ..start }
    }

    /// Module of an import that was found before.
    fn known_module(&self, file: &str) -> Option<Shared<rhai::Module>> {
        let state = self.state();
        let (_, real) = state.found.iter().find(|(known, _)| known == file)?;
        state.module(real)
    }
}

impl State {
    fn module(&self, real: &Path) -> Option<Shared<rhai::Module>> {
        let found = self.modules.iter().find(|(known, _)| known == real);
        found.map(|(_, module)| module.clone())
    }
}

/// The text without the byte order mark that some editors begin UTF-8 with.
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Resolves `import "name"` to `name.rhai` below the scene's folder or an asset folder; each file is loaded
/// once.
pub struct Resolver(pub Arc<Sources>);

impl rhai::ModuleResolver for Resolver {
    fn resolve(
        &self,
        engine: &rhai::Engine,
        source: Option<&str>,
        path: &str,
        at: Position,
    ) -> Result<Shared<rhai::Module>, Box<EvalAltResult>> {
        let module = self.find(engine, path, at);
        if let Err(wrong) = &module
            && let EvalAltResult::ErrorRuntime(text, at) = &**wrong
        {
            let file = source.unwrap_or_default().to_owned();
            let mut state = self.0.state();
            (state.refused).get_or_insert_with(|| (text.to_string(), file, *at));
        }
        module
    }
}

impl Resolver {
    fn find(
        &self,
        engine: &rhai::Engine,
        path: &str,
        at: Position,
    ) -> Result<Shared<rhai::Module>, Box<EvalAltResult>> {
        let sources = &self.0;
        let file = if path.ends_with(".rhai") {
            path.to_owned()
        } else {
            format!("{path}.rhai")
        };
        if let Some(module) = sources.known_module(&file) {
            return Ok(module);
        }
        let fail = |message: String| Err(Box::new(EvalAltResult::ErrorRuntime(message.into(), at)));
        if sources.state().sealed {
            let text = "imports must stand at the top of a script, outside functions";
            return fail(text.to_owned());
        }
        let found = match sources.find(&file) {
            Ok(found) => found,
            Err(problem) => return Err(problem.in_import(sources, at)),
        };
        let real = found.real.clone();
        sources.state().found.push((file, real.clone()));
        let known = sources.state().module(&real);
        if let Some(module) = known {
            return Ok(module);
        }
        if sources.state().open.contains(&real) {
            return fail(format!(
                "\"{path}\" imports itself, directly or through others"
            ));
        }
        let (name, text) = sources.keep(found);
        sources.state().open.push(real.clone());
        let module = module(engine, &name, &text);
        sources.state().open.pop();
        let module =
            module.map_err(|wrong| Box::new(EvalAltResult::ErrorInModule(name, wrong, at)))?;
        // The module outlives this thread, whose stack alone is large enough for deep values.
        let is_deep = |(_, value): (&str, &Dynamic)| is_deeper(value, NESTED);
        if module.iter_var().any(is_deep) {
            return fail(format!(
                "\"{path}\" exports a value that is nested more than {NESTED} deep"
            ));
        }
        let module: Shared<rhai::Module> = module.into();
        sources.state().modules.push((real, module.clone()));
        Ok(module)
    }
}

/// Compiles a module and runs its top level.
fn module(
    engine: &rhai::Engine,
    name: &str,
    text: &str,
) -> Result<rhai::Module, Box<EvalAltResult>> {
    let mut ast = compile(engine, text)?;
    ast.set_source(ImmutableString::from(name));
    rhai::Module::eval_ast_as_new(Scope::new(), &ast, engine)
}
