//! How a script was ended, and where.

use rhai::{EvalAltResult, Position};

/// A place in one of a script's files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// What messages call the file.
    pub file: String,
    /// Where in it.
    pub at: Position,
}

/// Where a script was when it was ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Met {
    /// The expression or statement.
    pub place: Place,
    /// Functions that were called, outermost first, and from where.
    pub calls: Vec<(String, Place)>,
}

/// How a script was ended.
pub struct Ended {
    /// What Rhai says.
    pub wrong: Box<EvalAltResult>,
    /// Where, if it was by a limit.
    pub met: Option<Met>,
}

/// Whether an error is one whose place Rhai overwrites.
pub fn is_limit(wrong: &EvalAltResult) -> bool {
    matches!(
        wrong.unwrap_inner(),
        EvalAltResult::ErrorTooManyOperations(_)
            | EvalAltResult::ErrorTooManyVariables(_)
            | EvalAltResult::ErrorTooManyModules(_)
            | EvalAltResult::ErrorStackOverflow(_)
            | EvalAltResult::ErrorDataTooLarge(..)
            | EvalAltResult::ErrorTerminated(..)
    )
}
