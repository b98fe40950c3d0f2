//! Input and results of the scripts of placed scenes.

use std::{cell::OnceCell, path::PathBuf};

use crate::scene::{
    desc::{At, Entry, ParamValue, TimelineDesc},
    diagnostic::{Diagnostic, Returned},
};

/// Input of the script of a placed scene.
pub struct ScriptInput<'a> {
    /// Folders where files are looked for, those of the placed scene first.
    pub folders: &'a [PathBuf],
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
pub struct RanScript {
    /// Index of the script among all scripts of placed scenes.
    pub number: usize,
    /// Name of its file in messages.
    pub name: String,
    /// Scene text that `setup` returned.
    pub text: String,
    /// Places in the script that explain mistakes in that text.
    pub returned: Returned,
}

/// Results of a placed file's script, one for all placements with the same parameters.
#[derive(Default)]
pub struct Runs(OnceCell<Box<OneRun>>);

struct OneRun {
    params: Vec<Entry<ParamValue>>,
    /// Result; `None` where the script failed, which was reported.
    ran: Option<RanScript>,
    others: Runs,
}

impl Runs {
    /// Result of the script with these parameters. `run` is called if there is none yet, with the script's
    /// number, if it has one.
    pub fn with(
        &self,
        params: &[Entry<ParamValue>],
        run: impl FnOnce(Option<usize>) -> Option<RanScript>,
    ) -> Option<&RanScript> {
        let is_same = |run: &OneRun| {
            let values = |params: &[Entry<ParamValue>]| {
                let values = params.iter().map(|p| (p.name.clone(), p.value.clone()));
                values.collect::<std::collections::BTreeMap<_, _>>()
            };
            values(&run.params) == values(params)
        };
        let (mut runs, mut known) = (self, None);
        while let Some(done) = runs.0.get() {
            if is_same(done) {
                return done.ran.as_ref();
            }
            known = known.or(done.ran.as_ref().map(|ran| ran.number));
            runs = &done.others;
        }
        let one = OneRun {
            params: params.to_vec(),
            ran: run(known),
            others: Self::default(),
        };
        runs.0.get_or_init(|| Box::new(one)).ran.as_ref()
    }
}

/// Loads a script and runs its `setup`.
pub type Run<'r> = &'r dyn Fn(&ScriptInput) -> Result<RanScript, Box<Diagnostic>>;

/// The script of one placed scene.
#[derive(Clone, Debug)]
pub struct PlacedScript {
    /// See [`RanScript::number`].
    pub number: usize,
    /// See [`RanScript::returned`].
    pub returned: Returned,
}
