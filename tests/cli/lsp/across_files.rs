//! Names across the files of a project, structure, colors and quick fixes, as an editor asks for them.

use crate::common::assert_says;
use std::fs;

use serde_json::{Value, json};

use super::{Client, list, position};

const PARTS: &str = "[material.brass]\nmetallic = 1\nbase_color = [0.214041, 1, 0]\n\n[material.red]\nextends = \"brass\"\n\
                     emission = \"#ff0080\"\n[environment]\ncolor = [0.5, 0.5, 0.5]\n";
const SHOT: &str = include_str!("across_files/shot.toml");
const SCRIPT: &str = "fn setup(ctx) { #{} }\nfn frame(ctx) {\n    ctx.place(\"first\", [0, ctx.params.lift, 0]);\n}\n";

/// A project with a shot in a subfolder, all of it open but the parts.
fn project(name: &str) -> Client {
    let mut client = Client::start(name);
    let folder = client.folder.clone();
    fs::create_dir_all(folder.join("shots")).expect("a folder");
    fs::write(folder.join("reflet.toml"), "assets = [\"shots\"]\n").expect("written");
    fs::write(folder.join("parts.toml"), PARTS).expect("written");
    client.open("move.rhai", SCRIPT);
    client.open("shots/scene.toml", SHOT);
    let uri = client.uri("shots/scene.toml");
    assert_eq!(client.found(&uri), [] as [Value; 0]);
    client
}

/// Files and start lines of locations.
fn lines(places: &Value) -> Vec<(String, u64)> {
    let place = |place: &Value| {
        let file = place["uri"].as_str().expect("a file");
        let line = &place["range"]["start"]["line"];
        let file = file.rsplit('/').next().unwrap_or_default().to_owned();
        (file, line.as_u64().expect("a line"))
    };
    list(places).iter().map(place).collect()
}

/// Answer to changing the name at a mark in a file.
fn renamed(client: &mut Client, file: &str, at: &str, new: &str) -> Value {
    let mut params = document(client, file);
    params["position"] = position(at);
    params["newName"] = new.into();
    client.answer("textDocument/rename", params)
}

fn document(client: &Client, name: &str) -> Value {
    json!({ "textDocument": { "uri": client.uri(name) } })
}

#[test]
fn references_are_found_in_all_files_and_renamed() {
    let mut client = project("across");
    let at = SHOT.replace("material = \"brass\"", "material = \"br|ass\"");
    let found = client.ask_at("references", "shots/scene.toml", &at);
    let own = |file: &str, line| (file.to_owned(), line);
    let want = [
        own("parts.toml", 0),
        own("parts.toml", 5),
        own("scene.toml", 11),
        own("scene.toml", 20),
    ];
    assert_eq!(lines(&found), want);
    let name = client.ask_at("prepareRename", "shots/scene.toml", &at);
    assert_eq!(name["start"], json!({ "line": 11, "character": 11 }));
    let mut edits = |at: &str, file: &str, new: &str| renamed(&mut client, file, at, new);
    let renamed = edits(&at, "shots/scene.toml", "old brass");
    let all = renamed["result"]["changes"].as_object().expect("edits");
    let edited = all.values().flat_map(list);
    let mut texts: Vec<_> = edited.map(|edit| &edit["newText"]).collect();
    texts.dedup();
    assert_eq!((all.len(), texts), (2, vec![&json!("\"old brass\"")]));
    let taken = edits(&at, "shots/scene.toml", "red");
    assert_says(
        &taken["error"]["message"].to_string(),
        &["another material"],
    );
    // A removed entry keeps its kind, and scripts follow.
    let at = SHOT.replace(
        "remove = [\"material.red\"]",
        "remove = [\"material.r|ed\"]",
    );
    let renamed = edits(&at, "shots/scene.toml", "blue").to_string();
    assert_says(&renamed, &["\"\\\"material.blue\\\"\"", "\"blue\""]);
    let at = SHOT.replace("lift = 1.0", "li|ft = 1.0");
    let renamed = edits(&at, "shots/scene.toml", "rise")["result"]["changes"].to_string();
    assert_says(&renamed, &["move.rhai", "scene.toml"]);
    let at = SCRIPT.replace("\"first\"", "\"fi|rst\"");
    let renamed = edits(&at, "move.rhai", "second")["result"]["changes"].to_string();
    assert_says(&renamed, &["move.rhai", "scene.toml"]);
    client.end();
}

#[test]
fn a_name_in_another_place_of_a_script_is_left_alone() {
    let mut client = project("other-texts");
    // A text without meaning, a word of a shape, and the name of another kind are no references to the model.
    let script = "fn setup(ctx) {\n    let word = \"ball\";\n    #{ models: #{ b: #{ shape: #{ kind: \"ball\" } } },\n\
                  instances: [#{ model: \"ball\" }] }\n}\nfn frame(ctx) { ctx.light(\"ball\", #{}); }\n";
    client.open("move.rhai", script);
    let at = SHOT.replace("[model.ball]", "[model.ba|ll]");
    let found = client.ask_at("references", "shots/scene.toml", &at);
    let found = lines(&found).into_iter();
    let found: Vec<_> = found.filter(|(file, _)| file == "move.rhai").collect();
    assert_eq!(
        found,
        [("move.rhai".to_owned(), 3)],
        "the model of the instance"
    );
    client.end();
}

#[test]
fn symbols_folds_and_colors_of_texts() {
    let mut client = project("structure");
    let ask = |client: &mut Client, what: &str, name: &str| {
        client.ask(&format!("textDocument/{what}"), document(client, name))
    };
    let symbols = ask(&mut client, "documentSymbol", "shots/scene.toml");
    let names: Vec<_> = list(&symbols).iter().map(|s| &s["name"]).collect();
    let want = [
        "params",
        "model.ball",
        "instance \"first\"",
        "variant.plain",
    ];
    assert_eq!(names, want);
    let folds = ask(&mut client, "foldingRange", "shots/scene.toml");
    let ends = |f: &Value| (f["startLine"].as_u64(), f["endLine"].as_u64());
    let folds: Vec<_> = list(&folds).iter().map(ends).collect();
    let want = [(4, 5), (7, 8), (9, 11), (13, 16), (18, 20)];
    assert_eq!(folds, want.map(|(a, b)| (Some(a), Some(b))));
    let symbols = ask(&mut client, "documentSymbol", "move.rhai");
    assert_eq!(symbols[1]["name"], "frame");
    assert_eq!(symbols[1]["range"]["end"]["line"], 3);
    client.open("parts.toml", PARTS);
    let colors = ask(&mut client, "documentColor", "parts.toml");
    let colors = list(&colors);
    assert_eq!(colors.len(), 3, "{colors:?}");
    let red = colors[0]["color"]["red"].as_f64().expect("a number");
    assert!((red - 0.5).abs() < 1e-4, "{red}");
    assert_eq!(
        colors[1]["color"],
        json!({ "red": 1.0, "green": 0.0, "blue": 128.0 / 255.0, "alpha": 1 })
    );
    let mut ask = |index: usize| {
        let mut params = document(&client, "parts.toml");
        params["color"] = json!({ "red": 1, "green": 0.5, "blue": 0, "alpha": 1 });
        params["range"] = colors[index]["range"].clone();
        client.ask("textDocument/colorPresentation", params)
    };
    assert_eq!(ask(0)[0]["label"], "[1, 0.214, 0]");
    assert_eq!(ask(1)[0]["label"], "\"#ff8000\"");
    client.end();
}

#[test]
fn suggestions_are_quick_fixes() {
    let mut client = project("fixes");
    let uri = client.uri("shots/scene.toml");
    let wrong = SHOT
        .replace("dynamic = true", "dynamik = true")
        .replace("model = \"ball\"", "model = \"bal\"");
    client.change(&uri, &wrong);
    let found = client.found(&uri);
    let mut params = document(&client, "shots/scene.toml");
    params["context"] = json!({ "diagnostics": found });
    let actions = client.ask("textDocument/codeAction", params);
    let new = |action: &Value| action["edit"]["changes"][&uri][0]["newText"].clone();
    let texts: Vec<_> = list(&actions).iter().map(new).collect();
    assert_eq!(texts, [json!("\"ball\""), json!("dynamic")], "{found:?}");
    client.end();
}

#[test]
fn messages_of_one_scene_stay_where_another_has_none_left() {
    let mut client = Client::start("shared");
    let folder = client.folder.clone();
    fs::write(folder.join("parts.toml"), "[material.a]\nmetalic = 1\n").expect("written");
    let scene = "version = 1\ninclude = \"parts.toml\"\n";
    client.open("other.toml", scene);
    let parts = client.uri("parts.toml");
    assert_eq!(client.found(&parts).len(), 1);
    client.open("scene.toml", scene);
    client.change(&client.uri("scene.toml"), "version = 1\n");
    assert_eq!(client.found(&parts).len(), 1, "the other scene has it");
    client.tell("textDocument/didClose", document(&client, "other.toml"));
    assert_eq!(client.found(&parts).len(), 0);
    client.end();
}

#[test]
fn the_text_of_a_project_is_completed_and_checked() {
    let mut client = project("reflet-toml");
    client.open("reflet.toml", "asets = 3\n");
    let uri = client.uri("reflet.toml");
    let found = client.found(&uri);
    let message = found[0]["message"].to_string();
    assert_says(&message, &["did you mean `assets`?"]);
    let labels = client.proposed("reflet.toml", "|\n");
    assert!(
        ["assets", "camera", "output", "sizes"]
            .iter()
            .all(|key| labels.contains(&(*key).to_owned())),
        "{labels:?}"
    );
    assert_eq!(
        client.proposed("reflet.toml", "assets = [\"|\"]\n"),
        ["shots"]
    );
    let file = client.folder.join("reflet.toml");
    fs::write(file, "assets = [\"shots\"]\n").expect("written");
    // Files of the project are proposed by their names in it.
    let labels = client.proposed("shots/scene.toml", "version = 1\ninclude = \"|\"\n");
    assert!(labels.contains(&"parts.toml".to_owned()), "{labels:?}");
    client.end();
}

const LAMP: &str = "version = 1\n[model.glass]\nshape = { kind = \"sphere\" }\n[[instance]]\nname = \"bulb\"\n\
                    model = \"glass\"\ndynamic = true\n";
const ROOM: &str = include_str!("across_files/room.toml");
const MOVES: &str = "fn frame(ctx) {\n    ctx.place(\"left.bulb\", [0, 1, ctx.t]);\n}\n";

#[test]
fn names_of_placed_scenes_have_the_prefix_of_their_group() {
    let mut client = Client::start("prefix");
    let folder = client.folder.clone();
    fs::write(folder.join("lamp.toml"), LAMP).expect("written");
    // Too long for a script, so that it is not read.
    fs::write(folder.join("long.rhai"), "// \"bulb\"\n".repeat(200_000)).expect("written");
    client.open("room.rhai", MOVES);
    client.open("room.toml", ROOM);
    let uri = client.uri("room.toml");
    assert_eq!(client.found(&uri), [] as [Value; 0]);
    let labels = |found: &Value| {
        let labels = list(found)
            .iter()
            .map(|item| item["label"].as_str().unwrap_or_default().to_owned());
        labels.collect::<Vec<_>>()
    };
    let at = ROOM.replace("\"left.bulb\"", "\"|left.bulb\"");
    let found = labels(&client.ask_at("completion", "room.toml", &at));
    assert_eq!(found, ["left", "left.bulb"]);
    let at = MOVES.replace("\"left.bulb\"", "\"|left.bulb\"");
    let found = labels(&client.ask_at("completion", "room.rhai", &at));
    assert!(found.contains(&"left.bulb".to_owned()) && !found.contains(&"bulb".to_owned()));
    let own = |file: &str, line| (file.to_owned(), line);
    let all = [
        own("lamp.toml", 4),
        own("room.rhai", 1),
        own("room.toml", 10),
    ];
    for (file, text) in [("room.toml", ROOM), ("room.rhai", MOVES)] {
        let at = text.replace("left.bulb", "left.bu|lb");
        let found = ["definition", "references"].map(|what| lines(&client.ask_at(what, file, &at)));
        assert_eq!(found, [&all[..1], &all[..]], "{file}");
        let name = client.ask_at("prepareRename", file, &at);
        let [start, end] = ["start", "end"].map(|end| name[end]["character"].as_u64());
        let length = end.zip(start).map(|(end, start)| end - start);
        assert_eq!(length, Some(4), "{file}");
    }
    let mut rename = |at: &str, new: &str| {
        renamed(&mut client, "room.toml", at, new)["result"]["changes"].to_string()
    };
    let renamed = rename(&ROOM.replace("left.bulb", "left.bu|lb"), "globe");
    assert_eq!(renamed.matches("globe").count(), 3, "{renamed}");
    assert_says(&renamed, &["lamp.toml", "room.rhai"]);
    let renamed = rename(&ROOM.replace("left.bulb", "le|ft.bulb"), "right");
    assert_eq!(renamed.matches("right").count(), 3, "{renamed}");
    assert!(!renamed.contains("lamp.toml"), "{renamed}");
    client.end();
}
