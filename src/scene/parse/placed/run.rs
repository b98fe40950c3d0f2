//! Input and results of the scripts of placed scenes.

use std::{collections::BTreeMap, sync::Arc};

use crate::{
    desc::{At, Entry, ParamValue, TimelineDesc},
    diagnostic::{Diagnostic, Source, Span},
    reach::Reach,
};

/// Input of the script of a placed scene.
pub struct ScriptInput<'a> {
    /// Folders where files are looked for, the placed scene's first.
    pub reach: &'a Reach,
    /// Name of the script's file, with its place.
    pub file: &'a At<String>,
    /// Parameters of the placed scene, with their values in this placement.
    pub params: &'a [Entry<ParamValue>],
    /// [`RanScript::number`] of the same script, if it was run before with other parameters.
    pub known: Option<usize>,
    /// The timeline of the outermost scene.
    pub timeline: Option<&'a TimelineDesc>,
}

/// A script whose `setup` was run.
#[derive(Clone, Debug)]
pub struct RanScript {
    /// Index of the script among all scripts of placed scenes.
    pub number: usize,
    /// Scene text that `setup` returned.
    pub text: Arc<Source>,
}

impl RanScript {
    /// Whether a place is in one of the script's files.
    pub fn has(&self, at: &Span) -> bool {
        self.text.returned.as_ref().is_some_and(|r| r.has(at))
    }
}

/// Function that loads a script and runs its `setup`.
pub type Run<'r> = &'r mut dyn FnMut(&ScriptInput) -> Result<RanScript, Box<Diagnostic>>;

/// Results of the scripts of placed files, one for all placements of a file with the same parameters.
#[derive(Default)]
pub struct Runs(Vec<OneRun>);

struct OneRun {
    /// Text of the placed file.
    file: Arc<Source>,
    params: BTreeMap<String, ParamValue>,
    /// Result; `None` where the script failed, which was reported.
    ran: Option<RanScript>,
}

impl Runs {
    /// Result of a placed file's script with these parameters. `run` is called if there is none yet, with the
    /// script's number, if it has one.
    pub fn with(
        &mut self,
        file: &Arc<Source>,
        params: &[Entry<ParamValue>],
        run: impl FnOnce(Option<usize>) -> Option<RanScript>,
    ) -> Option<RanScript> {
        let values = params.iter().map(|p| (p.name.clone(), p.value.clone()));
        let params: BTreeMap<_, _> = values.collect();
        let of_file = || self.0.iter().filter(|run| Arc::ptr_eq(&run.file, file));
        if let Some(done) = of_file().find(|run| run.params == params) {
            return done.ran.clone();
        }
        let known = of_file().find_map(|run| Some(run.ran.as_ref()?.number));
        let ran = run(known);
        self.0.push(OneRun {
            file: Arc::clone(file),
            params,
            ran: ran.clone(),
        });
        ran
    }
}
