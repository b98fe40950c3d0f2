//! Scripts in Rhai, which add to a scene (`setup`) and move it (`frame`). A script is a pure function of
//! the scene's parameters, the files that it reads before the first frame, and the frame: it has no clock, and no
//! memory between calls.

pub mod api;
mod bounded_functions;
mod bounds;
mod call_limits;
mod catch_values;
mod context;
mod ended;
mod engine;
mod error;
pub(crate) mod floats;
mod format_value;
mod limit_location;
mod limited_parser;
mod limits;
pub mod lint;
mod nested_values;
mod push;
mod setters;
mod setup_output;
mod sort;
mod source_files;
pub mod tokens;
mod value;

use std::{fmt, sync::Arc};

use rhai::{AST, CallFnOptions, Dynamic, Engine, EvalAltResult, Scope};

use self::{
    call_limits::{compile, run_alone, run_limited},
    context::{Call, Context},
    ended::{StoppedCall, is_limit},
    error::Known,
    source_files::{Sources, without_mark},
};
use super::{
    dependencies::Dependencies,
    desc::{At, Entry, ParamValue, ScriptDesc, TimelineDesc},
    diagnostic::{Diagnostic, Returned},
    motion::{FrameState, ScriptNames, ScriptedFields},
    reach::Reach,
};

pub use self::{
    bounds::{Bounds, Halt, together},
    limits::DEADLINE,
};

/// The scene as a script leaves it, and the cameras and lights that the script has set.
pub type Posed = (FrameState, ScriptedFields);

/// A compiled script; clones share it.
#[derive(Clone)]
pub struct Script(Arc<Compiled>);

struct Compiled {
    engine: Engine,
    ast: AST,
    /// Name of its file in messages.
    name: String,
    sources: Arc<Sources>,
    has_setup: bool,
    has_frame: bool,
}

impl fmt::Debug for Script {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Script").field(&self.0.name).finish()
    }
}

impl Script {
    /// Reads and compiles a script that a scene names, and all files that it imports. Files are read from the folders
    /// of the scene and of libraries of scripts alone, the scene's first; every file that is looked for is added to
    /// `dependencies`, also when this fails.
    ///
    /// # Errors
    /// A file that is missing or outside the folder, and mistakes of the script, with their places.
    pub fn load(
        reach: &Reach,
        file: &At<String>,
        dependencies: &Dependencies,
    ) -> Result<Self, Box<Diagnostic>> {
        let sources = Arc::new(Sources::new(reach, dependencies));
        let (name, text) = sources
            .read(&file.value)
            .map_err(|problem| Box::new(problem.at_name("script-file", file.at.clone())))?;
        Self::compile(sources, name, &text)
    }

    /// Compiles a text that is called `name`; it can import nothing.
    ///
    /// # Errors
    /// Same errors as [`Script::load`].
    pub fn from_text(name: &str, text: &str) -> Result<Self, Box<Diagnostic>> {
        let sources = Arc::new(Sources::without_files());
        let text = without_mark(text);
        sources.add(name, text);
        Self::compile(sources, name.to_owned(), text)
    }

    fn compile(sources: Arc<Sources>, name: String, text: &str) -> Result<Self, Box<Diagnostic>> {
        let engine = engine::engine(&sources);
        let mut ast = run_limited(Bounds::CALL, || compile(&engine, text))
            .result
            .map_err(|wrong| {
                Box::new(error::syntax(
                    wrong.err_type(),
                    wrong.position(),
                    &sources,
                    &name,
                ))
            })?;
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
        }));
        script.check_functions()?;
        script.check()?;
        Ok(script)
    }

    /// Refuses functions that would never be called, such as `fn frame()` and `fn Frame(ctx)`.
    fn check_functions(&self) -> Result<(), Box<Diagnostic>> {
        let this = &*self.0;
        for (wanted, is_there) in [("setup", this.has_setup), ("frame", this.has_frame)] {
            let alike = |name: &str| !is_there && name.eq_ignore_ascii_case(wanted);
            let Some(found) = this.ast.iter_functions().find(|f| alike(f.name)) else {
                continue;
            };
            let at = this.sources.start_of_function(&this.name, found.name);
            let error = if found.name == wanted {
                let message = format!("`{wanted}` has one parameter, `ctx`");
                let help = format!("write `fn {wanted}(ctx)`");
                Diagnostic::new("script-function", at, message).help(help)
            } else {
                let message = format!("`{}` is never called", found.name);
                let help = format!("did you mean `fn {wanted}`?");
                Diagnostic::new("script-function", at, message).help(help)
            };
            return Err(Box::new(error));
        }
        Ok(())
    }

    /// Runs the top level once, so that wrong imports are reported before the first frame.
    fn check(&self) -> Result<(), Box<Diagnostic>> {
        let this = &*self.0;
        let run = |engine: &Engine| engine.run_ast_with_scope(&mut Scope::new(), &this.ast);
        let work = || run(&this.engine).map_err(error::portable);
        let ran = run_limited(Bounds::CALL, work).or_limit();
        let ended = |wrong| self.ended(wrong, ran.again, run);
        (this.sources.or_refused(ran.result))
            .map_err(|wrong| self.explain(&ended(wrong), &[], None))?;
        this.sources.seal();
        if !this.has_frame && !this.has_setup {
            let message = "the script has neither `fn setup(ctx)` nor `fn frame(ctx)`";
            let start = this.sources.start_of(&this.name);
            let mut functions = this.ast.iter_functions();
            let help = match (functions.next(), functions.next()) {
                (Some(only), None) => {
                    format!("rename `{}` to `frame` if it moves the scene", only.name)
                }
                _ => {
                    "`frame` moves the scene, `setup` adds to it; each has one parameter".to_owned()
                }
            };
            return Err(Box::new(
                Diagnostic::new("script-empty", start, message).help(help),
            ));
        }
        Ok(())
    }

    /// Whether the script has a `frame` function, which moves the scene.
    pub fn has_frame(&self) -> bool {
        self.0.has_frame
    }

    /// Name, texts and files of the script; `setup_log` has the lines that its `setup` printed.
    pub fn describe(&self, setup_log: Vec<String>) -> ScriptDesc {
        ScriptDesc {
            name: self.0.name.clone(),
            has_frame: self.0.has_frame,
            texts: self.0.sources.texts(),
            files: self.0.sources.files(),
            setup_log,
        }
    }

    /// Name of its file in messages.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// Calls `setup`; returns its additions to the scene, as scene text, `None` where it returns nothing, and the lines
    /// that it printed.
    ///
    /// # Errors
    /// A mistake of the script, with its place.
    pub fn setup(
        &self,
        params: &[Entry<ParamValue>],
        timeline: Option<&TimelineDesc>,
    ) -> Result<(Option<String>, Vec<String>), Box<Diagnostic>> {
        if !self.0.has_setup {
            return Ok((Some(String::new()), Vec::new()));
        }
        let call = Call::new(params, timeline, timeline.map_or(0, |t| t.start));
        let contexts = [call.clone(), call].map(Context::for_setup);
        let (result, log) = self.call("setup", contexts, setup_output::text);
        let text = result.map_err(|wrong| self.explain(&wrong, params, Some("in setup")))?;
        let text = text.map_err(|wrong| {
            let at = match wrong.path.as_slice() {
                [] => self.0.sources.end_of_function(&self.0.name, "setup"),
                path => self.returned().place(path),
            };
            let mut error = Diagnostic::new("script-result", at, wrong.message);
            error.help = wrong.help;
            Box::new(error)
        })?;
        Ok((text, log))
    }

    /// Warning about a `setup` that returned nothing, and neither prints nor refuses anything.
    pub fn idle_setup(&self) -> Option<Diagnostic> {
        let texts = self.0.sources.texts();
        let says = |text: &str| {
            ["print", "debug", "throw", "return"]
                .iter()
                .any(|word| text.contains(word))
        };
        if texts.iter().any(|(_, text)| says(text)) {
            return None;
        }
        let at = self.0.sources.start_of_function(&self.0.name, "setup");
        let message = "`setup` returns nothing, so it adds nothing to the scene";
        let help = "end it with a map, as in `#{ instances: list }`; a list that another function changes is a copy there";
        Some(
            Diagnostic::new("idle-function", at, message)
                .help(help)
                .warning(),
        )
    }

    /// Places in the script that explain mistakes in the text that [`Script::setup`] returned.
    pub fn returned(&self) -> Returned {
        let Compiled { sources, name, .. } = &*self.0;
        Returned::new(sources.all(), sources.start_of_function(name, "setup"))
    }

    /// Calls `frame` on a posed scene; returns the scene as the script leaves it, and the cameras and
    /// lights that it has set.
    ///
    /// # Errors
    /// A mistake of the script, with its place and the frame.
    pub fn frame(
        &self,
        state: FrameState,
        names: &ScriptNames,
        params: &[Entry<ParamValue>],
        timeline: Option<&TimelineDesc>,
    ) -> Result<Posed, Vec<Diagnostic>> {
        if !self.0.has_frame {
            return Ok((state, ScriptedFields::default()));
        }
        self.0.sources.begin_poses();
        let frame = state.frame;
        let mut call = Call::new(params, timeline, frame);
        // While the shutter is open, this is the time of the sub-frame, not of the frame.
        call.time_s = state.time_s;
        let context = |state| Context::for_frame(call.clone(), state, names.clone());
        let (posed, afresh) = (context(state.clone()), context(state));
        let (result, log) = self.call("frame", [posed.clone(), afresh], |_| ());
        let when = format!("in frame {frame}");
        let explain = |wrong| vec![*self.explain(&wrong, params, Some(&when))];
        result.map_err(explain)?;
        let (mut state, touched) = posed.into_result();
        state.log.extend(log);
        Ok((state, touched))
    }

    /// Calls a function and extracts the needed part of its result by `take`, on the script's own thread:
    /// the result may be nested too deep for the stack of any other. The second context equals the first;
    /// a repeated call uses it to find the place of an error.
    fn call<T: Send>(
        &self,
        function: &str,
        [context, afresh]: [Context; 2],
        take: impl FnOnce(&Dynamic) -> T + Send,
    ) -> (Result<T, StoppedCall>, Vec<String>) {
        let this = &*self.0;
        let run = |engine: &Engine, context: Context| {
            // A new scope each time, and constants and imports evaluated again.
            let options = CallFnOptions::new().eval_ast(true).rewind_scope(true);
            let mut scope = Scope::new();
            let arguments = (context,);
            engine.call_fn_with_options::<Dynamic>(
                options, &mut scope, &this.ast, function, arguments,
            )
        };
        let work = move || {
            let result = run(&this.engine, context);
            result.map(|value| take(&value)).map_err(error::portable)
        };
        let ran = run_limited(Bounds::CALL, work).or_limit();
        let again = |engine: &Engine| run(engine, afresh);
        let ended = |wrong| self.ended(wrong, ran.again, again);
        let result = this.sources.or_refused(ran.result);
        (result.map_err(ended), ran.log)
    }

    /// The error with its place; where a limit was met, `again` repeats the call within `bounds` to find it.
    fn ended<T>(
        &self,
        wrong: Box<EvalAltResult>,
        bounds: Bounds,
        again: impl FnOnce(&Engine) -> Result<T, Box<EvalAltResult>> + Send,
    ) -> StoppedCall {
        let find = || {
            run_alone(bounds, || {
                limit_location::again(&self.0.sources, &wrong, again)
            })
            .result
        };
        let has_place = is_limit(&wrong) && !bounds.is_nothing();
        let met = has_place.then(find).flatten();
        StoppedCall { wrong, met }
    }

    fn explain(
        &self,
        ended: &StoppedCall,
        params: &[Entry<ParamValue>],
        when: Option<&str>,
    ) -> Box<Diagnostic> {
        let known = Known {
            functions: self.0.ast.iter_functions().map(|f| f.name).collect(),
            params: params.iter().map(|p| p.name.as_str()).collect(),
        };
        let (sources, name) = (&self.0.sources, &self.0.name);
        Box::new(error::runtime(ended, sources, name, &known, when))
    }
}

#[cfg(test)]
mod tests;
