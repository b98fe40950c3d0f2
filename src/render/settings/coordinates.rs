//! Moves worlds far from their origin close to it, relative to the camera, and scales small and large ones, so that
//! floats are precise and no length is too short for the shaders.
//!
//! Offsets that keep rays off the surface they start from grow with the coordinates, as rounding errors do. A
//! renderer therefore works in coordinates of its own, chosen when it was made, and converts each world and camera that
//! it is given.

use std::{borrow::Cow, ops::RangeInclusive};

use glam::{DVec3, Vec3};

use reflet_base::math::Bounds;
use reflet_scene::desc::{CameraDesc, LightKind};
use reflet_world::{Environment, World};

use super::options::RenderOptions;

/// Grid width of origins, m: scenes near their origin are not moved at all, and moving others rounds as little as
/// possible.
const GRID_M: f32 = 128.0;
/// Units U of scenes that are not scaled, m.
const USUAL_UNITS_M: RangeInclusive<f32> = 0.0625..=4096.0;

/// Coordinates of a renderer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinates {
    /// Origin in the scene, m.
    origin: Vec3,
    /// Length of a meter: a power of two, so that scaling rounds nothing.
    scale: f32,
}

impl Coordinates {
    /// Best coordinates for a renderer: the origin is a grid point near the eye of the options' camera.
    pub fn for_view(world: &World, options: &RenderOptions) -> Self {
        let camera = options.camera.unwrap_or_else(|| world.main_camera());
        let unit_m = world.unit_m();
        let eye = world.cameras.get(camera).map_or(Vec3::ZERO, |c| {
            approached(&c.value, &world.bounds(), unit_m).0.eye
        });
        let scale = match USUAL_UNITS_M.contains(&unit_m) {
            true => 1.0,
            false => (-unit_m.log2().round()).clamp(-64.0, 64.0).exp2(),
        };
        let grid_m = GRID_M / scale;
        let origin = (eye / grid_m).round() * grid_m;
        Self {
            origin: if origin.is_finite() {
                origin
            } else {
                Vec3::ZERO
            },
            scale,
        }
    }

    /// Meters of the scene in a length of one.
    pub fn meters(&self) -> f32 {
        1.0 / self.scale
    }

    /// A world in these coordinates.
    pub fn world<'a>(&self, world: &'a World) -> Cow<'a, World> {
        if self.origin == Vec3::ZERO && self.scale == 1.0 {
            return Cow::Borrowed(world);
        }
        let mut moved = world.clone();
        for instance in &mut moved.instances {
            let place = &mut instance.world_from_object;
            place.translation = (place.translation - glam::Vec3A::from(self.origin)) * self.scale;
            place.matrix3 *= self.scale;
        }
        for light in moved.lights.iter_mut().chain(&mut moved.lamps) {
            self.move_light(&mut light.desc.kind);
            light.range_m = light.range_m.map(|range_m| range_m * self.scale);
        }
        for decal in &mut moved.decals.list {
            let place = &mut decal.world_from_decal;
            place.translation = (place.translation - glam::Vec3A::from(self.origin)) * self.scale;
            place.matrix3 *= self.scale;
        }
        for camera in &mut moved.cameras {
            camera.value = self.camera(&camera.value);
        }
        self.move_fog(&mut moved.environment);
        for probe in moved.probes.iter_mut().map(|entry| &mut entry.value) {
            let corners = [&mut probe.box_min, &mut probe.box_max];
            let proxy = [&mut probe.proxy_min, &mut probe.proxy_max];
            for corner in corners.into_iter().chain(proxy).flatten() {
                *corner = (*corner - self.origin) * self.scale;
            }
            probe.position = (probe.position - self.origin) * self.scale;
        }
        for material in &mut moved.materials {
            material.attenuation_distance_m =
                material.attenuation_distance_m.map(|m| m * self.scale);
        }
        moved.rest_unit_m = moved.rest_unit_m.map(|unit_m| unit_m * self.scale);
        Cow::Owned(moved)
    }

    fn move_fog(&self, environment: &mut Environment) {
        if let Some(fog) = &mut environment.desc.fog {
            fog.density /= self.scale;
            fog.height_m = (fog.height_m - self.origin.y) * self.scale;
            fog.falloff_m = fog.falloff_m.map(|m| m * self.scale);
        }
        let corners = &mut environment.fog_box;
        corners.min = (corners.min - self.origin) * self.scale;
        corners.max = (corners.max - self.origin) * self.scale;
    }

    fn move_light(&self, kind: &mut LightKind) {
        if let Some(position) = kind.position_mut() {
            *position = (*position - self.origin) * self.scale;
        }
        kind.scale(self.scale);
    }

    /// A camera in these coordinates.
    pub fn camera(&self, camera: &CameraDesc) -> CameraDesc {
        let scaled = |length_m: Option<f32>| length_m.map(|m| m * self.scale);
        // The default is a length of the scene; in small scenes it is a part of U, which is scaled with them.
        let is_large = self.scale < 1.0;
        let nearest = || is_large.then(|| camera.near_in(f32::INFINITY));
        CameraDesc {
            eye: (camera.eye - self.origin) * self.scale,
            target: (camera.target - self.origin) * self.scale,
            orthographic_height_m: scaled(camera.orthographic_height_m),
            near_m: scaled(camera.near_m.or_else(nearest)),
            focus_m: scaled(camera.focus_m),
            // The sensor keeps its size, so a wider opening makes the lens as much larger.
            aperture_f: camera.aperture_f.map(|f| f / self.scale),
            clip_planes: (camera.clip_planes.iter())
                .map(|&[a, b, c, d]| {
                    [
                        a,
                        b,
                        c,
                        (d + Vec3::new(a, b, c).dot(self.origin)) * self.scale,
                    ]
                })
                .collect(),
            ..camera.clone()
        }
    }

    /// A camera in these coordinates that looks at things within `drawn` of a scene of unit `unit`, both in these
    /// coordinates, and how much nearer it is to them, m.
    pub fn view(&self, camera: &CameraDesc, drawn: &Bounds, unit: f32) -> (CameraDesc, f32) {
        let (camera, nearer) = approached(&self.camera(camera), drawn, unit);
        (camera, nearer * self.meters())
    }

    /// Options in these coordinates.
    pub fn options(&self, options: &RenderOptions) -> RenderOptions {
        let mut options = *options;
        let (lengths, points) = options.reflection.lengths_and_points();
        for length_m in lengths.into_iter().flatten() {
            *length_m *= self.scale;
        }
        for point in points.into_iter().flatten() {
            *point = (*point - self.origin) * self.scale;
        }
        options
    }
}

/// An orthographic camera moved along its view to just before what it may see, and the way: it shows the same, and
/// distances are short, where floats are precise. Others stay where they are.
fn approached(camera: &CameraDesc, seen: &Bounds, unit_m: f32) -> (CameraDesc, f32) {
    let (eye, target) = (camera.eye.as_dvec3(), camera.target.as_dvec3());
    let forward = (target - eye).normalize_or_zero();
    if camera.orthographic_height_m.is_none() || seen.is_empty() || forward == DVec3::ZERO {
        return (camera.clone(), 0.0);
    }
    let depths = seen
        .corners()
        .map(|corner| (corner.as_dvec3() - eye).dot(forward));
    let least = depths.fold(f64::INFINITY, f64::min);
    let size = f64::from(seen.diagonal());
    let way = least - f64::from(camera.near_in(unit_m)) - 0.01 * size;
    if !(way > 0.0 && way.is_finite()) {
        return (camera.clone(), 0.0);
    }
    let eye = eye + forward * way;
    let near = CameraDesc {
        eye: eye.as_vec3(),
        target: (eye + forward * size.max(f64::MIN_POSITIVE)).as_vec3(),
        ..camera.clone()
    };
    (near, way as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_near_plane_is_as_far_in_scenes_of_any_scale() {
        let camera = CameraDesc::default();
        for unit_m in [1.0 / 32.0, 0.1, 1.0, 4096.0, 8192.0, f32::exp2(40.0)] {
            let scale = if USUAL_UNITS_M.contains(&unit_m) {
                1.0
            } else {
                1.0 / unit_m
            };
            let origin = Vec3::ZERO;
            let coordinates = Coordinates { origin, scale };
            let near_m = coordinates.camera(&camera).near_in(unit_m * scale) * coordinates.meters();
            assert_eq!(near_m, camera.near_in(unit_m), "{unit_m}");
        }
    }
}
