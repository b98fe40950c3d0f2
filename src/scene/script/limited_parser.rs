//! Reading a script within the limits of a call. Rhai's parser knows none, and some lists take it a
//! time that grows with their square; each token is a chance to end it.

use rhai::{Engine, LexError, OptimizationLevel, Token};

use super::{call_limits::progress, catch_values::Caught};

/// Puts the limits into an engine, which tells `caught` each token.
pub fn register(engine: &mut Engine, caught: &Caught) {
    let caught = caught.clone();
    // The optimizer runs after the last token, where nothing ends it.
    engine.set_optimization_level(OptimizationLevel::None);
    #[expect(
        deprecated,
        reason = "Rhai marks its token callback so to say that it may change"
    )]
    engine.on_parse_token(move |token, _, _| match wrong_with(&token) {
        Some(wrong) => Token::LexError(wrong.into()),
        None => {
            caught.note(&token);
            token
        }
    });
}

fn wrong_with(token: &Token) -> Option<LexError> {
    if let Some(why) = progress(1) {
        return Some(LexError::Runtime(why));
    }
    match token {
        // Rhai makes a float of an integer that is too large.
        Token::FloatConstant(number) => {
            let is_integer = !number.1.contains(['.', 'e', 'E']);
            is_integer.then(|| LexError::MalformedNumber(number.1.to_string()))
        }
        _ => None,
    }
}
