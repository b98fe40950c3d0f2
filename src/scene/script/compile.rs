//! Compilation of script text to the AST that Rhai runs.

use rhai::{AST, Engine, LexError, ParseError, ParseErrorType};

use super::call_limits::met;

/// Compiles a text. If a limit was met, the error says so: Rhai may say that it expected something else there.
///
/// # Errors
/// A mistake of the text, or the limit that was met.
pub fn compile(engine: &Engine, text: &str) -> Result<AST, ParseError> {
    engine.compile(text).map_err(|wrong| match met() {
        Some(why) => {
            let limit = ParseErrorType::BadInput(LexError::Runtime(why));
            ParseError(limit.into(), wrong.position())
        }
        None => wrong,
    })
}
