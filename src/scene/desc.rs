//! The scene as people write it: plain data, its defaults, and its manual.
//!
//! Every field's comment says meaning, unit, range and the effect of larger values; `docs/scene` and
//! `reflet schema` are generated from these comments, so this file *is* the manual. A key that has
//! no field of its own has a line `- KEY: …`, the key in code marks, in the comment of the field or the
//! type that it sets.

#[macro_use]
mod declare;

mod animation;
mod box_faces;
mod camera;
mod decal;
mod environment;
mod hierarchy;
mod image;
mod include;
mod late;
mod light;
mod light_group;
mod material;
mod motion;
mod near_far;
mod or_auto;
mod outline;
mod pattern;
mod probe;
mod project;
mod reflection;
mod scatter;
mod script;
mod shape;
mod stage;
mod track;

use std::{
    collections::{HashMap, HashSet},
    path::PathBuf,
};

use glam::{Mat4, Quat, Vec3};

pub use self::{
    animation::{AnimationDesc, Playback},
    box_faces::BoxFacesDesc,
    camera::{CAMERA, CameraDesc, CameraMotionDesc},
    decal::{DecalChanges, DecalDesc},
    environment::{EnvironmentDesc, EnvironmentShadow, FogDesc},
    hierarchy::{GroupDesc, Parents, PlacedSceneDesc, ShownDesc},
    image::{ErrorBound, Exposure, ImageDesc, Radiance, Samples, ToneMap, Visibility},
    include::Include,
    late::{LATE_SETTINGS, LateSetting},
    light::{LIGHT, LightDesc, LightKind, LightMotionDesc, ShadowMode},
    light_group::LightGroup,
    material::{
        MATERIAL, MATERIAL_FIELDS, MATERIAL_KEYS, MOST_PATTERNED, MaterialDesc, MaterialKey,
        MaterialMotionDesc, MaterialNumbers, MaterialSlot, PLAIN, PatternedDesc, PatternedKey,
        ReflectionMode, reflectivity_of,
    },
    motion::{
        CutDesc, DecalMotionDesc, GroupMotionDesc, InstanceMotionDesc, ModelMotionDesc, MotionDesc,
        TimelineDesc,
    },
    near_far::NearFarDesc,
    outline::{BevelDesc, FigureDesc, FillRule, OutlineDesc},
    pattern::{CheckerDesc, ColorPatternDesc, NumberPatternDesc, PatternDesc, PatternKind},
    probe::{Lookup, ProbeDesc, ProbesDesc, SelectBy},
    project::ProjectDesc,
    reflection::{Accept, Bounces, Marched, Method, REFLECTION, ReflectionDesc, Trace},
    scatter::{AlongDesc, OverDesc},
    script::ScriptDesc,
    shape::{FontDesc, LatheSource, NoiseDesc, PartDesc, ShapeDesc, SweepCurve, TextAlign},
    stage::{StageDesc, is_stage},
    track::{
        CurveKind, Ease, FollowDesc, KeyDesc, NumberKeyDesc, NumberOscillateDesc, NumberTrackDesc,
        OrbitDesc, OscillateDesc, PairKeyDesc, PairOscillateDesc, PairTrackDesc, ScaleKeyDesc,
        ScaleOscillateDesc, ScaleTrackDesc, ShownKeyDesc, ShownTrackDesc, TrackDesc, Tracks,
    },
};
use super::diagnostic::Span;
pub use super::table::{
    located::{At, Entry, Written},
    params::ParamValue,
};

/// Indices of entries by their names, for lists that are searched once for each of many names.
#[derive(Clone, Debug, Default)]
pub struct ByName<'a>(HashMap<&'a str, usize>);

impl<'a> ByName<'a> {
    /// Indices of named tables.
    pub fn from_entries<T>(entries: &'a [Entry<T>]) -> Self {
        Self::of_names(entries.iter().map(|entry| Some(entry.name.as_str())))
    }

    /// Indices of things of which some have a name; of two with the same name, the first counts.
    pub fn of_names(names: impl Iterator<Item = Option<&'a str>>) -> Self {
        let mut indices = HashMap::new();
        for (index, name) in names.enumerate() {
            if let Some(name) = name {
                indices.entry(name).or_insert(index);
            }
        }
        Self(indices)
    }

    /// Index of the thing with this name.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.0.get(name).copied()
    }
}

declared! {
    /// Tables may be left out, and may stand in any order.
    ///
    /// - `version`: version of the scene text; this manual describes 1.
    /// - `base`: another scene, `base = "shot010.toml"`, that this one is laid over, key by key; looked for
    ///   beside the scene, then in each `--assets` folder. Instances with the same `name` are merged; other
    ///   lists are replaced. File names in it start from this scene's folder.
    /// - `box_faces`: box and buffers of method `ssr+box`.
    /// - `near_far`: box and maps of method `near-far`.
    /// - `probes`: size, look-up and grid of the cube maps of probes.
    /// - `remove`: entries of the base to leave out, such as `remove = ["light.lamp", "instance.ball"]`; also
    ///   in a variant.
    #[derive(Clone, Debug, PartialEq, Default)]
    pub struct SceneDesc {
        /// Start of the scene's own text; the span's source is that text, without the files that it names.
        pub own: Span,
        /// Folder that relative file names start from (the scene file's own).
        pub folder: PathBuf,
        /// `[camera.NAME]`: the view points; `main`, else the first, is rendered by default.
        pub cameras: Vec<Entry<CameraDesc>>,
        /// `[material.NAME]`: materials that shapes and instances refer to by name.
        pub materials: Vec<Entry<MaterialDesc>>,
        /// `[model.NAME]`: a glTF file or a shape. A model that no instance names stands once at the origin.
        pub models: Vec<Entry<ModelDesc>>,
        /// `[[instance]]`: placements of models.
        pub instances: Vec<InstanceDesc>,
        /// `[group.NAME]`: transforms without geometry, which other entries name as their `parent`.
        pub groups: Vec<Entry<GroupDesc>>,
        /// `[light.NAME]`: lights, at most 1,048,576, with the lights of glTF files. Where there are
        /// more than 64, a few of the lights that have a place and a shadow are chosen for each point and sample, and
        /// light it with shadow rays.
        pub lights: Vec<Entry<LightDesc>>,
        /// `[decal.NAME]`: materials that are projected onto surfaces.
        pub decals: Vec<Entry<DecalDesc>>,
        /// `[environment]`: the background that rays see where they leave the scene, and the light from it.
        pub environment: EnvironmentDesc,
        /// `[reflection]`: how reflections are found.
        pub reflection: ReflectionDesc,
        /// `[probe.NAME]`: places from which cube maps are captured, for methods `probe` and `ssr+probe`.
        pub probes: Vec<Entry<ProbeDesc>>,
        /// `[image]`: size, sampling and tone of the picture.
        pub image: ImageDesc,
        /// `[timeline]`: the frames of a film. Without it the scene is one picture, at time 0.
        pub timeline: Option<TimelineDesc>,
        /// `cuts` of the timeline.
        pub cuts: Vec<CutDesc>,
        /// `[motion]`: tracks that move cameras, instances, groups, lights and materials.
        pub motion: MotionDesc,
        /// `[params]`: parameters of the script, with names of your choice.
        pub params: Vec<Entry<ParamValue>>,
        /// Parents of instances, groups, lights and cameras.
        pub parents: Parents,
        /// `[variant.NAME]`: any keys of the scene, laid over it like a scene over its base where
        /// `--variant NAME` chooses it.
        pub variants: Vec<At<String>>,
        /// `include = ["….toml"]`: files of scene text below the scene's folder or an `--assets` folder,
        /// whose tables and instances come after the scene's own. The list has bases too, in the order of reading.
        pub includes: Vec<Include>,
        /// `script = "….rhai"`: a script beside the scene that adds to it and moves it; see
        /// `docs/scripting.md`.
        pub script: Option<ScriptDesc>,
        /// Scripts of placed scenes, each file once.
        pub placed_scripts: Vec<ScriptDesc>,
        /// Parameters of each placed scene with their values there, by the group that stands for the scene.
        pub placed_params: Vec<(String, Vec<Entry<ParamValue>>)>,
        /// Names of the cameras that placed scenes define.
        pub placed_cameras: HashSet<String>,
        /// Places in the text of settings of [`LATE_SETTINGS`].
        pub late: Vec<LateSetting>,
    }

    /// `[model.NAME]`: exactly one of `file` and `shape`.
    #[derive(Clone, Debug, PartialEq)]
    pub struct ModelDesc {
        /// Source of the geometry.
        pub source: ModelSource,
        /// For shapes: the name of a `[material.NAME]`. For files: tables `[model.NAME.material.M]`,
        /// each overriding the file's material `M`, or all of them as `"*"`.
        pub material: Option<At<String>>,
        /// For files: `[model.NAME.material.M]` overrides of the file's materials by name.
        pub overrides: Vec<Entry<MaterialDesc>>,
        /// For files: whether the file's own lights are used. Default true.
        pub lights: bool,
        /// For glTF files: name of the material variant that is shown (KHR_materials_variants).
        /// Default: the file's own materials.
        pub variant: Option<At<String>>,
        /// For files: name of the animation that is played, `"*"` for all of them, or a table with further
        /// keys. Default: none.
        pub animation: Option<AnimationDesc>,
        /// For USD stages: the variants, purposes and subdivision with which the stage is converted.
        pub usd: StageDesc,
    }

    /// Source of a model's geometry.
    #[derive(Clone, Debug, PartialEq)]
    pub enum ModelSource {
        /// `file = "…"`: glTF 2.0 (`.gltf`, `.glb`) or a USD stage (`.usd`, `.usda`, `.usdc`, `.usdz`),
        /// searched beside the scene, then in each `--assets` folder.
        File(At<String>),
        /// `shape = { kind = "…", … }`: geometry made here.
        Shape(ShapeDesc),
    }
}

impl ModelDesc {
    /// Number of vertices of a mesh that scripts may deform; `None` for any other model.
    pub fn deforming_vertices(&self) -> Option<usize> {
        match &self.source {
            ModelSource::Shape(shape) => shape.deforming_vertices(),
            ModelSource::File(_) => None,
        }
    }
}

declared! {
    /// `[[instance]]`
    ///
    /// - `parent`: `name` of another instance, or of a `[group.NAME]`: the placement is then relative to
    ///   that parent, also while the parent moves. Of an instance with copies, the first copy.
    ///   Default: none.
    #[derive(Clone, Debug, PartialEq)]
    pub struct InstanceDesc {
        /// Optional name, unique; scripts and messages use it.
        pub name: Option<String>,
        /// Name of a `[model.NAME]`, or `{ scene = "….toml" }`.
        pub model: At<String>,
        /// Transform of the instance.
        pub placement: PlacementDesc,
        /// Whether it may move: it is then part of the BVH of moving instances, not of the static tree.
        /// Default false.
        pub dynamic: bool,
        /// Whether camera rays, shadows and reflections show it.
        pub shown: ShownDesc,
        /// Copies on a grid.
        pub repeat: Option<RepeatDesc>,
        /// In place of `repeat`: a table of points (`.csv`), a copy for each row, at most a million. The
        /// first line names the columns: `x`, `y`, `z`, meters; `rx_deg`, `ry_deg`, `rz_deg` or `qx`, `qy`,
        /// `qz`, `qw`; `scale` or `sx`, `sy`, `sz`. Each row transforms the instance as its own keys place it.
        /// Looked for beside the scene, then in each `--assets` folder.
        pub instances_from: Option<At<String>>,
        /// In place of `repeat`: copies along a curve.
        pub along: Option<AlongDesc>,
        /// In place of `repeat`: copies over the surface of a shape.
        pub over: Option<OverDesc>,
        /// `material = "name"` or `material = {…}`: replaces or overrides every material of this placement.
        pub material: Option<InstanceMaterialDesc>,
        /// Animation of its file that this placement plays, by name; in place of its model's `animation`.
        pub animation: Option<AnimationDesc>,
        /// Nodes of its file that scripts pose with `ctx.joint`: joints of a skin, or any other, by name. Their
        /// descendants move too.
        pub joints: Vec<At<String>>,
        /// Morph targets of its file whose weights scripts set with `ctx.morph`, by name; one without a name is
        /// called by its number, from "0".
        pub morphs: Vec<At<String>>,
        /// Place where the table starts.
        pub at: Span,
    }
}

/// `material` of an instance.
#[derive(Clone, Debug, PartialEq)]
pub enum InstanceMaterialDesc {
    /// A `[material.NAME]` used in place of the model's own.
    Named(At<String>),
    /// Keys laid over the model's own materials.
    Override(Box<MaterialDesc>),
}

declared! {
    /// Either `matrix`, or any of `translation`, `rotation_deg` / `rotation_quat`, `scale`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum PlacementDesc {
        /// Scale first, then rotate, then translate.
        Trs {
            /// Position of the model's origin, meters.
            translation: Vec3,
            /// - `rotation_deg`: degrees about X, then Y, then Z, all fixed axes.
            /// - `rotation_quat`: the same as a quaternion x, y, z, w; normalized when read.
            rotation: Quat,
            /// Scale factor of the model, one number for all axes or three; not 0. Negative mirrors.
            scale: Vec3,
        },
        /// `matrix`: 16 numbers, column by column; the last row must be 0 0 0 1.
        Matrix(Mat4),
    }

    /// `repeat = { count = [8, 1, 2], step = [3, 0, 8] }`: copies at `translation + index * step`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct RepeatDesc {
        /// Copies along X, Y and Z, each 1 to 100000, and at most 100000 together.
        pub count: [u32; 3],
        /// Distance between neighbors, meters.
        pub step: Vec3,
    }
}
