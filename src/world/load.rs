//! Loads a scene description and its files into a [`World`].

use std::{
    collections::{HashMap, HashSet},
    path::PathBuf,
};

use super::{
    Mesh, World,
    gltf::{self, Fault, Model, Sandbox},
    shape::MOST_WORK,
    texture::{self, TextureLimits, pool_size::PoolSizes},
};
use reflet_base::memory::Budget;
use reflet_scene::{
    dependencies::Dependencies,
    desc::{At, ByName, SceneDesc},
    diagnostic::{Diagnostic, MOST_SHOWN, Span},
    fonts::Fonts,
    motion::{FileMaterial, file_materials},
    reach::{Border, Reach},
};

mod asset_cache;
mod blended;
mod camera;
mod check_names;
mod decals;
mod emitters;
mod environment;
pub mod foreign_formats;
mod lights_and_cameras;
mod material;
mod material_binding;
mod model_instance;
mod one_color;
mod place;
mod points;
mod preloaded_models;
mod read_models;
mod repeat;
mod scatter;
mod scripted;
pub(crate) mod tangent;
mod vertex_streams;

pub use asset_cache::AssetCache;
pub use preloaded_models::{Forgiven, PreloadedModels};

/// Asset folders and limits of loading.
#[derive(Clone, Debug)]
pub struct LoadOptions {
    /// Folders searched after the scene's own, in this order.
    pub assets: Vec<PathBuf>,
    /// Folder of the scene's project, inside of which names may climb by `..`.
    pub project: Option<PathBuf>,
    /// Largest width and height of an image, pixels.
    pub max_texture_px: u32,
    /// Most bytes that all images may decode to together.
    pub image_budget_bytes: u64,
    /// Largest single file, bytes.
    pub max_file_bytes: u64,
    /// Memory limit of geometry, images and trees together, bytes; `None`: three quarters of the free memory,
    /// or 6 GiB where the system does not tell it.
    pub memory_bytes: Option<u64>,
    /// Whether glTF files are shown without wrong references to scenes, nodes and meshes.
    pub lenient: bool,
    /// Whether wrong parts of glTF files that change only their look are errors; else they are left out with a warning:
    /// images that cannot be found or read, materials, textures, attributes, lights, cameras, references to these, and
    /// extensions that a file requires.
    pub strict: bool,
    /// Records the files that were searched.
    pub dependencies: Dependencies,
    /// Models that were read before.
    pub preloaded_models: PreloadedModels,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            assets: Vec::new(),
            project: None,
            max_texture_px: 16384,
            image_budget_bytes: 2 << 30,
            max_file_bytes: 4 << 30,
            memory_bytes: None,
            lenient: false,
            strict: false,
            dependencies: Dependencies::default(),
            preloaded_models: PreloadedModels::default(),
        }
    }
}

/// Loads every file of the scene once and places all instances.
///
/// # Errors
/// All errors in the scene's names and files, in the order of the scene text.
pub fn load(desc: &SceneDesc, options: &LoadOptions) -> Result<World, Vec<Diagnostic>> {
    load_with_cache(desc, options).map(|(world, _)| world)
}

/// Loads as [`load`] does, and returns an asset cache for later versions of the scene text.
///
/// # Errors
/// Same errors as [`load`].
pub fn load_with_cache(
    desc: &SceneDesc,
    options: &LoadOptions,
) -> Result<(World, AssetCache), Vec<Diagnostic>> {
    let mut loader = Loader::new(desc, options);
    let models = loader.read_models();
    loader.check_names(&models);
    loader.read_environment(&models);
    loader.fail_on_errors()?;
    loader.place_all(&models);
    loader.place_decals();
    loader.fail_on_errors()?;
    loader.finish(models)
}

/// State of loading.
struct Loader<'a> {
    desc: &'a SceneDesc,
    options: &'a LoadOptions,
    memory: Budget,
    /// Work that shapes may still take.
    shape_work: Budget,
    sandbox: Sandbox,
    /// Models and materials of the scene by name.
    models: ByName<'a>,
    named_materials: ByName<'a>,
    /// Materials with motion by name.
    moved: ByName<'a>,
    /// Indices into `FrameState::file_materials`.
    file_materials: HashMap<FileMaterial<'a>, usize>,
    /// Folders to search, as the user named them.
    folders: Vec<PathBuf>,
    fonts: Fonts,
    world: World,
    errors: Vec<Diagnostic>,
    textures: material::TextureTable,
    /// Index into `loaded` of each file that was read, by path and USD parts; `None` after an error.
    files: HashMap<read_models::Part, Option<usize>>,
    loaded: Vec<Model>,
    /// Index into the world's meshes of each mesh of a loaded file.
    meshes: HashMap<place::MeshKey, usize>,
    /// Indices of the world's meshes that players deform.
    deformed: HashSet<usize>,
    materials: HashMap<place::MaterialKey, usize>,
    materials_by_name: HashMap<String, Vec<usize>>,
    /// By name, indices of the world's moving materials that may be shared.
    moving_by_name: HashMap<String, Vec<usize>>,
}

/// Loaded source of a `[model.NAME]`.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// Index into [`Loader::loaded`].
    File(usize),
    /// A shape, whose mesh is in the world.
    Shape(usize),
    /// An error was reported.
    Broken,
}

/// An error at a place in the scene text.
fn error_at(name: &'static str, at: &Span, message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(name, at.clone(), message)
}

/// Help text `did you mean "…"?` if a known name is similar.
fn did_you_mean<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Option<String> {
    const CLOSE: f64 = 0.7;
    let scored = known.map(|k| {
        (
            strsim::jaro_winkler(&name.to_lowercase(), &k.to_lowercase()),
            k,
        )
    });
    let best = scored
        .filter(|(score, _)| *score >= CLOSE)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(_, k)| format!("did you mean \"{k}\"?"))
}

/// Help text `its … are a, b, c`, with at most 30 names.
fn list<'n>(what: &str, names: impl Iterator<Item = &'n str>) -> String {
    const MOST: usize = 30;
    let mut names: Vec<_> = names.collect();
    let more = if names.len() > MOST { ", …" } else { "" };
    names.truncate(MOST);
    format!("its {what} are {}{more}", names.join(", "))
}

impl<'a> Loader<'a> {
    fn new(desc: &'a SceneDesc, options: &'a LoadOptions) -> Self {
        let folders: Vec<_> = std::iter::once(&desc.folder)
            .chain(&options.assets)
            .cloned()
            .collect();
        let roots = folders.iter().chain(&options.project);
        let border = Border {
            project: options.project.clone(),
            ..Border::from(options.assets.clone())
        };
        let reach = Reach::new(desc.folder.clone(), &border);
        let memory = (options.memory_bytes).map_or_else(Budget::of_machine, Budget::new);
        Self {
            desc,
            options,
            memory: memory.clone(),
            shape_work: Budget::new(MOST_WORK),
            sandbox: Sandbox::new(roots.map(PathBuf::as_path), options.max_file_bytes)
                .with_dependencies(&options.dependencies),
            models: ByName::from_entries(&desc.models),
            named_materials: ByName::from_entries(&desc.materials),
            moved: ByName::from_entries(&desc.motion.materials),
            file_materials: (file_materials(desc).into_iter().enumerate())
                .map(|(index, material)| (material, index))
                .collect(),
            fonts: Fonts::new(&reach, &options.dependencies),
            folders,
            world: World {
                memory,
                probes: desc.probes.clone(),
                ..World::default()
            },
            errors: Vec::new(),
            textures: material::TextureTable::default(),
            files: HashMap::new(),
            loaded: Vec::new(),
            meshes: HashMap::new(),
            deformed: HashSet::new(),
            materials: HashMap::new(),
            materials_by_name: HashMap::new(),
            moving_by_name: HashMap::new(),
        }
    }

    fn fail_on_errors(&mut self) -> Result<(), Vec<Diagnostic>> {
        if self.errors.is_empty() {
            Ok(())
        } else {
            Err(std::mem::take(&mut self.errors))
        }
    }

    /// Advice for a name that starts from the folder of the included text that has it, not from the scene's folder.
    fn beside_text(&self, name: &At<String>) -> Option<String> {
        let text = name.at.source.as_ref()?;
        let own = self.folders.first()?;
        let from_own = text.path.parent()?.join(&name.value);
        let from_own = from_own.strip_prefix(own).unwrap_or(&from_own).to_str()?;
        self.sandbox.resolve(own, from_own).ok()?;
        Some(format!(
            "names start from the scene's folder: write \"{}\"",
            from_own.replace('\\', "/")
        ))
    }

    /// Finds a file that the scene text names: beside the scene, then in the asset folders.
    fn find(&self, name: &At<String>) -> Result<PathBuf, Box<Diagnostic>> {
        let mut looked = Vec::new();
        let mut similar = None;
        for folder in &self.folders {
            match self.sandbox.resolve(folder, &name.value) {
                Ok(path) => return Ok(path),
                Err(Fault {
                    name: "file-not-found",
                    help,
                    ..
                }) => {
                    similar = similar.or(help);
                    looked.push(format!("\"{}\"", folder.join(&name.value).display()));
                }
                // A name that climbs is most likely meant from the scene's own folder.
                Err(Fault {
                    name: "path-escape",
                    ..
                }) if !looked.is_empty() => {}
                Err(fault) => {
                    let mut error = error_at(fault.name, &name.at, fault.message);
                    error.help = fault.help;
                    return Err(Box::new(error));
                }
            }
        }
        let text = format!(
            "file \"{}\" not found; looked for {}",
            gltf::uri::shorten(&name.value),
            looked.join(", ")
        );
        let mut error = error_at("file-not-found", &name.at, text);
        let help = match () {
            () if name.value.contains(char::is_control) => {
                "a `\\` in double quotes begins a special character: write `/` between folders"
            }
            () if name.value.eq_ignore_ascii_case("none") => {
                "write \"none\", in small letters, to leave out a texture"
            }
            () if !name.value.contains('.') => "write the name of a file with its ending",
            () if name.value.starts_with('~') => {
                "`~` is not expanded: write the name of the file, and its folder with --assets DIR"
            }
            () if name.at.source.as_ref().is_some_and(|s| s.generated) => {
                "check the path; it starts from the folder you are in"
            }
            () => "add the folder that has it with --assets DIR or REFLET_ASSETS",
        };
        let beside = self.beside_text(name);
        error.help = similar.or(beside).or_else(|| Some(help.into()));
        Err(Box::new(error))
    }

    /// Adds the text files of the scene, after the files that are cached, as another text may have other files.
    fn add_texts(&mut self) {
        self.add_files(&self.desc.text_files());
    }

    fn add_files(&mut self, files: &[PathBuf]) {
        for file in files {
            if !self.world.files.contains(file) {
                self.world.files.push(file.clone());
            }
        }
    }

    fn finish(mut self, models: Vec<Source>) -> Result<(World, AssetCache), Vec<Diagnostic>> {
        self.drop_unused_deformations();
        let needs = vertex_streams::needs(&self.world);
        let num_warnings = self.world.warnings.len();
        vertex_streams::run(&mut self.world, &needs)?;
        let mesh_warnings = self.world.warnings[num_warnings..].to_vec();
        let limits = self.texture_limits();
        let (mut images, requests): (Vec<_>, Vec<_>) = (self.textures.take_used(&mut self.world))
            .into_iter()
            .map(|(key, request)| ((key, request.srgb), request))
            .unzip();
        let with_fallbacks = |request| {
            std::iter::successors(Some(request), |r: &&texture::TextureRequest| {
                r.fallback.as_deref()
            })
        };
        let all_requests = requests.iter().flat_map(with_fallbacks);
        let image_files = all_requests.flat_map(|r| r.source.files());
        let image_files: Vec<_> = image_files.cloned().collect();
        self.add_files(&image_files);
        let lenient = !self.options.strict;
        // Images that the scene text names have no user in a file.
        let is_forgiven =
            |request: &texture::TextureRequest| lenient && !request.used_by.is_empty();
        let decoded = texture::decode_all(&requests, &limits, &is_forgiven)?;
        if !(decoded.broken.is_empty() && decoded.damaged.is_empty()) {
            images.clear(); // a reload reads all images anew, with the warnings about the wrong ones
        }
        self.world.textures = decoded.textures.into();
        self.world.warnings.extend(decoded.damaged);
        self.leave_out_images(decoded.broken);
        self.world.memory = self.memory.clone();
        self.warn_of_reduced(&requests);
        let (meshes, textures) = (self.world.meshes.clone(), self.world.textures.clone());
        blended::drop_opaque(&mut self.world, &meshes, &textures);
        deform_at_start(&mut self.world, &meshes, self.desc)?;
        emitters::check(&mut self.world, &meshes, self.desc)?;
        let has_default_camera = camera::add_default(&mut self.world, &meshes, self.desc);
        self.world.rest_unit_m = Some(self.world.unit_m());
        self.world.environment.fog_box = self.world.fog_box();
        let files = self.world.files.clone();
        let source = self.panorama_source(&models);
        self.add_texts();
        let asset_cache = AssetCache {
            sources: asset_cache::sources(self.desc),
            models,
            loaded: self.loaded,
            meshes: self.meshes,
            needs,
            images,
            has_default_camera,
            mesh_warnings,
            folders: self.folders,
            files,
            panorama: (source, self.world.environment.panorama.clone()),
        };
        Ok((self.world, asset_cache))
    }
}

/// Poses the meshes that animations deform at the first frame; `meshes` are the world's.
fn deform_at_start(
    world: &mut World,
    meshes: &[Mesh],
    desc: &SceneDesc,
) -> Result<(), Vec<Diagnostic>> {
    let time_s = desc
        .timeline
        .as_ref()
        .map_or(0.0, |t| f64::from(t.start) / f64::from(t.fps));
    world.deform_at(meshes, desc.first_frame(), time_s)
}

impl Loader<'_> {
    fn drop_unused_deformations(&mut self) {
        for (index, mesh) in self.world.meshes.iter_mut().enumerate() {
            if !self.deformed.contains(&index) {
                mesh.deformation = None;
            }
        }
    }

    fn texture_limits(&self) -> TextureLimits {
        TextureLimits {
            max_px: self.options.max_texture_px,
            budget_bytes: self.options.image_budget_bytes,
            max_file_bytes: self.options.max_file_bytes,
            memory: self.memory.clone(),
        }
    }

    fn warn_of_reduced(&mut self, requests: &[texture::TextureRequest]) {
        let sizes = PoolSizes::for_textures(&self.world.textures);
        for (texture, request) in self.world.textures.iter().zip(requests) {
            if let Some((px, reason)) = sizes.reduced(texture) {
                let text = format!(
                    "{}: {} x {} pixels are rendered as {px} x {px}: {reason}",
                    texture.name, texture.width, texture.height
                );
                let warning = Diagnostic::in_file("texture-reduced", &request.file, text);
                self.world.warnings.push(warning.warning());
            }
        }
    }
}
