//! What the script of a placed scene is given, and what it gives.

use std::path::PathBuf;

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
    /// The parameters of the placed scene.
    pub params: &'a [Entry<ParamValue>],
    /// The timeline of the outermost scene.
    pub timeline: Option<&'a TimelineDesc>,
}

/// A script whose `setup` was run.
pub struct RanScript {
    /// Its number among all that were run.
    pub number: usize,
    /// What messages call its file.
    pub name: String,
    /// What `setup` returned, as scene text.
    pub text: String,
    /// What mistakes of the text are explained by.
    pub returned: Returned,
}

/// Loads a script and runs its `setup`.
pub type Run<'r> = &'r dyn Fn(&ScriptInput) -> Result<RanScript, Box<Diagnostic>>;

/// The script of one placed scene.
#[derive(Debug)]
pub struct PlacedScript {
    /// Name of the group that stands for the scene.
    pub group: String,
    /// See [`RanScript::number`].
    pub number: usize,
    /// The parameters that the scene declares.
    pub params: Vec<Entry<ParamValue>>,
}
