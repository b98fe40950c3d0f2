//! Panorama of a cube map.

use std::{array, f32::consts::PI};

use glam::{Quat, Vec2, Vec3};
use rayon::prelude::*;

use super::{
    Panorama,
    pixels::{LARGEST_KEPT, PanoramaLimits, Pixels, decoded_bytes, hold, zeros},
    read::panorama,
};
use crate::{Texture, gltf::Fault};
use reflet_base::math::linear_from_srgb;

/// A cube map as files have it.
#[derive(Debug)]
pub struct CubeMap<'a> {
    /// Name for messages.
    pub name: String,
    /// The six faces in the order +X, -X, +Y, -Y, +Z, -Z, sRGB-encoded and divided by alpha (RGBD). Rows and columns
    /// follow the table of cube map faces in the specifications of OpenGL and Vulkan, the first row at t = 0.
    pub faces: &'a [Texture],
    /// Rotation from the space of the cube map to the scene.
    pub rotation: Quat,
    /// Factor on its radiance, 0 or more.
    pub intensity: f32,
}

/// Makes a panorama of about the resolution of the cube map.
///
/// # Errors
/// Less memory than it takes, or radiance that exceeds 32-bit floats.
pub fn of_cube(cube: &CubeMap<'_>, limits: &PanoramaLimits) -> Result<Panorama, Fault> {
    let side = cube.faces.iter().map(|face| face.width.max(face.height));
    let side = side.max().unwrap_or(1);
    let width = (4 * side).clamp(4, LARGEST_KEPT[0]);
    let height = width / 2;
    let _held = hold(decoded_bytes([width.into(), height.into()]), limits)?;
    let mut rgb = zeros([width.into(), height.into()])?;
    let linear: [f32; 256] = array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0));
    let cube_from_scene = cube.rotation.inverse();
    // Directions across a texel, at least two on each axis.
    let across = (4 * side).div_ceil(width).max(2);
    let rows = rgb.par_chunks_exact_mut(width as usize).enumerate();
    rows.for_each(|(y, row)| {
        for (x, texel) in row.iter_mut().enumerate() {
            let part = |at: usize, k: u32| at as f32 + (k as f32 + 0.5) / across as f32;
            let mut sum = Vec3::ZERO;
            for (i, j) in (0..across * across).map(|k| (k % across, k / across)) {
                let place = Vec2::new(part(x, i) / width as f32, part(y, j) / height as f32);
                sum += radiance(cube.faces, cube_from_scene * direction(place), &linear);
            }
            *texel = (sum * (cube.intensity / (across * across) as f32)).to_array();
        }
    });
    panorama(cube.name.clone(), Pixels { width, height, rgb })
}

/// Direction of a place in a panorama, 0 to 1 across and down.
fn direction(place: Vec2) -> Vec3 {
    let (longitude, colatitude) = ((0.5 - place.x) * 2.0 * PI, place.y * PI);
    let (sin, cos) = colatitude.sin_cos();
    Vec3::new(sin * longitude.sin(), cos, sin * longitude.cos())
}

/// Face that a direction meets, and the place in it, 0 to 1 across and down.
fn face(direction: Vec3) -> (usize, Vec2) {
    let axis = direction.abs().max_position();
    let Vec3 { x, y, z } = direction;
    let is_negative = direction[axis] < 0.0;
    let sign = if is_negative { -1.0 } else { 1.0 };
    let (s, t) = match axis {
        0 => (-z * sign, -y),
        1 => (x, z * sign),
        _ => (x * sign, -y),
    };
    let place = Vec2::new(s, t) / direction[axis].abs() * 0.5 + 0.5;
    (2 * axis + usize::from(is_negative), place)
}

/// Radiance in a direction, between the four nearest texels of its face.
fn radiance(faces: &[Texture], direction: Vec3, linear: &[f32; 256]) -> Vec3 {
    let (face, place) = face(direction);
    let face = &faces[face];
    let size = Vec2::new(face.width as f32, face.height as f32);
    let at = (place * size - 0.5).clamp(Vec2::ZERO, size - 1.0);
    let texel = |offset: Vec2| {
        let at = (at.floor() + offset).min(size - 1.0);
        let first = 4 * (at.y as usize * face.width as usize + at.x as usize);
        let [r, g, b, a] = array::from_fn(|channel| face.rgba[first + channel]);
        let rgb = Vec3::from([r, g, b].map(|byte| linear[usize::from(byte)]));
        rgb * (255.0 / f32::from(a.max(1)))
    };
    let between = at - at.floor();
    let upper = texel(Vec2::ZERO).lerp(texel(Vec2::X), between.x);
    let lower = texel(Vec2::Y).lerp(texel(Vec2::ONE), between.x);
    upper.lerp(lower, between.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of the faces by the table of OpenGL 4.6, 8.13: the direction of the middle of a face, and where s grows.
    #[test]
    fn faces_are_those_of_the_specification() {
        let table = [
            (Vec3::X, Vec3::NEG_Z, Vec3::NEG_Y),
            (Vec3::NEG_X, Vec3::Z, Vec3::NEG_Y),
            (Vec3::Y, Vec3::X, Vec3::Z),
            (Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z),
            (Vec3::Z, Vec3::X, Vec3::NEG_Y),
            (Vec3::NEG_Z, Vec3::NEG_X, Vec3::NEG_Y),
        ];
        for (index, (middle, s, t)) in table.into_iter().enumerate() {
            let (found, place) = face((middle + 0.5 * s - 0.25 * t) * 3.0);
            assert_eq!(found, index);
            assert!(place.abs_diff_eq(Vec2::new(0.75, 0.375), 1e-6), "{place}");
        }
    }
}
