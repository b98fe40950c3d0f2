//! The scene as people write it: each key once, with its manual, its range and its default, from which its reader is
//! made.
//!
//! Every field's comment says meaning, unit, range and the effect of larger values; `docs/scene` and
//! `reflet schema` are generated from these comments, so this file *is* the manual. A key that has
//! no field of its own has a line `- KEY: …`, the key in code marks, in the comment of the field or the
//! type that it sets.

#[macro_use]
mod declare;

mod animation;
mod camera;
mod decal;
mod environment;
mod hierarchy;
mod image;
mod instance;
mod light;
mod light_group;
mod material;
mod motion;
mod or_auto;
mod outline;
mod pattern;
mod placement;
mod probe;
mod project;
pub mod reflection;
mod scatter;
mod shape;
mod stage;
mod track;

use std::{
    collections::{HashMap, HashSet},
    path::PathBuf,
    sync::Arc,
};

use crate::diagnostic::{Diagnostic, Source, Span};
use reflet_base::unique_names::UniqueNames;

pub use self::{
    animation::{AnimationDesc, Playback},
    camera::{CAMERA, CameraDesc, CameraMotionDesc, MOST_CLIP_PLANES},
    decal::{DecalChanges, DecalDesc},
    environment::{ENVIRONMENT, EnvironmentDesc, EnvironmentShadow, FogDesc},
    hierarchy::{GroupDesc, Parents, PlacedSceneDesc, ShownDesc},
    image::{ErrorBound, Exposure, ImageDesc, Radiance, Samples, ToneMap, Visibility},
    instance::{InstanceDesc, InstanceMaterialDesc, RepeatDesc},
    light::{BRIGHTNESS, LIGHT, LightDesc, LightKind, LightMotionDesc, MOST_CD, ShadowMode},
    light_group::LightGroup,
    material::{
        EMISSIVE_STRENGTH, LAYER_NUMBERS, MATERIAL, MATERIAL_FIELDS, MOST_PATTERNED, MaterialDesc,
        MaterialMotionDesc, MaterialNumbers, NEEDING, Needing, PLAIN, PatternedDesc, PatternedKey,
        ReflectionMode, reflectivity_of,
    },
    motion::{
        CutDesc, DecalMotionDesc, FRAMES, GroupMotionDesc, InstanceMotionDesc, ModelMotionDesc,
        MotionDesc, TimelineDesc,
    },
    outline::{BevelDesc, FigureDesc, FileDesc, FillRule, OutlineDesc},
    pattern::{CheckerDesc, PatternDesc, PatternKind},
    placement::{PlacementDesc, turned},
    probe::{Lookup, ProbeDesc, ProbesDesc, SelectBy},
    project::ProjectDesc,
    reflection::{Accept, Bounces, LATE_SETTINGS, Method, ReflectionDesc, Trace},
    scatter::{AlongDesc, OverDesc},
    shape::{LatheSource, NoiseDesc, PartDesc, ShapeDesc, SweepCurve, TextAlign},
    stage::{MODEL_ENDINGS, PANORAMA_ENDINGS, StageDesc, is_bare, is_panorama, is_stage},
    track::{
        CurveKind, Ease, FollowDesc, KeyDesc, NumberKeyDesc, NumberOscillateDesc, NumberTrackDesc,
        OrbitDesc, OscillateDesc, PairKeyDesc, PairOscillateDesc, PairTrackDesc, ScaleKeyDesc,
        ScaleOscillateDesc, ScaleTrackDesc, ShownKeyDesc, ShownTrackDesc, TrackDesc, Tracks,
    },
};
pub use super::table::{
    located::{At, Entry, Written},
    params::ParamValue,
};

pub(crate) use self::{motion::place, track::tracks};

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
        /// `file = "…"`: glTF 2.0 (`.gltf`, `.glb`), a USD stage (`.usd`, `.usda`, `.usdc`, `.usdz`), OBJ, STL or PLY,
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

/// Place of one of [`LATE_SETTINGS`].
#[derive(Clone, Debug, PartialEq)]
pub struct LateSetting {
    /// Table and key.
    pub key: [&'static str; 2],
    /// Place of the value.
    pub at: Written,
}

/// `script = "….rhai"`, after its `setup` was run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ScriptDesc {
    /// Name of the file in messages: the scene's folder and the name in the scene.
    pub name: String,
    /// Whether the script has `fn frame(ctx)`, so that frames may differ.
    pub has_frame: bool,
    /// Name and text of the script and of each file that it imports, the script first.
    pub texts: Vec<(String, String)>,
    /// Paths of these files, with symbolic links resolved, for fingerprints and watching.
    pub files: Vec<PathBuf>,
    /// Lines that `setup` printed.
    pub setup_log: Vec<String>,
}

/// A file of scene text that another file includes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Include {
    /// Name of the file relative to the scene's folder, as `include` writes it.
    pub name: String,
    /// Path of the file, with symbolic links resolved.
    pub path: PathBuf,
    /// Text of the file, with its syntax tree.
    pub source: Arc<Source>,
}

impl SceneDesc {
    /// Scripts of the scene itself and of placed scenes.
    pub fn scripts(&self) -> impl Iterator<Item = &ScriptDesc> {
        self.script.iter().chain(&self.placed_scripts)
    }

    /// Whether any script has `fn frame(ctx)`, which poses frames.
    pub fn has_frame_script(&self) -> bool {
        self.scripts().any(|script| script.has_frame)
    }

    /// Indices of the models that no instance places, each of which is shown once, where its file or shape puts it.
    pub fn unplaced_models(&self) -> impl Iterator<Item = usize> {
        let placed: HashSet<_> = (self.instances.iter())
            .map(|i| i.model.value.as_str())
            .collect();
        (0..self.models.len()).filter(move |i| !placed.contains(self.models[*i].name.as_str()))
    }

    /// Names by which answers and lists tell the instances apart from each other and from models that no instance
    /// places: their own, else the model's with a number from the second on.
    pub fn instance_names(&self) -> Vec<String> {
        let mut taken = UniqueNames::default();
        let alone = self
            .unplaced_models()
            .map(|index| self.models[index].name.as_str());
        for name in (self.instances.iter().filter_map(|i| i.name.as_deref())).chain(alone) {
            taken.take(name);
        }
        let name_of = |i: &InstanceDesc| match &i.name {
            Some(name) => name.clone(),
            None => taken.take(&i.model.value),
        };
        self.instances.iter().map(name_of).collect()
    }

    /// Paths of the scripts, their imports and the included scene text, with symbolic links resolved.
    pub fn text_files(&self) -> Vec<PathBuf> {
        let of_script = self.scripts().flat_map(|s| &s.files).cloned();
        let included = self.includes.iter().map(|file| file.path.clone());
        of_script.chain(included).collect()
    }

    /// Place of the first of these settings that is written.
    pub fn written(&self, keys: &[[&str; 2]]) -> Option<Span> {
        let place = |key: &[&str; 2]| self.late.iter().find(|setting| setting.key == *key);
        let found = keys.iter().find_map(place);
        found.map(|setting| setting.at.0.clone())
    }

    /// Place of the first of these settings that is written, or else of the method, or else the start of the text.
    pub fn place_of(&self, keys: &[[&str; 2]]) -> Span {
        let found = self.written(keys);
        let found = found.or_else(|| self.written(&[["reflection", "method"]]));
        found.unwrap_or_else(|| self.own.clone())
    }

    /// An error of a renderer with the place of the setting that it is about, if it is about one.
    pub fn located(&self, error: Diagnostic) -> Diagnostic {
        let about = LATE_SETTINGS
            .iter()
            .filter(|(_, names)| names.contains(&error.name));
        let keys: Vec<_> = about.map(|(key, _)| *key).collect();
        match error.span.source {
            None if !keys.is_empty() => Diagnostic {
                span: self.place_of(&keys),
                ..error
            },
            _ => error,
        }
    }
}
