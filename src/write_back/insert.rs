//! New keys and tables in scene text: a key lands where the manual lists it among the keys of its table, a table after
//! the tables of its kind.

use super::tree::{Step, find};
use reflet_scene::{
    parse::recorded_keys,
    syntax::{Content, Entries, Key, Node, key_text},
};

/// Keys of a table in the order of the manual; `section` is the table's type in `desc.rs`.
pub fn order_of(section: &str) -> Vec<&'static str> {
    let sections = recorded_keys();
    let found = sections.iter().find(|known| known.type_name == section);
    let of_variants = || found.into_iter().flat_map(|section| &section.variants);
    let own = (found.into_iter()).flat_map(|section| section.groups().flat_map(|(_, keys)| keys));
    // The key that chooses the variant begins the table.
    let chooses = of_variants().next().map(|variant| variant.key);
    let mut order = Vec::from_iter(chooses);
    for key in own.chain(of_variants().flat_map(|variant| &variant.keys)) {
        if !order.contains(&key.name) {
            order.push(key.name);
        }
    }
    order
}

/// Whether a value has a header of its own, `[a.b]` or `[[a.b]]`, so that it comes after the keys of its table.
fn has_header(text: &str, value: &Node) -> bool {
    let starts = |node: &Node, with: &str| text[node.span().start..].starts_with(with);
    match value.get_ref() {
        Content::Table(_) => starts(value, "["),
        Content::Array(items) => items
            .first()
            .is_some_and(|item| item.get_ref().as_table().is_some() && starts(item, "[[")),
        _ => false,
    }
}

/// End of the last byte of a value, with its table's values.
fn end_of(node: &Node) -> usize {
    let own = node.span().end;
    let inner: Box<dyn Iterator<Item = &Node>> = match node.get_ref() {
        Content::Table(all) => Box::new(all.values()),
        Content::Array(items) => Box::new(items.iter()),
        _ => Box::new(std::iter::empty()),
    };
    inner.map(end_of).fold(own, usize::max)
}

/// End of the line that contains a byte, without its line end, and how its lines end.
fn line_end(text: &str, from: usize) -> (usize, &'static str) {
    let end = text[from..].find('\n').map_or(text.len(), |end| from + end);
    match text[..end].ends_with('\r') && end < text.len() {
        true => (end - 1, "\r\n"),
        false => (end, if text.contains("\r\n") { "\r\n" } else { "\n" }),
    }
}

/// Start of the line that contains a byte.
fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |end| end + 1)
}

/// White space at the start of the line that contains a byte.
fn indent(text: &str, at: usize) -> &str {
    let line = &text[line_start(text, at)..at];
    &line[..line.len() - line.trim_start().len()]
}

/// The text with one more key in a table.
pub fn insert(
    text: &str,
    node: &Node,
    table: &Entries,
    (key, value): (&str, &str),
    order: &[&str],
) -> String {
    let rank = |key: &str| order.iter().position(|known| *known == key);
    let new_rank = rank(key).unwrap_or(usize::MAX);
    let own = || table.iter().filter(|(_, value)| !has_header(text, value));
    let end = |(_, value): &(&_, &Node)| end_of(value);
    let earlier = own().filter_map(|(key, value)| Some((rank(key.get_ref())?, value)));
    let earlier = earlier.filter(|(rank, _)| *rank < new_rank);
    let before = earlier.max_by_key(|(rank, value)| (*rank, end_of(value)));
    // Keys that the manual lists later come after it, unless there is no other place.
    let first = own().min_by_key(|(key, _)| key.span().start);
    let after = match (before, new_rank) {
        (Some((_, value)), _) => Some(end_of(value)),
        (None, usize::MAX) => own().map(|entry| end(&entry)).max(),
        (None, _) => None,
    };
    let line = format!("{} = {value}", key_text(key));
    let at = node.span();
    let mut out = text.to_owned();
    let starts = |with: char| text[at.start..].starts_with(with);
    if starts('{') {
        match (after, first) {
            (Some(end), _) => out.insert_str(end, &format!(", {line}")),
            (None, Some((first, _))) => out.insert_str(first.span().start, &format!("{line}, ")),
            (None, None) => out.replace_range(at, &format!("{{ {line} }}")),
        }
        return out;
    }
    if !starts('[') {
        return insert_dotted(text, node, first, after, &line);
    }
    match (after, first) {
        (None, Some((first, _))) => {
            let start = first.span().start;
            let (_, newline) = line_end(text, start);
            let indent = indent(text, start);
            out.insert_str(line_start(text, start), &format!("{indent}{line}{newline}"));
        }
        (after, _) => {
            let (end, newline) = line_end(text, after.unwrap_or(at.end));
            let indent = first.map_or("", |(first, _)| indent(text, first.span().start));
            out.insert_str(end, &format!("{newline}{indent}{line}"));
        }
    }
    out
}

/// The text with one more key in a table that dotted keys make, as `material.roughness = 1`.
fn insert_dotted(
    text: &str,
    node: &Node,
    first: Option<(&Key, &Node)>,
    after: Option<usize>,
    line: &str,
) -> String {
    let mut out = text.to_owned();
    let start = node.span().start;
    let Some((first, value)) = first else {
        return out;
    };
    // Between the table's own key and its first value's: `material.`.
    let prefix = &text[start..first.span().start.max(start)];
    let is_line = text[line_start(text, start)..start].trim().is_empty();
    let end = after.unwrap_or_else(|| end_of(value));
    if is_line {
        let (end, newline) = line_end(text, end);
        let indent = indent(text, start);
        out.insert_str(end, &format!("{newline}{indent}{prefix}{line}"));
    } else {
        out.insert_str(end, &format!(", {prefix}{line}"));
    }
    out
}

/// Text of a header, `[a."b c"]`.
fn header(locator: &[Step]) -> Option<String> {
    let names = locator.iter().map(|step| step.key().map(key_text));
    let names = names.collect::<Option<Vec<_>>>()?;
    Some(format!("[{}]", names.join(".")))
}

/// The text with a new table, which has these keys.
///
/// # Errors
/// A table around it that is neither there nor can have a header.
pub fn insert_table(
    text: &str,
    root: &Entries,
    locator: &[Step],
    lines: &[(&str, String)],
) -> Result<String, String> {
    let body = |separator: &str| {
        let lines = lines.iter().map(|(key, value)| format!("{key} = {value}"));
        lines.collect::<Vec<_>>().join(separator)
    };
    // An inline table around it takes an inline table.
    for depth in (1..locator.len()).rev() {
        let Some(node) = find(root, &locator[..depth]) else {
            continue;
        };
        let Content::Table(table) = node.get_ref() else {
            return Err("what is around it is not written as a table".to_owned());
        };
        let is_of_list = locator[..depth].iter().any(|step| step.key().is_none());
        let is_inline = text[node.span().start..].starts_with('{');
        if is_inline || (is_of_list && text[node.span().start..].starts_with('[')) {
            let missing = &locator[depth..];
            let mut value = format!("{{ {} }}", body(", "));
            for step in missing[1..].iter().rev() {
                let key = step.key().ok_or("its table is not there any more")?;
                value = format!("{{ {} = {value} }}", key_text(key));
            }
            let key = missing[0].key().ok_or("its table is not there any more")?;
            let order = order_of(if is_of_list { "InstanceDesc" } else { "" });
            return Ok(insert(text, node, table, (key, &value), &order));
        }
        break;
    }
    let header = header(locator).ok_or("its table is not there any more")?;
    let (_, newline) = line_end(text, 0);
    let body = body(newline);
    let mut out = text.to_owned();
    match sibling_end(text, root, locator) {
        Some(end) => {
            let (end, _) = line_end(text, end);
            out.insert_str(end, &format!("{newline}{newline}{header}{newline}{body}"));
        }
        None => {
            let gap = match out.is_empty() || out.ends_with('\n') {
                true => newline.to_owned(),
                false => newline.repeat(2),
            };
            out.push_str(&format!("{gap}{header}{newline}{body}{newline}"));
        }
    }
    Ok(out)
}

/// End of the last table after which the manual would put a new one: of its own kind, else of a kind before it.
fn sibling_end(text: &str, root: &Entries, locator: &[Step]) -> Option<usize> {
    for depth in (1..locator.len()).rev() {
        if let Some(around) = find(root, &locator[..depth]) {
            return Some(end_of(around)).filter(|end| *end < text.len());
        }
    }
    let order = order_of("SceneDesc");
    let rank = |key: &str| order.iter().position(|known| *known == key);
    let new_rank = rank(locator.first()?.key()?)?;
    let is_table = |(key, value): &(&Key, &Node)| {
        // `[a.b]` makes `a` without a header of its own.
        let before = text[..key.span().start].trim_end();
        has_header(text, value) || before.ends_with('[')
    };
    let before = root.iter().filter(is_table);
    let before = before.filter(|(key, _)| rank(key.get_ref()).is_some_and(|rank| rank < new_rank));
    before.map(|(_, value)| end_of(value)).max()
}
