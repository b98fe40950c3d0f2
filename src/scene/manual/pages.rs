//! The manual cut into pages: an index and a page for each top-level table, with links from keys that take
//! a table to its description.

use std::{collections::HashMap, fmt::Write as _};

use super::{describe_section, introduction, section_text, without_lead};
use crate::parse::{SectionRecord, recorded_keys, recorded_project_keys};

/// File of the index page, which also describes the top level of a scene.
pub const INDEX: &str = "README.md";

/// File of the page about `reflet.toml`.
const PROJECT: &str = "project.md";

const GENERATED: &str = "<!-- Generated from src/scene/desc.rs; `UPDATE_DOCS=1 cargo test --test scene` writes it anew. -->\n";

/// One page of the manual.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Page {
    /// File name in `docs/scene`: `INDEX`, or the name of the table with `.md`.
    pub file: String,
    /// Content of the page as Markdown.
    pub text: String,
}

/// Page and anchor of the description of a table.
struct Place {
    type_name: &'static str,
    file: String,
    anchor: String,
}

/// All pages, the index first.
pub fn pages() -> Vec<Page> {
    let sections = recorded_keys();
    let places = places(sections);
    let mut pages: Vec<Page> = Vec::new();
    for (section, place) in sections.iter().zip(&places) {
        let link = |type_name: &str| {
            let target = places.iter().find(|p| p.type_name == type_name)?;
            let file = (target.file != place.file).then_some(target.file.as_str());
            Some(format!("{}#{}", file.unwrap_or_default(), target.anchor))
        };
        let level = match pages.last_mut() {
            Some(page) if page.file == place.file => {
                describe_section(&mut page.text, section, 2, &link);
                continue;
            }
            Some(_) => 1,
            None => 2,
        };
        let mut text = match level {
            1 => format!("{GENERATED}[All of scene text]({INDEX})\n"),
            _ => format!("{GENERATED}{}{}", introduction(), index(sections, &places)),
        };
        describe_section(&mut text, section, level, &link);
        let file = place.file.clone();
        pages.push(Page { file, text });
    }
    pages.push(project_page());
    pages
}

/// Page of the text of projects.
fn project_page() -> Page {
    let mut text = format!("{GENERATED}[All of scene text]({INDEX})\n");
    for section in recorded_project_keys() {
        describe_section(&mut text, section, 1, &|_| None);
    }
    let file = PROJECT.to_owned();
    Page { file, text }
}

/// Page of each section: of the top-level table in its heading, or else of the previous section, to whose keys it
/// belongs.
fn places(sections: &[SectionRecord]) -> Vec<Place> {
    let mut file = INDEX.to_owned();
    let mut uses: HashMap<(String, String), usize> = HashMap::new();
    let place = |section: &SectionRecord| {
        if let Some(table) = section.heading.strip_prefix('[') {
            let table = table.trim_start_matches('[');
            let word = table.split(['.', ']']).next().unwrap_or(table);
            file = format!("{word}.md");
        }
        let anchor = anchor(section.heading);
        let before = uses.entry((file.clone(), anchor.clone())).or_default();
        *before += 1;
        let anchor = match *before {
            1 => anchor,
            more => format!("{anchor}-{}", more - 1),
        };
        let (type_name, file) = (section.type_name, file.clone());
        Place {
            type_name,
            file,
            anchor,
        }
    };
    sections.iter().map(place).collect()
}

/// Anchor that GitHub gives to a heading.
fn anchor(heading: &str) -> String {
    let kept = |c: char| match c {
        ' ' => Some('-'),
        c if c.is_alphanumeric() || "-_".contains(c) => Some(c.to_ascii_lowercase()),
        _ => None,
    };
    heading.chars().filter_map(kept).collect()
}

/// List of all tables, with nested tables indented.
fn index(sections: &[SectionRecord], places: &[Place]) -> String {
    let mut out = "\n## Tables\n\n".to_owned();
    let mut page = "";
    for (section, place) in sections.iter().zip(places) {
        let indent = if place.file == page { "  " } else { "" };
        page = &place.file;
        let heading = match section.type_name {
            "SceneDesc" => section.heading.to_owned(),
            _ => format!("`{}`", section.heading),
        };
        let file = Some(place.file.as_str()).filter(|file| *file != INDEX);
        let text = without_lead(&section_text(section), section.heading);
        let (first, _) = text.split_once(". ").unwrap_or((&text, ""));
        let example = first.strip_prefix('`').and_then(|t| t.split_once('`'));
        let first = match example {
            Some((_, "")) => "",
            Some((_, rest)) => rest.strip_prefix(": ").unwrap_or(first),
            None => first,
        };
        let first = first.trim_end_matches('.');
        let colon = if first.is_empty() { "" } else { ": " };
        let _ = writeln!(
            out,
            "{indent}- [{heading}]({}#{}){colon}{first}",
            file.unwrap_or_default(),
            place.anchor
        );
    }
    let _ = writeln!(
        out,
        "\nScenes that share files are a project: [`reflet.toml`]({PROJECT})."
    );
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Anchors that GitHub gives to the headings of a text: without code marks, equal ones numbered.
    fn anchors(text: &str) -> Vec<String> {
        let headings = text.lines().filter_map(|line| {
            let (marks, heading) = line.split_once(' ')?;
            (!marks.is_empty() && marks.chars().all(|c| c == '#')).then_some(heading)
        });
        let mut all: Vec<String> = Vec::new();
        for heading in headings {
            let plain = anchor(heading);
            let mut one = plain.clone();
            let mut n = 0;
            while all.contains(&one) {
                n += 1;
                one = format!("{plain}-{n}");
            }
            all.push(one);
        }
        all
    }

    #[test]
    fn every_link_between_pages_meets_a_heading() {
        let pages = pages();
        let mut links = 0;
        for page in &pages {
            for target in page.text.split("](").skip(1) {
                let target = target.split(')').next().unwrap_or(target);
                let Some((file, anchor)) = target.split_once('#') else {
                    continue;
                };
                let file = if file.is_empty() { &page.file } else { file };
                let other = pages.iter().find(|p| p.file == file).expect(target);
                assert!(
                    anchors(&other.text).iter().any(|a| a == anchor),
                    "{}: {target}",
                    page.file
                );
                links += 1;
            }
        }
        assert!(links > 60, "{links}");
    }

    #[test]
    fn each_table_of_the_file_has_a_page() {
        let pages = pages();
        let files: Vec<_> = pages.iter().map(|p| p.file.as_str()).collect();
        let sections = recorded_keys();
        let root = &sections[0].keys;
        for file in files[1..].iter().filter(|file| **file != PROJECT) {
            let table = file.trim_end_matches(".md");
            assert!(root.iter().any(|key| key.name == table), "{file}");
        }
        assert_eq!(files[0], INDEX);
        assert!(files.contains(&"light.md") && files.contains(&"motion.md"));
    }
}
