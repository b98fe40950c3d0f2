//! Colors: three linear numbers, or sRGB as the web writes it.

use glam::Vec3;
use serde_json::{Value as Json, json};
use svgtypes::Color as CssColor;

use super::{
    report::Report,
    value::{Named, Value, wrong_type},
    value_advice::list_of_number,
};
use crate::syntax::{Content, Node};
use crate::{diagnostic::Diagnostic, range::Range, suggest};
use reflet_base::math::linear_from_srgb;

/// A linear color, written as three linear numbers or as sRGB text `"#rrggbb"` or `"#rgb"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color(pub Vec3);

impl Value for Color {
    const RANGED: bool = true;

    fn expected() -> String {
        "three numbers or \"#rrggbb\"".into()
    }
    fn several(count: &str) -> String {
        format!("{count} colors, each {}", Self::expected())
    }
    fn schema(range: &Range) -> Json {
        let text = json!({ "type": "string", "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})$" });
        json!({ "anyOf": [Vec3::schema(range), text] })
    }
    fn to_json(&self) -> Json {
        self.0.to_json()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        match node.get_ref() {
            Content::String(text) => match of_text(text) {
                Some(bytes) => Some(Self(linear(bytes))),
                None => {
                    let key = named.key;
                    let shown = suggest::text(text);
                    let message = format!("`{key}` must be {}, not {shown}", Self::expected());
                    report.error("wrong-color", &node.span(), message).help = Some(advice(text));
                    None
                }
            },
            Content::Array(items) => {
                if let Some(bytes) = as_bytes(items, named.range) {
                    let [r, g, b] = bytes;
                    let message = format!(
                        "`{}` must be three numbers, {}, not [{r}, {g}, {b}]",
                        named.key,
                        named.range.words()
                    );
                    let [x, y, z] = linear(bytes).to_array().map(|c| (c * 1e3).round() / 1e3);
                    report.error("out-of-range", &node.span(), message).help = Some(format!(
                        "write \"#{r:02x}{g:02x}{b:02x}\", or in linear light [{x}, {y}, {z}]"
                    ));
                    return None;
                }
                if let Some([r, g, b]) = seems_bytes(items) {
                    let message = format!(
                        "`{}` is a linear color, in which 1 is white: [{r}, {g}, {b}] is {} times as bright",
                        named.key,
                        r.max(g).max(b)
                    );
                    let help = format!(
                        "if bytes were meant, write \"#{r:02x}{g:02x}{b:02x}\"; brightness has a key of its own"
                    );
                    let warning =
                        Diagnostic::new("bytes-as-color", report.span(&node.span()), message);
                    report.push(warning.help(help).warning());
                }
                Vec3::read(node, named, report).map(Self)
            }
            _ => {
                let help = of_number(node).or_else(|| list_of_number(node, named.key, 3));
                wrong_type(node, named.key, &Self::expected(), report).help = help;
                None
            }
        }
    }
}

/// The bytes of `#rrggbb` or `#rgb`.
fn of_text(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#')?;
    let hex = digits.bytes().all(|b| b.is_ascii_hexdigit());
    let number = u32::from_str_radix(digits, 16).ok().filter(|_| hex)?;
    let nibble = |at: u32| (number >> at & 15) as u8 * 17;
    let byte = |at: u32| (number >> at) as u8;
    match digits.len() {
        3 => Some([nibble(8), nibble(4), nibble(0)]),
        6 => Some([byte(16), byte(8), byte(0)]),
        _ => None,
    }
}

/// Advice for the bytes of a color as one number.
fn of_number(node: &Node) -> Option<String> {
    let Content::Integer(number) = node.get_ref() else {
        return None;
    };
    let bytes = number.value().filter(|n| (256..=0xff_ffff).contains(n))?;
    Some(format!("write \"#{bytes:06x}\""))
}

/// A color of CSS, also without the `#` or with `0x` in its place.
pub fn in_css(text: &str) -> Option<CssColor> {
    let digits = format!("#{}", text.trim_start_matches("0x"));
    (text.parse().ok()).or_else(|| digits.parse().ok())
}

/// Linear color of a text in CSS, rounded.
pub fn linear_css(text: &str) -> Option<[f32; 3]> {
    let color = in_css(text)?;
    let rgb = linear([color.red, color.green, color.blue]);
    Some(rgb.to_array().map(|c| (c * 1e3).round() / 1e3))
}

/// Colors of lamps by their names on the box: 2700 K, 4000 K, 6500 K and 10000 K, as in sRGB.
const LIGHTS: [(&str, &str); 5] = [
    ("warm", "#ffa757"),
    ("neutral", "#ffcea6"),
    ("daylight", "#fff9fd"),
    ("cold", "#cadaff"),
    ("cool", "#cadaff"),
];

/// Advice for a text that is not a color.
fn advice(text: &str) -> String {
    let is_image = [".png", ".jpg", ".jpeg", ".webp", ".ktx2"];
    if is_image.iter().any(|ending| text.ends_with(ending)) {
        return format!(
            "an image is a texture: write `base_color_texture = {}`",
            suggest::text(text)
        );
    }
    if let Some((_, code)) = LIGHTS.iter().find(|(name, _)| *name == text) {
        return format!("colors have no names; write \"{code}\"");
    }
    let is_name = text.chars().all(char::is_alphabetic) && text.parse::<CssColor>().is_ok();
    let Some(color) = in_css(text) else {
        return "such as \"#ff8800\", in sRGB as the web writes it, or [1, 0.25, 0] in linear light"
            .into();
    };
    let (r, g, b) = (color.red, color.green, color.blue);
    let code = format!("write \"#{r:02x}{g:02x}{b:02x}\"");
    match color.alpha {
        255 if is_name => format!("colors have no names; {code}"),
        255 => code,
        alpha => {
            let alpha = (f32::from(alpha) / 2.55).round() / 100.0;
            format!("{code}, and of a material `alpha = {alpha}`")
        }
    }
}

/// Linear color of sRGB bytes.
fn linear(bytes: [u8; 3]) -> Vec3 {
    Vec3::from_array(bytes.map(|b| linear_from_srgb(f32::from(b) / 255.0)))
}

/// Three whole numbers up to 255, of which at least one is too large for the brightness of linear light.
fn seems_bytes(items: &[Node]) -> Option<[u8; 3]> {
    let bytes = bytes_of(items)?;
    (bytes.iter().any(|b| *b >= 128)).then_some(bytes)
}

/// The bytes of three whole numbers up to 255 where 1 is the limit: sRGB bytes were meant.
fn as_bytes(items: &[Node], range: &Range) -> Option<[u8; 3]> {
    let bytes = bytes_of(items)?;
    // [1, 2, 0] is more likely a typing error.
    let too_large = bytes
        .iter()
        .any(|b| *b > 15 && !range.contains(f64::from(*b)));
    (too_large && range.contains(1.0)).then_some(bytes)
}

/// Three whole numbers from 0 to 255.
fn bytes_of(items: &[Node]) -> Option<[u8; 3]> {
    let byte = |item: &Node| match item.get_ref() {
        Content::Integer(i) => u8::try_from(i.value()?).ok(),
        _ => None,
    };
    let bytes = items.iter().map(byte).collect::<Option<Vec<_>>>()?;
    bytes.try_into().ok()
}
