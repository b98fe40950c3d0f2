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
use crate::{diagnostic::Diagnostic, forms, range::Range, suggest};
use reflet_base::math::{BLACK_BODY_K, black_body, linear_from_srgb};

/// Pattern of the texts of colors, where N is a number.
const TEXT: &str =
    "^(#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})|hs[lv]\\( *N(( *, *N%?){2}|( +N%?){2}) *\\)|N *K)$";
/// Pattern of a number in them.
const NUMBER: &str = "-?[0-9]*\\.?[0-9]+";

/// A linear color, written as three linear numbers or as a text, see [`of_text`].
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
        let text = json!({ "type": "string", "pattern": TEXT.replace('N', NUMBER) });
        json!({ "anyOf": [Vec3::schema(range), text] })
    }
    fn to_json(&self) -> Json {
        self.0.to_json()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        match node.get_ref() {
            Content::String(text) => match of_text(text) {
                Some(color) => Some(Self(color)),
                None => {
                    let key = named.key;
                    let shown = suggest::text(text);
                    let message = format!(
                        "`{key}` must be three numbers, \"#rrggbb\", \"hsl(H, S%, L%)\", \"hsv(H, S%, V%)\" or \"T K\", \
                         not {shown}"
                    );
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
                let help = of_number(node).or_else(|| list_of_number(node, "", 3));
                wrong_type(node, named.key, &Self::expected(), report).help = help;
                None
            }
        }
    }
}

/// Linear color of `#rrggbb`, `#rgb`, `hsl(H, S%, L%)`, `hsv(H, S%, V%)`, or `T K`, the glow of a black body.
pub fn of_text(text: &str) -> Option<Vec3> {
    if let Some(kelvin) = text.strip_suffix('K') {
        let kelvin = number(kelvin.trim_end_matches(' '))?;
        return BLACK_BODY_K.contains(&kelvin).then(|| black_body(kelvin));
    }
    let Some(digits) = text.strip_prefix('#') else {
        return of_hue(text);
    };
    let hex = digits.bytes().all(|b| b.is_ascii_hexdigit());
    let number = u32::from_str_radix(digits, 16).ok().filter(|_| hex)?;
    let nibble = |at: u32| (number >> at & 15) as u8 * 17;
    let byte = |at: u32| (number >> at) as u8;
    match digits.len() {
        3 => Some(linear([nibble(8), nibble(4), nibble(0)])),
        6 => Some(linear([byte(16), byte(8), byte(0)])),
        _ => None,
    }
}

/// Linear color of a hue in degrees, a saturation, and a lightness or value, as CSS and color pickers have them in sRGB.
fn of_hue(text: &str) -> Option<Vec3> {
    let (form, rest) = text.split_once('(')?;
    let rest = rest.strip_suffix(')')?.trim_matches(' ');
    let parts: Vec<&str> = match rest.contains(',') {
        true => rest.split(',').map(|part| part.trim_matches(' ')).collect(),
        false => rest.split(' ').filter(|part| !part.is_empty()).collect(),
    };
    let [hue, saturation, light] = parts.try_into().ok()?;
    let hue = number(hue)? as f32;
    let percent = |part: &str| number(part.strip_suffix('%').unwrap_or(part));
    let [saturation, light] = [percent(saturation)? as f32, percent(light)? as f32];
    let is_share = |percent| (0.0..=100.0).contains(&percent);
    if !hue.is_finite() || !is_share(saturation) || !is_share(light) {
        return None;
    }
    let [saturation, light] = [saturation / 100.0, light / 100.0];
    // Largest component, and the distance of the smallest from it.
    let (most, depth) = match form {
        "hsv" => (light, light * saturation),
        "hsl" => {
            let half = saturation * light.min(1.0 - light);
            (light + half, 2.0 * half)
        }
        _ => return None,
    };
    let component = |corner: f32| {
        let turn = (corner + hue / 60.0).rem_euclid(6.0);
        linear_from_srgb(most - depth * turn.min(4.0 - turn).clamp(0.0, 1.0))
    };
    Some(Vec3::new(component(5.0), component(3.0), component(1.0)))
}

/// A number of [`NUMBER`]: without `+`, exponent and bare point at the end.
fn number(text: &str) -> Option<f64> {
    let is_plain = text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'.' | b'-'));
    let number = text.parse().ok()?;
    (is_plain && !text.ends_with('.')).then_some(number)
}

/// Advice for the bytes of a color as one number.
fn of_number(node: &Node) -> Option<String> {
    let Content::Integer(number) = node.get_ref() else {
        return None;
    };
    if let Some(kelvin) = number.value().filter(|n| (1000..=12_000).contains(n)) {
        return Some(format!(
            "write \"{kelvin} K\", the glow at this temperature"
        ));
    }
    let bytes = number.value().filter(|n| (256..=0xff_ffff).contains(n))?;
    Some(format!("write \"#{bytes:06x}\""))
}

/// A color of CSS, also without the `#` or with `0x` in its place.
pub fn in_css(text: &str) -> Option<CssColor> {
    let digits = format!("#{}", text.trim_start_matches("0x"));
    (text.parse().ok()).or_else(|| digits.parse().ok())
}

/// Advice for a text that is not a color.
pub fn advice(text: &str) -> String {
    if let Some((_, help)) = forms::explained("color", text) {
        return help;
    }
    let kelvin = text.to_ascii_lowercase();
    let kelvin = kelvin.strip_suffix('k').and_then(|k| k.trim().parse().ok());
    if let Some(kelvin) = kelvin.filter(|k: &f64| !k.is_nan()) {
        let near = kelvin.clamp(*BLACK_BODY_K.start(), *BLACK_BODY_K.end());
        return format!("a black body has 1000 to 40000 K: write \"{near} K\"");
    }
    let value = text.replacen("hsb", "hsv", 1);
    if value != text && of_text(&value).is_some() {
        return format!("write {}", suggest::text(&value));
    }
    let is_name = text.chars().all(char::is_alphabetic) && text.parse::<CssColor>().is_ok();
    let of_numbers = text
        .chars()
        .all(|c| c.is_ascii_digit() || "., ".contains(c));
    let parts: Vec<f64> = text
        .split([',', ' '])
        .filter_map(|part| part.parse().ok())
        .collect();
    match (of_numbers, parts.as_slice()) {
        (true, [r, g, b]) if parts.iter().all(|x| *x <= 1.0) => {
            return format!("write [{r}, {g}, {b}]");
        }
        (true, [r, g, b]) if parts.iter().all(|x| *x <= 255.0) => {
            return format!(
                "write \"#{:02x}{:02x}{:02x}\"",
                *r as u8, *g as u8, *b as u8
            );
        }
        _ => {}
    }
    let Some(color) = in_css(text) else {
        return "such as \"#ff8800\", in sRGB as the web writes it, \"hsl(32, 100%, 50%)\", \"hsv(32, 100%, 100%)\", \
            \"3000 K\" (1000 to 40000), or [1, 0.25, 0] in linear light"
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
