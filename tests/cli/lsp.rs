//! The language server, driven by a client as editors do.

mod across_files;
mod session;
mod writing;

use std::{
    io::{BufRead as _, BufReader, Read as _, Write as _},
    process::{Child, ChildStdin, ChildStdout, Command},
};

use serde_json::{Value, json};

use super::*;
use crate::common::{assert_says, cases};

/// A client connected to one language server.
struct Client {
    server: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    folder: PathBuf,
    requests: u64,
}

impl Client {
    fn start(name: &str) -> Self {
        let folder = kept_folder(&format!("lsp-{name}"), &[]);
        let mut server = Command::new(env!("CARGO_BIN_EXE_reflet"))
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let input = server.stdin.take().expect("piped");
        let output = BufReader::new(server.stdout.take().expect("piped"));
        let mut client = Self {
            server,
            input,
            output,
            folder,
            requests: 0,
        };
        // One client takes snippets, as most editors do.
        let item = json!({ "snippetSupport": name == "completion" });
        let completion = json!({ "textDocument": { "completion": { "completionItem": item } } });
        let result = client.ask("initialize", json!({ "capabilities": completion }));
        assert_eq!(result["capabilities"]["hoverProvider"], true);
        client.tell("initialized", json!({}));
        client
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        write!(self.input, "Content-Length: {}\r\n\r\n{text}", text.len()).expect("it listens");
        self.input.flush().expect("it listens");
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    fn receive(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            self.output.read_line(&mut line).expect("it answers");
            assert!(!line.is_empty(), "the server has gone");
            match line.trim().strip_prefix("Content-Length: ") {
                Some(number) => length = number.parse().expect("a number"),
                None if line.trim().is_empty() => break,
                None => {}
            }
        }
        let mut text = vec![0; length];
        self.output.read_exact(&mut text).expect("it answers");
        serde_json::from_slice(&text).expect("JSON")
    }

    /// Sends a request and returns its result.
    fn ask(&mut self, method: &str, params: Value) -> Value {
        let message = self.answer(method, params);
        assert!(message["error"].is_null(), "{message}");
        message["result"].clone()
    }

    /// Sends a request and returns the answer, which may be an error.
    fn answer(&mut self, method: &str, params: Value) -> Value {
        self.requests += 1;
        let id = self.requests;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.receive();
            if message["id"] == id {
                return message;
            }
        }
    }

    fn uri(&self, name: &str) -> String {
        format!("file://{}", self.folder.join(name).display())
    }

    /// Writes and opens a file; returns its diagnostics.
    fn open(&mut self, name: &str, text: &str) -> Vec<Value> {
        fs::write(self.folder.join(name), text).expect("a file");
        let uri = self.uri(name);
        self.tell(
            "textDocument/didOpen",
            json!({ "textDocument": { "uri": uri, "text": text } }),
        );
        if name == "scene.toml" {
            self.found(&uri)
        } else {
            Vec::new()
        }
    }

    /// Waits for the next diagnostics of a file.
    fn found(&mut self, uri: &str) -> Vec<Value> {
        loop {
            let message = self.receive();
            if message["params"]["uri"] == uri {
                return list(&message["params"]["diagnostics"]).clone();
            }
        }
    }

    /// Sends a request at the position `|` of a text, which is opened under that name without the mark.
    fn ask_at(&mut self, method: &str, name: &str, text: &str) -> Value {
        let place =
            json!({ "textDocument": { "uri": self.uri(name) }, "position": position(text) });
        self.ask(&format!("textDocument/{method}"), place)
    }

    fn change(&mut self, uri: &str, text: &str) {
        let change =
            json!({ "textDocument": { "uri": uri }, "contentChanges": [{ "text": text }] });
        self.tell("textDocument/didChange", change);
    }

    /// Changes a file to a text with a mark, and returns the completions proposed there.
    fn items(&mut self, name: &str, text: &str) -> Vec<Value> {
        self.change(&self.uri(name), &text.replace('|', ""));
        let items = self.ask_at("completion", name, text);
        items.as_array().cloned().unwrap_or_default()
    }

    /// Labels of these completions.
    fn proposed(&mut self, name: &str, text: &str) -> Vec<String> {
        let items = self.items(name, text);
        let label = |item: &Value| item["label"].as_str().expect("text").to_owned();
        items.iter().map(label).collect()
    }

    fn end(mut self) {
        assert_eq!(self.ask("shutdown", Value::Null), Value::Null);
        self.tell("exit", Value::Null);
        let status = self.server.wait().expect("it ends");
        assert_eq!(status.code(), Some(0));
    }
}

fn list(value: &Value) -> &Vec<Value> {
    value.as_array().expect("a list")
}

/// Position of the mark `|`.
fn position(text: &str) -> Value {
    let before = text.split('|').next().expect("a mark");
    let row = before.rsplit('\n').next().unwrap_or_default();
    json!({ "line": before.matches('\n').count(), "character": row.chars().count() })
}

const SCENE: &str = include_str!("lsp/scene.toml");
const PARTS: &str = "[material.brass]\nmetallic = 1\n";
const SCRIPT: &str = include_str!("lsp/move.rhai");

fn show(name: &str) -> Client {
    let mut client = Client::start(name);
    client.open("parts.toml", PARTS);
    client.open("move.rhai", SCRIPT);
    assert_eq!(client.open("scene.toml", SCENE), [] as [Value; 0]);
    client
}

#[test]
fn messages_follow_the_text() {
    let mut client = show("messages");
    let uri = client.uri("scene.toml");
    let wrong = SCENE.replace("model = \"ball\"", "model = \"bal\"");
    client.change(&uri, &wrong);
    let found = client.found(&uri);
    assert_eq!(found.len(), 1, "{found:?}");
    let start = &found[0]["range"]["start"];
    assert_eq!(*start, json!({ "line": 13, "character": 8 }));
    assert_eq!(found[0]["severity"], 1);
    let text = found[0]["message"].as_str().expect("text");
    assert_says(text, &["help:", "\"ball\""]);
    client.change(&uri, SCENE);
    assert_eq!(client.found(&uri).len(), 0);
    // A mistake in an included file is reported there while it is typed, and later withdrawn.
    let parts = client.uri("parts.toml");
    let document = json!({ "uri": parts });
    let wrong = PARTS.replace("metallic", "metalic");
    let mut type_in = |text: &str| {
        client.change(&parts, text);
        client.found(&parts)
    };
    let start = type_in(&wrong)[0]["range"]["start"].clone();
    assert_eq!(start, json!({ "line": 1, "character": 0 }));
    assert_eq!(type_in(PARTS).len(), 0);
    // The file counts again where its text is closed.
    fs::write(client.folder.join("parts.toml"), wrong).expect("saved");
    let params = json!({ "textDocument": document });
    client.tell("textDocument/didClose", params.clone());
    assert_eq!(client.found(&parts).len(), 1);
    fs::write(client.folder.join("parts.toml"), PARTS).expect("saved");
    client.tell("textDocument/didSave", params);
    assert_eq!(client.found(&parts).len(), 0);
    // A mistake in a script is reported while it is typed too.
    let script = client.uri("move.rhai");
    client.change(&script, &format!("{SCRIPT}\nlet x = ;"));
    assert_eq!(client.found(&script).len(), 1);
    client.end();
}

#[test]
fn keys_words_names_and_files_are_proposed() {
    let mut client = show("completion");
    let names = include_str!("../queries/two.gltf");
    fs::write(client.folder.join("two.gltf"), names).expect("written");
    client.open("lone.toml", "");
    for (case, wanted) in cases(include_str!("lsp/completions.txt")) {
        let (name, text) = case.split_once(' ').expect("a text");
        let before = if name == "scene.toml" { SCENE } else { "" };
        let all = client.items(name, &format!("{before}{text}"));
        let (wanted, inserted) = wanted.split_once(" >> ").unwrap_or((wanted, ""));
        let label = wanted.trim_start_matches('!');
        let found = all.iter().find(|item| item["label"] == label);
        assert_eq!(found.is_some(), label == wanted, "{case}: {all:?}");
        let text = found.map_or("", |item| item["insertText"].as_str().unwrap_or(label));
        assert!(inserted.is_empty() || text == inserted, "{case}: {text}");
    }
    client.end();
}

#[test]
fn places_are_explained_and_names_lead_to_where_they_are_given() {
    let mut client = show("hover");
    let marked = |text: &str, mark: &str| text.replacen(&mark.replace('|', ""), mark, 1);
    for (case, wanted) in cases(include_str!("lsp/hovers.txt")) {
        let (name, mark) = case.split_once(' ').expect("a place");
        let texts = [
            ("scene.toml", SCENE),
            ("parts.toml", PARTS),
            ("move.rhai", SCRIPT),
        ];
        let text = texts.iter().find(|text| text.0 == name).expect("a file").1;
        let hover = client.ask_at("hover", name, &marked(text, mark));
        let value = hover["contents"]["value"].as_str().unwrap_or_default();
        let value = value.replace(&client.folder.display().to_string(), "FOLDER");
        assert!(
            value.contains(&wanted.replace("\\n", "\n")),
            "{case}: {hover}"
        );
    }
    for (name, text, mark, file, line) in [
        ("scene.toml", SCENE, "\"bra|ss\"", "parts.toml", 0),
        ("scene.toml", SCENE, "model = \"ba|ll\"", "scene.toml", 8),
        ("scene.toml", SCENE, "\"move|.rhai\"", "move.rhai", 0),
        ("move.rhai", SCRIPT, "\"fir|st\"", "scene.toml", 12),
        ("move.rhai", SCRIPT, "params.li|ft", "scene.toml", 5),
    ] {
        let found = client.ask_at("definition", name, &marked(text, mark));
        assert_eq!(found[0]["uri"], client.uri(file), "{mark}: {found}");
        assert_eq!(found[0]["range"]["start"]["line"], line, "{mark}: {found}");
    }
    client.end();
}

#[test]
fn a_client_that_sends_garbage_is_told_and_nothing_panics() {
    let mut client = show("garbage");
    for params in [
        json!(null),
        json!([]),
        json!({ "textDocument": 3 }),
        json!({ "position": { "line": -1 } }),
    ] {
        for method in ["completion", "hover", "definition"] {
            client.ask(&format!("textDocument/{method}"), params.clone());
        }
        for method in ["didOpen", "didChange", "didSave", "didClose"] {
            client.tell(&format!("textDocument/{method}"), params.clone());
        }
    }
    let uri = client.uri("scene.toml");
    let position = json!({ "line": u64::MAX, "character": u64::MAX });
    client.ask(
        "textDocument/hover",
        json!({ "textDocument": { "uri": uri }, "position": position }),
    );
    let refused = client.answer("no/such", json!({}));
    assert_eq!(refused["error"]["code"], -32601);
    let garbage = b"Content-Length: 7\r\n\r\n{\"a\": }";
    client.input.write_all(garbage).expect("it listens");
    drop(client.input);
    let output = client.server.wait_with_output().expect("it ends");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{errors}");
    assert!(
        errors.contains("client of `lsp`") && !errors.contains("panicked"),
        "{errors}"
    );
}
