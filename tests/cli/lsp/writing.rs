//! Help while writing: signatures of calls, names of the right kind, and formatted text.

use std::fs;

use serde_json::{Value, json};

use super::{Client, session::offset};
use crate::common::cases;

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
        client.ask_at("signatureHelp", "move.rhai", &text)
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
    client.change(&uri, &formatted);
    assert_eq!(format(&mut client), json!([]), "it stays as it is");
    client.change(&uri, "version = = 1\n  x");
    assert_eq!(format(&mut client), json!([]), "it is no TOML");
    client.end();
}

#[test]
fn help_that_says_what_to_write_is_a_quick_fix() {
    let mut client = Client::start("help");
    let uri = client.uri("scene.toml");
    client.open("scene.toml", "version = 1\n");
    let all = cases(include_str!("quick_fixes.txt")).into_iter();
    // A line like it would be a comment of the table.
    for (wrong, right) in all.chain([("// the floor", "# the floor")]) {
        let right = right.replace("\\n", "\n");
        let text = format!("version = 1\n{wrong}\n");
        client.change(&uri, &text);
        let found = client.found(&uri);
        let params = json!({ "textDocument": { "uri": uri }, "context": { "diagnostics": found } });
        let actions = client.ask("textDocument/codeAction", params);
        let edit = &actions[0]["edit"]["changes"][&uri][0];
        let new = edit["newText"].as_str();
        let new = new.unwrap_or_else(|| panic!("no action: {wrong}: {found:?}"));
        let [from, to] = ["start", "end"].map(|end| offset(&text, &edit["range"][end]));
        let mended = [&text[..from], new, &text[to..]].concat();
        assert_eq!(mended, format!("version = 1\n{right}\n"), "{found:?}");
    }
    client.end();
}

#[test]
fn keys_are_those_of_the_kind_and_of_placed_scenes() {
    let mut client = Client::start("of-kind");
    let gear = "version = 1\n[params]\nteeth = 24\nspokes = 5\n";
    fs::write(client.folder.join("gear.toml"), gear).expect("written");
    client.open("room.toml", "version = 1\n");
    let mut proposed = |text: &str| client.proposed("room.toml", &format!("version = 1\n{text}"));
    let box_keys = ["bevel", "bevel_segments", "kind", "size"];
    let mut own = proposed("[model.a]\nshape = { kind = \"box\", | }\n");
    own.sort();
    assert_eq!(own, box_keys);
    // The kind may stand behind, and other shapes around it have theirs.
    let parts = "[model.a]\nshape = { kind = \"union\", parts = [{ shape = { kind = \"text\" } }, { shape = { |, kind = \"box\" } }] }\n";
    let mut own = proposed(parts);
    own.sort();
    assert_eq!(own, box_keys);
    let own = proposed("[light.a]\nkind = \"spot\"\n[light.b]\n|\nkind = \"rect\"\n");
    let has = |key: &str| own.iter().any(|own| own == key);
    assert!(has("size") && has("color") && !has("outer_deg"), "{own:?}");
    let placed = "[[instance]]\nmodel = { scene = \"gear.toml\", params = { | } }\n";
    assert_eq!(proposed(placed), ["teeth", "spokes"]);
    let at = format!("version = 1\n{}", placed.replace('|', "te|eth = 3"));
    client.proposed("room.toml", &at);
    let found = client.ask_at("definition", "room.toml", &at);
    assert_eq!(found[0]["range"]["start"]["line"], 2, "{found}");
    client.end();
}
