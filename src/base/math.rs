//! Axis-aligned bounds, sRGB conversion and other small geometry over glam.

pub mod spline;

use std::ops::RangeInclusive;

use glam::{Affine3A, DAffine3, DMat3, DVec3, Mat3, Vec3};

/// Weights of linear red, green and blue in luminance, and of their code values in luma (ITU-R BT.709).
pub const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// An axis-aligned box; empty when `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds {
    /// Empty box, which contains no point.
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The smallest box around `points`.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self {
            min: b.min.min(p),
            max: b.max.max(p),
        })
    }

    /// Whether the box contains no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box around both boxes.
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Distance between the extreme corners; 0 when empty.
    pub fn diagonal(&self) -> f32 {
        if self.is_empty() {
            0.0
        } else {
            (self.max - self.min).length()
        }
    }

    /// Center of the box; the origin when empty.
    pub fn center(&self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            (self.min + self.max) * 0.5
        }
    }

    /// Eight corners of the box; none when empty.
    pub fn corners(self) -> impl Iterator<Item = Vec3> {
        let count = if self.is_empty() { 0 } else { 8 };
        (0..count).map(move |i| {
            Vec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The box around the eight transformed corners.
    pub fn transformed(&self, transform: &Affine3A) -> Self {
        if self.is_empty() {
            return *self;
        }
        Self::around(
            self.corners()
                .map(|corner| transform.transform_point3(corner)),
        )
    }
}

/// Temperatures of [`black_body`], kelvin: below, hardly anything glows to the eye; above, the color hardly changes. Below
/// about 1900 K the glow is redder than sRGB can show: its blue is cut to 0.
pub const BLACK_BODY_K: RangeInclusive<f64> = 1000.0..=40_000.0;

/// Linear sRGB color of the glow of a black body, its largest component 1: Planck's law, seen by the standard observer
/// of CIE 1931 in the fit of Wyman, Sloan and Shirley, JCGT 2(2), 2013, from 380 to 780 nm. Components that sRGB
/// cannot have are 0.
pub fn black_body(temperature_k: f64) -> Vec3 {
    // Height, place, and widths below and above it, nm.
    const X: [[f64; 4]; 3] = [
        [1.056, 599.8, 37.9, 31.0],
        [0.362, 442.0, 16.0, 26.7],
        [-0.065, 501.1, 20.4, 26.2],
    ];
    const Y: [[f64; 4]; 2] = [[0.821, 568.8, 46.9, 40.5], [0.286, 530.9, 16.3, 31.1]];
    const Z: [[f64; 4]; 2] = [[1.217, 437.0, 11.8, 36.0], [0.681, 459.0, 26.0, 13.8]];
    /// Second radiation constant, nm K.
    const C2: f64 = 1.438_776_877e7;
    let seen = |lobes: &[[f64; 4]], nm: f64| -> f64 {
        let lobe = |[height, at, below, above]: &[f64; 4]| {
            let width = if nm < *at { below } else { above };
            height * (-0.5 * ((nm - at) / width).powi(2)).exp()
        };
        lobes.iter().map(lobe).sum()
    };
    let mut xyz = DVec3::ZERO;
    for nm in (380..=780).step_by(5).map(f64::from) {
        let glow = nm.powi(-5) / (C2 / (nm * temperature_k)).exp_m1();
        xyz += glow * DVec3::new(seen(&X, nm), seen(&Y, nm), seen(&Z, nm));
    }
    // IEC 61966-2-1.
    let linear_from_xyz = DMat3::from_cols_array(&[
        3.2406, -0.9689, 0.0557, -1.5372, 1.8758, -0.2040, -0.4986, 0.0415, 1.0570,
    ]);
    let linear = linear_from_xyz * xyz;
    (linear / linear.max_element()).max(DVec3::ZERO).as_vec3()
}

/// Linear light of an sRGB component, both 0 to 1 (IEC 61966-2-1).
pub fn linear_from_srgb(v: f32) -> f32 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

/// sRGB component of linear light, both 0 to 1 (IEC 61966-2-1).
pub fn srgb_from_linear(v: f32) -> f32 {
    if v <= 0.003_130_8 {
        v * 12.92
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    }
}

/// The transform, converted to f64.
pub fn in_f64(transform: &Affine3A) -> DAffine3 {
    DAffine3 {
        matrix3: DMat3::from_cols(
            transform.matrix3.x_axis.as_dvec3(),
            transform.matrix3.y_axis.as_dvec3(),
            transform.matrix3.z_axis.as_dvec3(),
        ),
        translation: transform.translation.as_dvec3(),
    }
}

/// Whether rays can be brought into object space without losing all digits: the volume that the columns span must
/// not be negligible against the product of their lengths.
pub fn invertible(transform: &Affine3A) -> bool {
    const LEAST_VOLUME: f64 = 1e-7; // f32 carries about seven digits
    let linear = Mat3::from(transform.matrix3).as_dmat3();
    let lengths = linear.x_axis.length() * linear.y_axis.length() * linear.z_axis.length();
    let volume = linear.determinant().abs();
    transform.is_finite() && volume > lengths * LEAST_VOLUME && transform.inverse().is_finite()
}
