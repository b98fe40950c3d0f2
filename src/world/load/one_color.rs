//! Whether a camera sees one color alone: it is inside of a surface, or close to one, whose color no light changes.

use glam::{Affine3A, Vec2, Vec3, Vec3A, Vec4};
use obvhs::{ray::Ray, triangle::Triangle};

use crate::{Material, Mesh, bvh::capsule::Capsule, sight::Sight};
use reflet_base::math::in_f64;

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
        && !mesh.at_least_a_pixel;
    is_plain.then(|| material.base_color + material.emission.extend(0.0))
}

/// A placed mesh, as rays of a camera meet it.
pub struct PlacedMesh<'a, T> {
    /// Corners of each triangle in object space.
    pub triangles: T,
    pub place: &'a Affine3A,
    pub double_sided: bool,
    /// Exact surface, in place of the triangles.
    pub round: Option<Capsule>,
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
        if let Some(capsule) = met.round {
            let to_object = in_f64(met.place).inverse();
            for (ray, color) in &mut rays {
                let origin = to_object.transform_point3(ray.origin.as_dvec3());
                let direction = to_object.transform_vector3(ray.direction.as_dvec3());
                let span = capsule.span(origin, direction).unwrap_or([-1.0; 2]);
                let shown = if met.double_sided {
                    &span[..]
                } else {
                    &span[..1]
                };
                let distance = shown
                    .iter()
                    .find(|t| **t > 0.0)
                    .map_or(f32::MAX, |t| *t as f32);
                if distance < ray.tmax {
                    (ray.tmax, *color) = (distance, met.color);
                }
            }
            continue;
        }
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
