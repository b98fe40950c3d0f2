//! Place at which a key is written: the topmost layer that sets it, else the thing's own table.

use std::sync::Arc;

use super::{
    insert::order_of,
    splice::{self, Value},
    tree::{self, Locator, Step, below, keys},
};
use reflet_scene::{
    desc::{BRIGHTNESS, SceneDesc},
    diagnostic::{Source, Span},
    parse::{OVERRIDE, VARIANT},
    syntax::{Content, Entries, Node, SyntaxTree},
};

/// A thing of a scene whose values stand in a table.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// Kind of the table: `instance`, `light`, …
    pub kind: &'static str,
    /// Type of the table in `desc.rs`, which says the order of its keys.
    pub section: &'static str,
    /// Name of the thing, if it has one; `None` also for tables that exist once.
    pub name: Option<&'a str>,
    /// Place of the thing's table; `None` for tables that exist once.
    pub at: Option<&'a Span>,
    /// Keys from the thing's table to the table that has the values, such as `material` of an instance.
    pub below: &'a [&'a str],
}

/// A table in a scene text.
pub struct Place {
    /// Text that contains the table, or where it is to stand.
    pub source: Arc<Source>,
    locator: Locator,
    section: &'static str,
}

impl Place {
    fn table(&self) -> Option<&Entries> {
        let root = self.source.syntax().correct().ok()?;
        tree::find(root, &self.locator)?.get_ref().as_table()
    }

    /// The value under a key of the table.
    pub fn node(&self, key: &str) -> Option<&Node> {
        self.table()?.get(key)
    }

    /// The numbers under a key of the table.
    pub fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        tree::numbers(self.table()?.get(key)?)
    }

    /// The text with another value for a key of the table.
    pub fn put(&self, key: &str, value: &Value) -> Result<String, String> {
        self.put_into(&self.source.text, key, value)
    }

    /// A changed text of the same source with another value for a key of the table.
    pub fn put_into(&self, text: &str, key: &str, value: &Value) -> Result<String, String> {
        let tree = SyntaxTree::parse(text);
        let root = tree.correct().map_err(|error| error.message.clone())?;
        splice::put(
            text,
            root,
            &self.locator,
            key,
            value,
            &order_of(self.section),
        )
    }

    /// The text with another value for an element of a list in the table; `path` leads to it.
    pub fn replace(&self, path: &[Step], value: &Value) -> Result<String, String> {
        let root = correct(&self.source)?;
        let locator = [&self.locator, path].concat();
        let node = tree::find(root, &locator).ok_or("it is not there any more")?;
        splice::replace(&self.source.text, node, value)
    }

    /// Whether the table has a key.
    pub fn has(&self, key: &str) -> bool {
        self.table().is_some_and(|table| table.contains_key(key))
    }
}

/// Type of the table of a kind: a placed scene is a group that an instance's table defines.
fn section(subject: &Subject<'_>, kind: &str) -> &'static str {
    match kind {
        "instance" if subject.kind == "group" => "InstanceDesc",
        _ => subject.section,
    }
}

/// Entries of a text without syntax errors.
pub fn correct(source: &Source) -> Result<&Entries, String> {
    let root = source.syntax().correct();
    root.map_err(|error| error.message.clone())
}

/// Refuses things that are not written in a file.
pub fn writable(source: Option<&Source>) -> Result<(), String> {
    let Some(source) = source else {
        return Err("it is not written in a file".to_owned());
    };
    if source.returned.is_some() {
        let script = source.path.display();
        return Err(format!(
            "it comes from `setup` of {script}; change it there"
        ));
    }
    if source.generated {
        return Err("a file alone has no scene text to change".to_owned());
    }
    if [OVERRIDE, VARIANT]
        .iter()
        .any(|name| source.path.as_os_str() == *name)
    {
        return Err("it comes from the command line".to_owned());
    }
    Ok(())
}

/// Keys that set the same value as this key, itself included.
pub(super) fn alike(key: &str) -> &'static [&'static str] {
    match key {
        "rotation_deg" => &["rotation_deg", "rotation_quat"],
        "direction" | "target" => &["direction", "target"],
        key if BRIGHTNESS.contains(&key) => &BRIGHTNESS,
        _ => &[],
    }
}

/// Table in which a key of a thing is to be written; of the chosen `variants` the last one wins.
///
/// # Errors
/// Sentence with the reason why it cannot be written.
pub fn places(
    desc: &SceneDesc,
    variants: &[String],
    subject: &Subject<'_>,
    key: &str,
) -> Result<Place, String> {
    let at = subject.at.unwrap_or(&desc.own);
    let source = at.source.as_ref();
    writable(source.map(Arc::as_ref))?;
    let source = source.ok_or("it is not written in a file")?;
    let sets = |table: &Entries| {
        let mut keys = alike(key).iter().chain([&key]);
        keys.any(|key| table.contains_key(*key))
    };
    if let Some(place) = above(desc, variants, subject, sets) {
        return Ok(place);
    }
    if subject.at.is_none() {
        let place = above(desc, variants, subject, |_| true);
        return Ok(place.unwrap_or_else(|| Place {
            source: Arc::clone(source),
            locator: below(&keys([subject.kind]), subject.below),
            section: subject.section,
        }));
    }
    let locator = own(correct(source)?, subject.kind, at);
    let locator = locator.ok_or("its table cannot be found in the text")?;
    let is_instance = locator.iter().any(|step| step.key() == Some("instance"));
    let kind = if is_instance {
        "instance"
    } else {
        subject.kind
    };
    Ok(Place {
        source: Arc::clone(source),
        locator: below(&locator, subject.below),
        section: section(subject, kind),
    })
}

/// Topmost table of the thing's name that `is_meant` accepts.
fn above(
    desc: &SceneDesc,
    variants: &[String],
    subject: &Subject<'_>,
    is_meant: impl Fn(&Entries) -> bool,
) -> Option<Place> {
    if subject.at.is_some() && subject.name.is_none() {
        return None;
    }
    let parts = desc.includes.iter().map(|part| &part.source);
    let texts = desc.own.source.iter().chain(parts);
    // A group may be a placed scene, which an instance table defines.
    let kinds = match subject.kind {
        "group" => &["group", "instance"][..],
        kind => &[kind][..],
    };
    for source in texts {
        let Ok(root) = source.syntax().correct() else {
            continue;
        };
        let chosen = variants.iter().rev();
        let chosen = chosen.map(|name| keys(["variant", name.as_str()]));
        for above in chosen.chain([Vec::new()]) {
            for kind in kinds {
                let named = subject.name.map(|name| Step::Name(name.to_owned()));
                let locator: Locator = (above.iter().cloned())
                    .chain([Step::Key((*kind).to_owned())])
                    .chain(named)
                    .collect();
                let locator = below(&locator, subject.below);
                let node = tree::find(root, &locator);
                let table = node.and_then(|node| node.get_ref().as_table());
                if table.is_some_and(&is_meant) {
                    return Some(Place {
                        source: Arc::clone(source),
                        locator,
                        section: section(subject, kind),
                    });
                }
            }
        }
    }
    None
}

/// Locator of the table that begins, or has its name, at a span.
fn own(root: &Entries, kind: &'static str, at: &Span) -> Option<Locator> {
    for (above, table) in tree::roots(root) {
        let locator = |kind: &str, step| {
            let kind = Step::Key(kind.to_owned());
            [above.clone(), vec![kind, step]].concat()
        };
        if let Some(Content::Table(all)) = table.get(kind).map(Node::get_ref) {
            let found = all.keys().find(|key| key.span().start == at.range.start);
            if let Some(name) = found {
                return Some(locator(kind, Step::Key(name.get_ref().to_string())));
            }
        }
        let Some(Content::Array(list)) = table.get("instance").map(Node::get_ref) else {
            continue;
        };
        // The span of a placed scene is at its name, or at its file's name.
        let begins = |entry: &Node| {
            let table = entry.get_ref().as_table();
            let key = |key: &str| table?.get(key);
            let file = || key("model")?.get_ref().as_table()?.get("scene");
            let starts = [Some(entry), key("name"), file()];
            let mut starts = starts.into_iter().flatten();
            starts.any(|node| node.span().start == at.range.start)
        };
        if let Some(index) = list.iter().position(begins) {
            return Some(locator("instance", Step::Index(index)));
        }
    }
    None
}
