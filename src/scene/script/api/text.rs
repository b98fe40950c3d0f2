//! Widths of texts, and places of their letters, as text shapes have them.

use std::sync::Arc;

use reflet_base::guard;
use reflet_text::{Font, Letter, Line, WrongFont};
use rhai::{Dynamic, Engine, EvalAltResult, Map, Position};

use super::super::{
    call_limits::progress, setup_output::keys, source_files::Sources, value::fail_with,
};
use crate::{
    desc::ShapeDesc,
    syntax::SyntaxTree,
    table::{Place, Table, report::Report},
};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Operations that a byte of a text counts as.
const OPERATIONS: u64 = 1000;

/// Registers the functions of texts, whose fonts are files beside the sources of a script.
pub fn register(engine: &mut Engine, sources: &Arc<Sources>) {
    let own = Arc::clone(sources);
    engine.register_fn("text_width", move |text: &str, look: Map| {
        let widths = |lines: Vec<Line>| lines.into_iter().map(|line| line.width);
        lines(&own, text, &look).map(|lines| widths(lines).fold(0.0, f64::max))
    });
    let own = Arc::clone(sources);
    engine.register_fn("text_letters", move |text: &str, look: Map| {
        let lines = lines(&own, text, &look)?;
        let letters = lines.into_iter().flat_map(|line| line.letters);
        let letters = letters.filter(Letter::is_visible).map(|letter| {
            let [x, y] = letter.place;
            let numbers = [("x", x), ("y", y), ("width", letter.width)];
            let mut map = Map::from([("text".into(), letter.text.into())]);
            map.extend(numbers.map(|(key, x)| (key.into(), Dynamic::from(x))));
            Dynamic::from(map)
        });
        Ok::<_, Box<EvalAltResult>>(letters.collect::<Vec<_>>())
    });
}

/// Lines of a text shape of these keys.
fn lines(sources: &Sources, text: &str, look: &Map) -> Result<Vec<Line>> {
    let shape = shape(text, look)?;
    let (Some(lines), ShapeDesc::Text { font, .. }) = (shape.lines(), &shape) else {
        return Ok(Vec::new());
    };
    if let Some(why) = progress(OPERATIONS * text.len() as u64) {
        return Err(EvalAltResult::ErrorTerminated(why.into(), Position::NONE).into());
    }
    let bytes = font
        .as_ref()
        .map(|font| sources.font(&font.file))
        .transpose();
    let bytes = bytes.or_else(|problem| fail_with(problem.message, problem.help))?;
    let bytes = bytes.as_deref().unwrap_or(Font::OWN);
    let set = || Ok::<_, WrongFont>(lines.set_in(&Font::open(bytes)?));
    let set = guard::catch(set).unwrap_or_else(|| Err(WrongFont::damaged()));
    set.or_else(|wrong| fail_with(wrong.message, wrong.help))
}

/// The text shape of these keys, read as scene text is.
fn shape(text: &str, look: &Map) -> Result<ShapeDesc> {
    let own = [("kind", "text"), ("text", text)];
    let mut map = look.clone();
    map.extend(own.map(|(key, value)| (key.into(), value.into())));
    let mut written = String::new();
    if let Err(wrong) = keys(&mut written, &map) {
        return fail_with(wrong.message, wrong.help.unwrap_or_default());
    }
    let mut report = Report::default();
    let place = Place {
        whole: "a text",
        ..Place::default()
    };
    let tree = SyntaxTree::parse(&written);
    let entries = tree.correct().map_err(|error| error.message.clone())?;
    let read = Table::read::<ShapeDesc>(&mut report, entries, place);
    match (read, report.finish().0.pop()) {
        (Some(shape), None) => Ok(shape),
        (_, Some(wrong)) => fail_with(wrong.message, wrong.help.unwrap_or_default()),
        (None, None) => fail_with("these are no keys of a text".to_owned(), ""),
    }
}
