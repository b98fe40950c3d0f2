//! `info`: contents of a scene as counts, meters and bytes.

pub mod frame;
mod skipped;
mod table;
mod time;

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    time::Instant,
};

use clap::Args;
use frame::planned_frames;
use serde::Serialize;
use skipped::{SkippedInfo, skipped};
use time::PictureTime;

use super::{
    cameras, check,
    error::AppError,
    lint::Lint,
    print_json, print_out,
    render::{choose_aovs, overrides, turned},
    scene::load_scene,
};
use crate::{
    app::args::{PictureArgs, RenderArgs},
    files::folder_of,
    gpu::adapter::AdapterSummary,
    math::Bounds,
    render::{
        RenderOptions,
        buffers::textures::Layers,
        decide::{Decision, decide, needs_trees, skip::Skipping},
        layout::types::GpuVertex,
        lighting::lights::ShadowSizes,
        maps::method_maps::MapFacts,
        methods,
        plan::{Dropped, Plan},
        query::answer::Choices,
        settings::cutoff::can_reflect,
    },
    runtime::{
        ViewOverrides,
        parameters::setting,
        scene_text::{LoadedScene, asset_folders},
    },
    scene::{
        desc::{Entry, LightKind, ParamValue, SceneDesc},
        diagnostic::print_diagnostics,
    },
    world::{Light, Mesh, World, animation::Listed, bvh::Trees},
};

/// Output of `info --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Info {
    /// Path of the scene file, or the name of the built-in atrium.
    pub scene: String,
    /// File of the scene's project; `None` for a scene of no project.
    pub project: Option<String>,
    /// Folders that files of the scene may be in, and below.
    pub border: Vec<String>,
    /// Names of the cameras; the first is the default.
    pub cameras: Vec<String>,
    /// Width and height of the picture, pixels.
    pub size_px: [u32; 2],
    /// Sub-frames of the picture; where an error bound decides, the largest number that it allows.
    pub samples: u32,
    /// Time and memory of the picture on this machine, with `--time`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<PictureTime>,
    /// Unique meshes.
    pub meshes: usize,
    /// Triangles of the unique meshes, as stored.
    pub triangles_stored: usize,
    /// Triangles of all instances, as rendered.
    pub triangles_placed: usize,
    /// Instances of meshes.
    pub instances: usize,
    /// Instances that may move.
    pub instances_dynamic: usize,
    /// Materials.
    pub materials: usize,
    /// Materials that reflect at this scene's roughness cut-off.
    pub materials_reflective: usize,
    /// Materials with an alpha cut-out.
    pub materials_cut_out: usize,
    /// Images.
    pub textures: usize,
    /// Lights of each of [`LightKind::NAMES`].
    pub lights: [usize; LightKind::NAMES.len()],
    /// Lights among them that a light tree chooses, whose shadows are found by rays.
    pub tree_lamps: usize,
    /// Triangles of materials with `light = true`.
    pub light_triangles: usize,
    /// Animations of the files, played or not.
    pub animations: Vec<Listed>,
    /// Names that the scene and its models' files offer to choose from.
    #[serde(flatten)]
    pub choices: Choices,
    /// Animated values and their sources.
    pub moves: Vec<String>,
    /// Parameters of the script, as scene text.
    pub params: Vec<String>,
    /// Parameters of the scripts of placed scenes, with their values there, by the names of the scenes' groups.
    pub placed_params: BTreeMap<String, Vec<String>>,
    /// Smallest and largest corner of all instances over their motion, meters; `None` for an empty scene.
    pub bounds_m: Option<[[f32; 3]; 2]>,
    /// Smallest and largest corner of the static instances, of which U is a share, or of all where none is static.
    pub static_bounds_m: Option<[[f32; 3]; 2]>,
    /// U, meters.
    pub unit_m: f32,
    /// Length of a reflection ray, meters.
    pub ray_length_m: f32,
    /// The threshold T, meters.
    pub threshold_m: f32,
    /// Vertices and indices as loaded, bytes.
    pub geometry_bytes: u64,
    /// Images with their mip levels, bytes.
    pub texture_bytes: u64,
    /// Shadow maps, bytes.
    pub shadow_map_bytes: u64,
    /// BVHs that rays are traced through, bytes.
    pub tree_bytes: u64,
    /// Maps that the scene's method captures; `None` where it captures or needs none, or they are refused.
    #[serde(flatten)]
    pub maps: Option<MapFacts>,
    /// Instances that reflection rays skip; `None` with `skip_px = 0`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skipped: Option<SkippedInfo>,
    /// Maximum number of consecutive reflections in this scene.
    pub bounces: u32,
    /// Settings left to `auto`, and their values on software adapters.
    pub decided_software: Vec<Decision>,
    /// Settings left to `auto`, and their values on GPUs.
    pub decided_gpu: Vec<Decision>,
    /// Name, driver and API of this machine's adapter; `None` without one.
    pub adapter: Option<String>,
    /// Abilities of this adapter that Reflet uses or could use, such as ray queries.
    pub adapter_has: Vec<String>,
    /// Abilities that Reflet uses or could use and this adapter lacks.
    pub adapter_lacks: Vec<String>,
    /// Features that the plan drops, and why the picture stays the same.
    pub left_out: Vec<Dropped>,
    /// Warnings, as `check` counts them for the chosen variant.
    pub warnings: usize,
    /// Every file that was read.
    pub files: Vec<String>,
}

/// Prints the contents of a scene, or the passes of its frame.
///
/// # Errors
/// [`AppError::Scene`] when it cannot be loaded, or when this machine's device cannot hold it.
pub fn info(args: &InfoArgs) -> Result<(), AppError> {
    let started = Instant::now();
    let scene = args.scene.as_deref();
    let picture = turned(&args.picture, scene)?;
    let mut loaded = load_scene(scene, &picture.from, &overrides(&picture, scene)?)?;
    let load = started.elapsed();
    let camera = cameras::first(&loaded, picture.camera.as_deref())?;
    let aovs = choose_aovs(&picture.aov, &loaded.world)?;
    if let Some(refused) = Lint::refused_here(&loaded.scene, &loaded.world) {
        return Err(AppError::Scene(vec![refused]));
    }
    if args.frame {
        let frames = planned_frames(&loaded)?;
        return match args.json {
            true => print_json(&frames),
            false => print_out(&frame::table(&frames)),
        };
    }
    let mut info = gather(&loaded, args.at)?;
    let mut bounds = loaded.first_frame().bounds();
    let found = check::lint(&mut loaded, &mut |world| {
        bounds = bounds.union(world.bounds())
    });
    info.bounds_m = corners(bounds);
    print_diagnostics(&found);
    info.warnings += found.len();
    info.border = border(&loaded, args);
    if let Ok(adapter) = AdapterSummary::first(picture.adapter.as_deref()) {
        info.adapter = Some(adapter.name);
        (info.adapter_has, info.adapter_lacks) = (adapter.has, adapter.lacks);
    }
    if args.time {
        let frame = args.at.unwrap_or_else(|| loaded.scene.first_frame());
        let mut args = RenderArgs::for_pictures(scene, &picture);
        args.picture.denoise = false; // it takes its time once, after all samples
        let time = PictureTime::measure(&args, loaded, camera, aovs, frame, load)?;
        info.time = Some(time);
    }
    if args.json {
        print_json(&info)
    } else {
        print_out(&table::table(&info))
    }
}

/// Folders that files of the scene may be in, and below; none for the built-in atrium.
fn border(loaded: &LoadedScene, args: &InfoArgs) -> Vec<String> {
    let Some(scene) = &args.scene else {
        return Vec::new();
    };
    let whole = |folder: &Path| Path::new(".").join(folder).canonicalize();
    let own = match &loaded.project {
        Some(project) => project.folder.clone(),
        None => folder_of(scene).to_owned(),
    };
    let mut all: Vec<PathBuf> = Vec::new();
    for folder in [own]
        .into_iter()
        .chain(asset_folders(&args.picture.from.assets))
    {
        let folder = whole(&folder).unwrap_or(folder);
        if !all.iter().any(|other| folder.starts_with(other)) {
            all.push(folder);
        }
    }
    all.iter()
        .map(|folder| folder.display().to_string())
        .collect()
}

/// Counts and measures a loaded scene. `at` is the frame whose skipped instances are listed, by default the first.
///
/// # Errors
/// [`AppError::Scene`] when its trees cannot be built, [`AppError::Usage`] when it has no such frame.
pub fn gather(loaded: &LoadedScene, at: Option<u32>) -> Result<Info, AppError> {
    let world = &loaded.first_frame();
    let reflection = &loaded.scene.reflection;
    let unit_m = reflection.unit_m.unwrap_or_else(|| world.unit_m());
    let is_of = |light: &Light, name: &str| light.desc.kind.name() == name;
    let num_lights = |name| world.all_lights().filter(|l| is_of(l, name)).count();
    let num_triangles = |mesh: usize| world.meshes[mesh].triangles.len();
    let options = ViewOverrides::default().options(loaded);
    let trees = trees_of(world, &options)?;
    let [software, gpu] = [true, false].map(|software| decide(world, &trees, &options, software));
    let layers = Layers::for_world(world);
    let plan = Plan::for_world(world, &trees, &layers, &gpu.options);
    let materials = world.materials.iter();
    let cutoff = reflection.reflects_below();
    let key = methods::map_key(world, &gpu.options, 1.0).ok().flatten();
    Ok(Info {
        scene: loaded.name.clone(),
        project: (loaded.project.as_ref()).map(|project| project.file.display().to_string()),
        border: Vec::new(),
        cameras: world.cameras.iter().map(|c| c.name.clone()).collect(),
        size_px: loaded.scene.image.size,
        samples: loaded.scene.image.samples.count(),
        time: None,
        meshes: world.meshes.len(),
        triangles_stored: (0..world.meshes.len()).map(num_triangles).sum(),
        triangles_placed: world.instances.iter().map(|i| num_triangles(i.mesh)).sum(),
        instances: world.instances.len(),
        instances_dynamic: world.instances.iter().filter(|i| i.dynamic).count(),
        materials: world.materials.len(),
        materials_reflective: materials
            .clone()
            .filter(|material| can_reflect(material, cutoff))
            .count(),
        materials_cut_out: materials.filter(|m| m.alpha_cutoff.is_some()).count(),
        textures: world.textures.len(),
        lights: LightKind::NAMES.map(num_lights),
        tree_lamps: world.lamps.len(),
        light_triangles: (world.lighting_instances())
            .map(|(_, instance)| num_triangles(instance.mesh))
            .sum(),
        animations: world.animations.clone(),
        choices: Choices::of_scene(loaded),
        moves: moves(&loaded.scene),
        params: settings(&loaded.scene.params),
        placed_params: (loaded.scene.placed_params.iter())
            .map(|(group, params)| (group.clone(), settings(params)))
            .collect(),
        bounds_m: corners(world.bounds()),
        static_bounds_m: corners(world.static_bounds()),
        unit_m,
        ray_length_m: reflection.ray_length_u * unit_m,
        threshold_m: reflection.threshold_u * unit_m,
        geometry_bytes: geometry_bytes(world),
        texture_bytes: layers.bytes(),
        shadow_map_bytes: ShadowSizes::for_lights(&world.lights, &gpu.options).bytes(),
        tree_bytes: (size_of_val(trees.nodes.as_slice())
            + size_of_val(trees.triangles.as_slice())
            + size_of_val(trees.instances.as_slice())) as u64,
        maps: key.map(|key| key.facts(&gpu.options.reflection, unit_m, 1.0)),
        skipped: skipped(loaded, &gpu.options, at)?,
        bounces: plan.bounces,
        decided_software: software.decisions,
        decided_gpu: gpu.decisions,
        adapter: None,
        adapter_has: Vec::new(),
        adapter_lacks: Vec::new(),
        left_out: plan.dropped,
        warnings: loaded.warnings.len(),
        files: (world.files.iter().map(|f| f.display().to_string())).collect(),
    })
}

/// BVHs of a world, empty where no adapter traces rays.
fn trees_of(world: &World, options: &RenderOptions) -> Result<Trees, AppError> {
    match [true, false]
        .into_iter()
        .any(|software| needs_trees(world, options, software))
    {
        true => Trees::build_apart(world, u64::MAX, &Skipping::for_world(world, options).apart)
            .map_err(|d| AppError::Scene(vec![*d])),
        false => Ok(Trees::unbuilt(world)),
    }
}

fn settings(params: &[Entry<ParamValue>]) -> Vec<String> {
    let params = params.iter();
    params.map(|p| setting(&p.name, &p.value)).collect()
}

fn corners(bounds: Bounds) -> Option<[[f32; 3]; 2]> {
    (!bounds.is_empty()).then(|| [bounds.min.to_array(), bounds.max.to_array()])
}

/// Number of names of a list that are told.
const NAMES: usize = 12;

/// The first of these names, and how many there are more.
fn first(names: &[String]) -> String {
    let told = names[..names.len().min(NAMES)].join(", ");
    match names.len().saturating_sub(NAMES) {
        0 => told,
        more => format!("{told}, and {more} more, which --json lists"),
    }
}

/// Names of everything that `[motion]` and the script animate.
fn moves(desc: &SceneDesc) -> Vec<String> {
    fn names<T>(kind: &str, list: &[Entry<T>]) -> Vec<String> {
        let named = list.iter();
        named.map(|e| format!("{kind} \"{}\"", e.name)).collect()
    }
    let motion = &desc.motion;
    let tracks = [
        names("camera", &motion.cameras),
        names("instance", &motion.instances),
        names("group", &motion.groups),
        names("decal", &motion.decals),
        names("light", &motion.lights),
        names("material", &motion.materials),
        names("materials of model", &motion.models),
    ];
    let script = desc.scripts().filter(|script| script.has_frame);
    let script = script.map(|script| format!("poses of frame() of {}", script.name));
    tracks.concat().into_iter().chain(script).collect()
}

/// GPU memory of vertices and indices.
fn geometry_bytes(world: &World) -> u64 {
    let mesh = |mesh: &Mesh| {
        mesh.positions.len() * size_of::<GpuVertex>()
            + size_of_val(mesh.triangles.as_slice())
            + size_of_val(mesh.uv1.as_slice())
    };
    world.meshes.iter().map(mesh).sum::<usize>() as u64
}

/// `info`
#[derive(Clone, Debug, Args)]
pub struct InfoArgs {
    /// Scene file; without one, the built-in atrium
    pub scene: Option<PathBuf>,
    /// Settings of the picture, as of `render`
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Render the first samples of the picture by its first camera, and print the time and memory that all of them take
    /// on this machine, without --denoise
    #[arg(long, conflicts_with = "frame")]
    pub time: bool,
    /// Frame of the timeline for which the instances are listed that reflections skip, and of --time; default: the first
    #[arg(long, value_name = "FRAME")]
    pub at: Option<u32>,
    /// Print the passes of the frame instead, in their order, with the textures that each reads and writes
    #[arg(long)]
    pub frame: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}
