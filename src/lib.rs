//! Reflet renders scenes that people write as text, with hybrid reflections after Macedo &
//! Rodrigues, "Real-time dynamic reflections for realistic rendering of 3D scenes" (The Visual
//! Computer 34(3), 2018): reflections are marched in screen space first; every pixel that the march
//! cannot answer goes into a mask; only the mask is ray traced on the GPU.
//!
//! A program opens a scene by [`runtime::Session`]; `docs/examples/render_to_pixels.rs` is one in a few
//! lines.
//!
//! # The map
//!
//! Reflet is a workspace. Its crates are folders of `src/`, each with its `Cargo.toml` and a first page that says what
//! it owns; this package is the program. Data flows one way, and a crate depends only on crates below it in the table:
//!
//! ```text
//! scene text ──> SyntaxTree ──> Document ──> setup ──> SceneDesc ──> World ──> GpuScene ──> passes ──> picture
//!                scene/syntax   scene/parse  script    scene/desc    world/    render/      render/    app/
//! ```
//!
//! | folder | crate | contents |
//! |---|---|---|
//! | `src/app` | `reflet` | [`app`]: the commands and their output; exit codes; [`app::lint`] warns of likely mistakes |
//! | `src/python` | `reflet-python` | the module of Python: a thin user of the runtime's sessions, of [`output`] and of [`metric`] |
//! | `src/web` | `reflet-web` | a page that runs by itself: checker, renderer and bench as WebAssembly, and the page around them; built by `tools/web.sh` alone, see `docs/web.md` |
//! | `src/preview` | [`reflet_preview`] | a scene that follows its files ([`reflet_preview::watch`], [`reflet_preview::live`]), and the window |
//! | `src/write_back` | [`reflet_write_back`] | edits of the preview and of the page → texts in which all other bytes stay |
//! | `src/lsp` | [`reflet_lsp`] | the language server without its transport: messages of editors → answers |
//! | `src/bench` | [`reflet_bench`] | [`bench::run`] renders and measures; reports are drawn from the table of samples |
//! | `src/output` | [`reflet_output`] | files of pictures: PNG, EXR and films, their names and fingerprints, the denoiser, statistics; packs of scenes |
//! | `src/render` | [`reflet_render`] | the library. [`runtime`]: one scene from its text to its pictures, opened, changed and posed in keyed stages, and the only code that builds a `Renderer`: `render` and the preview are thin users of its sessions, `bench` of its renderer stage. `render/passes/mod.rs` lists the passes in their order: read it first; `reflet info --frame` prints the passes of a scene; [`render::plan`] lists the features and passes that a scene needs, [`render::pipeline::targets`] the one table of intermediate textures, [`render::layout::types`] every struct shared with the shaders |
//! | `src/metric` | [`reflet_metric`] | picture × picture → error: reads pictures, judges them, and prints that; no device |
//! | `src/gpu` | [`reflet_gpu`] | thin layer over wgpu: device, shaders, bindings by name, timings, readback; independent of scenes |
//! | `src/world` | [`reflet_world`] | SceneDesc → CPU data: glTF, images, shapes, trees and the CPU oracle; no wgpu |
//! | `src/scene` | [`reflet_scene`] | the scene format, its default values and its manual; [`scene::stages`] from text to a scene at a frame: [`scene::syntax`] is the tree of a text, parsed once for all who ask, [`scene::parse`] merges and reads trees and runs no program, [`scene::script`] is the sandbox, [`scene::motion`] evaluates animation tracks; loads no assets |
//! | `src/text` | `reflet_text` | fonts, the places of letters in a line of text, and the outlines of letters; reads no files |
//! | `src/base` | [`reflet_base`] | bounds and color over glam, atomic file writes, the memory budget, clocks, standard error; in a page, files of a folder in memory (`base/files/in_memory.rs`) |
//!
//! `docs/extending.md` says what each kind of addition touches, `docs/glossary.md` explains Reflet's own terms.
//! `shaders/` has a file for each pass, named like `src/render/passes/*.rs`, and `shaders/methods/NAME` has the passes
//! of `src/render/methods/NAME`; only files in a folder `lib` can be imported.
//!
//! The feature `window` (default) of this package and of `reflet-preview` is the preview's window; machines that only
//! render do without its packages.
//!
//! Where does new code go? A key of the scene format: `scene/desc.rs`. Code that reads asset files: `world/`. Code that
//! needs a device: `gpu/` if it is independent of scenes, else `render/`. Code that judges a picture: `metric/`; that
//! writes one: `output/`.
//!
//! # A frame
//!
//! 0. **Pose**: meshes with skins or morph targets are deformed on the CPU ([`world::deform`]), their
//!    trees refitted from the topology at rest, and the top level over instances built.
//! 1. **Shadow**: depth cube maps for point lights, flat maps for spot and directional ones; lights
//!    with `shadow = "ray"` need none. A map whose light and casters have not moved is not drawn
//!    again.
//! 2. **Visibility** rasterizes depth and ids (instance, triangle) and nothing else; spheres, points and lines are capsules
//!    ([`world::Mesh::capsule_radius_m`]), whose id stands for a triangle's, drawn as quadrilaterals in which every
//!    pixel tests its ray; with `image.visibility = "rays"`, **primary** finds the same ids by a ray a pixel.
//! 3. **Surface** resolves the G-buffer from the ids in compute and lists the reflective pixels. The
//!    function that turns (instance, triangle, barycentrics, footprint) into a surface is `surface_at`
//!    in `shaders/lib/surface.wgsl`; screen hits and traced hits use the same one.
//! 4. **Light** shades the surfaces that the camera sees: view-independent radiance, apart from the specular of
//!    this view. **Transmit** follows rays through the surfaces that pixels show, where some transmit light. **Indirect**
//!    finds light between matte surfaces (`diffuse_bounces`), which **denoise_indirect** smooths below 256 sub-frames.
//!    These two and **trace** below are dispatches of one shader, `shaders/paths.wgsl`, which drivers compile once.
//! 5. **Peel** rasterizes the second depth layer, where `reflection.layers` asks for it. **Pyramid** keeps the nearest depth of ever larger cells of pixels.
//! 6. **SSR** walks the listed pixels' mirror rays through the pyramid, cell by cell, and decides what
//!    each ray hits ([`render::pipeline::cause::Cause`]): `accept_verified` in `shaders/ssr.wgsl` accepts a triangle
//!    or plane that the ray is shown to meet, `accept_by_threshold` a crossing by the paper's rule. Hits are
//!    listed, and so are the rays to trace, with the distance proven free where the ray left the
//!    picture. **Arguments** sizes the dispatches over lists.
//! 7. With `reflection.rate` above 1 **split_rays** lets **trace** follow one of several rays first, and between leaders whose
//!    hits agree **upsample** reuses their hits. **Trace** follows the listed rays through the static tree and the top level over instances,
//!    bounce by bounce, and shades accepted hits at the point where the ray meets the surface, with the ray's footprint. With `reflection.trace = "query"` the device's ray queries find candidates in the structures of
//!    [`render::upload::structures`], for these and all other rays; our own tests choose among them.
//! 8. **Filter** (rough reflections, below 256 sub-frames), **blur** (if asked for), **compose** (only the
//!    mirror term is replaced, and transmitted light is added), **guides** (where a picture is denoised), **tone**.
//!
//! Settings that a scene leaves to `auto` (method, visibility, shadows, exposure) are decided before a renderer is
//! built: [`render::decide`] follows rays of the view on the CPU, counts, and weighs the counts by the unit costs
//! of the adapter's kind. Nothing is timed, so that every machine of a kind decides alike.
//!
//! Everything with an extent (a panorama, a light with a size, a rough reflection) is sampled:
//! `shaders/lib/sampling.wgsl` gives every pixel and sub-frame its own random numbers, and reflection rays and
//! light samples are combined by multiple importance sampling, so that sub-frames converge.
//! Glass, blended alpha and clear coats are layers of a surface (`shaders/lib/layers.wgsl`): at the surface
//! of a pixel both the reflection and the transmission are followed; at later hits one layer is chosen with a
//! probability in proportion to the light that it returns.
//! [`render::pipeline::shader_variant`] keeps that code out of shaders whose scene needs none of it.
//!
//! Method `rt` lists every reflective pixel as a ray and has no passes 5 and 6; `ssr` is `hybrid` with
//! the paper's threshold and without the tracing. A frame depends on nothing but its scene, its
//! settings and its camera, so any of them can be rendered alone.
//!
//! # A reload
//!
//! Saving a file reruns the stages that come after it in the diagram of the data flow, and no others.
//!
//! 1. [`reflet_preview::watch`] tells which kind of file has new content.
//! 2. [`reflet_preview::live::ReloadJob`] reads the text, runs the script and poses the first frame and the shown
//!    frame; the preview does it on a thread of its own. A newer save cancels the job ([`scene::script::Halt`]).
//! 3. [`runtime::Session::show`] does the rest, as for [`runtime::Session::set`]: [`world::load::AssetCache`] builds
//!    instances and materials anew from the files that are in memory already.
//! 4. [`render::Renderer::change`] compares meshes and textures by identity, and trees, materials, poses and bindings
//!    by value, and rebuilds whatever differs. Shaders are cached by their text, pipelines by their shader.
//!
//! Every step builds its results beside the current ones and swaps them at its end, so that an error changes nothing.
//! Other values of the script's parameters are a reload too; values that fail although the scene without them does not
//! are refused ([`reflet_preview::live::Refusal`]). Showing another frame takes only [`scene::stages::Scene::pose`],
//! [`world::World::apply`] and [`render::Renderer::update`].
//!
//! # Rules
//!
//! - Every pipeline stays inside `wgpu::Limits::default()` but for buffer and texture sizes, which
//!   are checked by name, for the number of storage buffers where geometry exceeds one
//!   (`render/buffers/chunks.rs`), and on software adapters for the number of textures, sampled or storage, that hold
//!   the scene (`gpu/adapter.rs`). `tests/shaders` asserts it by reflection.
//! - Shaders follow a world's indices unchecked in the tracing module, so [`render::check_world`] checks
//!   them before an upload, and every later call that the world is the uploaded one, posed anew.
//! - Every ray has one budget of nodes that it may visit (`shaders/lib/bvh.wgsl`); one that needs more is a
//!   miss, counted in the frame's statistics.
//! - `unsafe` is used in nine places, each with its reason: `src/main.rs` sets environment variables
//!   before any thread exists, `src/gpu/pipeline.rs` turns off run-time checks of a built-in shader,
//!   `src/gpu/experimental.rs` lets devices of scenes that ask for it use ray queries, which wgpu calls experimental,
//!   `src/gpu/brought_driver.rs` loads the Vulkan loader that a release brings, `src/gpu/kept_pipelines.rs` hands a driver the
//!   pipelines that it compiled in an earlier run, `src/gpu/wait.rs` calls the page's function that suspends WebAssembly, `src/base/processor_time.rs` reads CPU clocks that the standard
//!   library lacks, `src/world/usd/tool.rs` has the converter end with its parent, and `src/output/denoise.rs` calls a C
//!   library that it loads at run time.
//! - No import cycles: the modules of one parent can be read in some order (`tests/layers`).
//! - A dependency on another package stands in the manifest of the crates that use it; its version and its reason
//!   stand once, in the workspace's `Cargo.toml`.
//! - Numbers and structs that Rust and the shaders share are written once, in Rust, and generated into
//!   `lib/constants.wgsl` and `lib/structs.wgsl`.
//! - Groups 0 (frame) and 1 (scene) are shared; group 2 is the pass's own, reflected from its WGSL
//!   and bound by name. A name that is missing on either side is an error that names the file.
//! - Shader imports are plain text inclusion, once per file, with a line map: names must survive for
//!   binding by name and for pipeline overrides, which rules out importers that mangle them.
//! - Vectors name their spaces (`clip_from_world`), quantities their units (`threshold_m`). The
//!   length U is the diagonal of the static bounding box / 16, so that the paper's settings carry
//!   over between scenes.

pub mod app;

pub use reflet_base::{files, math, memory};
pub use reflet_bench as bench;
pub use reflet_gpu as gpu;
pub use reflet_metric as metric;
pub use reflet_output as output;
pub use reflet_render::{self as render, runtime};
pub use reflet_scene as scene;
pub use reflet_world as world;
