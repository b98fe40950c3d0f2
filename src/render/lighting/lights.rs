//! Lights: the uniform block and the shadow map views.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4, camera::rh};

use reflet_base::math::Bounds;
use reflet_scene::desc::{LightKind, ShadowMode};
use reflet_world::Light;

use crate::{layout::types::GpuLight, settings::options::RenderOptions};

/// Near plane of shadow maps and maps of probes, in the renderer's lengths, of which one is so many `meters` of the
/// scene: a tenth of a millimeter also of worlds that are scaled down. Depth is reversed, so that it costs no precision.
pub fn map_near_m(meters: f32) -> f32 {
    1e-4 / meters.max(1.0)
}

/// Value of [`GpuLight::shadow`] for lights without a shadow.
pub const SHADOW_NONE: u32 = 0;
/// Value of [`GpuLight::shadow`] for shadow maps.
pub const SHADOW_MAP: u32 = 1;
/// Value of [`GpuLight::shadow`] for shadow rays.
pub const SHADOW_RAY: u32 = 2;

/// Bytes of a texel of a shadow map.
pub const TEXEL_BYTES: u64 = 4;

/// Uniform block of the lights, always of full size.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct LightBlock {
    /// Lights; unused entries are zero.
    pub lights: [GpuLight; reflet_world::MAX_LIGHTS],
}

/// One shadow map view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowView {
    /// Whether the view is a face of a cube map rather than a flat map.
    pub cube: bool,
    /// Array layer; a cube has six.
    pub layer: u32,
    /// World to clip, reversed depth.
    pub clip_from_world: Mat4,
}

/// Sizes and counts of shadow maps; constant for a set of lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShadowSizes {
    /// Width of every cube face, pixels: the maximum over point lights.
    pub cube_px: u32,
    /// Number of cube maps.
    pub cubes: u32,
    /// Width of every flat map, pixels: the maximum over spot and directional lights.
    pub map_px: u32,
    /// Number of flat maps.
    pub maps: u32,
}

impl ShadowSizes {
    /// Sizes of the shadow maps of these lights.
    pub fn for_lights(lights: &[Light], options: &RenderOptions) -> Self {
        let mut sizes = Self::default();
        let has_map = |(i, l): &(usize, &Light)| options.shadow_of(*i, l) == ShadowMode::Map;
        for (_, light) in lights.iter().enumerate().filter(has_map) {
            if has_cube_map(&light.desc.kind) {
                sizes.cubes += 1;
                sizes.cube_px = sizes.cube_px.max(light.desc.shadow_px);
            } else {
                sizes.maps += 1;
                sizes.map_px = sizes.map_px.max(light.desc.shadow_px);
            }
        }
        sizes
    }

    /// Width of a map of a light of this kind, pixels.
    pub fn px_of(&self, kind: &LightKind) -> u32 {
        match has_cube_map(kind) {
            true => self.cube_px,
            false => self.map_px,
        }
    }

    /// Size of all maps, bytes.
    pub fn bytes(&self) -> u64 {
        let of = |px: u32, layers: u32| TEXEL_BYTES * u64::from(px).pow(2) * u64::from(layers);
        of(self.cube_px, 6 * self.cubes) + of(self.map_px, self.maps)
    }
}

/// Faces of a cube map in their order, by the axis that each looks along.
pub const CUBE_FACES: [&str; 6] = ["+X", "-X", "+Y", "-Y", "+Z", "-Z"];

/// Whether a light of this kind has a cube map rather than a flat one: it shines from its position in all directions.
pub fn has_cube_map(kind: &LightKind) -> bool {
    kind.position().is_some() && kind.direction().is_none()
}

/// Features of lights that shading passes must support.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightNeeds {
    /// Whether some light has ray traced shadows.
    pub rays: bool,
    /// Whether some light without a size has ray traced shadows.
    pub hard_rays: bool,
    /// Number of lights without a size; 2: several.
    pub hard: usize,
    /// Number of lights with a size; 2: several.
    pub sized: usize,
    /// Whether some directional light has a size.
    pub sized_suns: bool,
}

impl LightNeeds {
    /// Features that these lights need.
    pub fn for_lights(lights: &[Light], options: &RenderOptions) -> Self {
        let is_sized = |light: &Light| light.desc.kind.has_size();
        let by_rays = |(i, l): &(usize, &Light)| options.shadow_of(*i, l) == ShadowMode::Ray;
        let mut by_rays = lights.iter().enumerate().filter(by_rays).peekable();
        let (_, hard) = in_order(lights);
        Self {
            rays: by_rays.peek().is_some(),
            hard_rays: by_rays.any(|(_, light)| !is_sized(light)),
            hard: hard.min(2),
            sized: (lights.len() - hard).min(2),
            sized_suns: lights
                .iter()
                .any(|l| is_sized(l) && matches!(l.desc.kind, LightKind::Directional { .. })),
        }
    }

    /// Whether passes built for these features support `other` ones.
    pub fn cover(self, other: Self) -> bool {
        (self.rays || !other.rays)
            && (self.hard_rays || !other.hard_rays)
            && self.hard >= other.hard
            && self.sized >= other.sized
            && (self.sized_suns || !other.sized_suns)
    }
}

/// Whether some light has ray traced shadows.
pub fn has_shadow_rays(lights: &[Light], options: &RenderOptions) -> bool {
    LightNeeds::for_lights(lights, options).rays
}

/// Lights with their indices in the order of shaders: lights without a size first, and their number.
pub fn in_order(lights: &[Light]) -> (impl Iterator<Item = (usize, &Light)>, usize) {
    let lights = lights.iter().enumerate();
    let (sized, hard): (Vec<_>, Vec<_>) = lights.partition(|(_, l)| l.desc.kind.has_size());
    let count = hard.len();
    (hard.into_iter().chain(sized), count)
}

/// Uniform block of the lights, lights without a size first, and the shadow views of one frame. `bounds` must contain
/// all shadow casters; `near_m` comes from [`map_near_m`].
pub fn lights(
    lights: &[Light],
    sizes: ShadowSizes,
    bounds: &Bounds,
    near_m: f32,
    options: &RenderOptions,
) -> (LightBlock, Vec<ShadowView>) {
    let mut block = LightBlock::zeroed();
    let mut views = Vec::new();
    let (mut cubes, mut maps) = (0, 0);
    for ((index, light), out) in in_order(lights).0.zip(&mut block.lights) {
        let shadow = options.shadow_of(index, light);
        *out = gpu_light(light, shadow);
        if shadow != ShadowMode::Map {
            continue;
        }
        if has_cube_map(&light.desc.kind) {
            out.layer = cubes;
            out.texel = 2.0 / sizes.cube_px as f32;
            let faces = cube_faces(light.desc.kind.position().unwrap_or_default(), near_m);
            out.clip_from_world = faces[0].to_cols_array_2d(); // of which shaders need the near plane
            views.extend(
                faces
                    .into_iter()
                    .zip(6 * cubes..)
                    .map(|(clip, layer)| ShadowView {
                        cube: true,
                        layer,
                        clip_from_world: clip,
                    }),
            );
            cubes += 1;
        } else {
            let (clip, texel) = flat_view(&light.desc.kind, sizes.map_px, bounds, near_m);
            out.layer = maps;
            out.texel = texel;
            out.clip_from_world = clip.to_cols_array_2d();
            views.push(ShadowView {
                cube: false,
                layer: maps,
                clip_from_world: clip,
            });
            maps += 1;
        }
    }
    (block, views)
}

pub(crate) fn gpu_light(light: &Light, shadow: ShadowMode) -> GpuLight {
    let kind = &light.desc.kind;
    let mut out = GpuLight::zeroed();
    out.position = kind.position().unwrap_or_default().to_array();
    let direction = kind.direction().unwrap_or_default();
    let direction = direction.normalize_or(Vec3::NEG_Y);
    out.direction = direction.to_array();
    out.extent = match *kind {
        LightKind::Directional { angle_deg, .. } => (0.5 * angle_deg).to_radians(),
        _ if kind.is_flat() => 0.0,
        _ => kind.radius_m(),
    };
    [out.spot_scale, out.spot_offset] = kind.cone_falloff().unwrap_or_default();
    let halves = kind.edges().unwrap_or_default().map(|edge| 0.5 * edge);
    [out.half_u, out.half_v] = halves.map(|half| half.to_array());
    out.kind = kind.index() as u32;
    out.color = (light.desc.color * kind.intensity()).to_array();
    out.range_m = light.range_m.unwrap_or(0.0);
    out.reflected = light.desc.in_reflections.into();
    out.shadow = match shadow {
        ShadowMode::None => SHADOW_NONE,
        ShadowMode::Default | ShadowMode::Map | ShadowMode::Auto => SHADOW_MAP,
        ShadowMode::Ray => SHADOW_RAY,
    };
    out
}

/// Clip matrix of a frustum with these axes: x to the right, y up, depth near / distance along `forward`.
fn frustum(position: Vec3, near_m: f32, [forward, right, up]: [Vec3; 3]) -> Mat4 {
    let row = |axis: Vec3| axis.extend(-axis.dot(position));
    Mat4::from_cols(row(right), row(up), Vec4::W * near_m, row(forward)).transpose()
}

/// Clip matrices of the six faces in the order and orientation of cube maps (Vulkan 1.3, "Cube Map Face Selection").
fn cube_faces(position: Vec3, near_m: f32) -> [Mat4; 6] {
    const X: Vec3 = Vec3::X;
    const Y: Vec3 = Vec3::Y;
    const Z: Vec3 = Vec3::Z;
    [
        [X, -Z, Y],
        [-X, Z, Y],
        [Y, X, -Z],
        [-Y, X, Z],
        [Z, X, Y],
        [-Z, -X, Y],
    ]
    .map(|axes| frustum(position, near_m, axes))
}

/// Clip matrix of a spot or directional light, and the world size of a texel (at distance 1 for spots), m.
pub(crate) fn flat_view(kind: &LightKind, px: u32, bounds: &Bounds, near_m: f32) -> (Mat4, f32) {
    match *kind {
        LightKind::Spot {
            position,
            direction,
            outer_deg,
            ..
        } => {
            let half = (outer_deg + 1.0).min(89.0).to_radians();
            let forward = direction.normalize_or(Vec3::NEG_Y);
            let projection =
                rh::proj::directx::perspective_infinite_reverse(2.0 * half, 1.0, near_m);
            let view = rh::view::look_to_mat4(position, forward, forward.any_orthonormal_vector());
            (projection * view, 2.0 * half.tan() / px as f32)
        }
        LightKind::Directional { direction, .. } => {
            parallel_view(direction.normalize_or(Vec3::NEG_Y), px, bounds)
        }
        LightKind::Point { .. } | LightKind::Rect { .. } | LightKind::Disk { .. } => {
            (Mat4::IDENTITY, 0.0)
        }
    }
}

/// World size of a texel of a light's shadow map, `px` wide, at a point, m; `bounds` contain all casters.
pub fn map_texel_m(kind: &LightKind, px: u32, bounds: &Bounds, point: Vec3) -> f32 {
    match *kind {
        _ if has_cube_map(kind) => {
            let offset = point - kind.position().unwrap_or_default();
            2.0 / px as f32 * offset.abs().max_element()
        }
        LightKind::Spot {
            position,
            direction,
            ..
        } => {
            let (_, texel) = flat_view(kind, px, bounds, map_near_m(1.0));
            texel
                * (point - position)
                    .dot(direction.normalize_or(Vec3::NEG_Y))
                    .max(0.0)
        }
        _ => flat_view(kind, px, bounds, map_near_m(1.0)).1,
    }
}

/// Orthographic view along `forward` that holds all of `bounds`, with a margin of two texels on each side.
fn parallel_view(forward: Vec3, px: u32, bounds: &Bounds) -> (Mat4, f32) {
    let right = forward.any_orthonormal_vector();
    let up = right.cross(forward);
    let axes = glam::Mat3::from_cols(right, up, forward).transpose();
    let extents = bounds.transformed(&glam::Affine3A::from_mat3(axes));
    let (center, extent) = (
        extents.center(),
        (extents.max - extents.min).max(Vec3::splat(1e-3)),
    );
    let edge = extent.x.max(extent.y) * (1.0 + 4.0 / px as f32);
    let row = |axis: Vec3, scale: f32, offset: f32| (axis * scale).extend(offset);
    let clip = Mat4::from_cols(
        row(right, 2.0 / edge, -2.0 * center.x / edge),
        row(up, 2.0 / edge, -2.0 * center.y / edge),
        row(
            forward,
            -1.0 / extent.z,
            1.0 + (center.z - 0.5 * extent.z) / extent.z,
        ),
        Vec4::W,
    )
    .transpose();
    (clip, edge / px as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_serve_lights_that_ask_for_less() {
        let all = LightNeeds {
            rays: true,
            hard_rays: true,
            hard: 2,
            sized: 2,
            sized_suns: true,
        };
        let less = [
            LightNeeds { rays: false, ..all },
            LightNeeds {
                hard_rays: false,
                ..all
            },
            LightNeeds { hard: 1, ..all },
            LightNeeds { sized: 1, ..all },
            LightNeeds {
                sized_suns: false,
                ..all
            },
        ];
        for less in less {
            assert!(all.cover(less));
            assert!(!less.cover(all));
        }
        assert!(all.cover(all));
    }
}
