//! Text to what Rhai runs.

use rhai::{AST, Engine, LexError, ParseError, ParseErrorType};

use super::call_limits::met;

/// Compiles a text. Where a limit was met, Rhai may say that something else was expected there.
///
/// # Errors
/// A mistake of the text, or the limit.
pub fn compile(engine: &Engine, text: &str) -> Result<AST, ParseError> {
    engine.compile(text).map_err(|wrong| match met() {
        Some(why) => {
            let limit = ParseErrorType::BadInput(LexError::Runtime(why));
            ParseError(limit.into(), wrong.position())
        }
        None => wrong,
    })
}
