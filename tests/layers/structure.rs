//! Signatures and types of Rust files, read without a parser: tuples that stand for a struct, and things to look at.

use std::collections::BTreeSet;

/// A function of a file.
pub struct Function {
    /// Line of its name, from 1.
    pub line: usize,
    /// Name.
    pub name: String,
    /// Types of its parameters; `self` has none.
    pub parameters: Vec<String>,
    /// Number of lines from its name to its end.
    pub num_lines: usize,
}

impl Function {
    /// Parameters that are tuples of things of several types.
    pub fn unlike_tuples(&self) -> impl Iterator<Item = &String> {
        let is_unlike = |parameter: &&String| {
            let plain = parameter.trim_start_matches(['&', ' ']);
            let plain = plain.strip_prefix("mut ").unwrap_or(plain);
            let inner = plain.strip_prefix('(').and_then(|p| p.strip_suffix(')'));
            let kinds: BTreeSet<String> = inner.map_or(BTreeSet::new(), |i| parts(i).collect());
            kinds.len() > 1
        };
        self.parameters.iter().filter(is_unlike)
    }
}

/// Text with spaces in place of comments, strings and characters, so that brackets and words are code.
fn code(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let hidden = match first {
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            'r' if rest.starts_with("r#\"") => rest.find("\"#").map_or(rest.len(), |end| end + 2),
            '"' => end_of_text(rest, '"'),
            '\'' if rest[1..].starts_with('\\') => end_of_text(rest, '\''),
            '\'' if rest.chars().nth(2) == Some('\'') => {
                rest.char_indices().nth(3).map_or(0, |c| c.0)
            }
            _ => 0,
        };
        let (part, after) = rest.split_at(hidden.max(first.len_utf8()));
        match hidden {
            0 => out.push_str(part),
            _ => out.extend(part.chars().map(|c| if c == '\n' { '\n' } else { ' ' })),
        }
        rest = after;
    }
    out
}

/// Length of a text in quotes at the start of `rest`.
fn end_of_text(rest: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            _ if c == quote => return at + 1,
            _ => {}
        }
    }
    rest.len()
}

/// Parts of a list between commas that stand in no brackets, without spaces around.
fn parts(list: &str) -> impl Iterator<Item = String> {
    let (mut all, mut depth, mut before) = (vec![String::new()], 0, ' ');
    for c in list.chars() {
        match c {
            '(' | '[' | '{' | '<' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            '>' if before != '-' && before != '=' => depth -= 1,
            _ => {}
        }
        match c {
            ',' if depth == 0 => all.push(String::new()),
            _ => all.last_mut().expect("at least one").push(c),
        }
        before = c;
    }
    let words = |part: String| part.split_whitespace().collect::<Vec<_>>().join(" ");
    all.into_iter().map(words).filter(|part| !part.is_empty())
}

/// Length of the brackets at the start of a text, with their content.
fn bracketed(text: &str) -> usize {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match c {
            '(' | '{' => depth += 1,
            ')' | '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + 1;
        }
    }
    text.len()
}

/// Length of the generic parameters at the start of a text, 0 without any.
fn generics(text: &str) -> usize {
    let (mut depth, mut before) = (0, ' ');
    for (at, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' if before != '-' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return if at == 0 { 0 } else { at + 1 };
        }
        before = c;
    }
    0
}

/// Type of a parameter: the text behind the first colon that is in no brackets and no path.
fn type_of(parameter: &str) -> Option<&str> {
    let mut depth = 0;
    for (at, c) in parameter.char_indices() {
        match c {
            '(' | '[' | '{' | '<' => depth += 1,
            ')' | ']' | '}' | '>' => depth -= 1,
            ':' if depth == 0 => return Some(parameter[at + 1..].trim()),
            _ => {}
        }
    }
    None
}

/// Functions of a Rust file, with nested and test functions.
pub fn functions(text: &str) -> Vec<Function> {
    let code = code(text);
    let starts = code.match_indices("fn ").filter(|(at, _)| {
        let before = code[..*at].chars().next_back();
        before.is_none_or(|c| !c.is_alphanumeric() && c != '_')
    });
    let function = |(at, _): (usize, &str)| {
        let rest = &code[at + 3..];
        let name = rest.find(|c: char| !c.is_alphanumeric() && c != '_')?;
        let generics = &rest[name..name + generics(&rest[name..])];
        let list = &rest[name + generics.len()..];
        let end = bracketed(list);
        let parameters = parts(&list[1..end.saturating_sub(1).max(1)]);
        let body = list[end..].find(['{', ';']).unwrap_or(0) + end;
        let length = name + generics.len() + body + bracketed(&list[body..]);
        (name > 0 && list.starts_with('(')).then(|| Function {
            line: code[..at].matches('\n').count() + 1,
            name: rest[..name].to_owned(),
            parameters: parameters
                .filter_map(|p| type_of(&p).map(str::to_owned))
                .collect(),
            num_lines: rest[..length].matches('\n').count() + 1,
        })
    };
    starts.filter_map(function).collect()
}

/// Groups of public types of a file that do not name each other, each by its first type.
pub fn unrelated_types(text: &str) -> Vec<String> {
    let code = code(text);
    let types: Vec<&str> = (code.lines())
        .filter_map(|line| {
            let line = line
                .strip_prefix("pub ")
                .or(line.strip_prefix("pub(crate) "))?;
            let mut words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
            let is_type = ["struct", "enum", "trait"].contains(&words.next()?);
            words.next().filter(|_| is_type)
        })
        .collect();
    // Items of the file, which begin at the left margin; an item relates all types that it names.
    let items = code.split("\n}\n").flat_map(|part| part.split(";\n"));
    let mut group: Vec<usize> = (0..types.len()).collect();
    for item in items {
        let words: BTreeSet<&str> =
            (item.split(|c: char| !c.is_alphanumeric() && c != '_')).collect();
        let named: Vec<usize> = (0..types.len())
            .filter(|i| words.contains(types[*i]))
            .collect();
        for pair in named.windows(2) {
            let (low, high) = (
                group[pair[0]].min(group[pair[1]]),
                group[pair[0]].max(group[pair[1]]),
            );
            group
                .iter_mut()
                .filter(|g| **g == high)
                .for_each(|g| *g = low);
        }
    }
    let firsts: BTreeSet<usize> = group.into_iter().collect();
    firsts
        .into_iter()
        .map(|first| types[first].to_owned())
        .collect()
}
