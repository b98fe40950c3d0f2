//! Whether a camera sees one color alone: it is inside of a surface, or close to one, whose color no light changes.

use glam::{Affine3A, Vec2, Vec3, Vec3A, Vec4};
use obvhs::{ray::Ray, triangle::Triangle};

use crate::{Material, Mesh, sight::Sight};

/// Number of rays along each axis of the picture.
const RAYS: u8 = 5;
/// Triangles that are tried for all rays of a camera together; what has more is taken to be seen.
const MOST_TRIED: usize = 1 << 24;

/// The color of a mesh with a material where it is the same everywhere and in any light: unlit, without textures,
/// colors of vertices and holes.
pub fn plain_color(material: &Material, mesh: &Mesh) -> Option<Vec4> {
    let is_plain = material.unlit
        && !material.blended
        && material.alpha_cutoff.is_none()
        && material.patterned.is_empty()
        && material.slots().iter().flatten().next().is_none()
        && mesh.colors.is_empty()
        && mesh.capsule_radius_m.is_none();
    is_plain.then(|| material.base_color + material.emission.extend(0.0))
}

/// A placed mesh, as rays of a camera meet it.
pub struct PlacedMesh<'a, T> {
    /// Corners of each triangle in object space.
    pub triangles: T,
    pub place: &'a Affine3A,
    pub double_sided: bool,
    /// Result of [`plain_color`].
    pub color: Option<Vec4>,
    /// Number of triangles.
    pub count: usize,
}

/// Whether rays through the whole picture all meet surfaces of the same plain color; false where finding out would take
/// long.
pub fn is_one_color<'a, T: Iterator<Item = [Vec3; 3]>>(
    sight: &Sight,
    met: impl Iterator<Item = PlacedMesh<'a, T>>,
) -> bool {
    let met: Vec<_> = met.collect();
    let tried: usize = met.iter().map(|met| met.count).sum();
    let has_plain = met.iter().any(|met| met.color.is_some());
    if !has_plain || tried.saturating_mul(usize::from(RAYS).pow(2)) > MOST_TRIED {
        return false;
    }
    let mut rays: Vec<(Ray, Option<Vec4>)> = (0..RAYS)
        .flat_map(|y| (0..RAYS).map(move |x| Vec2::new(x.into(), y.into())))
        .map(|at| {
            let [origin, direction] = sight.ray(at * (1.96 / f32::from(RAYS - 1)) - 0.98);
            (Ray::new_inf(origin.into(), direction.into()), None)
        })
        .collect();
    for met in met {
        let mirrors = met.place.matrix3.determinant().signum();
        for corners in met.triangles {
            let [v0, v1, v2] = corners.map(|p| Vec3A::from(met.place.transform_point3(p)));
            let triangle = Triangle { v0, v1, v2 };
            let normal = (v1 - v0).cross(v2 - v0) * mirrors;
            for (ray, color) in &mut rays {
                let is_shown = met.double_sided || normal.dot(ray.direction) < 0.0;
                let distance = triangle.intersect(ray);
                if is_shown && distance < ray.tmax {
                    (ray.tmax, *color) = (distance, met.color);
                }
            }
        }
    }
    let first = rays.first().and_then(|(_, color)| *color);
    first.is_some() && rays.iter().all(|(_, color)| *color == first)
}
