//! Reads a glTF 2.0 file into a [`Model`]: meshes, materials, placements, lights and cameras. All
//! content is untrusted until validated.
//!
//! The JSON is read into plain structs of our own (`schema`), as the crate `gltf` refused 39 of 248 valid files and
//! panicked on 2. That crate only serves as the reference of `tests/gltf/judge.rs`.

use std::{
    collections::{BTreeMap, HashMap},
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::{Affine3A, Vec3};

use super::{Light, ListedNames, Material, Mesh, deform::DeformingNodes, rig::Rig};
use reflet_base::memory;
use reflet_scene::{desc::CameraDesc, diagnostic::Diagnostic};

mod accessor;
mod animated;
mod animation;
mod budget;
mod buffer;
mod camera;
mod container;
mod draco;
mod extension;
mod geometry;
mod image_light;
mod interchange;
mod json_memory;
mod layers;
mod least_bytes;
mod lenient;
mod light;
mod material;
mod meshopt;
mod morph;
mod node;
mod posed;
mod primitive;
mod primitive_context;
mod ranges;
mod read_array;
pub(super) mod repair;
mod run;
mod schema;
mod skin;
mod specular_glossiness;
mod splats;
pub mod stand_in;
mod texture_ref;
mod transform;
mod tree;
pub(super) mod uri;
mod wire;
mod wrong_types;

pub use animation::{Clip, Playable, StageTime};
pub use container::Bytes;
pub use extension::supported_extensions;
pub use image_light::{ImageLight, LightMap};
pub use lenient::FORGIVEN;
pub use posed::{Posed, PosedNames};
pub use specular_glossiness::{Factors, Part, SpecularGlossinessMaps};
pub use uri::Sandbox;

/// Name of the warning about a file that places nothing.
pub const MODEL_EMPTY: &str = "model-empty";

/// Contents of one file; transforms are relative to the model.
#[derive(Debug, Default)]
pub struct Model {
    /// Meshes, one for each visible primitive and skin.
    pub meshes: Vec<Mesh>,
    /// Materials of the file, the default material, and unlit copies for points and lines; their textures are
    /// indices into [`Model::images`].
    pub materials: Vec<Material>,
    /// For each material, the file's sets of texture coordinates that its textures refer to as 0 and 1.
    pub uv_sets: Vec<[u32; 2]>,
    /// Images that materials use, one entry per color space.
    pub images: Vec<ImageUse>,
    /// Deforming nodes of each mesh that animations of the file deform, by index into [`Model::meshes`].
    pub deforming: HashMap<usize, Arc<DeformingNodes>>,
    /// Names of the materials and the nodes, in the order of the file.
    pub names: ListedNames,
    /// Names of the material variants.
    pub variants: Vec<String>,
    /// Materials of each mesh in some variants, as indices into [`Model::variants`] and
    /// [`Model::materials`].
    pub variant_materials: HashMap<usize, Vec<(usize, usize)>>,
    /// Mesh placements.
    pub placements: Vec<Attached<Placement>>,
    /// Lights (KHR_lights_punctual), in the space of their nodes.
    pub lights: Vec<Attached<Light>>,
    /// Light from all directions (EXT_lights_image_based, or dome lights of a USD stage).
    pub image_light: Option<ImageLight>,
    /// Cameras by name, in the space of their nodes.
    pub cameras: Vec<Attached<(String, CameraDesc)>>,
    /// Node hierarchy.
    pub rig: Arc<Rig>,
    /// Names of the nodes and morph targets that scripts may pose; empty where scripts pose none.
    pub posed_names: PosedNames,
    /// Animations.
    pub clips: Vec<Clip>,
    /// Time codes of the USD stage that the file was converted from.
    pub stage: Option<StageTime>,
    /// Named, counted warnings.
    pub warnings: Vec<Diagnostic>,
    /// The file and its buffers.
    pub files: Vec<PathBuf>,
}

impl Model {
    /// Animations and light of the model, and metadata of its USD stage.
    pub fn playable(&self) -> Playable {
        let is_unlit = |placed: &Attached<Placement>| self.materials[placed.value.material].unlit;
        Playable {
            is_unlit: !self.placements.is_empty() && self.placements.iter().all(is_unlit),
            has_image_light: self.image_light.is_some(),
            clips: self.clips.clone(),
            stage: self.stage,
        }
    }
}

/// An item attached to a node.
#[derive(Clone, Debug)]
pub struct Attached<T> {
    /// Index of the item's node.
    pub node: Option<usize>,
    /// Transform from the item's space to the node's.
    pub node_from_object: Affine3A,
    /// Whether the node only shows and hides the item and does not place it: joints place a skinned mesh.
    pub is_skinned: bool,
    /// Rest transform from the item's space to the model's; finite, perhaps singular.
    pub model_from_object: Affine3A,
    /// Whether the item is hidden unless an animation shows it.
    pub hidden: bool,
    /// Index of a light or a camera in the file; `None` for meshes.
    pub index: Option<usize>,
    /// The attached item.
    pub value: T,
}

/// A mesh placed by a node.
#[derive(Clone, Debug)]
pub struct Placement {
    /// Names of the nodes from the root down, joined with `/`.
    pub name: String,
    /// Index into [`Model::meshes`].
    pub mesh: usize,
    /// Index into [`Model::materials`].
    pub material: usize,
}

/// An image as color (sRGB) or as data (linear).
#[derive(Clone, Debug)]
pub struct ImageUse {
    /// Name for messages, such as `image 3 "wall"`.
    pub name: String,
    /// First user of the image, for messages: the texture, its place in the JSON and its material.
    pub used_by: String,
    /// Index of the image in the file.
    pub index: usize,
    /// Whether the image is sampled as color (sRGB).
    pub srgb: bool,
    /// Location of its encoded bytes; an error is reported only if the image is used.
    pub source: Result<ImageSource, Fault>,
    /// Index of the image that a texture has for readers that cannot show this one.
    pub fallback: Option<usize>,
}

/// Location of encoded bytes.
#[derive(Clone, Debug)]
pub enum ImageSource {
    /// Bytes in a buffer or `data:` URI.
    Bytes(Bytes),
    /// A file, by its canonical path.
    File(PathBuf),
    /// An image that is converted from specular-glossiness maps.
    SpecularGlossiness(Arc<SpecularGlossinessMaps>),
}

impl ImageSource {
    /// The files that the image is read from.
    pub fn files(&self) -> Vec<&PathBuf> {
        match self {
            Self::Bytes(_) => Vec::new(),
            Self::File(path) => vec![path],
            Self::SpecularGlossiness(maps) => [&maps.diffuse, &maps.specular]
                .into_iter()
                .flatten()
                .flat_map(Self::files)
                .collect(),
        }
    }
}

/// An error inside a file; the caller adds the file name.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Kebab-case name of the kind of error.
    pub name: &'static str,
    /// Error message, with the place inside the file.
    pub message: String,
    /// Help text.
    pub help: Option<String>,
}

impl Fault {
    /// An error without help text.
    pub fn new(name: &'static str, message: impl Into<String>) -> Self {
        Self {
            name,
            message: message.into(),
            help: None,
        }
    }

    /// Adds help text.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Prefixes the message with a place.
    pub fn placed(mut self, place: &str) -> Self {
        self.message = format!("{place}: {}", self.message);
        self
    }

    /// Reference to a part of the file that is not there.
    pub fn missing(kind: &str, index: usize) -> Self {
        Self::new("gltf-index", format!("{kind} {index} does not exist"))
    }

    /// Adds the folder in which a file that is not there was looked for, and the advice to bring it along.
    pub fn looked_for_in(mut self, folder: &Path) -> Self {
        if self.name == "file-not-found" {
            self.message = format!("{}, in {}", self.message, folder.display());
            let help = "copy it there: models are handed on with the files that they name";
            self.help.get_or_insert_with(|| help.to_owned());
        }
        self
    }

    /// Converts the error to a diagnostic about a file.
    pub fn in_file(self, file: &Path) -> Diagnostic {
        let mut diagnostic = Diagnostic::in_file(self.name, file, self.message);
        diagnostic.help = self.help;
        diagnostic
    }
}

/// Warnings by kind, counted, each with the first place where it occurred.
#[derive(Clone, Debug, Default)]
pub struct Notes(BTreeMap<(&'static str, &'static str), (u64, String)>);

impl Notes {
    /// Counts `count` more cases of `what` (plural) at `place`.
    pub fn add(&mut self, name: &'static str, count: u64, what: &'static str, place: &str) {
        if count > 0 {
            let entry = self
                .0
                .entry((name, what))
                .or_insert_with(|| (0, place.to_owned()));
            entry.0 += count;
        }
    }

    fn merge(&mut self, other: Self) {
        for ((name, what), (count, place)) in other.0 {
            self.add(name, count, what, &place);
        }
    }

    /// The warnings, ordered by name.
    pub fn into_warnings(self, file: &Path) -> Vec<Diagnostic> {
        let warning = |((name, what), (count, place)): ((&'static str, &str), (u64, String))| {
            Diagnostic::in_file(name, file, format!("{count} {what}; first: {place}")).warning()
        };
        self.0.into_iter().map(warning).collect()
    }
}

/// Maximum decoded geometry of one file, bytes; less where the load has less left.
const GEOMETRY_BUDGET_BYTES: u64 = 2 << 30;

/// Maximum number of listed errors per file.
const MAX_ERRORS: usize = 20;

/// Options of reading a file.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Whether wrong references to nodes and meshes are dropped.
    pub lenient: bool,
    /// Whether a wrong part that could be left out is an error.
    pub strict: bool,
    /// Nodes and morph targets that scripts pose.
    pub posed: Posed,
    /// Memory budget of the load, from which geometry is taken.
    pub memory: memory::Budget,
}

/// Reads the file at `path` (canonical, from [`Sandbox::resolve`]). Skins and morph targets are at rest.
///
/// # Errors
/// All errors, each with its place inside the file.
pub fn read(
    path: &Path,
    sandbox: &Sandbox,
    options: &ReadOptions,
) -> Result<Model, Vec<Diagnostic>> {
    read_faults(path, sandbox, options).map_err(|mut faults| {
        let left_out = faults.len().saturating_sub(MAX_ERRORS);
        if left_out > 0 {
            faults.truncate(MAX_ERRORS);
            let text = format!("{left_out} more errors are not shown");
            faults.push(Fault::new("too-many-errors", text));
        }
        faults.into_iter().map(|f| f.in_file(path)).collect()
    })
}

fn read_faults(path: &Path, sandbox: &Sandbox, options: &ReadOptions) -> Result<Model, Vec<Fault>> {
    let one = |fault: Fault| vec![fault];
    let bytes = sandbox.read(path).map_err(one)?;
    let budget = budget::GeometryBudget::new(
        memory::Budget::new(GEOMETRY_BUDGET_BYTES),
        options.memory.clone(),
    );
    let mut notes = Notes::default();
    let mut files = vec![path.to_owned()];
    let found = interchange::Found {
        notes: &mut notes,
        files: &mut files,
    };
    let bytes = interchange::as_glb(path, bytes, sandbox, &options.memory, found).map_err(one)?;
    budget.take_file(bytes.len()).map_err(one)?;
    let container = container::open(bytes, options, &mut notes).map_err(one)?;
    let (mut root, binary, held) = (container.root, container.binary, container.held);
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut model = Model {
        files,
        ..Model::default()
    };
    lenient::check_references(&mut root, &mut notes, options).map_err(one)?;
    let mut buffers = buffer::read(
        &root,
        binary,
        folder,
        sandbox,
        &mut model.files,
        &mut notes,
        &budget,
    )
    .map_err(one)?;
    draco::decompress(&mut root, &mut buffers, &budget, &mut notes).map_err(one)?;
    let data = accessor::Data::new(&root, buffers, budget, &mut notes).map_err(one)?;
    material::read(&root, &data, folder, sandbox, &mut model, &mut notes).map_err(one)?;
    let light = image_light::read(&root, &data, folder, sandbox);
    let light = lenient::forgiven(&root, light, None, &LEFT_OUT_LIGHT, &mut notes);
    model.image_light = light.map_err(one)?;
    model.stage = StageTime::from_root(&root);
    let variants = root.extensions.variants.iter().flat_map(|v| &v.variants);
    model.variants = variants.map(|v| v.name.clone()).collect();
    model.clips = animation::read(&root, &data);
    for fault in model
        .clips
        .iter()
        .filter_map(|c| c.animation.as_ref().err())
    {
        let what = "animations are broken and cannot be played";
        notes.add("animation-broken", 1, what, &fault.message);
    }
    let visit =
        node::traverse(&root, &data, &model.clips, &options.posed, &mut notes).map_err(one)?;
    model.posed_names = PosedNames::from_nodes(&root, &options.posed, |node| {
        visit.model_from_node(node).is_some()
    });
    let of_scene = |(i, node): (usize, &schema::Node)| {
        let name = node.name.clone().filter(|name| !name.is_empty());
        name.filter(|_| visit.model_from_node(i).is_some())
    };
    let own_materials = model.materials.iter().take(root.materials.len());
    model.names = ListedNames {
        materials: own_materials.map(|m| m.name.clone()).collect(),
        nodes: root.nodes.iter().enumerate().filter_map(of_scene).collect(),
    };
    let primitives = geometry::read(&root, &data, &visit, &mut model, &mut notes)?;
    model.warnings = extension::ignored(&root, path);
    // A million nodes take less memory as JSON or as placements than as both.
    drop(data);
    drop((root, held));
    node::place(visit, &primitives, &mut model).map_err(one)?;
    model.warnings.extend(notes.into_warnings(path));
    if model.placements.is_empty() && model.lights.is_empty() && model.cameras.is_empty() {
        let text = "the file shows nothing: no node places a mesh";
        let warning = Diagnostic::in_file(MODEL_EMPTY, path, text);
        model.warnings.push(warning.warning());
    }
    Ok(model)
}

/// Warning about an image-based light that is left out.
const LEFT_OUT_LIGHT: lenient::LeftOut<'_> = lenient::LeftOut {
    name: "light-left-out",
    what: "image-based lights are wrong and left out",
    place: "the scene",
};

/// Name of an object for messages, such as `mesh 3 "wall"`.
fn label(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) => format!("{kind} {index} \"{}\"", uri::shorten(name)),
        None => format!("{kind} {index}"),
    }
}

/// Whether all values are finite.
fn finite(values: &[f32]) -> bool {
    values.iter().all(|v| v.is_finite())
}

/// Local view direction of lights and cameras.
const FORWARD: Vec3 = Vec3::NEG_Z;
