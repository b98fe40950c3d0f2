//! The JSON Schema agrees with the reader, as far as a schema can: a small validator checks it on
//! every bad scene and the manual's example.

use std::{fs, path::Path};

use reflet::scene::{
    manual::EXAMPLE,
    parse::{self, SectionRecord},
    schema::schema,
    stages::Scene,
};
use serde_json::{Map, Value, json};

/// Messages about what depends on other values, or is no JSON at all.
const BEYOND_SCHEMA: &[&str] = &[
    "bad-matrix",
    "bad-set",
    "dangling-name",
    "duplicate-name",
    "empty-timeline",
    "key-order",
    "key-range",
    "no-handles",
    "no-keys",
    "script-file",
    "singular",
    "too-many-lights",
    "wrong-motion",
    "wrong-shadow",
    "wrong-source",
    "zero-direction",
];

fn is_valid(root: &Value, schema: &Value, value: &Value) -> bool {
    let Some(keywords) = schema.as_object() else {
        return schema
            .as_bool()
            .expect("a schema is an object or a boolean");
    };
    keywords
        .iter()
        .all(|(keyword, argument)| holds(root, keywords, keyword, argument, value))
}

fn holds(
    root: &Value,
    schema: &Map<String, Value>,
    keyword: &str,
    argument: &Value,
    value: &Value,
) -> bool {
    let valid = |schema: &Value| is_valid(root, schema, value);
    let list = || argument.as_array().expect("a list").iter();
    let limit = || argument.as_f64().expect("a number");
    let compare = |holds: fn(f64, f64) -> bool| value.as_f64().is_none_or(|x| holds(x, limit()));
    let count = |holds: fn(usize, usize) -> bool| {
        value
            .as_array()
            .is_none_or(|v| holds(v.len(), limit() as usize))
    };
    match keyword {
        "$schema" | "$defs" | "title" | "description" | "default" | "x-tombi-toml-version" => true,
        "$ref" => {
            let path = argument.as_str().expect("a path").trim_start_matches('#');
            valid(root.pointer(path).expect("a reference to something"))
        }
        "type" => match argument.as_str().expect("one type") {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "string" => value.is_string(),
            "boolean" => value.is_boolean(),
            "number" => value.is_number(),
            "integer" => value.as_f64().is_some_and(|x| x.fract() == 0.0),
            other => panic!("unknown type {other}"),
        },
        "const" => value == argument,
        "enum" => list().any(|v| v == value),
        "minimum" => compare(|x, limit| x >= limit),
        "maximum" => compare(|x, limit| x <= limit),
        "exclusiveMinimum" => compare(|x, limit| x > limit),
        "exclusiveMaximum" => compare(|x, limit| x < limit),
        "minLength" => value
            .as_str()
            .is_none_or(|s| s.chars().count() >= limit() as usize),
        "minItems" => count(|n, limit| n >= limit),
        "maxItems" => count(|n, limit| n <= limit),
        "items" => value
            .as_array()
            .is_none_or(|items| items.iter().all(|item| is_valid(root, argument, item))),
        "properties" => argument
            .as_object()
            .expect("schemas by name")
            .iter()
            .all(|(name, s)| value.get(name).is_none_or(|value| is_valid(root, s, value))),
        "additionalProperties" => value.as_object().is_none_or(|object| {
            let known = |name: &String| {
                schema
                    .get("properties")
                    .is_some_and(|p| p.get(name).is_some())
            };
            object
                .iter()
                .all(|(name, v)| known(name) || is_valid(root, argument, v))
        }),
        "required" => list().all(|name| value.get(name.as_str().expect("a name")).is_some()),
        "allOf" => list().all(valid),
        "anyOf" => list().any(valid),
        "oneOf" => list().filter(|s| valid(s)).count() == 1,
        "not" => !valid(argument),
        other => panic!("the schema uses {other}, which the validator does not know"),
    }
}

/// TOML as JSON; `None` for what is not TOML or has no JSON (nan, dates).
fn json_of(text: &str) -> Option<Value> {
    let table: toml::Table = text.parse().ok()?;
    let json = serde_json::to_value(&table).ok()?;
    let lost =
        |text: &str| text.contains("nan") || text.contains("inf") || text.contains("$__toml");
    (!lost(&table.to_string()) && !lost(&json.to_string())).then_some(json)
}

#[test]
fn the_schema_refuses_what_the_reader_refuses() {
    let schema = schema();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes");
    let mut compared = 0;
    for entry in fs::read_dir(folder).expect("the folder exists") {
        let path = entry.expect("it can be listed").path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let text = fs::read_to_string(&path).expect("it can be read");
        let Some(json) = json_of(&text) else { continue };
        let messages = Scene::from_text(&text, &path, &[])
            .err()
            .unwrap_or_default();
        let within = messages.iter().any(|m| !BEYOND_SCHEMA.contains(&m.name));
        let valid = is_valid(&schema, &schema, &json);
        assert_eq!(
            valid,
            !within,
            "{}: the schema and the reader disagree",
            path.display()
        );
        compared += 1;
    }
    assert!(compared >= 45, "only {compared} files could be compared");
}

#[test]
fn the_schema_takes_the_example_and_one_more_thing_breaks_it() {
    let schema = schema();
    let example = json_of(EXAMPLE).expect("it is TOML");
    let refuses = |change: fn(&mut Value)| {
        let mut scene = example.clone();
        change(&mut scene);
        !is_valid(&schema, &schema, &scene)
    };
    assert!(!refuses(|_| ()));
    assert!(refuses(|s| s["version"] = json!(2)));
    assert!(refuses(|s| s["camera"]["main"]["fov"] = json!(60)));
    assert!(refuses(|s| s["camera"]["main"]["fov_deg"] = json!(171)));
    assert!(refuses(|s| s["camera"]["main"]["eye"] = json!([0, 1])));
    assert!(refuses(|s| s["camera"]["main"]["near_m"] = json!(0)));
    assert!(refuses(|s| s["light"]["lamp"]["intensity_lux"] = json!(1)));
    assert!(refuses(|s| s["light"]["sun"]["direction"] = json!(null)));
    assert!(refuses(|s| s["light"]["lamp"]["kind"] = json!("lamp")));
    assert!(refuses(
        |s| s["model"]["hall"]["shape"] = json!({ "kind": "box" })
    ));
    assert!(refuses(|s| s["instance"][0]["matrix"] = json!([1])));
    assert!(refuses(|s| s["environment"]["color"] = json!([0, 0, 0])));
    assert!(refuses(|s| s["reflection"]["bounces"] = json!(2.5)));
    assert!(!refuses(|s| s["reflection"]["bounces"] = json!(2.0)));
    assert!(!refuses(|s| s["instance"][0]["scale"] = json!(2)));
    assert!(!refuses(|s| s["instance"][0]["scale"] = json!([2, 1, 1])));
}

/// A table of the file for a section: every key of the section, with its default or a stand-in.
fn property_names(section: &SectionRecord) -> Vec<&'static str> {
    let of_variants = section
        .variants
        .iter()
        .flat_map(|v| std::iter::once(v.key).chain(v.keys.iter().map(|k| k.name)));
    section
        .keys
        .iter()
        .map(|k| k.name)
        .chain(of_variants)
        .collect()
}

#[test]
fn schema_manual_and_reader_have_the_same_keys() {
    let schema = schema();
    let manual = reflet::scene::manual::manual();
    for section in &parse::recorded_keys().sections {
        let object = match section.type_name {
            "SceneDesc" => &schema,
            name => &schema["$defs"][name],
        };
        let mut in_schema: Vec<&str> = Vec::new();
        let variants = object["oneOf"].as_array().into_iter().flatten();
        for part in std::iter::once(object).chain(variants) {
            let properties = part["properties"].as_object();
            in_schema.extend(properties.into_iter().flatten().map(|(key, property)| {
                let text = property["description"].as_str().unwrap_or_default();
                assert!(
                    !text.is_empty(),
                    "{key} of {} is not described",
                    section.type_name
                );
                key.as_str()
            }));
        }
        let mut asked = property_names(section);
        asked.sort_unstable();
        asked.dedup();
        in_schema.sort_unstable();
        in_schema.dedup();
        assert_eq!(asked, in_schema, "{}", section.type_name);
        // The part of the manual under the section's heading.
        let heading = format!("## `{}`\n", section.heading);
        let heading = match section.type_name {
            "SceneDesc" => format!("## {}\n", section.heading),
            _ => heading,
        };
        let (_, part) = manual
            .split_once(&heading)
            .expect("a heading for each section");
        let part = part.split("\n## ").next().unwrap_or(part);
        let row = |line: &str| Some(line.strip_prefix("| `")?.split('`').next()?.to_owned());
        let mut in_manual: Vec<_> = part.lines().filter_map(row).collect();
        in_manual.extend(section.variants.iter().map(|v| v.key.to_owned()));
        in_manual.sort_unstable();
        in_manual.dedup();
        assert_eq!(asked, in_manual, "{}", section.type_name);
    }
}

#[test]
fn defaults_of_the_schema_are_values_it_takes() {
    fn walk(root: &Value, schema: &Value, found: &mut usize) {
        if let Some(default) = schema.get("default") {
            assert!(is_valid(root, schema, default), "{schema}");
            *found += 1;
        }
        let inner: Vec<_> = match schema {
            Value::Object(map) => map.values().collect(),
            Value::Array(list) => list.iter().collect(),
            _ => Vec::new(),
        };
        inner.into_iter().for_each(|s| walk(root, s, found));
    }
    let (schema, mut found) = (schema(), 0);
    walk(&schema, &schema, &mut found);
    assert!(found >= 30, "only {found} defaults");
}
