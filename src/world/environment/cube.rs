//! Panorama of a cube map.

use std::{array, f32::consts::PI};

use glam::{Quat, Vec2, Vec3};
use rayon::prelude::*;

use super::{
    Panorama,
    pixels::{BROKEN_HELP, LARGEST_KEPT, PanoramaLimits, Pixels, decoded_bytes, hold, zeros},
};
use crate::{Texture, gltf::Fault};
use reflet_base::{math::linear_from_srgb, memory::Reservation};

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
    let linear: [f32; 256] = array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0));
    let cube_from_scene = cube.rotation.inverse();
    let side = side.max().unwrap_or(1);
    let (pixels, _held) = unfolded(side, cube.intensity, limits, |direction| {
        radiance(cube.faces, cube_from_scene * direction, &linear)
    })?;
    if pixels.rgb.as_flattened().iter().any(|v| !v.is_finite()) {
        let text = "its radiance is not finite";
        return Err(Fault::new("image-values", text).help("lower its intensity"));
    }
    Ok(pixels.into_panorama(cube.name.clone()))
}

/// Makes a panorama of a cube map of OpenEXR ("Technical Introduction to OpenEXR", section on environment maps): its
/// faces +X, -X, +Y, -Y, +Z, -Z below each other, whose outer texels are centered on the edges of the cube.
///
/// # Errors
/// Pictures of another shape, and less memory than it takes.
pub(super) fn of_column(
    column: &Pixels,
    limits: &PanoramaLimits,
) -> Result<(Pixels, Reservation), Fault> {
    let side = column.width;
    if u64::from(column.height) != 6 * u64::from(side) {
        let text = format!(
            "is a cube map of {side} × {} pixels, expected six squares below each other",
            column.height
        );
        return Err(Fault::new("image-broken", text).help(BROKEN_HELP));
    }
    unfolded(side, 1.0, limits, |direction| {
        // Beside a cube map of OpenGL it is mirrored, so that its faces in -Z and +Z change places.
        let (face, place) = face(direction * Vec3::new(1.0, 1.0, -1.0));
        let face = if face < 4 { face } else { 9 - face };
        let size = Vec2::splat(side as f32);
        between(size, place * (size - 1.0), |at| {
            let row = face * side as usize + at.y as usize;
            Vec3::from(column.rgb[row * side as usize + at.x as usize])
        })
    })
}

/// Panorama of the radiance in all directions, times `intensity`, with about the resolution of a cube of `side` pixels,
/// and the memory that is held for it.
fn unfolded(
    side: u32,
    intensity: f32,
    limits: &PanoramaLimits,
    radiance: impl Fn(Vec3) -> Vec3 + Sync,
) -> Result<(Pixels, Reservation), Fault> {
    let width = side.saturating_mul(4).clamp(4, LARGEST_KEPT[0]);
    let height = width / 2;
    let held = hold(decoded_bytes([width.into(), height.into()]), limits)?;
    let mut rgb = zeros([width.into(), height.into()])?;
    // Directions across a texel, at least two on each axis.
    let across = side.saturating_mul(4).div_ceil(width).max(2);
    let rows = rgb.par_chunks_exact_mut(width as usize).enumerate();
    rows.for_each(|(y, row)| {
        for (x, texel) in row.iter_mut().enumerate() {
            let part = |at: usize, k: u32| at as f32 + (k as f32 + 0.5) / across as f32;
            let mut sum = Vec3::ZERO;
            for (i, j) in (0..across * across).map(|k| (k % across, k / across)) {
                let place = Vec2::new(part(x, i) / width as f32, part(y, j) / height as f32);
                sum += radiance(direction(place));
            }
            *texel = (sum * (intensity / (across * across) as f32)).to_array();
        }
    });
    Ok((Pixels { width, height, rgb }, held))
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
    between(size, place * size - 0.5, |at| {
        let first = 4 * (at.y as usize * face.width as usize + at.x as usize);
        let [r, g, b, a] = array::from_fn(|channel| face.rgba[first + channel]);
        let rgb = Vec3::from([r, g, b].map(|byte| linear[usize::from(byte)]));
        rgb * (255.0 / f32::from(a.max(1)))
    })
}

/// Value at a place between the four nearest texels of a picture.
fn between(size: Vec2, at: Vec2, texel: impl Fn(Vec2) -> Vec3) -> Vec3 {
    let at = at.clamp(Vec2::ZERO, size - 1.0);
    let texel = |offset: Vec2| texel((at.floor() + offset).min(size - 1.0));
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
