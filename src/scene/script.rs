//! Scripts in Rhai: what a scene adds by program and how it moves by program. A script is a pure
//! function of the scene's parameters and the frame: it has no files, no clock and no memory
//! between calls.

mod additions;
pub mod api;
mod context;
mod engine;
mod error;
mod sources;

use std::{
    collections::HashSet,
    fmt,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use rhai::{AST, CallFnOptions, Dynamic, Engine, EvalAltResult, Scope};

use self::{
    context::{Call, Context},
    engine::run_limited,
    sources::Sources,
};
use super::{
    desc::{At, Entry, ParamValue, SceneDesc, TimelineDesc},
    diagnostic::Diagnostic,
    motion::{FrameState, Kind, Names},
    trail::Trail,
};

/// A scene as a script leaves it, and which cameras and lights the script has set.
pub type Posed = (FrameState, HashSet<(Kind, usize)>);

/// A compiled script; clones share it.
#[derive(Clone)]
pub struct Script(Arc<Compiled>);

struct Compiled {
    engine: Engine,
    ast: AST,
    /// What messages call its file.
    name: String,
    sources: Arc<Sources>,
    has_setup: bool,
    has_frame: bool,
    setup_log: OnceLock<Vec<String>>,
}

impl fmt::Debug for Script {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Script").field(&self.0.name).finish()
    }
}

/// Scripts are equal when all their texts are.
impl PartialEq for Script {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name && self.0.sources.texts() == other.0.sources.texts()
    }
}

impl Script {
    /// Reads and compiles a script that a scene names, and everything that it imports; nothing
    /// outside `folder` is read. What is looked for is added to `trail`, also when it fails.
    ///
    /// # Errors
    /// A file that is missing or outside the folder, and mistakes of the script, with their places.
    pub fn load(folder: &Path, file: &At<String>, trail: &Trail) -> Result<Self, Box<Diagnostic>> {
        let sources = Arc::new(Sources::new(folder, trail));
        let (name, text) = sources
            .read(&file.value)
            .map_err(|problem| problem.at(&file.at))?;
        Self::compile(sources, name, &text)
    }

    /// Compiles a text that is called `name`; it can import nothing.
    ///
    /// # Errors
    /// As [`Script::load`].
    pub fn from_text(name: &str, text: &str) -> Result<Self, Box<Diagnostic>> {
        let sources = Arc::new(Sources::without_files());
        sources.add(name, text);
        Self::compile(sources, name.to_owned(), text)
    }

    fn compile(sources: Arc<Sources>, name: String, text: &str) -> Result<Self, Box<Diagnostic>> {
        let engine = engine::engine(&sources);
        let mut ast = engine
            .compile(text)
            .map_err(|wrong| Box::new(error::syntax(&wrong, &sources, &name)))?;
        ast.set_source(name.as_str());
        let has = |wanted: &str| {
            ast.iter_functions()
                .any(|f| f.name == wanted && f.params.len() == 1)
        };
        let script = Self(Arc::new(Compiled {
            has_setup: has("setup"),
            has_frame: has("frame"),
            engine,
            ast,
            name,
            sources,
            setup_log: OnceLock::new(),
        }));
        script.check()?;
        Ok(script)
    }

    /// Runs what stands outside functions once: wrong imports show before the first frame.
    fn check(&self) -> Result<(), Box<Diagnostic>> {
        let this = &*self.0;
        let (result, _) =
            run_limited(|| this.engine.run_ast_with_scope(&mut Scope::new(), &this.ast));
        result.map_err(|wrong| self.explain(&wrong, None))?;
        this.sources.seal();
        if !this.has_frame && !this.has_setup {
            let message = "the script has neither `fn setup(ctx)` nor `fn frame(ctx)`";
            let start = this.sources.start_of(&this.name);
            let help = "`frame` moves the scene, `setup` adds to it; each has one parameter";
            return Err(Box::new(
                Diagnostic::at("script-empty", start, message).help(help),
            ));
        }
        Ok(())
    }

    /// Whether it moves anything.
    pub fn has_frame(&self) -> bool {
        self.0.has_frame
    }

    /// Name and text of every file that it consists of, itself first.
    pub fn texts(&self) -> Vec<(String, String)> {
        self.0.sources.texts()
    }

    /// Every file that was read, for fingerprints and watching.
    pub fn files(&self) -> Vec<PathBuf> {
        self.0.sources.files()
    }

    /// What messages call its file.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// What `setup` printed.
    pub fn setup_log(&self) -> &[String] {
        self.0.setup_log.get().map_or(&[], Vec::as_slice)
    }

    /// Calls `setup`: what it adds to the scene, as scene text.
    ///
    /// # Errors
    /// What the script does wrong, with its place.
    pub fn setup(
        &self,
        params: &[Entry<ParamValue>],
        timeline: Option<&TimelineDesc>,
    ) -> Result<String, Box<Diagnostic>> {
        if !self.0.has_setup {
            return Ok(String::new());
        }
        let call = Call::new(params, timeline, timeline.map_or(0, |t| t.start));
        let context = Context::for_setup(call);
        let (result, log) = self.call("setup", context);
        self.0.setup_log.get_or_init(|| log);
        let returned = result.map_err(|wrong| self.explain(&wrong, Some("in setup")))?;
        let text = additions::text(&returned).map_err(|message| {
            let start = self.0.sources.start_of_function(&self.0.name, "setup");
            Box::new(Diagnostic::at("script-result", start, message))
        })?;
        Ok(text)
    }

    /// Calls `frame` on a posed scene: the scene as it leaves it, and which cameras and lights it
    /// has set.
    ///
    /// # Errors
    /// What the script does wrong, with its place and the frame.
    pub fn frame(
        &self,
        state: FrameState,
        names: &Arc<Names>,
        desc: &SceneDesc,
    ) -> Result<Posed, Vec<Diagnostic>> {
        if !self.0.has_frame {
            return Ok((state, HashSet::new()));
        }
        let frame = state.frame;
        let call = Call::new(&desc.params, desc.timeline.as_ref(), frame);
        let context = Context::for_frame(call, state, Arc::clone(names));
        let (result, log) = self.call("frame", context.clone());
        let _ = result
            .map_err(|wrong| vec![*self.explain(&wrong, Some(&format!("in frame {frame}")))])?;
        let (mut state, touched) = context.into_result();
        state.log.extend(log);
        Ok((state, touched))
    }

    fn call(
        &self,
        function: &str,
        context: Context,
    ) -> (Result<Dynamic, Box<EvalAltResult>>, Vec<String>) {
        let this = &*self.0;
        run_limited(move || {
            // A new scope each time, and constants and imports evaluated anew.
            let options = CallFnOptions::new().eval_ast(true).rewind_scope(true);
            let mut scope = Scope::new();
            this.engine
                .call_fn_with_options(options, &mut scope, &this.ast, function, (context,))
        })
    }

    fn explain(&self, wrong: &EvalAltResult, when: Option<&str>) -> Box<Diagnostic> {
        let functions: Vec<_> = self.0.ast.iter_functions().map(|f| f.name).collect();
        Box::new(error::runtime(
            wrong,
            &self.0.sources,
            &self.0.name,
            &functions,
            when,
        ))
    }
}

#[cfg(test)]
mod tests;
