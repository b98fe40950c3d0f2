//! Colors in scene text, for the color picker of an editor.

use serde_json::{Value, json};

use super::position::range;
use reflet_base::math::{linear_from_srgb, srgb_from_linear};
use reflet_scene::{
    diagnostic::Source,
    parse::{Form, tables::Manual},
    syntax::{Content, Node},
};

/// Colors of a text: values of keys that take `"#rrggbb"`, written so or as three linear numbers up to 1.
pub fn colors(file: &Source) -> Vec<Value> {
    let mut found = Vec::new();
    let root = file.syntax().root();
    for (key, node) in root {
        walk(file, &[], key.get_ref(), node, &mut found);
    }
    found.sort_by_key(|(start, _)| *start);
    found.into_iter().map(|(_, color)| color).collect()
}

fn walk(file: &Source, table: &[String], key: &str, node: &Node, found: &mut Vec<(usize, Value)>) {
    if let Content::Table(entries) = node.get_ref() {
        let inner = [table, &[key.to_owned()]].concat();
        for (key, node) in entries {
            walk(file, &inner, key.get_ref(), node, found);
        }
        return;
    }
    if let Content::Array(items) = node.get_ref()
        && items.iter().any(|item| item.get_ref().as_table().is_some())
    {
        items
            .iter()
            .for_each(|item| walk(file, table, key, item, found));
        return;
    }
    if let Some(rgb) = color_of(node).filter(|_| is_color(file, table, key)) {
        let [red, green, blue] = rgb;
        let color = json!({
            "range": range(&file.text, &node.span()),
            "color": { "red": red, "green": green, "blue": blue, "alpha": 1 },
        });
        found.push((node.span().start, color));
    }
}

/// Whether the manual says that a key takes a color.
fn is_color(file: &Source, table: &[String], key: &str) -> bool {
    let Some((_, _, key)) = Manual::for_file(&file.path).key(table, key) else {
        return false;
    };
    let is_color = |form: &Form| matches!(form, Form::Value(words, _) if words.contains("#rrggbb"));
    key.forms.iter().any(is_color)
}

/// Display color of a value, each channel 0 to 1.
fn color_of(node: &Node) -> Option<[f64; 3]> {
    match node.get_ref() {
        Content::String(text) => {
            let hex = text
                .strip_prefix('#')
                .filter(|hex| hex.len() == 6 && hex.is_ascii())?;
            let channel = |i: usize| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).ok();
            Some([channel(0)?, channel(1)?, channel(2)?].map(|c| f64::from(c) / 255.0))
        }
        Content::Array(items) => {
            let number = |item: &Node| match item.get_ref() {
                Content::Integer(i) => i.value().map(|x| x as f64),
                Content::Float(f) => f.value(),
                _ => None,
            };
            let numbers: Option<Vec<f64>> = items.iter().map(number).collect();
            let rgb: [f64; 3] = numbers?.try_into().ok()?;
            let is_shown = rgb.iter().all(|c| (0.0..=1.0).contains(c));
            is_shown.then(|| rgb.map(|c| f64::from(srgb_from_linear(c as f32))))
        }
        _ => None,
    }
}

/// The ways to write a display color at a range of a text: as it is written there first.
pub fn presentations(file: &Source, params: &Value) -> Vec<Value> {
    let channel = |name: &str| {
        params["color"][name]
            .as_f64()
            .unwrap_or(0.0)
            .clamp(0.0, 1.0)
    };
    let rgb = ["red", "green", "blue"].map(channel);
    let hex = rgb
        .map(|c| format!("{:02x}", (c * 255.0).round() as u8))
        .concat();
    let linear = rgb.map(|c| {
        let text = format!("{:.4}", linear_from_srgb(c as f32));
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    });
    let mut ways = [format!("\"#{hex}\""), format!("[{}]", linear.join(", "))];
    let start = super::position::offset(&file.text, &params["range"]["start"]);
    if file.text[start..].starts_with('[') {
        ways.reverse();
    }
    ways.iter().map(|way| json!({ "label": way })).collect()
}
