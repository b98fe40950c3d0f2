//! What the script of a placed scene is given, and what it gives.

use std::{cell::OnceCell, path::PathBuf};

use crate::scene::{
    desc::{At, Entry, ParamValue, TimelineDesc},
    diagnostic::{Diagnostic, Returned},
};

/// What the script of a placed scene is given.
pub struct ScriptInput<'a> {
    /// Where files are looked for, those of the placed scene first.
    pub folders: &'a [PathBuf],
    /// Its name.
    pub file: &'a At<String>,
    /// The parameters of the placed scene, as they are where it stands.
    pub params: &'a [Entry<ParamValue>],
    /// [`RanScript::number`] of the same script, where it was run with other parameters.
    pub known: Option<usize>,
    /// The timeline of the outermost scene.
    pub timeline: Option<&'a TimelineDesc>,
}

/// A script whose `setup` was run.
pub struct RanScript {
    /// Its number among all scripts of placed scenes.
    pub number: usize,
    /// What messages call its file.
    pub name: String,
    /// What `setup` returned, as scene text.
    pub text: String,
    /// What mistakes of the text are explained by.
    pub returned: Returned,
}

/// What the script of a placed file gave, once for all places with the same parameters.
#[derive(Default)]
pub struct Runs(OnceCell<Box<OneRun>>);

struct OneRun {
    params: Vec<Entry<ParamValue>>,
    /// `None` where it failed, which was reported.
    ran: Option<RanScript>,
    others: Runs,
}

impl Runs {
    /// What the script gives with these parameters; `run` runs it where it was not run with them, and is
    /// told its number.
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
