//! Place at which a key of an item is written: the topmost layer that sets it, else the item's own table.

use std::sync::Arc;

use super::{
    SceneItem,
    splice::{self, Locator, Selector},
};
use reflet_scene::syntax::{Content, Entries, Node};
use reflet_scene::{
    desc::SceneDesc,
    diagnostic::{Source, Span},
    parse::{OVERRIDE, VARIANT},
};

/// A table in a scene text.
pub struct Place {
    /// Text that contains the table.
    pub source: Arc<Source>,
    locator: Locator,
}

impl Place {
    /// The numbers under a key of the table.
    pub fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        let root = self.source.syntax().correct().ok()?;
        let node = splice::find(root, &self.locator)?;
        splice::numbers(node.get_ref().as_table()?.get(key)?)
    }

    /// The text with other numbers for a key of the table.
    pub fn put(&self, key: &str, values: &[f64]) -> Result<String, String> {
        let root = correct(&self.source)?;
        let node = splice::find(root, &self.locator).ok_or("its table is not there any more")?;
        splice::put(&self.source.text, node, key, values)
    }
}

/// Entries of a text without syntax errors.
fn correct(source: &Source) -> Result<&Entries, String> {
    let root = source.syntax().correct();
    root.map_err(|error| error.message.clone())
}

/// Refuses items that are not written in a file.
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
    if [OVERRIDE, VARIANT]
        .iter()
        .any(|name| source.path.as_os_str() == *name)
    {
        return Err("it comes from the command line".to_owned());
    }
    Ok(())
}

/// Keys that set the same value as this key, itself included.
fn alike(key: &str) -> &'static [&'static str] {
    match key {
        "translation" => &["translation"],
        "rotation_deg" => &["rotation_deg", "rotation_quat"],
        "scale" => &["scale"],
        "direction" | "target" => &["direction", "target"],
        _ => &[],
    }
}

/// Table in which a key of an item is to be written; of the chosen `variants` the last one wins.
///
/// # Errors
/// Sentence with the reason why it cannot be written.
pub fn places(
    desc: &SceneDesc,
    variants: &[String],
    item: SceneItem,
    key: &str,
) -> Result<Place, String> {
    let (name, at) = item.named(desc).ok_or("it is not there any more")?;
    let source = at.source.as_ref();
    writable(source.map(Arc::as_ref))?;
    let source = source.ok_or("it is not written in a file")?;
    if let Some(place) = name.and_then(|name| above(desc, variants, (item, name), key)) {
        return Ok(place);
    }
    let locator = own(correct(source)?, item, at).ok_or("its table cannot be found in the text")?;
    Ok(Place {
        source: Arc::clone(source),
        locator,
    })
}

/// Topmost table of the item's name that has the key.
fn above(
    desc: &SceneDesc,
    variants: &[String],
    (item, name): (SceneItem, &str),
    key: &str,
) -> Option<Place> {
    let parts = desc.includes.iter().map(|part| &part.source);
    let texts = desc.own.source.iter().chain(parts);
    // A group may be a placed scene, which an instance table defines.
    let kinds: &[&'static str] = match item {
        SceneItem::Group(_) => &["group", "instance"],
        item => &[item.kind()][..],
    };
    for source in texts {
        let Ok(root) = source.syntax().correct() else {
            continue;
        };
        let chosen = variants.iter().rev();
        let chosen = chosen.map(|name| vec!["variant".to_owned(), name.clone()]);
        for above in chosen.chain([Vec::new()]) {
            for kind in kinds {
                let locator = Locator {
                    above: above.clone(),
                    kind,
                    selector: Selector::Name(name.to_owned()),
                };
                let node = splice::find(root, &locator);
                let table = node.and_then(|node| node.get_ref().as_table());
                let keys = alike(key).iter().chain([&key]);
                if table.is_some_and(|table| keys.into_iter().any(|key| table.contains_key(*key))) {
                    return Some(Place {
                        source: Arc::clone(source),
                        locator,
                    });
                }
            }
        }
    }
    None
}

/// Locator of the table that begins, or has its name, at a span.
fn own(root: &Entries, item: SceneItem, at: &Span) -> Option<Locator> {
    for (above, table) in splice::roots(root) {
        let locator = |kind: &'static str, selector| Locator {
            above: above.clone(),
            kind,
            selector,
        };
        let kind = item.kind();
        if let Some(Content::Table(all)) = table.get(kind).map(Node::get_ref) {
            let found = all.keys().find(|key| key.span().start == at.range.start);
            if let Some(name) = found {
                return Some(locator(kind, Selector::Name(name.get_ref().to_string())));
            }
        }
        let Some(Content::Array(list)) = table.get("instance").map(Node::get_ref) else {
            continue;
        };
        // The span of a placed scene is at its name, or at that of its file.
        let begins = |entry: &Node| {
            let table = entry.get_ref().as_table();
            let key = |key: &str| table?.get(key);
            let file = || key("model")?.get_ref().as_table()?.get("scene");
            let starts = [Some(entry), key("name"), file()];
            let mut starts = starts.into_iter().flatten();
            starts.any(|node| node.span().start == at.range.start)
        };
        if let Some(index) = list.iter().position(begins) {
            return Some(locator("instance", Selector::Index(index)));
        }
    }
    None
}
