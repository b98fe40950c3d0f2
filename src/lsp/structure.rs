//! Structure of a text: its tables or functions as symbols and as hover shows them, and its foldable ranges.

use std::ops::Range;

use serde_json::{Value, json};

use super::{
    is_script,
    names::names,
    outline::{Part, words},
    position::range,
    scopes::{Scoped, definitions},
};
use reflet_scene::{
    diagnostic::Source,
    script::tokens::{Token, tokens},
};

/// Kinds of symbols in the protocol.
const FUNCTION: u32 = 12;
const OBJECT: u32 = 19;
const STRUCT: u32 = 23;

/// A part of a text: its heading, and the range up to the next part.
struct Section {
    title: String,
    heading: Range<usize>,
    whole: Range<usize>,
    kind: u32,
}

/// Symbols of a text.
pub fn symbols(file: &Source) -> Vec<Value> {
    let symbol = |section: &Section| {
        json!({
            "name": section.title,
            "kind": section.kind,
            "range": range(&file.text, &section.whole),
            "selectionRange": range(&file.text, &section.heading),
        })
    };
    sections(file).iter().map(symbol).collect()
}

/// Ranges of lines that can be folded: tables or functions, and comments of several lines.
pub fn folds(file: &Source) -> Vec<Value> {
    let line = |offset: usize| file.text[..offset].matches('\n').count();
    let sections = sections(file);
    let mut all: Vec<(usize, usize, &str)> = (sections.iter())
        .map(|section| {
            (
                line(section.heading.start),
                line(section.whole.end),
                "region",
            )
        })
        .collect();
    let comment = if is_script(&file.path) { "//" } else { "#" };
    let mut first = None;
    for (number, text) in file.text.lines().chain([""]).enumerate() {
        match (text.trim_start().starts_with(comment), first) {
            (true, None) => first = Some(number),
            (false, Some(start)) => {
                all.push((start, number - 1, "comment"));
                first = None;
            }
            _ => {}
        }
    }
    all.retain(|(start, end, _)| end > start);
    all.sort_unstable();
    let fold = |(start, end, kind): (usize, usize, &str)| json!({ "startLine": start, "endLine": end, "kind": kind });
    all.into_iter().map(fold).collect()
}

/// Byte range of the table or function around a byte offset; the innermost one.
fn section_at(file: &Source, offset: usize) -> Option<Range<usize>> {
    let all = sections(file).into_iter().map(|section| section.whole);
    all.rev().find(|whole| whole.contains(&offset))
}

fn sections(file: &Source) -> Vec<Section> {
    let starts = match is_script(&file.path) {
        true => functions(&file.text),
        false => headers(file),
    };
    let ends: Vec<_> = starts.iter().skip(1).map(|(_, at, _)| at.start).collect();
    let ends = ends.into_iter().chain([file.text.len()]);
    (starts.into_iter().zip(ends))
        .map(|((title, heading, kind), end)| {
            let body = file.text[heading.start..end].trim_end();
            let body = without_comments(body);
            let whole = heading.start..(heading.start + body.len()).max(heading.end);
            Section {
                title,
                heading,
                whole,
                kind,
            }
        })
        .collect()
}

/// A text without the comments at its end, which are about what follows.
fn without_comments(text: &str) -> &str {
    let mut rest = text;
    while let Some((before, last)) = rest.rsplit_once('\n')
        && last.trim_start().starts_with(['#', '/'])
    {
        rest = before.trim_end();
    }
    rest
}

/// Headers of tables, and named tables that are written in one line.
fn headers(file: &Source) -> Vec<(String, Range<usize>, u32)> {
    let line_of = |at: &Range<usize>| {
        let start = file.text[..at.start].rfind('\n').map_or(0, |i| i + 1);
        let end = file.text[at.end..]
            .find('\n')
            .map_or(file.text.len(), |i| at.end + i);
        start..start + file.text[start..end].trim_end().len()
    };
    let mut all: Vec<(String, Range<usize>, u32)> = Vec::new();
    for word in words(file) {
        if word.part != Part::Header {
            continue;
        }
        let line = line_of(&word.range);
        let title = [word.table.as_slice(), &[word.text]].concat().join(".");
        match all.last_mut() {
            Some(last) if last.1 == line => last.0 = title,
            _ => all.push((title, line, STRUCT)),
        }
    }
    for name in names(file) {
        let line = line_of(&name.range);
        let is_list = file.text[line.clone()].starts_with('[');
        if name.kind == "instance" {
            // The header of a list says nothing; the name of its entry does.
            let before = all.iter_mut();
            let before = before.rev().find(|(_, at, _)| at.start < line.start);
            if let Some((title, ..)) = before.filter(|(title, ..)| title == "instance") {
                title.push_str(&format!(" \"{}\"", name.name));
            }
        } else if !is_list && name.kind != "params" && all.iter().all(|(_, at, _)| *at != line) {
            all.push((format!("{}.{}", name.kind, name.name), line, OBJECT));
        }
    }
    all.sort_by_key(|(_, at, _)| at.start);
    all
}

/// Functions that a script defines: name, line and kind of symbol.
fn functions(text: &str) -> Vec<(String, Range<usize>, u32)> {
    let tokens = tokens(text);
    let is_function = |pair: &&[Token]| pair[0].text == "fn" && pair[1].is_word();
    let named = tokens.windows(2).filter(is_function);
    let function = |pair: &[Token]| {
        let start = text[..pair[0].at.start].rfind('\n').map_or(0, |i| i + 1);
        let line = text[start..].lines().next().unwrap_or_default();
        let line = start..start + line.trim_end().len();
        (pair[1].text.to_owned(), line, FUNCTION)
    };
    named.map(function).collect()
}

/// Largest number of lines that are shown of a table.
const MOST_LINES: usize = 30;

/// The table that defines a name, with its place, as Markdown.
pub fn table(files: &[Scoped], name: &str, is_kind: impl Fn(&str) -> bool) -> Option<String> {
    let (source, name) = definitions(files, name, is_kind).into_iter().next()?;
    let at = section_at(&source, name.range.start)?;
    let line = source.text[..at.start].matches('\n').count() + 1;
    let mut shown: Vec<_> = source.text[at].lines().take(MOST_LINES + 1).collect();
    if let Some(last) = shown.get_mut(MOST_LINES) {
        *last = "# …";
    }
    let (shown, file) = (shown.join("\n"), source.path.display());
    Some(format!("```toml\n{shown}\n```\n`{file}:{line}`"))
}

/// Signature of a function that a script defines, and the comment before it, as Markdown.
pub fn function(script: &str, name: &str) -> Option<String> {
    let all = functions(script).into_iter();
    let (_, line, _) = all.into_iter().find(|(known, ..)| known == name)?;
    let signature = script[line.clone()].split('{').next()?.trim();
    let above = script[..line.start].lines().rev();
    let mut comment: Vec<_> = above
        .map_while(|line| line.trim_start().strip_prefix("//"))
        .map(|line| line.trim_start_matches('/').trim())
        .collect();
    comment.reverse();
    Some(format!("```rhai\n{signature}\n```\n{}", comment.join("\n")))
}
