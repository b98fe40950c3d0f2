//! Scenes far from their origin.

use crate::kit::*;

/// A box on a mirror, at (X, 0, X).
const CONTACT: &str = include_str!("far/contact.toml");

/// Number of pixels of the box in the mirror, down to its foot, and number of pixels in its shadow.
fn shown(kilometers: &str, method: &str) -> Option<(usize, usize)> {
    let text = CONTACT.replace('X', kilometers);
    let set = format!("reflection.method={method}");
    let picture = render(gpu()?, &text, &[&set], &[Aov::HitIds, Aov::Ids]);
    let (hits, ids) = (
        integers(&picture, Aov::HitIds),
        integers(&picture, Aov::Ids),
    );
    let reflected = ids.chunks(2).zip(hits.chunks(2));
    let reflected = reflected
        .filter(|(seen, met)| seen[0] == 0 && met[0] == 1)
        .count();
    let dark = picture.display.chunks(4).filter(|p| p[1] < 40).count();
    Some((reflected, dark))
}

#[test]
fn contacts_stay_closed_far_from_the_origin() {
    for method in ["rt", "hybrid"] {
        let (reflected, dark) = or_skip!(shown("", method));
        assert!(reflected > 200, "{reflected} pixels reflect the box");
        // Spacing of floats at these distances: 0.06, 1 and 8 mm.
        for (kilometers, share) in [("100", 0.01), ("1000", 0.02), ("10000", 0.1)] {
            let (far, far_dark) = shown(kilometers, method).expect("a GPU");
            let close = |a: usize, b: usize| a.abs_diff(b) as f64 <= share * b as f64 + 4.0;
            assert!(
                close(far, reflected) && close(far_dark, dark),
                "{method}, {kilometers}0 m: {far} pixels, {far_dark} dark; at the origin {reflected}, {dark}"
            );
        }
    }
}
