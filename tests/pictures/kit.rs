//! Renders scene text to a picture in one call, on one device for the whole test process.

use std::sync::OnceLock;

use reflet::{
    render::PlaneData,
    scene::{diagnostic::Diagnostic, stages::Animator},
    world::{Texture, TextureRef, Wrap, load},
};

// Names that most tests of pictures need, beside the functions below.
pub use crate::common::{
    first_or_all, folder::kept_folder, gpu_or_skip, is_long, sampled, shaders,
};
pub use glam::Vec3;
pub use reflet::{
    gpu::Gpu,
    render::{Picture, RenderOptions, Renderer, picture::aov::Aov, pipeline::cause::Cause},
    scene::{
        desc::{Method, SceneDesc, Visibility},
        stages::Scene,
    },
    world::World,
};
pub use std::{f32::consts::PI, fs, path::Path};

/// GPU device of the process; `None` where tests are skipped.
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(gpu_or_skip).as_ref()
}

/// Scene and world from text with `--set` overrides.
pub fn scene(text: &str, set: &[&str]) -> (SceneDesc, World) {
    scene_of(Path::new("test.toml"), text, set)
}

/// Scene and world from text as the contents of `file`, beside the images that it names.
pub fn scene_of(file: &Path, text: &str, set: &[&str]) -> (SceneDesc, World) {
    let (scene, world) = film_of(file, text, set);
    (scene.desc, world)
}

/// Scene that may move, and its world, from text as the contents of `file`.
pub fn film_of(file: &Path, text: &str, set: &[&str]) -> (Scene, World) {
    let all = |errors: Vec<Diagnostic>| -> String {
        errors.iter().map(|error| error.to_string()).collect()
    };
    let set: Vec<String> = set.iter().map(|&s| s.to_owned()).collect();
    let (scene, _) = or_panic!(Scene::from_text(text, file, &set).map_err(all));
    let world = or_panic!(load::load(&scene, &load::LoadOptions::default()).map_err(all));
    (scene, world)
}

/// Poses a world as it is in a frame.
pub fn pose(scene: &Scene, world: &mut World, frame: u32) {
    let state = Animator::new(scene).pose(frame).expect("a pose");
    world.apply(&state).expect("a world in this pose");
}

/// Renders with the plan that drops unused features.
pub fn render(gpu: &Gpu, text: &str, set: &[&str], aovs: &[Aov]) -> Picture {
    let (desc, world) = scene(text, set);
    renderer(gpu, &desc, &world, false).first_view(&world, aovs)
}

/// Picture of a world by a renderer of its own; `None` where tests are skipped.
pub fn picture(desc: &SceneDesc, world: &World, aovs: &[Aov]) -> Option<Picture> {
    Some(renderer(gpu()?, desc, world, false).first_view(world, aovs))
}

/// Pictures by a renderer on the device of the process; an error ends the test.
pub trait FirstView {
    /// Picture from the world's first camera.
    fn first_view(&mut self, world: &World, aovs: &[Aov]) -> Picture;

    /// Picture from the first camera of a world that has moved.
    fn moved_view(&mut self, world: &World, aovs: &[Aov]) -> Picture;
}

impl FirstView for Renderer {
    fn first_view(&mut self, world: &World, aovs: &[Aov]) -> Picture {
        let gpu = gpu().expect("the GPU of this renderer");
        or_panic!(self.picture(gpu, &world.cameras[0].value, aovs))
    }

    fn moved_view(&mut self, world: &World, aovs: &[Aov]) -> Picture {
        let gpu = gpu().expect("the GPU of this renderer");
        or_panic!(self.update(gpu, world));
        self.first_view(world, aovs)
    }
}

/// A renderer for a scene.
pub fn renderer(gpu: &Gpu, desc: &SceneDesc, world: &World, general: bool) -> Renderer {
    let mut options = RenderOptions {
        general,
        ..RenderOptions::for_scene(desc)
    };
    // Choices that tests rely on where the scene leaves them to `auto`.
    if options.reflection.method == Method::Auto {
        options.reflection.method = Method::Hybrid;
    }
    if options.image.visibility == Visibility::Auto {
        options.image.visibility = Visibility::Raster;
    }
    or_panic!(Renderer::new(gpu, &shaders(), world, &options))
}

/// Image of linear values, four bytes a texel.
pub fn linear_image(width: u32, height: u32, rgba: Vec<u8>) -> Texture {
    Texture {
        name: "made".to_owned(),
        width,
        height,
        rgba,
        srgb: false,
    }
}

/// Use of the first image as it is, by its interpolated texels.
pub const FIRST_IMAGE: TextureRef = TextureRef {
    texture: 0,
    uv_set: 0,
    transform: [Vec3::X, Vec3::Y],
    wrap: [Wrap::Repeat; 2],
    nearest: false,
};

/// Linear color of a pixel.
pub fn color(picture: &Picture, x: u32, y: u32) -> [f32; 3] {
    let at = 4 * (y * picture.size[0] + x) as usize;
    [
        picture.color[at],
        picture.color[at + 1],
        picture.color[at + 2],
    ]
}

/// Asserts that a pixel's linear color is `expected` within `tolerance` of each channel.
pub fn assert_color(picture: &Picture, x: u32, y: u32, expected: [f32; 3], tolerance: f32) {
    let found = color(picture, x, y);
    let close = found
        .iter()
        .zip(expected)
        .all(|(f, e)| (f - e).abs() <= tolerance);
    assert!(
        close,
        "pixel ({x}, {y}) is {found:?}, expected {expected:?} ± {tolerance}"
    );
}

/// Mean color of a picture.
pub fn mean(picture: &Picture) -> [f32; 3] {
    let [width, height] = picture.size;
    let mut sum = [0.0_f64; 3];
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        for (sum, value) in sum.iter_mut().zip(color(picture, x, y)) {
            *sum += f64::from(value);
        }
    }
    sum.map(|sum| (sum / f64::from(width * height)) as f32)
}

/// The plane of this AOV as floats.
pub fn floats(picture: &Picture, aov: Aov) -> &[f32] {
    match &plane(picture, aov).data {
        PlaneData::F32(values) => values,
        PlaneData::U32(_) => panic!("{} holds numbers of things", aov.name()),
    }
}

/// The plane of this AOV as integers.
pub fn integers(picture: &Picture, aov: Aov) -> &[u32] {
    match &plane(picture, aov).data {
        PlaneData::U32(values) => values,
        PlaneData::F32(_) => panic!("{} holds measures", aov.name()),
    }
}

fn plane(picture: &Picture, aov: Aov) -> &reflet::render::Plane {
    let found = picture.planes.iter().find(|p| p.name == aov.name());
    found.unwrap_or_else(|| panic!("{} was not asked for", aov.name()))
}

/// Share of pixels whose display color differs by more than `levels` of 255 in some channel.
pub fn share_differing(a: &Picture, b: &Picture, levels: u8) -> f64 {
    assert_eq!(a.size, b.size);
    let pairs = a.display.chunks_exact(4).zip(b.display.chunks_exact(4));
    let differing = pairs
        .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > levels))
        .count();
    differing as f64 / f64::from(a.size[0] * a.size[1])
}

/// Two mirrors with emission 0.1 and reflectance 1/2 face each other; the camera stands between.
pub const FACING: &str = include_str!("kit/facing.toml");
