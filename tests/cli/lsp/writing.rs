//! Help while writing: signatures of calls, names of the right kind, and formatted text.

use std::fs;

use serde_json::{Value, json};

use super::Client;

const SCENE: &str = "version = 1\nscript = \"move.rhai\"\n[material.brass]\nmetallic = 1\n\n[light.lamp]\nkind = \"point\"\n\n\
                     [model.ball]\nshape = { kind = \"sphere\" }\n\n[[instance]]\nname = \"first\"\nmodel = \"ball\"\n";

/// A scene with a script, which is open.
fn scripted(name: &str) -> Client {
    let mut client = Client::start(name);
    fs::write(client.folder.join("scene.toml"), SCENE).expect("written");
    client.open("move.rhai", "fn frame(ctx) {}\n");
    client
}

#[test]
fn calls_in_scripts_show_their_signatures() {
    let mut client = scripted("signatures");
    let mut help = |call: &str| {
        let text = format!("fn frame(ctx) {{\n  {call}");
        client.open("move.rhai", &text.replace('|', ""));
        client.at("signatureHelp", "move.rhai", &text)
    };
    let found = help("ctx.place(\"a, b\", [0, 1, |");
    let signatures = found["signatures"].as_array().expect("a list");
    let labels: Vec<_> = signatures.iter().map(|s| &s["label"]).collect();
    let wanted = json!("ctx.place(name, position, rotation)");
    assert!(labels.contains(&&wanted), "{labels:?}");
    assert_eq!(found["activeParameter"], 1);
    assert_eq!(signatures[0]["parameters"][1]["label"], "position");
    // A form that takes a third argument.
    let found = help("ctx.place(\"a\", [0, 1, 2], |");
    let active = (&found["activeSignature"], &found["activeParameter"]);
    assert_eq!(active, (&json!(1), &json!(2)));
    assert_eq!(help("let a = 1; |"), Value::Null);
    client.end();
}

#[test]
fn calls_in_scripts_take_names_of_their_kind() {
    let mut client = scripted("kinds");
    let proposed = |client: &mut Client, call: &str| {
        client.proposed("move.rhai", &format!("fn frame(ctx) {{\n  {call}"))
    };
    assert_eq!(proposed(&mut client, "ctx.place(\"|"), ["first"]);
    assert_eq!(proposed(&mut client, "ctx.light(\"|"), ["lamp"]);
    assert_eq!(proposed(&mut client, "ctx.material(\"|"), ["ball", "brass"]);
    // Where nothing is known of the text, all names are proposed.
    assert_eq!(
        proposed(&mut client, "let name = \"|"),
        ["ball", "brass", "first", "lamp"]
    );
    client.end();
}

#[test]
fn texts_are_formatted_and_keep_their_comments() {
    let mut client = Client::start("format");
    let text = "version=1 # of the language\n# The ball.\n[model.ball]\nshape={kind=\"sphere\",radius=1}\n\n\n\n\n[camera.main]\neye=[0,1,5]\n\
                target=[\n0, # x\n0,0\n]\n";
    client.open("scene.toml", text);
    let format = |client: &mut Client| {
        let params = json!({
            "textDocument": { "uri": client.uri("scene.toml") },
            "options": { "tabSize": 2, "insertSpaces": true },
        });
        client.ask("textDocument/formatting", params)
    };
    let edits = format(&mut client);
    let formatted = edits[0]["newText"].as_str().expect("an edit").to_owned();
    assert_eq!(
        formatted,
        "version = 1 # of the language\n# The ball.\n[model.ball]\nshape = { kind = \"sphere\", radius = 1 }\n\n\n[camera.main]\n\
         eye = [0, 1, 5]\ntarget = [\n  0, # x\n  0, 0\n]\n"
    );
    let uri = client.uri("scene.toml");
    let change = |text: &str| json!({ "textDocument": { "uri": uri }, "contentChanges": [{ "text": text }] });
    client.tell("textDocument/didChange", change(&formatted));
    assert_eq!(format(&mut client), json!([]), "it stays as it is");
    client.tell("textDocument/didChange", change("version = = 1\n  x"));
    assert_eq!(format(&mut client), json!([]), "it is no TOML");
    client.end();
}
