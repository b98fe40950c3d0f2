//! Widens points and lines to a pixel of the default camera: of thinner ones, some or all pixels would show nothing.

use crate::{Mesh, World};
use reflet_base::math::Bounds;
use reflet_scene::desc::{CameraDesc, SceneDesc};

/// Diameter of points, pixels: a circle of the diagonal of a pixel holds a pixel's center wherever it is.
const POINT_PX: f32 = 1.43;
/// Diameter of lines, pixels.
const LINE_PX: f32 = 1.01;

/// Radius of the capsules of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Width {
    /// Index into the world's meshes.
    mesh: usize,
    radius_m: f32,
}

/// Radii of all meshes of capsules whose placements the camera `main` shall show at least a pixel wide; `meshes` are
/// the world's.
pub fn widths(world: &World, meshes: &[Mesh], desc: &SceneDesc) -> Vec<Width> {
    let mut widths: Vec<_> = meshes.iter().map(|mesh| mesh.least_radius_m).collect();
    let camera = &world.cameras[world.main_camera()].value;
    for instance in &world.instances {
        let mesh = &meshes[instance.mesh];
        let Some(radius_m) = mesh.capsule_radius_m else {
            continue;
        };
        let place = &instance.world_from_object;
        let scale = place.matrix3.determinant().abs().cbrt();
        // The box without the radius that it has now.
        let mut bounds = mesh.bounds;
        (bounds.min, bounds.max) = (bounds.min + radius_m, bounds.max - radius_m);
        let pixel_m = pixel_m(camera, &bounds.transformed(place), desc.image.size[1]);
        let are_points = mesh.triangles.iter().all(|[a, b, _]| a == b);
        let wide_m = 0.5 * pixel_m * if are_points { POINT_PX } else { LINE_PX } / scale;
        if wide_m.is_finite() {
            widths[instance.mesh] = widths[instance.mesh].max(wide_m);
        }
    }
    let capsules = (0..meshes.len()).filter(|i| meshes[*i].capsule_radius_m.is_some());
    let width = |mesh| Width {
        mesh,
        radius_m: widths[mesh],
    };
    capsules.map(width).collect()
}

impl Width {
    /// Whether the mesh has this radius already.
    pub fn is_of(&self, meshes: &[Mesh]) -> bool {
        meshes[self.mesh].capsule_radius_m == Some(self.radius_m)
    }

    /// Gives the mesh this radius.
    pub fn set(&self, meshes: &mut [Mesh]) {
        let mesh = &mut meshes[self.mesh];
        mesh.capsule_radius_m = Some(self.radius_m);
        mesh.bounds = mesh.bounds_at_rest();
    }
}

/// Height of a pixel at the farthest corner of a box, m; 0 behind the camera.
fn pixel_m(camera: &CameraDesc, bounds: &Bounds, height_px: u32) -> f32 {
    let forward = (camera.target - camera.eye).normalize_or_zero();
    let depths = (bounds.corners()).map(|corner| (corner - camera.eye).dot(forward));
    let depth_m = depths.fold(0.0, f32::max);
    let height_m = match camera.orthographic_height_m {
        Some(height_m) => height_m,
        None => 2.0 * depth_m * (camera.fov_deg.to_radians() * 0.5).tan(),
    };
    height_m / height_px as f32
}
