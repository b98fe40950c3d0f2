//! Shapes have one budget of work, whose end is told before memory or hours are spent.

use std::collections::HashMap;

use kurbo::PathEl;
use reflet_base::memory::Budget;
use reflet_scene::desc::ShapeDesc;

use super::{read, text::with_font};
use crate::shape::{
    MOST_WORK, Supplies,
    flatten::{MOST_CHORDS, Pen},
    make,
};

fn limited(work: u64) -> Supplies {
    Supplies {
        work: Budget::new(work),
        ..Supplies::default()
    }
}

fn sphere(segments: u32) -> ShapeDesc {
    read(&format!(
        r#"{{ kind = "sphere", radius = 1, segments = {segments} }}"#
    ))
}

#[test]
fn shapes_within_their_bounds_exceed_that_of_all() {
    let supplies = limited(MOST_WORK);
    let made = (0..100)
        .map_while(|_| make(&sphere(1024), &supplies).ok())
        .count();
    assert_eq!(made, 16);
    let fault = make(&sphere(1024), &supplies).expect_err("too many");
    assert_eq!(fault.name, "shapes-too-large");
    assert!(fault.message.contains("16,777,216"), "{}", fault.message);
}

#[test]
fn combining_parts_costs_their_triangles_each_time() {
    let combined = |kind: &str, count: u32| {
        let sphere = r#"shape = { kind = "sphere", radius = 1, segments = 16 }"#;
        let part = |i: u32| {
            format!(
                "{{ {sphere}, rotation_deg = [0, {}, 0] }}",
                57.3 * f64::from(i)
            )
        };
        let parts = (0..count).map(part).collect::<Vec<_>>().join(", ");
        read(&format!(r#"{{ kind = "{kind}", parts = [{parts}] }}"#))
    };
    let spent = |count: u32| {
        let supplies = limited(1 << 20);
        make(&combined("union", count), &supplies).expect("a union");
        (1 << 20) - supplies.work.left()
    };
    let (few, many) = (spent(2), spent(5));
    assert!(many > 4 * few, "{few} {many}");
    let fault = make(&combined("intersection", 5), &limited(many / 2));
    assert_eq!(fault.expect_err("too much").name, "shapes-too-large");
}

/// A star whose sides all cross each other, with some of its corners elsewhere.
#[test]
fn outlines_that_cross_too_often_are_refused() {
    let star = |corners: u32| {
        let corner = |i: u32| {
            let turn =
                f64::from(i) * std::f64::consts::PI * f64::from(corners - 2) / f64::from(corners);
            format!("{} {}", turn.cos(), turn.sin())
        };
        let corners = (0..corners).map(corner).collect::<Vec<_>>().join("L");
        read(&format!(
            r#"{{ kind = "extrude", depth = 1, outline = {{ path = "M{corners}Z" }} }}"#
        ))
    };
    assert!(make(&star(51), &Supplies::default()).is_ok());
    let fault = make(&star(5001), &Supplies::default()).expect_err("too many");
    assert_eq!(fault.name, "wrong-outline");
    assert!(
        fault.message.contains("1,000,000 times"),
        "{}",
        fault.message
    );
    let fault = make(&star(501), &limited(50_000)).expect_err("too much work");
    assert_eq!(fault.name, "shapes-too-large");
}

#[test]
fn each_hole_costs_the_corners_before_it() {
    let hole = |i: u8| {
        let x = 0.3 * f32::from(i) - 9.0;
        format!("[[{x}, 0], [{}, 0], [{x}, 0.1]]", x + 0.1)
    };
    let holes = (0..60).map(hole).collect::<Vec<_>>().join(", ");
    let shape = read(&format!(
        r#"{{ kind = "extrude", depth = 1, outline = {{ rect = [20, 1], holes = [{holes}] }} }}"#
    ));
    let spent = limited(1 << 20);
    make(&shape, &spent).expect("a frame");
    assert!(spent.work.left() > (1 << 20) - 10_000);
    let fault = make(&shape, &limited(3000)).expect_err("too much work");
    assert_eq!(fault.name, "shapes-too-large");
}

#[test]
fn no_more_chords_are_drawn_than_an_outline_may_have() {
    let mut pen = Pen::new(4096);
    for _ in 0..1000 {
        pen.draw(PathEl::MoveTo((0.0, 0.0).into()));
        let (x1, y1, x, y) = (1.0, 1.0, 1.0, 0.0);
        pen.draw(PathEl::QuadTo((x1, y1).into(), (x, y).into()));
    }
    assert!((MOST_CHORDS..MOST_CHORDS + 4096).contains(&pen.count));
}

/// Fonts of composite glyphs, each of which has the next one ten times, 25 deep, or five times, 3 deep; the last is empty.
#[test]
fn letters_of_letters_of_letters_are_refused() {
    let with = |bytes: &[u8]| {
        let files = HashMap::from([("a.ttf".to_owned(), bytes.to_vec())]);
        let work = Budget::default();
        let made = make(&with_font("A"), &Supplies { files, work });
        made.expect_err("no outline").message
    };
    // 10²⁵ parts, and some that are drawn and empty.
    let said = with(include_bytes!("nested_25_10.ttf"));
    assert!(said.contains("more than 1000 others"), "{said}");
    let said = with(include_bytes!("nested_3_5.ttf"));
    assert!(!said.contains("others"), "{said}");
}
