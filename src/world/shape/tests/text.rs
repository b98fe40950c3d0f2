//! Text is closed, stands where it says, and fonts that are none are refused.

use std::collections::HashMap;

use super::*;

fn text(text: &str, more: &str) -> ShapeDesc {
    let text = text.replace('\n', "\\n");
    read(&format!(
        "{{ kind = \"text\", text = \"{text}\", size = 1, depth = 0.25, segments = 32, {more} }}"
    ))
}

/// A text that begins at x = 0.
fn left(letters: &str) -> ShapeDesc {
    text(letters, r#"align = "left""#)
}

/// A text in the font file `a.ttf`.
pub fn with_font(letters: &str) -> ShapeDesc {
    text(letters, r#"font = "a.ttf""#)
}

#[test]
fn letters_are_closed_and_stand_on_their_line() {
    let solid = mesh(&text("Reflét & 8%", ""));
    assert_eq!(open_edges(&solid), 0);
    assert!(area_and_volume(&solid).1 > 0.1);
    assert_eq!((solid.bounds.min.z, solid.bounds.max.z), (0.0, 0.25));
    let capital = mesh(&left("H")).bounds;
    assert_eq!(capital.min.y, 0.0);
    assert!((0.6..0.8).contains(&capital.max.y), "{capital:?}");
    assert!(capital.min.x >= 0.0);
    let right = mesh(&text("H", r#"align = "right""#)).bounds;
    assert!(right.max.x <= 0.0);
    let lines = mesh(&text("H\nH", "line_height = 1.5")).bounds;
    assert!((lines.min.y + 1.5).abs() < 1e-6, "{lines:?}");
}

/// Each letter at its place is a part of the whole text, and "fi" is one letter.
#[test]
fn letters_at_their_places_are_the_text() {
    // Neither a soft hyphen nor a zero-width space is a letter.
    let whole = text("AV\u{ad} fi\n\u{200b}T", "");
    let lines = whole.lines().expect("a text");
    let font = reflet_text::Font::open(reflet_text::Font::OWN, "").expect("a font");
    let letters: Vec<_> = lines.visible_letters(&font).collect();
    let names: Vec<_> = letters.iter().map(|letter| letter.text.as_str()).collect();
    assert_eq!(names, ["A", "V", "fi", "T"]);
    let (mut bounds, mut volume) = (Bounds::EMPTY, 0.0);
    for (i, letter) in letters.iter().enumerate() {
        let own = mesh(&text("AV\u{ad} fi\n\u{200b}T", &format!("letter = {i}")));
        let [x, y] = letter.place.map(|x| x as f32);
        let moved = glam::Affine3A::from_translation(Vec3::new(x, y, 0.0));
        bounds = bounds.union(own.bounds.transformed(&moved));
        volume += area_and_volume(&own).1;
    }
    let whole = mesh(&whole);
    assert!((volume / area_and_volume(&whole).1 - 1.0).abs() < 1e-5);
    let off = (bounds.min - whole.bounds.min).abs() + (bounds.max - whole.bounds.max).abs();
    assert!(off.max_element() < 1e-5, "{bounds:?} {:?}", whole.bounds);
    // Aligned by its own width: H has as much space on its left as on its right.
    let middle = mesh(&text("AH", "letter = 1")).bounds.center().x;
    assert!(middle.abs() < 1e-5, "{middle}");
    let shape = text("AV fi\nT", "letter = 4");
    let fault = make(&shape, &supplies(&shape)).expect_err("four letters");
    assert_eq!(fault.name, "out-of-range", "{}", fault.message);
    let at = fault.at.expect("a place");
    assert_eq!(at.source.expect("a text").text[at.range], *"4");
}

/// The font draws "fi" as one glyph, which has no place for a space.
#[test]
fn letters_that_are_spaced_are_no_ligatures() {
    let width = |letters: &str, spacing: f32| {
        let spacing = format!(r#"align = "left", letter_spacing = {spacing}"#);
        mesh(&text(letters, &spacing)).bounds.max.x
    };
    let wide = width("fi", 2.0);
    assert!(wide > width("fi", 0.0) + 1.9, "{wide}");
    // A letter keeps its marks.
    assert_eq!(width("x\u{302}", 2.0), width("x\u{302}", 0.0));
}

#[test]
fn bevelled_letters_are_closed() {
    let of = |bevel: &str| mesh(&text("Reflet & GLASS 38%", bevel));
    let plain = area_and_volume(&of("")).1;
    let solid = of("bevel = 0.015");
    assert_eq!(open_edges(&solid), 0);
    let volume = area_and_volume(&solid).1;
    assert!(volume < plain && volume > 0.8 * plain, "{volume} {plain}");
}

#[test]
fn fonts_that_are_none_are_refused_and_missing_letters_told() {
    let with = |bytes: &[u8]| {
        let shape = with_font("a");
        let fonts = Supplies {
            files: HashMap::from([("a.ttf".to_owned(), bytes.to_vec())]),
            ..Supplies::default()
        };
        make(&shape, &fonts)
    };
    let own = reflet_text::Font::OWN;
    assert!(with(own).is_ok());
    for bytes in [&b""[..], b"wOF2....", b"not a font", &own[..200]] {
        let fault = with(bytes).expect_err("no font");
        let is_told = fault.name == "wrong-font" && fault.message.contains("a.ttf");
        assert!(is_told, "{fault:?}");
    }
    // Eight subroutines, each of which calls the next sixty times, and the last one draws nothing.
    let calls = with(include_bytes!("calls.otf")).expect_err("it does not end");
    assert!(calls.message.contains("call each other"), "{calls:?}");
    // Broken ones are errors or have other letters, and nothing worse.
    for cut in [2_000, 50_000, 200_000] {
        let _ = with(&own[..cut]);
        let mut broken = own.to_vec();
        broken[cut..cut + 64].fill(0xff);
        let _ = with(&broken);
    }
    // A table that says of each letter that it is as long as the font.
    let mut long = own.to_vec();
    let loca = own
        .windows(4)
        .position(|tag| tag == b"loca")
        .expect("a table");
    let start = u32::from_be_bytes(own[loca + 8..loca + 12].try_into().expect("4 bytes")) as usize;
    long[start..start + 4000].fill(0x7f);
    let _ = with(&long);
    let blank = make(&left("\u{200b}"), &Supplies::default()).expect_err("nothing");
    assert_eq!(blank.name, "wrong-font");
}
