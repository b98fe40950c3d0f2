//! Loaded scenes: SceneDesc → CPU data, including asset files and BVHs, without a GPU.
//!
//! This crate owns the readers of untrusted files ([`gltf`], [`texture`], [`environment`], [`usd`] by its converter),
//! [`load`], which turns a scene into a [`World`], its pose at a frame ([`pose`], [`rig`], [`deform`]), and the trees
//! with the ray casts that judge the GPU's ([`bvh`]).

use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{Arc, OnceLock},
};

use glam::{Affine3A, Vec2, Vec3, Vec4};

use reflet_base::{math::Bounds, memory::Budget};
use reflet_scene::{
    desc::{CameraDesc, Entry, LightDesc, ProbeDesc, SceneDesc, ShownDesc},
    diagnostic::{Diagnostic, Span},
};

pub mod animation;
pub mod bvh;
mod closed;
pub mod contact;
mod corner_tangents;
mod curvature;
mod decals;
pub mod deform;
pub mod emitters;
pub mod environment;
pub mod gltf;
mod lamps;
mod left_out;
mod light_groups;
pub mod light_tree;
pub mod load;
mod material;
mod material_textures;
mod normal_uv;
mod pointed;
pub mod pose;
pub mod reach;
pub mod rig;
pub mod shape;
mod shared;
pub mod sight;
mod solid_around;
pub mod texture;
pub mod usd;

pub use curvature::Curvature;
pub use decals::{Decal, DecalMask, Decals};
pub use environment::Environment;
pub use material::{ListedModel, ListedNames, Material};
pub use material_textures::{
    CORE_SLOTS, CoreTexture, FILE_TEXTURES, FileTexture, LAYER_SLOTS, LayerTexture, TEXTURE_SLOTS,
};
pub use shared::Shared;
pub use solid_around::solid_around;

use deform::{Deformation, Deformed};

/// A loaded scene: geometry in object space, placed by instances.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// Unique geometry, which instances place.
    pub meshes: Shared<Mesh>,
    /// Materials; instances refer to them by index.
    pub materials: Vec<Material>,
    /// Decoded images; materials refer to them by index.
    pub textures: Shared<Texture>,
    /// Placements of meshes.
    pub instances: Vec<Instance>,
    /// Index of the `[[instance]]` in the scene text of each instance, if it has one.
    pub written: Vec<Option<usize>>,
    /// Index of the `[model.NAME]` in the scene text that each instance places.
    pub placed_models: Vec<usize>,
    /// The scene's and the files' lights, at most [`MAX_LIGHTS`]; where there are more, some are [`Self::lamps`]
    /// instead.
    pub lights: Vec<Light>,
    /// Lights of which light trees choose, at most
    /// [`SceneDesc::MOST_LIGHTS`](reflet_scene::desc::SceneDesc::MOST_LIGHTS).
    pub lamps: Vec<Light>,
    /// Index of each light into `lights`, then `lamps`; empty if light i has index i.
    pub light_order: Vec<usize>,
    /// Origins of the lights of files, which are the last lights.
    pub file_lights: Vec<FileLight>,
    /// The scene's and the files' cameras; never empty.
    pub cameras: Vec<Entry<CameraDesc>>,
    /// The scene's probes.
    pub probes: Vec<Entry<ProbeDesc>>,
    /// The scene's decals, and which instances may show them.
    pub decals: Decals,
    /// Environment: radiance of rays that leave the scene, and light from all directions.
    pub environment: Environment,
    /// The animations of all files.
    pub animations: Vec<animation::Listed>,
    /// Contents of the models' files.
    pub models: Vec<ListedModel>,
    /// Named warnings collected while loading.
    pub warnings: Vec<Diagnostic>,
    /// Every file that was read, for fingerprints and watching.
    pub files: Vec<PathBuf>,
    /// Animated parts.
    pub moving: pose::Moving,
    /// Current pose of the meshes that animations deform, by index into `meshes`.
    pub deformed: BTreeMap<usize, Arc<Deformed>>,
    /// The unit U at load, meters, kept because poses would change it in scenes without static geometry. `None`
    /// computes it from the current bounds.
    pub rest_unit_m: Option<f32>,
    /// Memory budget that loading left for trees.
    pub memory: Budget,
    /// Lights and decals that the view leaves out.
    pub left_out: left_out::LeftOut,
}

/// Size of the static part of a scene, relative to all of it, below which the unit U counts what moves too.
const SMALL_STILL: f32 = 0.25;

/// Maximum number of lights that are not chosen by a light tree; their uniform block stays far below 64 KiB.
pub const MAX_LIGHTS: usize = 64;

/// Triangles or capsules with per-vertex attributes; all attribute arrays are as long as `positions`.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Name for messages: model, node and primitive.
    pub name: String,
    /// Positions in object space, meters, finite.
    pub positions: Vec<Vec3>,
    /// Normals of unit length; for capsules the shading normals, or empty for round shading.
    pub normals: Vec<Vec3>,
    /// Tangents: xyz of unit length, w = ±1 handedness; empty where no normal map needs them.
    pub tangents: Vec<Vec4>,
    /// First texture coordinates, glTF convention (v down); zeros where the file has none, or empty for capsules.
    pub uv0: Vec<Vec2>,
    /// Second texture coordinates; empty where the material needs none.
    pub uv1: Vec<Vec2>,
    /// Linear vertex color; empty where the file has none.
    pub colors: Vec<Vec4>,
    /// Vertex indices, each below `positions.len()`; counter-clockwise is the front.
    pub triangles: Vec<[u32; 3]>,
    /// Radius in object space, m, of capsules: each of `triangles` is then `[a, b, b]` and stands for all points within
    /// this radius of the segment from vertex `a` to vertex `b`, a sphere where `a` is `b`.
    pub capsule_radius_m: Option<f32>,
    /// Whether capsules are drawn at least a pixel wide, as points and lines of files are.
    pub at_least_a_pixel: bool,
    /// Capsule that takes the place of the triangles where no material needs these; kept when it has taken it.
    pub round: Option<Round>,
    /// Object-space bounds.
    pub bounds: Bounds,
    /// Deformation by animations; the vertices here are at rest, and the world holds their pose.
    pub deformation: Option<Arc<Deformation>>,
    /// Cached result of [`Mesh::is_closed_outward`].
    pub closed: OnceLock<bool>,
    /// Cached result of [`Mesh::curvature`].
    pub curvature: OnceLock<Curvature>,
}

/// The exact surface of a mesh that is a sphere or a capsule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// Ends of the segment, in object space; equal for a sphere.
    pub ends: [Vec3; 2],
    /// Radius in object space, m.
    pub radius_m: f32,
}

/// The attributes of a mesh that depend on its pose.
#[derive(Clone, Copy, Debug)]
pub struct Posed<'a> {
    /// Posed [`Mesh::positions`].
    pub positions: &'a [Vec3],
    /// Posed [`Mesh::normals`].
    pub normals: &'a [Vec3],
    /// Posed [`Mesh::tangents`].
    pub tangents: &'a [Vec4],
    /// Posed [`Mesh::uv0`]; empty where they do not move.
    pub uv0: &'a [Vec2],
    /// Posed [`Mesh::colors`]; empty where they do not move.
    pub colors: &'a [Vec4],
    /// Bounds of the positions.
    pub bounds: Bounds,
}

impl Posed<'_> {
    /// Corners of a triangle.
    pub fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|i| self.positions[i as usize])
    }
}

impl Mesh {
    /// Memory of the vertices and triangles, bytes.
    pub fn bytes(&self) -> u64 {
        let streams = [
            size_of_val(self.positions.as_slice()),
            size_of_val(self.normals.as_slice()),
            size_of_val(self.tangents.as_slice()),
            size_of_val(self.uv0.as_slice()),
            size_of_val(self.uv1.as_slice()),
            size_of_val(self.colors.as_slice()),
            size_of_val(self.triangles.as_slice()),
        ];
        streams.into_iter().sum::<usize>() as u64
    }

    /// Replaces the triangles with a capsule.
    pub fn make_round(&mut self, round: Round) {
        *self = Self {
            name: std::mem::take(&mut self.name),
            positions: round.ends.to_vec(),
            triangles: vec![if round.ends[0] == round.ends[1] {
                [0; 3]
            } else {
                [0, 1, 1]
            }],
            capsule_radius_m: Some(round.radius_m),
            round: Some(round),
            ..Self::default()
        };
        self.bounds = self.bounds_at_rest();
    }

    /// Greatest distance of a placed capsule's surface from its segment, meters; `None` for triangles.
    pub fn placed_radius_m(&self, place: &Affine3A) -> Option<f32> {
        let columns = [place.x_axis, place.y_axis, place.z_axis].map(|c| c.length());
        let scale = columns.into_iter().fold(0.0, f32::max);
        self.capsule_radius_m.map(|radius_m| radius_m * scale)
    }

    /// Bounds of the positions, with the radius of capsules.
    pub fn bounds_at_rest(&self) -> Bounds {
        let bounds = Bounds::around(self.positions.iter().copied());
        let radius_m = self.capsule_radius_m.unwrap_or(0.0);
        Bounds {
            min: bounds.min - radius_m,
            max: bounds.max + radius_m,
        }
    }

    /// The vertices at rest.
    pub fn at_rest(&self) -> Posed<'_> {
        Posed {
            positions: &self.positions,
            normals: &self.normals,
            tangents: &self.tangents,
            uv0: &[],
            colors: &[],
            bounds: self.bounds,
        }
    }
}

/// A mesh placed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Name in the scene text, or of the file's node, for messages and scripts.
    pub name: String,
    /// Index into [`World::meshes`].
    pub mesh: usize,
    /// Index into [`World::materials`].
    pub material: usize,
    /// Object to world, finite; may mirror. Singular ones are dropped at load with a warning, but
    /// for [`Instance::HIDDEN`].
    pub world_from_object: Affine3A,
    /// Whether the instance may move or is deformed; then it is traced through the top level.
    pub dynamic: bool,
    /// Visibility to rays of the camera, shadows and reflections.
    pub shown: ShownDesc,
}

impl Instance {
    /// Transform of a hidden instance: no ray hits it and no draw shows it.
    pub const HIDDEN: Affine3A = Affine3A::ZERO;

    /// Whether the instance is hidden in the current pose.
    pub fn is_hidden(&self) -> bool {
        self.world_from_object.matrix3 == Self::HIDDEN.matrix3
    }
}

/// A material's reference to a texture, and how it is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into [`World::textures`].
    pub texture: usize,
    /// Index of the set of texture coordinates, 0 or 1.
    pub uv_set: u32,
    /// KHR_texture_transform as rows of a 2×3 matrix: u' = r0·(u, v, 1), v' = r1·(u, v, 1).
    pub transform: [Vec3; 2],
    /// Wrap modes along u and v.
    pub wrap: [Wrap; 2],
    /// Whether magnification picks the nearest texel.
    pub nearest: bool,
}

impl TextureRef {
    /// Matrix rows of KHR_texture_transform. The extension's printed rotation matrix turns the other way than its
    /// reference pictures and every viewer; see KhronosGroup/glTF#1563.
    pub fn rows(offset: Vec2, rotation: f32, scale: Vec2) -> [Vec3; 2] {
        let (s, c) = rotation.sin_cos();
        [
            Vec3::new(c * scale.x, s * scale.y, offset.x),
            Vec3::new(-s * scale.x, c * scale.y, offset.y),
        ]
    }
}

/// glTF's wrap modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Wrap {
    /// glTF's `REPEAT`.
    #[default]
    Repeat,
    /// glTF's `CLAMP_TO_EDGE`.
    Clamp,
    /// glTF's `MIRRORED_REPEAT`.
    Mirror,
}

/// A decoded image: RGBA, 8 bits a channel, top row first, with the coarser levels that its file states.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Name of the image's file or data URI, for messages.
    pub name: String,
    /// Pixels across, 1 to 16384.
    pub width: u32,
    /// Pixels down, 1 to 16384.
    pub height: u32,
    /// `width * height * 4` bytes, then as many for each stated level, every level half as wide and high as the last,
    /// rounded down, at least 1.
    pub rgba: Vec<u8>,
    /// Whether the bytes are sRGB-encoded (color) or linear (data). An image used as both is stored twice.
    pub srgb: bool,
}

impl Texture {
    /// Width and height in pixels, and RGBA, of the image and of each level that its file states.
    pub fn levels(&self) -> impl Iterator<Item = ([u32; 2], &[u8])> {
        let mut rest = &self.rgba[..];
        (0..u32::BITS).map_while(move |k| {
            let size = [self.width, self.height].map(|side| (side >> k).max(1));
            let level = rest.split_off(..4 * size[0] as usize * size[1] as usize)?;
            Some((size, level))
        })
    }

    /// Alpha of the texel nearest to a point, 0 to 1 from the left and from the top.
    pub fn alpha(&self, u: f32, v: f32) -> f32 {
        let place =
            |part: f32, side: u32| ((part * side as f32) as u32).min(side.saturating_sub(1));
        let texel =
            place(v, self.height) as usize * self.width as usize + place(u, self.width) as usize;
        self.rgba
            .get(4 * texel + 3)
            .map_or(1.0, |a| f32::from(*a) / 255.0)
    }
}

/// Placement of the file that a light is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileLight {
    /// Index of the `[[instance]]` in the scene text, if it has one.
    pub written: Option<usize>,
    /// Index of the `[model.NAME]` in the scene text.
    pub model: usize,
}

/// A light in world space.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name from scene text or file.
    pub name: String,
    /// Description of the light, as in scene text.
    pub desc: LightDesc,
    /// Distance at which a file's light ends (KHR_lights_punctual `range`), meters; `None` is endless.
    pub range_m: Option<f32>,
    /// Whether the description may be another one in other frames.
    pub moves: bool,
}

impl World {
    /// Place in the scene's text of the table that places an instance, else of its `[model.NAME]`.
    pub fn place_of<'d>(&self, desc: &'d SceneDesc, instance: usize) -> Option<&'d Span> {
        let written = self.written.get(instance).copied().flatten();
        let written = written.and_then(|index| desc.instances.get(index));
        let model = || desc.models.get(*self.placed_models.get(instance)?);
        (written.map(|written| &written.at)).or_else(|| Some(&model()?.at))
    }

    /// Index of the camera that is taken where none is chosen: `main`, else the first.
    pub fn main_camera(&self) -> usize {
        let mut cameras = self.cameras.iter();
        cameras
            .position(|camera| camera.name == "main")
            .unwrap_or(0)
    }

    /// The vertices of a mesh in its current pose.
    pub fn posed(&self, mesh: usize) -> Posed<'_> {
        match self.deformed.get(&mesh) {
            Some(deformed) => deformed.posed(),
            None => self.meshes[mesh].at_rest(),
        }
    }

    /// World-space bounds of an instance; empty when it is hidden.
    pub fn bounds_of(&self, instance: &Instance) -> Bounds {
        if instance.is_hidden() {
            return Bounds::EMPTY;
        }
        let bounds = self.posed(instance.mesh).bounds;
        bounds.transformed(&instance.world_from_object)
    }

    /// Bounds of all static instances in world space, or of everything when nothing is static.
    pub fn static_bounds(&self) -> Bounds {
        let of = |want_static: bool| {
            let mut bounds = Bounds::EMPTY;
            for i in self.instances.iter().filter(|i| !want_static || !i.dynamic) {
                bounds = bounds.union(self.bounds_of(i));
            }
            bounds
        };
        let bounds = of(true);
        if bounds.is_empty() { of(false) } else { bounds }
    }

    /// Bounds of all instances in world space.
    pub fn bounds(&self) -> Bounds {
        let boxes = self.instances.iter().map(|i| self.bounds_of(i));
        boxes.fold(Bounds::EMPTY, |all, one| all.union(one))
    }

    /// Box that fog without a falloff fills: around all instances, lamps and cameras.
    pub fn fog_box(&self) -> Bounds {
        let lamps = self.all_lights().filter_map(|l| l.desc.kind.position());
        let eyes = self.cameras.iter().map(|camera| camera.value.eye);
        self.bounds().union(Bounds::around(lamps.chain(eyes)))
    }

    /// The unit U in meters: the diagonal of the static bounds / 16, or of all where the static ones are small beside
    /// that; 1 for an empty scene.
    pub fn unit_m(&self) -> f32 {
        if let Some(unit_m) = self.rest_unit_m {
            return unit_m;
        }
        let (still, all) = (self.static_bounds().diagonal(), self.bounds().diagonal());
        let diagonal = if still < SMALL_STILL * all {
            all
        } else {
            still
        };
        if diagonal > 0.0 { diagonal / 16.0 } else { 1.0 }
    }
}
