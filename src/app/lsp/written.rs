//! Tables and functions as their texts write them, for hover.

use super::{
    scopes::{Scoped, definitions},
    structure::{functions, section_at},
};

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
