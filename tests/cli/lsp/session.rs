//! A session of an editor with the language server, from the first mistake to the saved files.

use std::fs;

use serde_json::{Value, json};

use super::{Client, position};
use crate::common::program::exits;

const SCENE: &str = "version = 1\ninclude = \"parts.toml\"\n[environment]\ncolor = [0.5, 0.5, 0.5]\n[model.ball]\n\
                     shape = { kind = \"sphere\" }\nmaterial = \"bras\"\n[[instance]]\nmodel=\"ball\" # the only one\n";
const PARTS: &str = "[material.brass]\nmetallic = 1\n";

/// The editor: texts of the open files, and the language server.
struct Editor {
    client: Client,
    texts: Vec<(&'static str, String)>,
}

/// Byte offset of a position in an ASCII text.
pub fn offset(text: &str, position: &Value) -> usize {
    let number = |key: &str| position[key].as_u64().expect("a number") as usize;
    let before = text.split_inclusive('\n').take(number("line"));
    before.map(str::len).sum::<usize>() + number("character")
}

impl Editor {
    /// Opens files, the scene last; returns the messages about it too.
    fn open(files: [(&'static str, &str); 2]) -> (Self, Vec<Value>) {
        let mut client = Client::start("session");
        let found = files.map(|(name, text)| client.open(name, text));
        let texts = files.map(|(name, text)| (name, text.to_owned())).to_vec();
        (
            Self { client, texts },
            found.into_iter().flatten().collect(),
        )
    }

    /// Messages of the next check of the scene, about all of its files.
    fn found(&mut self) -> Vec<Value> {
        let (mut all, scene) = (Vec::new(), self.client.uri("scene.toml"));
        loop {
            let message = self.client.receive();
            let found = message["params"]["diagnostics"].as_array();
            all.extend(found.expect("messages").iter().cloned());
            // A check ends with the messages about the scene itself, as its name is the last.
            if message["params"]["uri"] == scene {
                return all;
            }
        }
    }

    /// Applies edits of one file as editors do, from its end; returns the messages about the scene.
    fn apply(&mut self, uri: &str, edits: &Value) -> Vec<Value> {
        let mut edits = edits.as_array().expect("edits").clone();
        let is_meant = |(name, _): &(&str, String)| self.client.uri(name) == uri;
        let file = self.texts.iter().position(is_meant);
        let text = &mut self.texts[file.expect("an open file")].1;
        edits.sort_by_key(|edit| offset(text, &edit["range"]["start"]));
        for edit in edits.iter().rev() {
            let [from, to] = ["start", "end"].map(|end| offset(text, &edit["range"][end]));
            text.replace_range(from..to, edit["newText"].as_str().expect("a text"));
        }
        self.client.change(uri, text);
        self.found()
    }

    /// Applies the changes of an answer that may concern several files.
    fn apply_all(&mut self, changes: &Value) -> Vec<Value> {
        let changes = changes.as_object().expect("changes").clone();
        let found = changes.iter().map(|(uri, edits)| self.apply(uri, edits));
        found.last().unwrap_or_default()
    }

    fn document(&self, name: &str) -> Value {
        json!({ "textDocument": { "uri": self.client.uri(name) } })
    }

    /// Position of the end of a part of a file.
    fn after(&self, name: &str, part: &str) -> Value {
        let (_, text) = self.texts.iter().find(|(n, _)| *n == name).expect("open");
        position(&text[..text.find(part).expect("it is there") + part.len()])
    }
}

/// A mistake is mended by its quick fix, a key is completed, a name is changed in both files, the text is formatted and
/// saved; what lies on the disk then is a right scene.
#[test]
fn a_scene_is_mended_completed_renamed_formatted_and_saved() {
    let (mut editor, found) = Editor::open([("parts.toml", PARTS), ("scene.toml", SCENE)]);
    let uri = editor.client.uri("scene.toml");
    assert_eq!(found[0]["code"], "dangling-name", "{found:?}");
    let mut params = editor.document("scene.toml");
    params["context"] = json!({ "diagnostics": found });
    let actions = editor.client.ask("textDocument/codeAction", params);
    let found = editor.apply_all(&actions[0]["edit"]["changes"]);
    assert_eq!(found, [] as [Value; 0], "the quick fix mends it");

    let parts = editor.client.uri("parts.toml");
    let end = editor.after("parts.toml", "metallic = 1\n");
    let typed = json!([{ "range": { "start": end, "end": end }, "newText": "rou" }]);
    let found = editor.apply(&parts, &typed);
    assert!(!found.is_empty(), "half a key is a mistake");
    let mut params = editor.document("parts.toml");
    params["position"] = editor.after("parts.toml", "rou");
    let items = editor.client.ask("textDocument/completion", params);
    let mut labels = items.as_array().expect("a list").iter();
    assert!(labels.any(|item| item["label"] == "roughness"), "{items}");
    let end = editor.after("parts.toml", "rou");
    let rest = json!([{ "range": { "start": end, "end": end }, "newText": "ghness = 0.3\n" }]);
    assert_eq!(editor.apply(&parts, &rest), [] as [Value; 0]);

    let mut params = editor.document("scene.toml");
    params["position"] = editor.after("scene.toml", "material = \"bra");
    params["newName"] = "bronze".into();
    let renamed = editor.client.ask("textDocument/rename", params);
    assert_eq!(renamed["changes"].as_object().map(|c| c.len()), Some(2));
    assert_eq!(editor.apply_all(&renamed["changes"]), [] as [Value; 0]);

    let mut params = editor.document("scene.toml");
    params["options"] = json!({ "tabSize": 2, "insertSpaces": true });
    let edits = editor.client.ask("textDocument/formatting", params);
    assert_eq!(editor.apply(&uri, &edits), [] as [Value; 0]);

    let scene = SCENE
        .replace("\"bras\"", "\"bronze\"")
        .replace("model=", "model = ");
    let expected = ["[material.bronze]\nmetallic = 1\nroughness = 0.3\n", &scene];
    for ((name, text), expected) in editor.texts.clone().into_iter().zip(expected) {
        assert_eq!(text, expected, "{name}");
        fs::write(editor.client.folder.join(name), &text).expect("writable");
        let saved = editor.document(name);
        editor.client.tell("textDocument/didSave", saved);
    }
    exits(&editor.client.folder, "check --no-project scene.toml", 0);
    editor.client.end();
}
