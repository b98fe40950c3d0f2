//! Texture coordinates of normal maps, on which tangents depend.

use glam::{Mat2, Vec2};

use super::TextureRef;

/// Coordinates that a normal map is sampled with, as far as tangents depend on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalUv {
    /// Index of the set of texture coordinates, 0 or 1.
    pub uv_set: u32,
    /// Linear part of KHR_texture_transform. Without a rotation it holds the signs of the scales alone, since the size
    /// of a scale does not turn a normal.
    pub turn: Mat2,
}

impl NormalUv {
    /// The first set of texture coordinates, untransformed.
    pub const PLAIN: Self = Self {
        uv_set: 0,
        turn: Mat2::IDENTITY,
    };

    /// Coordinates of a material's normal map.
    pub fn from_map(map: &TextureRef) -> Self {
        let [u, v] = map.transform.map(|row| row.truncate());
        let turn = if u.y == 0.0 && v.x == 0.0 {
            Mat2::from_diagonal(Vec2::new(u.x, v.y).map(f32::signum))
        } else {
            Mat2::from_cols(u, v).transpose()
        };
        Self {
            uv_set: map.uv_set,
            turn,
        }
    }
}
