//! Error that ended a script, and its place.

use rhai::{EvalAltResult, Position};

/// A place in one of a script's files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Name of the file in messages.
    pub file: String,
    /// Position in the file.
    pub at: Position,
}

/// Place of a script when it was ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LimitHit {
    /// Place of the expression or statement.
    pub place: Place,
    /// Functions on the call stack, outermost first, and the places of their calls.
    pub calls: Vec<(String, Place)>,
}

/// Error that ended a script.
pub struct StoppedCall {
    /// Error of Rhai.
    pub wrong: Box<EvalAltResult>,
    /// Place of the error, if it was a limit and the place was found.
    pub met: Option<LimitHit>,
}

/// Whether a limit caused an error, whose place Rhai overwrites.
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
