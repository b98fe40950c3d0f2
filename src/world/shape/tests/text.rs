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

/// The H of Ubuntu Light is three rectangles: its volume is theirs.
#[test]
fn a_letter_has_the_volume_of_its_strokes() {
    let solid = mesh(&left("H"));
    let xs: std::collections::BTreeSet<u32> =
        solid.positions.iter().map(|p| p.x.to_bits()).collect();
    let ys: std::collections::BTreeSet<u32> =
        solid.positions.iter().map(|p| p.y.to_bits()).collect();
    let [xs, ys] = [xs, ys].map(|all| -> Vec<f64> {
        all.into_iter()
            .map(|x| f64::from(f32::from_bits(x)))
            .collect()
    });
    assert_eq!((xs.len(), ys.len()), (4, 4), "{xs:?} {ys:?}");
    let strokes = (xs[1] - xs[0] + xs[3] - xs[2]) * (ys[3] - ys[0]);
    let bar = (xs[2] - xs[1]) * (ys[2] - ys[1]);
    let volume = area_and_volume(&solid).1;
    assert!(
        (volume / (0.25 * (strokes + bar)) - 1.0).abs() < 1e-4,
        "{volume}"
    );
}

/// The font draws "fi" as one glyph, which has no place for a space.
#[test]
fn letters_that_are_spaced_are_no_ligatures() {
    let width = |spacing: f32| {
        let spacing = format!(r#"align = "left", letter_spacing = {spacing}"#);
        mesh(&text("fi", &spacing)).bounds.max.x
    };
    assert!(width(2.0) > width(0.0) + 1.9, "{}", width(2.0));
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
fn kerning_moves_letters_together() {
    let width = |word: &str| {
        let bounds = mesh(&left(word)).bounds;
        bounds.max.x - bounds.min.x
    };
    let [apart, close] = [width("A") + width("V"), width("AV")];
    assert!(close < apart, "{close} {apart}");
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
    let own = epaint_default_fonts::UBUNTU_LIGHT;
    assert!(with(own).is_ok());
    for bytes in [&b""[..], b"wOF2....", b"not a font", &own[..200]] {
        assert_eq!(with(bytes).expect_err("no font").name, "wrong-font");
    }
    // Eight subroutines, each of which calls the next sixty times, and the last one draws nothing.
    let calls = with(include_bytes!("calls.otf")).expect_err("it does not end");
    assert!(
        calls.message.contains("call each other"),
        "{}",
        calls.message
    );
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
    let mut blank = left("a");
    if let ShapeDesc::Text { text, .. } = &mut blank {
        " \u{a0}".clone_into(text);
    }
    let blank = make(&blank, &Supplies::default()).expect_err("nothing");
    assert_eq!(blank.name, "wrong-font");
}

/// The sides of a letter are as long as its outline: faces and sides of two depths tell it.
#[test]
fn a_letter_has_the_area_of_its_faces_and_sides() {
    let deep = |depth: f32| {
        let mut letter = left("H");
        if let ShapeDesc::Text { depth: own, .. } = &mut letter {
            *own = depth;
        }
        area_and_volume(&mesh(&letter))
    };
    let ((thin, _), (thick, volume)) = (deep(0.25), deep(0.5));
    let bounds = mesh(&left("H")).bounds;
    // Three bars: around both strokes, and four times along the bar's gap.
    let height = f64::from(bounds.max.y - bounds.min.y);
    let round = (thick - thin) / 0.25;
    assert!(round > 4.0 * height && round < 4.0 * height + 4.0 * f64::from(bounds.max.x));
    assert!((thick - (2.0 * volume / 0.5 + 0.5 * round)).abs() < 1e-4 * thick);
}
