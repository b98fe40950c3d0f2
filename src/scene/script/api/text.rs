//! Widths of texts, and places of their letters, as text shapes have them.

use std::sync::Arc;

use reflet_base::guard;
use reflet_text::{Font, Lines, PastLast, WrongFont};
use rhai::{Dynamic, Engine, EvalAltResult, ImmutableString, Map, Position};

use super::super::{
    call_limits::progress,
    setup_output::keys,
    source_files::Sources,
    value::{WrongKey, fail_with},
};
use crate::{
    desc::{MOST_CHARACTERS, ShapeDesc, control_character},
    suggest,
    syntax::SyntaxTree,
    table::{Place, Table, report::Report},
};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Operations that opening a font counts as.
const OPEN: u64 = 5000;
/// Operations that a byte of a text counts as.
const BYTE: u64 = 1000;
/// Operations that a key counts as.
const KEY: u64 = 3000;
/// Operations that a wrong key counts as, which is compared with the names of all keys for advice.
const MISTAKE: u64 = 10_000;
/// Operations that a byte of scene text counts as, into which keys are written.
const WRITTEN_BYTE: u64 = 10;
/// Operations that the outline of a letter counts as.
const OUTLINE: u64 = 100;

/// Counts operations of the call.
fn charge(operations: u64) -> Result<()> {
    progress(operations).map_or(Ok(()), |why| {
        Err(EvalAltResult::ErrorTerminated(why.into(), Position::NONE).into())
    })
}

/// Registers the functions of texts, whose fonts are files beside the sources of a script.
pub fn register(engine: &mut Engine, sources: &Arc<Sources>) {
    let own = Arc::clone(sources);
    engine.register_fn("text_width", move |text: &str, look: Map| {
        in_font(&own, text, &look, |lines, font| {
            let widths = lines.set_in(font).into_iter().map(|line| line.width);
            widths.fold(0.0, f64::max)
        })
    });
    let own = Arc::clone(sources);
    engine.register_fn("text_letters", move |text: &str, look: Map| {
        let letters = in_font(&own, text, &look, |lines, font| {
            let letters = lines.visible_letters(font);
            (letters.take_while(|_| progress(OUTLINE).is_none())).collect::<Vec<_>>()
        })?;
        let letters = letters.into_iter().map(|letter| {
            let [x, y] = letter.place;
            let numbers = [("x", x), ("y", y), ("width", letter.width)];
            let mut map = Map::from([("text".into(), letter.text.into())]);
            map.extend(numbers.map(|(key, x)| (key.into(), Dynamic::from(x))));
            Dynamic::from(map)
        });
        Ok::<_, Box<EvalAltResult>>(letters.collect::<Vec<_>>())
    });
}

/// Result of work with the lines of a text shape of these keys and with its font.
fn in_font<T: Default>(
    sources: &Sources,
    text: &str,
    look: &Map,
    work: impl FnOnce(&Lines, &Font) -> T,
) -> Result<T> {
    charge(OPEN + BYTE * text.len() as u64 + KEY * look.len() as u64)?;
    let shape = shape(text, look)?;
    let (Some(lines), ShapeDesc::Text { font, letter, .. }) = (shape.lines(), &shape) else {
        return Ok(T::default());
    };
    let lines = Lines { text, ..lines };
    let bytes = font
        .as_ref()
        .map(|font| sources.font(&font.file))
        .transpose();
    let bytes = bytes.or_else(|problem| fail_with(problem.message, problem.help))?;
    let bytes = bytes.as_deref().unwrap_or(Font::OWN);
    let done = || {
        let font = Font::open(bytes)?;
        let letter = letter.map(|number| lines.letter(&font, number)).transpose();
        Ok(letter.map(|_| work(&lines, &font)))
    };
    let done = guard::catch(done).unwrap_or_else(|| Err(WrongFont::damaged()));
    match done {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(wrong)) => {
            fail_with(wrong.message, PastLast::HELP).map_err(WrongKey::in_key("letter"))
        }
        Err(WrongFont { message, help }) => {
            let named = font.as_ref().map(|font| font.message(&message));
            fail_with(named.unwrap_or(message), help)
        }
    }
}

/// A text shape of these keys, read as scene text is, with letters in place of the text, which may be empty here.
fn shape(text: &str, look: &Map) -> Result<ShapeDesc> {
    let count = text.chars().count();
    if count > MOST_CHARACTERS {
        let message = format!("a text must be at most {MOST_CHARACTERS} characters, not {count}");
        return fail_with(message, "measure its lines or its words one by one");
    }
    if let Some((_, message, help)) = control_character(text) {
        return fail_with(message, help);
    }
    let mut map = look.clone();
    for (key, value, own) in [("kind", "text", "text"), ("text", text, "letters")] {
        if let Some(given) = map.insert(key.into(), own.into())
            && !given
                .read_lock::<ImmutableString>()
                .is_some_and(|given| *given == value)
        {
            let message = format!("`{key}` must be {} here", suggest::text(value));
            return fail_with(message, format!("leave `{key}` out")).map_err(WrongKey::in_key(key));
        }
    }
    let mut written = String::new();
    if let Err(wrong) = keys(&mut written, &map) {
        return fail_with(wrong.message, wrong.help.unwrap_or_default());
    }
    charge(WRITTEN_BYTE * written.len() as u64)?;
    let mut report = Report::default();
    let place = Place {
        whole: "a text",
        ..Place::default()
    };
    let tree = SyntaxTree::parse(&written);
    let entries = tree.correct().map_err(|error| error.message.clone())?;
    let read = Table::read::<ShapeDesc>(&mut report, entries, place);
    let mut mistakes = report.finish().0;
    charge(MISTAKE * mistakes.len() as u64)?;
    match (read, mistakes.pop()) {
        (Some(shape), None) => Ok(shape),
        (_, Some(wrong)) => fail_with(wrong.message, wrong.help.unwrap_or_default()),
        (None, None) => fail_with("these are no keys of a text".to_owned(), ""),
    }
}
