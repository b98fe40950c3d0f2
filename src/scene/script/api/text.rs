//! Widths of texts, and places of their letters, as text shapes have them.

use std::sync::Arc;

use reflet_base::guard;
use reflet_text::{Font, Lines, WrongFont};
use rhai::{Dynamic, Engine, EvalAltResult, Map, Position};

use super::super::{
    call_limits::progress,
    setup_output::keys,
    source_files::Sources,
    value::{WrongKey, fail_with},
};
use crate::{
    desc::{FileDesc, ShapeDesc},
    suggest,
    syntax::SyntaxTree,
    table::{Place, Table, report::Report},
};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Operations that opening a font counts as.
const OPEN: u64 = 5000;
/// Operations that a byte of a text, and the outline of a letter, count as.
const BYTE: u64 = 1000;
/// Operations that a key counts as.
const KEY: u64 = 3000;
/// Operations that a wrong key counts as, which is compared with the names of all keys for advice.
const MISTAKE: u64 = 10_000;
/// Operations that a byte of scene text counts as, into which keys are written.
const WRITTEN_BYTE: u64 = 10;

/// Counts operations of the call.
fn charge(operations: u64) -> Result<()> {
    let ended = |why: String| EvalAltResult::ErrorTerminated(why.into(), Position::NONE).into();
    progress(operations).map_or(Ok(()), |why| Err(ended(why)))
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
            (letters.take_while(|_| progress(BYTE).is_none())).collect::<Vec<_>>()
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
    let read = |font: &FileDesc| sources.font(&font.file);
    let bytes = font.as_ref().map(read).transpose();
    let bytes = bytes.or_else(|problem| fail_with(problem.message, problem.help))?;
    let bytes = bytes.as_deref().unwrap_or(Font::OWN);
    let name = font.as_ref().map_or("", |font| &font.file);
    let done = || {
        let font = Font::open(bytes, name)?;
        letter.map_or(Ok(()), |number| lines.letter(&font, number).map(drop))?;
        Ok(work(&lines, &font))
    };
    let done = guard::catch(done).unwrap_or_else(|| Err(WrongFont::damaged()));
    done.or_else(|WrongFont { message, help }| {
        let named = font.as_ref().map(|font| font.message(&message));
        fail_with(named.unwrap_or(message), help)
    })
}

/// A text shape of these keys, read as scene text is, with a letter before spaces alone, which no shape has.
fn shape(text: &str, look: &Map) -> Result<ShapeDesc> {
    let mut map = look.clone();
    for (key, value) in [("kind", "text"), ("text", text)] {
        let given = map.insert(key.into(), value.into());
        if given.is_some_and(|given| given.into_string().as_deref() != Ok(value)) {
            let message = format!("`{key}` must be {} here", suggest::text(value));
            return fail_with(message, format!("leave `{key}` out")).map_err(WrongKey::in_key(key));
        }
    }
    if text.trim().is_empty() {
        let spaces = text.trim_start_matches(' ');
        map.insert("text".into(), format!("a{spaces}").into());
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
