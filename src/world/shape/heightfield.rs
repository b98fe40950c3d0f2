//! Height fields: meshes with a vertex for each pixel of an image, whose brightness is the height.

use glam::{Vec2, Vec3};
use image::ImageReader;

use crate::{
    Mesh,
    texture::{Watched, largest_frame_bytes},
};
use reflet_base::{guard, math::Bounds};

/// Maximum width and height of the image, pixels.
pub const MOST_PX: u32 = 2048;
/// Most bytes that are taken for a pixel while it is decoded and becomes a height: coefficients of JPEG in four
/// components, or 16 bits of four channels and their conversions.
const WORKING_BYTES_PER_PIXEL: u64 = 40;

/// Upper bound of the memory for decoding an image, bytes.
pub fn working_bytes(bytes: &[u8]) -> u64 {
    let pixels = u64::from(MOST_PX).pow(2);
    pixels * WORKING_BYTES_PER_PIXEL + largest_frame_bytes(bytes)
}

/// Brightness of each pixel, 0 to 1, top row first.
pub struct Heights {
    /// Pixels across, 2 or more.
    pub width: u32,
    /// Pixels down, 2 or more.
    pub height: u32,
    /// Brightness values, `width * height` of them.
    pub values: Vec<f32>,
}

impl Heights {
    /// Decodes an image, of 8 or 16 bits a channel, linear.
    ///
    /// # Errors
    /// A sentence that says what is wrong with the image.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        let decoded = guard::catch(|| Self::decode_unguarded(bytes));
        decoded.unwrap_or_else(|| Err("the image decoder panicked; please report this".to_owned()))
    }

    fn decode_unguarded(bytes: &[u8]) -> Result<Self, String> {
        let reader = || {
            let reader = ImageReader::new(Watched::new(bytes)).with_guessed_format();
            reader.map_err(|error| error.to_string())
        };
        let size = reader()?
            .into_dimensions()
            .map_err(|error| error.to_string())?;
        let (width, height) = size;
        if width.max(height) > MOST_PX || width.min(height) < 2 {
            return Err(format!(
                "a height field must have 2 to {MOST_PX} pixels on each side, not {width} x {height}"
            ));
        }
        let image = reader()?.decode().map_err(|error| error.to_string())?;
        let gray = image.to_luma16();
        let values = gray.into_raw().into_iter();
        Ok(Self {
            width,
            height,
            values: values.map(|value| f32::from(value) / 65535.0).collect(),
        })
    }

    fn height(&self, x: u32, y: u32) -> f32 {
        self.values[(y * self.width + x) as usize]
    }
}

/// The mesh, centered at the origin in X and Z, with the top row of the image towards -Z; black is at height 0.
pub fn mesh(heights: &Heights, size: Vec3) -> Mesh {
    let (width, height) = (heights.width, heights.height);
    let step = Vec2::new(size.x / (width - 1) as f32, size.z / (height - 1) as f32);
    let mut mesh = Mesh {
        name: "heightfield".to_owned(),
        ..Mesh::default()
    };
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let uv = Vec2::new(
            x as f32 / (width - 1) as f32,
            y as f32 / (height - 1) as f32,
        );
        let [left, right] = [x.saturating_sub(1), (x + 1).min(width - 1)];
        let [up, down] = [y.saturating_sub(1), (y + 1).min(height - 1)];
        let rise = |high: f32, low: f32, cells: u32, cell: f32| {
            (high - low) * size.y / (cells as f32 * cell)
        };
        let slope_x = rise(
            heights.height(right, y),
            heights.height(left, y),
            right - left,
            step.x,
        );
        let slope_z = rise(
            heights.height(x, down),
            heights.height(x, up),
            down - up,
            step.y,
        );
        mesh.positions.push(Vec3::new(
            (uv.x - 0.5) * size.x,
            heights.height(x, y) * size.y,
            (uv.y - 0.5) * size.z,
        ));
        mesh.normals
            .push(Vec3::new(-slope_x, 1.0, -slope_z).normalize());
        mesh.uv0.push(uv);
    }
    for (y, x) in (0..height - 1).flat_map(|y| (0..width - 1).map(move |x| (y, x))) {
        let (a, b) = (y * width + x, (y + 1) * width + x);
        mesh.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
    }
    mesh.bounds = Bounds::around(mesh.positions.iter().copied());
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(width: u32, height: u32, values: &[u16]) -> Vec<u8> {
        let image =
            image::ImageBuffer::<image::Luma<u16>, _>::from_raw(width, height, values.to_vec());
        let mut bytes = std::io::Cursor::new(Vec::new());
        let image = image::DynamicImage::from(image.expect("as many as pixels"));
        image
            .write_to(&mut bytes, image::ImageFormat::Png)
            .expect("it can be encoded");
        bytes.into_inner()
    }

    #[test]
    fn a_slope_has_its_height_and_its_normal() {
        let bytes = png(3, 2, &[0, 32768, 65535, 0, 32768, 65535]);
        let heights = Heights::decode(&bytes).unwrap_or_else(|e| panic!("{e}"));
        let mesh = mesh(&heights, Vec3::new(2.0, 2.0, 6.0));
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (6, 4));
        assert_eq!(mesh.positions[0], Vec3::new(-1.0, 0.0, -3.0));
        assert!(mesh.positions[5].distance(Vec3::new(1.0, 2.0, 3.0)) < 1e-6);
        let want = Vec3::new(-1.0, 1.0, 0.0).normalize();
        assert!(
            mesh.normals.iter().all(|n| n.distance(want) < 1e-4),
            "{:?}",
            mesh.normals
        );
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            assert!((b - a).cross(c - a).dot(want) > 0.0);
        }
    }

    #[test]
    fn images_that_cannot_be_one_are_named() {
        let Err(small) = Heights::decode(&png(1, 2, &[0, 0])) else {
            panic!("it has one column");
        };
        assert!(
            small.contains("2 to 2048 pixels on each side, not 1 x 2"),
            "{small}"
        );
        assert!(Heights::decode(b"no image").is_err());
    }
}
