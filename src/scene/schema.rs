//! The JSON Schema of the scene text, for editors: the same keys that the reader reads.

use serde_json::{Map, Value, json};

use super::{
    manual,
    parse::{
        Form, KeyRecord, Rule, SectionRecord, VariantRecord, recorded_keys, recorded_project_keys,
    },
};

/// The key that every scene file must have, also one with a `base`.
const VERSION: &str = "version";

/// The schema, draft 2020-12. It cannot check what depends on other values or files: names that refer to
/// nothing, directions that are zero, matrices that are singular, keys that are missing here and stand in a
/// `base`.
pub fn schema() -> Value {
    document("Reflet scene", recorded_keys())
}

/// The schema of `reflet.toml`, draft 2020-12.
pub fn project_schema() -> Value {
    document("Reflet project", recorded_project_keys())
}

fn document(title: &str, sections: &[SectionRecord]) -> Value {
    let mut tables = sections.iter();
    let mut root = tables.next().map(table).unwrap_or_default();
    let defs: Map<_, _> = tables
        .map(|s| (s.type_name.into(), Value::Object(table(s))))
        .collect();
    root.insert(
        "$schema".into(),
        "https://json-schema.org/draft/2020-12/schema".into(),
    );
    root.insert("title".into(), title.into());
    root.insert("x-tombi-toml-version".into(), "v1.1.0".into());
    root.insert("$defs".into(), defs.into());
    root.into()
}

fn table(section: &SectionRecord) -> Map<String, Value> {
    let mut object = Map::new();
    object.insert("type".into(), "object".into());
    object.insert("description".into(), manual::section_text(section).into());
    if section.variants.is_empty() {
        object.extend(keys(section, None));
    } else {
        let variants = section
            .variants
            .iter()
            .map(|v| Value::Object(keys(section, Some(v))));
        object.insert("oneOf".into(), variants.collect());
    }
    object
}

/// Properties, required keys and rules of a table or of one of its variants.
fn keys(section: &SectionRecord, variant: Option<&VariantRecord>) -> Map<String, Value> {
    let own = variant.map_or(&[][..], |v| &v.keys);
    let own_rules = variant.map_or(&[][..], |v| &v.rules);
    let mut properties = Map::new();
    let mut required = Vec::new();
    if let Some(v) = variant {
        let text = manual::variant_text(section, v.word);
        properties.insert(
            v.key.into(),
            json!({ "const": v.word, "description": text }),
        );
        required.push(Value::from(v.key));
    }
    let common = section.keys.iter().map(|key| (None, key));
    for (word, key) in common.chain(own.iter().map(|key| (variant.map(|v| v.word), key))) {
        properties.insert(key.name.into(), property(section, word, key));
        // Any other required key may come from a `base`.
        if key.required && key.name == VERSION {
            required.push(key.name.into());
        }
    }
    let mut object = Map::new();
    object.insert("properties".into(), properties.into());
    object.insert("required".into(), required.into());
    object.insert("additionalProperties".into(), false.into());
    let rules: Vec<_> = section
        .rules
        .iter()
        .chain(own_rules)
        .flat_map(rule)
        .collect();
    if !rules.is_empty() {
        object.insert("allOf".into(), rules.into());
    }
    object
}

fn property(section: &SectionRecord, word: Option<&str>, key: &KeyRecord) -> Value {
    let reference = |name: &str| json!({ "$ref": format!("#/$defs/{name}") });
    let form = |form: &Form| match form {
        Form::Value(_, schema) => schema.clone(),
        Form::Table(name) => reference(name),
        Form::Entries(name) => {
            json!({ "type": "object", "additionalProperties": reference(name) })
        }
        Form::List(name) => json!({ "type": "array", "items": reference(name) }),
    };
    let mut forms: Vec<_> = key.forms.iter().map(form).collect();
    let mut property = match (forms.pop(), forms.is_empty()) {
        (Some(only), true) => only,
        (last, _) => json!({ "anyOf": forms.into_iter().chain(last).collect::<Vec<_>>() }),
    };
    property["description"] = manual::key_text(section, word, key).into();
    if let Some(default) = &key.default {
        property["default"] = default.clone();
    }
    property
}

fn rule(rule: &Rule) -> Vec<Value> {
    let mut schemas = Vec::new();
    for (i, group) in rule.groups.iter().enumerate() {
        for other in &rule.groups[i + 1..] {
            let pairs = group.iter().flat_map(|a| other.iter().map(move |b| [a, b]));
            schemas.extend(pairs.map(|pair| json!({ "not": { "required": pair } })));
        }
    }
    if rule.required {
        let any: Vec<_> = rule
            .groups
            .iter()
            .flatten()
            .map(|k| json!({ "required": [k] }))
            .collect();
        schemas.push(json!({ "anyOf": any }));
    }
    schemas
}
