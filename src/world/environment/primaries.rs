//! Conversion of colors of a file's primaries to the primaries of ITU-R BT.709, which the renderer has.

use glam::{DMat3, DVec2, DVec3};

/// CIE xy chromaticities of red, green, blue and white.
pub(super) type Chromaticities = [DVec2; 4];

/// ITU-R BT.709-6, item 1.3 and 1.4.
pub(super) const BT709: Chromaticities = [
    DVec2::new(0.64, 0.33),
    DVec2::new(0.30, 0.60),
    DVec2::new(0.15, 0.06),
    DVec2::new(0.3127, 0.3290),
];
/// Largest difference of chromaticities that are the same.
const SAME: f64 = 1e-3;

/// Matrix from colors of some chromaticities to colors of BT.709, white to white (Bradford's chromatic adaptation, as
/// in ICC.1:2022, annex E); `None` where they are the same. Colors whose primaries are X, Y and Z are tristimulus
/// values, which are not adapted.
///
/// # Errors
/// Chromaticities that span no colors, as words.
pub(super) fn to_bt709(from: Chromaticities) -> Result<Option<DMat3>, &'static str> {
    let is_same = |(a, b): (DVec2, DVec2)| a.abs_diff_eq(b, SAME);
    if from.into_iter().zip(BT709).all(is_same) {
        return Ok(None);
    }
    let bt709_from_xyz = xyz_from(BT709).inverse();
    if from[..3] == [DVec2::X, DVec2::Y, DVec2::ZERO] {
        return Ok(Some(bt709_from_xyz));
    }
    let matrix = bt709_from_xyz * adaptation(from[3], BT709[3]) * xyz_from(from);
    match matrix.is_finite() {
        true => Ok(Some(matrix)),
        false => Err("its chromaticities span no colors"),
    }
}

/// Luminances of red, green and blue of some chromaticities, of which to_bt709 found colors; their sum is 1.
pub(super) fn luminance(of: Chromaticities) -> DVec3 {
    xyz_from(of).row(1)
}

/// XYZ of a chromaticity with a luminance of 1.
fn xyz(at: DVec2) -> DVec3 {
    DVec3::new(at.x, at.y, 1.0 - at.x - at.y) / at.y
}

/// Matrix from colors of some chromaticities to XYZ; white has a luminance of 1 (SMPTE RP 177).
fn xyz_from([red, green, blue, white]: Chromaticities) -> DMat3 {
    let of_unit_sum = |at: DVec2| DVec3::new(at.x, at.y, 1.0 - at.x - at.y);
    let primaries = DMat3::from_cols(of_unit_sum(red), of_unit_sum(green), of_unit_sum(blue));
    primaries * DMat3::from_diagonal(primaries.inverse() * xyz(white))
}

/// Bradford's adaptation of XYZ from one white to another.
fn adaptation(from: DVec2, to: DVec2) -> DMat3 {
    let cone_from_xyz = DMat3::from_cols(
        DVec3::new(0.8951, -0.7502, 0.0389),
        DVec3::new(0.2664, 1.7135, -0.0685),
        DVec3::new(-0.1614, 0.0367, 1.0296),
    );
    let gains = cone_from_xyz * xyz(to) / (cone_from_xyz * xyz(from));
    cone_from_xyz.inverse() * DMat3::from_diagonal(gains) * cone_from_xyz
}

#[cfg(test)]
mod tests {
    use super::*;

    fn converted(from: [[f64; 2]; 4], color: [f64; 3]) -> [f64; 3] {
        let matrix = to_bt709(from.map(DVec2::from)).unwrap();
        (matrix.unwrap_or(DMat3::IDENTITY) * DVec3::from(color)).to_array()
    }

    fn assert_near(found: [f64; 3], expected: [f64; 3]) {
        let is_near = DVec3::from(found).abs_diff_eq(expected.into(), 2e-3);
        assert!(is_near, "{found:?}, expected {expected:?}");
    }

    /// Against the matrices that are published: ACES AP0 by the Academy's CTL, BT.2020 by ITU-R BT.2087, XYZ by IEC
    /// 61966-2-1.
    #[test]
    fn colors_are_converted_as_published() {
        let ap0 = [
            [0.7347, 0.2653],
            [0.0, 1.0],
            [0.0001, -0.077],
            [0.32168, 0.33767],
        ];
        assert_near(converted(ap0, [1.0, 0.0, 0.0]), [2.5217, -0.2765, -0.0154]);
        assert_near(converted(ap0, [1.0; 3]), [1.0; 3]);
        let bt2020 = [
            [0.708, 0.292],
            [0.17, 0.797],
            [0.131, 0.046],
            [0.3127, 0.329],
        ];
        assert_near(
            converted(bt2020, [0.0, 1.0, 0.0]),
            [-0.5876, 1.1329, -0.1006],
        );
        let xyz = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]];
        assert_near(converted(xyz, [0.9505, 1.0, 1.089]), [1.0; 3]);
        let rounded = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];
        assert_near(converted(rounded, [1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn chromaticities_that_span_nothing_are_errors() {
        for bad in [[[0.0; 2]; 4], [[0.3, 0.3]; 4]] {
            assert!(to_bt709(bad.map(DVec2::from)).is_err(), "{bad:?}");
        }
    }
}
