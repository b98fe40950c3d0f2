//! Answers about a scene, as JSON; the comments of the fields are the descriptions of their schema.

use schemars::{JsonSchema, Schema, schema_for};
use serde::Serialize;

/// JSON Schema of [`Answer`], draft 2020-12.
pub fn schema() -> Schema {
    schema_for!(Answer)
}

/// Facts about a scene and its picture at a frame, by rays on the processor. Numbers are rounded to five digits; lists are
/// bounded, and `left_out` counts the entries that are not listed.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Answer {
    /// Path of the scene file, or the name of the built-in atrium.
    pub scene: String,
    /// Frame of the timeline that is asked about; 0 without one.
    pub frame: u32,
    /// Name of the camera.
    pub camera: String,
    /// Rows of the matrix from the world to the camera: x to the right, y up, z against the view, m.
    pub view_from_world: [[f32; 4]; 4],
    /// Rows of the matrix from the camera to clip space, whose x and y over w are -1 to 1 in the picture, to the right and
    /// up; z over w is 1 at the near plane and less behind it.
    pub clip_from_view: [[f32; 4]; 4],
    /// Width and height of the picture, pixels.
    pub picture_px: [u32; 2],
    /// Columns and rows of the grid of rays through the picture, to which shares and boxes are exact.
    pub rays: [u32; 2],
    /// Share of the picture that shows no surface.
    pub background: f64,
    /// Least and greatest corner of all things over all posed frames, m.
    pub bounds_m: Option<[[f64; 3]; 2]>,
    /// Number of frames that were posed for bounds over the motion, spread over the timeline.
    pub posed_frames: u32,
    /// Things that were asked about; else all, by their share of the picture.
    pub things: Vec<Thing>,
    /// Names of the things that no camera has in its picture at this frame, hidden or not.
    pub outside: Vec<String>,
    /// Pixels that were asked about.
    pub pixels: Vec<Pixel>,
    /// Direct light on the surfaces in the picture, brightest first.
    pub lit_by: Vec<LightShare>,
    /// The cameras.
    pub cameras: Vec<Named>,
    /// The lights of the scene and its files.
    pub lights: Vec<Named>,
    /// Names that the scene and its models' files offer to choose from.
    #[serde(flatten)]
    pub choices: Choices,
    /// Entries that are not listed, a sentence for each kind.
    pub left_out: Vec<String>,
}

/// An instance of the scene text with its copies and the parts of its file, or a part that was asked about.
#[derive(Clone, Debug, Default, Serialize, JsonSchema)]
pub struct Thing {
    /// Name of the instance, else of its model.
    pub name: String,
    /// Place of its table in the text, `file:line:column`.
    pub place: Option<String>,
    /// Name of the `[model.NAME]`.
    pub model: String,
    /// Names of its materials.
    pub materials: Vec<String>,
    /// Whether its instance changes them by a table of its own.
    pub changes_material: bool,
    /// Number of its parts and copies.
    pub parts: usize,
    /// Number of its triangles and capsules.
    pub triangles: usize,
    /// Least and greatest corner at this frame, m, whether the thing is visible or not; none if it has no surface or is
    /// scaled to 0.
    pub bounds_m: Option<[[f64; 3]; 2]>,
    /// Width, height and depth of these bounds, m.
    pub size_m: Option<[f64; 3]>,
    /// Bounds over all posed frames, m, of a thing that moves.
    pub motion_bounds_m: Option<[[f64; 3]; 2]>,
    /// Share of the picture that shows it, directly or through transparent surfaces.
    pub share: f64,
    /// Whether the picture shows any of it; with a share of 0 it shows between the rays of the grid.
    pub visible: bool,
    /// Left, upper, right and lower edge of its visible part, pixels.
    pub box_px: Option<[f64; 4]>,
    /// Distance from the camera to its nearest visible point, m.
    pub distance_m: Option<f64>,
    /// Reason why the picture shows none of it.
    pub unseen: Option<UnseenFor>,
    /// Share of its surface in the picture that other things hide.
    pub hidden: f64,
    /// Things that hide it, each with its part of that share.
    pub hidden_by: Vec<Share>,
    /// Names of the cameras in whose picture it is, hidden or not.
    pub in_pictures_of: Vec<String>,
    /// Things that it touches or cuts through, deepest first.
    pub contacts: Vec<Contact>,
    /// Direct light on its surface, brightest first; only of things that were asked about by name.
    pub lit_by: Vec<LightShare>,
}

/// Reason why a picture shows none of a thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum UnseenFor {
    /// It is not visible to cameras, scaled to 0, or has no surface.
    SwitchedOff,
    /// It is behind the camera, or beside its picture.
    Outside,
    /// It is nearer than the near plane.
    TooNear,
    /// It is behind a clip plane of the camera.
    CutAway,
    /// Its alpha is 0, or below the cut-off.
    Transparent,
    /// The camera sees only backs of its single-sided surfaces.
    Backs,
    /// It is smaller than a pixel.
    Small,
    /// Other things, or its own parts, are before it.
    Hidden,
}

/// Share of a light in the light on surfaces, from 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LightShare {
    /// Kind of the light.
    pub kind: LightKind,
    /// Name of the lamp or of the thing; `environment` for the light from all around.
    pub name: String,
    /// The share.
    pub share: f64,
}

/// Kind of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LightKind {
    /// A light of the scene or of its files.
    Lamp,
    /// A thing whose material lights.
    Thing,
    /// The environment.
    Environment,
}

/// Name of a thing with a share, from 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Share {
    /// The name.
    pub name: String,
    /// The share.
    pub share: f64,
}

/// A thing that another one touches or cuts through.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Contact {
    /// Name of the other thing.
    pub with: String,
    /// Whether it cuts through it; else they only touch.
    pub cuts: bool,
    /// Least distance by which one must be moved straight out of the other through a face that they cross, m: until it is
    /// beyond the outside of that face of a solid, or beyond either side of an open surface. Where no faces cross because
    /// the two solids are aligned: the least along the normals of their faces and the axes until their extents are apart.
    pub depth_m: f64,
    /// A point of the contact, m.
    pub at_m: [f64; 3],
}

/// A pixel of the picture.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Pixel {
    /// Column and row, from the upper left corner.
    pub at: [u32; 2],
    /// Surfaces at its middle from the front to the first that lets no light through; none for the background.
    pub surfaces: Vec<Surface>,
    /// Direct light on the first surface, brightest first.
    pub lit_by: Vec<LightShare>,
}

/// A surface behind a pixel.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Surface {
    /// Name of the thing.
    pub thing: String,
    /// Place of the thing's table in the text, `file:line:column`.
    pub place: Option<String>,
    /// Name of the copy, or of the part of the file, with its number of the triangle.
    pub part: String,
    /// Index of the triangle or capsule in the part.
    pub triangle: u32,
    /// Name of the material.
    pub material: String,
    /// Whether the instance changes it by a table of its own.
    pub changes_material: bool,
    /// Place of the table in the text that has, or changes, the material; none for a material of a file that the text does
    /// not change.
    pub material_place: Option<String>,
    /// Names of the decals that cover it there, the topmost first.
    pub decals: Vec<String>,
    /// Distance from the camera, m.
    pub distance_m: f64,
    /// The point, m.
    pub at_m: [f64; 3],
    /// Unit normal towards the camera.
    pub normal: [f64; 3],
}

/// A camera or a light.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Named {
    /// Its name.
    pub name: String,
    /// Kind of light; none for a camera.
    pub kind: Option<String>,
    /// Place of its table in the text; none if it is of a file.
    pub place: Option<String>,
    /// Position at this frame, m; none for light without a place.
    pub at_m: Option<[f64; 3]>,
    /// Point at which a camera looks, m.
    pub target_m: Option<[f64; 3]>,
}

/// Names that a scene and its models' files offer to choose from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Choices {
    /// Models that are read from files.
    pub models: Vec<ModelContents>,
    /// Names of the scene's variants.
    pub scene_variants: Vec<String>,
    /// Parameters of the scene's script.
    pub parameters: Vec<Parameter>,
    /// First frame, last frame and frames a second; none without a timeline.
    pub timeline: Option<Timeline>,
    /// Cuts of the timeline, each with the camera shown from its frame on.
    pub cuts: Vec<Cut>,
}

/// Contents of a model's file, by the names that scene text uses.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ModelContents {
    /// Name of the `[model.NAME]`.
    pub name: String,
    /// The file.
    pub file: String,
    /// Names of its materials.
    pub materials: Vec<String>,
    /// Names of its nodes; at most 1000 are listed.
    pub nodes: Vec<String>,
    /// Number of its nodes that have a name.
    pub node_count: usize,
    /// Names of its material variants.
    pub variants: Vec<String>,
    /// Name of the shown variant; none: the file's own materials are shown.
    pub shown_variant: Option<String>,
}

/// A parameter of the scene's script.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value, as scene text.
    pub value: String,
    /// Place of its declaration in the text.
    pub place: Option<String>,
    /// Least and largest value of its slider in the preview; any number may be set. None for other values.
    pub range: Option<[f64; 2]>,
}

/// The frames of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Timeline {
    /// First frame.
    pub start: u32,
    /// Last frame.
    pub end: u32,
    /// Frames a second.
    pub fps: f32,
}

/// A cut of the timeline.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Cut {
    /// First frame of the camera.
    pub frame: u32,
    /// Name of the camera.
    pub camera: String,
}
