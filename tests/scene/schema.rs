//! The JSON Schema names the keys that the manual and the reader have. An independent validator tests in
//! `tests/tools/test_schema.py` that it accepts and refuses what the reader does.

use reflet::scene::{
    parse::{self, SectionRecord},
    schema::schema,
};

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
    for section in parse::recorded_keys() {
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
