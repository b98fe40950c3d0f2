//! The scene as people write it: plain data, its defaults, and its manual.
//!
//! Every field's comment says meaning, unit, range and what more of it does; `docs/scene.md` and
//! `reflet schema` are generated from these comments, so this file *is* the manual. A key that has
//! no field of its own has a line `- KEY: …`, the key in code marks, in the comment of what it sets.

mod animation;
mod camera;
mod environment;
mod include;
mod light;
mod material;
mod motion;
mod script;
mod stage;
mod track;

use std::path::PathBuf;

use glam::{Mat4, Quat, Vec3};

pub use self::{
    animation::{AnimationDesc, Playback},
    camera::{CAMERA, CameraDesc, CameraMotionDesc},
    environment::{EnvironmentDesc, EnvironmentShadow},
    include::Include,
    light::{LIGHT, LightDesc, LightKind, LightMotionDesc, ShadowMode},
    material::{
        CheckerDesc, MATERIAL, MATERIAL_FIELDS, MaterialDesc, MaterialMotionDesc, PLAIN,
        ReflectionMode,
    },
    motion::{InstanceMotionDesc, ModelMotionDesc, MotionDesc, ParamValue, TimelineDesc},
    script::ScriptDesc,
    stage::{StageDesc, is_stage},
    track::{
        CurveKind, Ease, FollowDesc, KeyDesc, NumberKeyDesc, NumberOscillateDesc, NumberTrackDesc,
        OrbitDesc, OscillateDesc, PairKeyDesc, PairOscillateDesc, PairTrackDesc, ScaleKeyDesc,
        ScaleOscillateDesc, ScaleTrackDesc, TrackDesc, Tracks,
    },
};
use super::diagnostic::Span;

/// A named table such as `[camera.main]`, in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry<T> {
    /// The name after the dot.
    pub name: String,
    /// Where the name is written.
    pub at: Span,
    /// The table's content.
    pub value: T,
}

/// A value together with the place where it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct At<T> {
    /// The value.
    pub value: T,
    /// Where it is written.
    pub at: Span,
}

/// Tables may be left out, and may stand in any order.
///
/// - `version`: version of the scene text; this manual describes 1.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct SceneDesc {
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
    /// `[light.NAME]`: lights, at most 64 with those inside glTF files.
    pub lights: Vec<Entry<LightDesc>>,
    /// `[environment]`: what rays that leave the scene see, and the light it sheds.
    pub environment: EnvironmentDesc,
    /// `[reflection]`: how reflections are found.
    pub reflection: ReflectionDesc,
    /// `[image]`: size, sampling and tone of the picture.
    pub image: ImageDesc,
    /// `[timeline]`: the frames of a film. Without it the scene is one picture, at time 0.
    pub timeline: Option<TimelineDesc>,
    /// `[motion]`: what moves.
    pub motion: MotionDesc,
    /// `[params]`: parameters of the script, with names of your choice.
    pub params: Vec<Entry<ParamValue>>,
    /// `include = ["….toml"]`: files of scene text below the scene's folder, whose tables and instances
    /// stand behind the scene's own.
    pub includes: Vec<Include>,
    /// `script = "….rhai"`: a script beside the scene that adds to it and moves it; see
    /// `docs/scripting.md`.
    pub script: Option<ScriptDesc>,
}

/// `[model.NAME]`: exactly one of `file` and `shape`.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelDesc {
    /// Where the geometry comes from.
    pub source: ModelSource,
    /// For shapes: the name of a `[material.NAME]`. For files: tables `[model.NAME.material.M]`,
    /// each overriding the file's material `M`, or all of them as `"*"`.
    pub material: Option<At<String>>,
    /// For files: `[model.NAME.material.M]` overrides of the file's materials by name.
    pub overrides: Vec<Entry<MaterialDesc>>,
    /// For files: whether its own lights are used. Default true.
    pub lights: bool,
    /// For files: which of its animations is played, by name, `"*"` for all of them, or a table
    /// with more. Default: none.
    pub animation: Option<AnimationDesc>,
    /// For USD stages: what of the stage is converted.
    pub usd: StageDesc,
}

/// Where a model's geometry comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum ModelSource {
    /// `file = "…"`: glTF 2.0 (`.gltf`, `.glb`) or a USD stage (`.usd`, `.usda`, `.usdc`, `.usdz`),
    /// searched beside the scene, then in each `--assets` folder.
    File(At<String>),
    /// `shape = { kind = "…", … }`: geometry made here.
    Shape(ShapeDesc),
}

/// `shape = { kind = "…" }`, centered on the origin unless said; curved ones are tessellated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShapeDesc {
    /// `"plane"`: in XZ, facing +Y.
    Plane {
        /// Edge lengths along X and Z, meters, above 0. Default [1, 1].
        size: [f32; 2],
    },
    /// `"box"`
    Box {
        /// Edge lengths, meters, above 0. Default [1, 1, 1].
        size: Vec3,
    },
    /// `"sphere"`
    Sphere {
        /// Radius, meters, above 0. Default 0.5.
        radius: f32,
        /// Divisions around, 3 to 1024; half as many from pole to pole. More is rounder. Default 128.
        segments: u32,
    },
    /// `"cylinder"`: axis Y, standing on y = 0, with caps.
    Cylinder {
        /// Radius, meters, above 0. Default 0.5.
        radius: f32,
        /// Height, meters, above 0. Default 1.
        height: f32,
        /// Divisions around, 3 to 1024. Default 64.
        segments: u32,
    },
    /// `"cone"`: axis Y, standing on y = 0, with a cap below.
    Cone {
        /// Radius of the foot, meters, above 0. Default 0.5.
        radius: f32,
        /// Height, meters, above 0. Default 1.
        height: f32,
        /// Divisions around, 3 to 1024. Default 64.
        segments: u32,
    },
}

/// `[[instance]]`
#[derive(Clone, Debug, PartialEq)]
pub struct InstanceDesc {
    /// Optional name, unique; scripts and messages use it.
    pub name: Option<String>,
    /// Name of a `[model.NAME]`.
    pub model: At<String>,
    /// Where it stands.
    pub placement: PlacementDesc,
    /// Whether it may move: it then lives in the dynamic tree. Default false.
    pub dynamic: bool,
    /// Copies on a grid.
    pub repeat: Option<RepeatDesc>,
    /// `material = "name"` or `material = {…}`: replaces or overrides every material of this placement.
    pub material: Option<InstanceMaterialDesc>,
    /// Which of its file's animations this placement plays; in place of its model's `animation`.
    pub animation: Option<AnimationDesc>,
    /// Where the table starts.
    pub at: Span,
}

/// `material` of an instance.
#[derive(Clone, Debug, PartialEq)]
pub enum InstanceMaterialDesc {
    /// A `[material.NAME]` used in place of the model's own.
    Named(At<String>),
    /// Keys laid over the model's own materials.
    Override(Box<MaterialDesc>),
}

/// Either `matrix`, or any of `translation`, `rotation_deg` / `rotation_quat`, `scale`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacementDesc {
    /// Scale first, then rotate, then translate.
    Trs {
        /// Where the model's origin goes, meters.
        translation: Vec3,
        /// - `rotation_deg`: degrees about X, then Y, then Z, all fixed axes.
        /// - `rotation_quat`: the same as a quaternion x, y, z, w; normalized when read.
        rotation: Quat,
        /// Factor on the model's size, one number or three; not 0. Negative mirrors.
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

/// How reflections are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// `"ssr"`: screen space only; black where it fails.
    Ssr,
    /// `"rt"`: every reflective pixel is ray traced.
    Rt,
    /// `"hybrid"`: screen space first, ray traced where that fails.
    Hybrid,
    /// `"auto"`: `rt` or `hybrid`, whichever a cost model of the adapter's kind expects to take less
    /// time; `reflet info` and `--stats` say which and why.
    #[default]
    Auto,
}

impl Method {
    /// As scene text and tables write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ssr => "ssr",
            Self::Rt => "rt",
            Self::Hybrid => "hybrid",
            Self::Auto => "auto",
        }
    }
}

/// When a crossing on the screen counts as a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Accept {
    /// `"verified"`: the ray meets a triangle that the picture shows there, or their common plane.
    #[default]
    Verified,
    /// `"threshold"`: it is at most `threshold_u` behind the stored depth, as in the paper.
    Threshold,
}

/// `[reflection]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReflectionDesc {
    /// How reflections are found. Default `"auto"`.
    pub method: Method,
    /// Length of a reflection ray in U, above 0. More reaches further. Default 16.
    pub ray_length_u: f32,
    /// How method `hybrid` decides whether the picture shows what a mirror ray meets. Default
    /// `"verified"`; method `ssr` always takes `"threshold"`.
    pub accept: Accept,
    /// With `accept = "verified"`: how far, in pixels, the point that a ray meets may lie outside of
    /// the pixel that shows its surface, along the ray and beyond the edge of its triangle, 0 to 4.
    /// More accepts more and errs more at edges. Default 0.25.
    pub edge_px: f32,
    /// With `accept = "threshold"`, the paper's T: how far behind the stored depth a crossing still
    /// counts as a hit, in U, 0 or more. Too small gives stripes, too large prolonged reflections. Default 0.025.
    pub threshold_u: f32,
    /// Most reflections in a row, 1 to 16. Default 3.
    pub bounces: u32,
    /// Most steps of the screen-space march, 8 to 4096. More misses less and takes longer. Default 128.
    pub steps: u32,
    /// `"auto"` materials reflect below this roughness, 0 to 1; with 1 all of them do. Others show only the
    /// environment and the lights, which costs less. Default 0.2.
    pub roughness_cutoff: f32,
    /// U in meters, above 0. Default: the diagonal of the static bounding box / 16.
    pub unit_m: Option<f32>,
    /// Whether reflections fade to the environment along the ray, as in the paper. Default false.
    pub fade: bool,
    /// Standard deviation of the Gaussian blur of the combined reflection, pixels, 0 to 16: 0 is off. Default 0.
    pub blur_px: f32,
}

impl Default for ReflectionDesc {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            ray_length_u: 16.0,
            accept: Accept::Verified,
            edge_px: 0.25,
            threshold_u: 0.025,
            bounces: 3,
            steps: 128,
            roughness_cutoff: 0.2,
            unit_m: None,
            fade: false,
            blur_px: 0.0,
        }
    }
}

impl ReflectionDesc {
    /// Roughness that every `"auto"` material that reflects stays below: past 1 where all do.
    pub fn reflects_below(&self) -> f32 {
        match self.roughness_cutoff {
            cutoff if cutoff < 1.0 => cutoff,
            _ => 2.0,
        }
    }

    /// Whether the march accepts only what it can verify.
    pub fn verifies(&self) -> bool {
        self.accept == Accept::Verified && matches!(self.method, Method::Hybrid | Method::Auto)
    }
}

/// How linear radiance becomes display color.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ToneMap {
    /// `"none"`: clipped at 1.
    None,
    /// `"neutral"`: Khronos PBR Neutral, which keeps base colors.
    #[default]
    Neutral,
    /// `"aces"`: a filmic curve (Narkowicz's fit of ACES).
    Aces,
    /// `"agx"`: a filmic curve that turns bright colors pale (Sobotka's AgX, Wrensch's fit).
    Agx,
}

/// How the surface that each pixel shows is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Visibility {
    /// `"raster"`: all triangles are drawn.
    Raster,
    /// `"rays"`: a ray a pixel through the trees; cheaper in small pictures of many triangles.
    Rays,
    /// `"auto"`: the one that a cost model expects to take less time; `raster` where nothing else
    /// follows rays.
    #[default]
    Auto,
}

/// `[image]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageDesc {
    /// Width and height in pixels, each 1 to 16384. Default [1280, 720].
    pub size: [u32; 2],
    /// Sub-frames averaged per picture, 1 to 4096. More smooths edges. Default 1.
    pub samples: u32,
    /// Rays that every pixel of a sub-frame sends towards each light with a size, and towards an
    /// environment with `shadow = "ray"` or a `file`, 1 to 256. More is less grainy, and takes longer; `samples` multiplies it. Default 4 with
    /// 1 sample, 2 with 2 or 3, else 1.
    pub light_rays: Option<u32>,
    /// Exposure in stops, -20 to 20; +1 doubles the brightness. Default 0.
    pub exposure_ev: f32,
    /// How radiance becomes display color; EXR output is never tone-mapped. Default `"neutral"`.
    pub tone_map: ToneMap,
    /// How the surface that each pixel shows is found. Pictures differ only by
    /// rounding: at edges of triangles, and where surfaces lie in each other. Default `"auto"`.
    pub visibility: Visibility,
}

impl ImageDesc {
    /// Rays of a pixel and sub-frame towards each light that is sampled.
    pub fn light_rays(&self) -> u32 {
        let default = 4_u32.div_ceil(self.samples.max(1));
        self.light_rays.unwrap_or(default)
    }
}

impl Default for ImageDesc {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            samples: 1,
            light_rays: None,
            exposure_ev: 0.0,
            tone_map: ToneMap::Neutral,
            visibility: Visibility::Auto,
        }
    }
}
