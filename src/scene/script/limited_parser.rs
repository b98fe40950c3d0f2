//! Parsing of a script within the limits of a call. Rhai's parser has no limits, and its time for some
//! lists grows with the square of their length; each token is a chance to end it.

use rhai::{Engine, LexError, OptimizationLevel, Token};

use super::{call_limits::progress, catch_values::Caught};

/// Has an engine check the limits at each token, and pass each token to `caught`.
pub fn register(engine: &mut Engine, caught: &Caught) {
    let caught = caught.clone();
    // The optimizer runs after the last token, so no check could end it.
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
        // Rhai turns an integer that is too large into a float.
        Token::FloatConstant(number) => {
            let is_integer = !number.1.contains(['.', 'e', 'E']);
            is_integer.then(|| LexError::MalformedNumber(number.1.to_string()))
        }
        _ => None,
    }
}
