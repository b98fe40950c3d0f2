//! Parsing of a script within the limits of a call. Rhai's parser has no limits, and its time for some
//! lists grows with the square of their length; each token is a chance to end it.

use std::sync::{Mutex, PoisonError};

use rhai::{Engine, LexError, OptimizationLevel, Token};

use super::{
    call_limits::progress,
    catch_values::Caught,
    limits::{ARGUMENTS, VARIABLES},
};

/// Has an engine check the limits at each token, and pass each token to `caught`.
pub fn register(engine: &mut Engine, caught: &Caught) {
    let caught = caught.clone();
    let open = Mutex::default();
    // The optimizer runs after the last token, so no check could end it.
    engine.set_optimization_level(OptimizationLevel::None);
    #[expect(
        deprecated,
        reason = "Rhai marks its token callback so to say that it may change"
    )]
    engine.on_parse_token(move |token, _, _| match wrong_with(&token, &open) {
        Some(wrong) => Token::LexError(wrong.into()),
        None => {
            caught.note(&token);
            token
        }
    });
}

/// An open bracket.
#[derive(Default)]
struct Bracket {
    /// Number of commas so far; `None` in brackets without arguments.
    commas: Option<usize>,
    /// Number of variables that are defined in it so far.
    variables: usize,
}

/// Open brackets, the outermost first; the text around them all is one from its first variable on.
type Open = Mutex<Vec<Bracket>>;

fn wrong_with(token: &Token, open: &Open) -> Option<LexError> {
    if let Some(why) = progress(1).or_else(|| too_long(token, open)) {
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

/// Message about a call with too many arguments, or a block with too many variables: Rhai's work on them grows with the
/// square of their number.
fn too_long(token: &Token, open: &Open) -> Option<String> {
    let mut open = open.lock().unwrap_or_else(PoisonError::into_inner);
    match token {
        Token::LeftParen => open.push(Bracket {
            commas: Some(0),
            ..Bracket::default()
        }),
        Token::LeftBracket | Token::LeftBrace | Token::MapStart => open.push(Bracket::default()),
        Token::RightParen | Token::RightBracket | Token::RightBrace => drop(open.pop()),
        Token::EOF => open.clear(),
        Token::Comma => {
            let commas = open.last_mut()?.commas.as_mut()?;
            *commas += 1;
            return (*commas >= ARGUMENTS)
                .then(|| format!("a call has more than {ARGUMENTS} arguments"));
        }
        Token::Let | Token::Const => {
            if open.is_empty() {
                open.push(Bracket::default());
            }
            let block = open.last_mut()?;
            block.variables += 1;
            return (block.variables > VARIABLES)
                .then(|| format!("a block has more than {VARIABLES} variables"));
        }
        _ => {}
    }
    None
}
