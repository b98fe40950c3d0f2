//! The arguments of the commands: their names, ranges and help.

use std::{
    path::{Path, PathBuf},
    time::Duration,
};

use clap::{
    Args, ValueEnum,
    builder::{PossibleValue, PossibleValuesParser, TypedValueParser},
};

pub use super::size_arg::{SizeArg, parse_crop, parse_size, parse_size_or_name, parse_time};
use super::{error::AppError, lint::since::VERSION, relight::Light};
use crate::{
    files::Goal,
    output::frames::{Shard, parse_shard},
    render::Crop,
    runtime::scene_text::SceneOptions,
    scene::{
        declared::Words,
        desc::Method,
        syntax::{Content, value_text},
    },
};

/// Source of the scene, and overrides of its values.
#[derive(Clone, Debug, Default, Args)]
pub struct SceneArgs {
    /// Change a value of the scene, such as reflection.threshold_u=0.01; repeatable
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<String>,
    /// Lay [variant.NAME] of the scene over it; repeatable, the later over the earlier. Without it, the project's
    /// variants; "" is none
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub variant: Vec<String>,
    /// Folder to search for models, textures, bases and included files after the scene's own;
    /// repeatable. The folders of REFLET_ASSETS come last
    #[arg(long, value_name = "DIR")]
    pub assets: Vec<PathBuf>,
    /// Load glTF files without references to scenes, nodes and meshes that they do not have. A node of several parents
    /// stays with the first. Each kind has a warning
    #[arg(long)]
    pub lenient: bool,
    /// Refuse models with wrong parts that are else left out or replaced with a warning, such as images that are
    /// missing, lights and channels of animations
    #[arg(long, conflicts_with = "lenient")]
    pub strict: bool,
    /// File or folder of the scene's project, in place of the reflet.toml that is found in its folder or above
    #[arg(long, value_name = "PATH", conflicts_with = "no_project")]
    pub project: Option<PathBuf>,
    /// Look for no reflet.toml, so that the scene reads files below its own folder and folders of --assets alone
    #[arg(long)]
    pub no_project: bool,
}

impl SceneArgs {
    /// Options for opening the scene.
    pub fn options(&self) -> SceneOptions {
        SceneOptions {
            set: self.set.clone(),
            variant: self.variant.clone(),
            assets: self.assets.clone(),
            lenient: self.lenient,
            strict: self.strict,
            project: self.project_choice(),
            ..SceneOptions::default()
        }
    }
}

/// Settings of rendered pictures that do not depend on the frame, for `render` and for the tasks of `job`, which pass
/// all of them on.
#[derive(Clone, Debug, Args)]
pub struct PictureArgs {
    /// Overrides of scene values
    #[command(flatten)]
    pub from: SceneArgs,
    /// Width and height in pixels, each 1 to 16384; a width alone, whose height is as in the scene's proportions; or the
    /// name of a size of the project
    #[arg(long, value_name = "WxH", value_parser = parse_size_or_name)]
    pub size: Option<SizeArg>,
    /// Light in place of the scene's lights, their motion and environment: outdoor, studio, or a panorama (.hdr, .exr).
    /// A script that sets a light by its name fails
    #[arg(long, value_name = "LIGHT")]
    pub light: Option<Light>,
    /// Color of the background that the camera sees in place of the environment, such as "#202020"; its light and
    /// reflections stay
    #[arg(long, value_name = "COLOR")]
    pub background: Option<String>,
    /// Turn the camera once around the scene in this time, such as 4s, at 24 frames a second or as many as its timeline
    /// has
    #[arg(long, value_name = "TIME", value_parser = parse_time, conflicts_with = "camera")]
    pub turntable: Option<Duration>,
    /// Part of the picture to write: left and top edge, width and height in pixels. It has the same pixels as the whole
    /// picture
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_crop, allow_hyphen_values = true)]
    pub crop: Option<Crop>,
    /// How reflections are found
    #[arg(long, value_parser = method())]
    pub method: Option<Method>,
    /// Camera of the scene, or all but cameras of placed scenes, or a list such as main,side, with {camera} in the name
    /// of the output; without it `main`, else the first
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Sub-frames averaged, 1 to 4096
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub samples: Option<u32>,
    /// AOVs to write too, such as depth,normal,source,cause, light:NAME (a light group alone) or light:* (all): layers
    /// of an EXR, or OUT.NAME.png beside a PNG, in which distances run from white (near) to black, and reflectance from
    /// 0 to 255, as `compare --mask` takes it
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub aov: Vec<String>,
    /// Remove noise with Intel Open Image Denoise, where that library is installed (REFLET_OIDN names its folder),
    /// guided by each pixel's albedo and normal over all samples, in sharp mirrors by the reflected albedo
    #[arg(long)]
    pub denoise: bool,
    /// Frames before and after each frame of a film over which `--denoise` averages pixels of the same surface, 0 to 8,
    /// never across a cut: more leave less flicker, and take more time and memory
    #[arg(long, value_name = "N", default_value_t = DENOISE_WINDOW, value_parser = clap::value_parser!(u32).range(0..=8))]
    pub denoise_window: u32,
    /// Read the shaders from a folder instead of the built-in ones
    #[arg(long, value_name = "DIR")]
    pub shaders: Option<PathBuf>,
    /// Use the GPU adapter whose name contains this text, or a `software` one; also REFLET_ADAPTER
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Default of `--denoise-window`.
const DENOISE_WINDOW: u32 = 2;

/// Words of a command line that pass [`PictureArgs`] on.
#[derive(Default)]
pub struct PictureWords<'a> {
    /// Words that hold on any machine.
    pub options: Vec<String>,
    /// Options that name files or folders, but for asset folders.
    pub paths: Vec<(&'static str, &'a Path)>,
}

impl PictureArgs {
    /// The arguments with light and background as overrides of a scene, before all others.
    ///
    /// # Errors
    /// Same errors as [`Light::overrides`].
    pub fn lit(&self, scene: Option<&Path>) -> Result<Self, AppError> {
        let mut lit = self.clone();
        if let Some(color) = lit.background.take() {
            let color = match color.starts_with('[') {
                true => color,
                false => value_text(&Content::String(color)),
            };
            let set = format!("environment.background={color}");
            lit.from.set.insert(0, set);
        }
        if let Some(light) = lit.light.take() {
            let (set, folder) = light.overrides(&lit.from.assets, scene)?;
            lit.from.set.splice(0..0, set);
            lit.from.assets.extend(folder);
        }
        Ok(lit)
    }

    /// Words that pass these arguments on, but for the folders of assets.
    pub fn words(&self) -> PictureWords<'_> {
        // Without `..`, so that an argument that is added does not compile until it is passed on.
        let Self {
            from:
                SceneArgs {
                    set,
                    variant,
                    assets: _,
                    lenient,
                    strict,
                    project,
                    no_project,
                },
            size,
            // Part of `from`, see `render::turned`.
            light: _,
            background: _,
            turntable: _,
            crop,
            method,
            camera,
            samples,
            aov,
            denoise,
            denoise_window,
            shaders,
            adapter,
        } = self;
        let size = size.as_ref().map(SizeArg::word);
        let method = method.map(|method| method.name().to_owned());
        let window =
            (*denoise && *denoise_window != DENOISE_WINDOW).then(|| denoise_window.to_string());
        let aov = (!aov.is_empty()).then(|| aov.join(","));
        let repeated = [("--set", set), ("--variant", variant)];
        let repeated = repeated
            .into_iter()
            .flat_map(|(name, all)| all.iter().map(move |value| (name, value.clone())));
        let single = [
            ("--size", size),
            ("--crop", crop.map(|crop| crop.to_string())),
            ("--method", method),
            ("--camera", camera.clone()),
            ("--samples", samples.map(|samples| samples.to_string())),
            ("--aov", aov),
            ("--denoise-window", window),
            ("--adapter", adapter.clone()),
        ];
        let single = single
            .into_iter()
            .filter_map(|(name, value)| Some((name, value?)));
        let valued = repeated.chain(single);
        let mut options: Vec<_> = valued
            .flat_map(|(name, value)| option_words(name, &value))
            .collect();
        for (name, is_set) in [
            ("--denoise", denoise),
            ("--lenient", lenient),
            ("--strict", strict),
            ("--no-project", no_project),
        ] {
            options.extend(is_set.then(|| name.to_owned()));
        }
        let paths = [("--shaders", shaders), ("--project", project)];
        let paths = paths
            .into_iter()
            .filter_map(|(name, path)| Some((name, path.as_deref()?)));
        PictureWords {
            options,
            paths: paths.collect(),
        }
    }
}

/// `render`
#[derive(Clone, Debug, Args)]
pub struct RenderArgs {
    /// Scene file or model; without one, the built-in atrium
    pub scene: Option<PathBuf>,
    /// Picture to write, without it the project's: .png (tone-mapped) or .exr (linear radiance), with #### (at most 20)
    /// where the number of a frame goes, or %04d, $F4, <frame> or {frame:04}; or a film: .apng, or .mp4, .mov, .mkv,
    /// .webm, .gif or .webp through ffmpeg
    #[arg(short, long, value_name = "FILE", value_hint = clap::ValueHint::AnyPath)]
    #[allow(rustdoc::invalid_html_tags, reason = "the text is that of --help")]
    pub output: Option<Goal>,
    /// Frames of the scene's timeline, or of a model's animation: all, or a list such as 0-949, 1-20:2 or 1,3,5-9.
    /// Default: all where the output is a film or has #### in its name, else the first
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub frames: Option<String>,
    /// Keep the files of frames that were made from the same scene, settings and version
    #[arg(long)]
    pub resume: bool,
    /// Render again whenever a file of the scene is saved, until it is stopped
    #[arg(long, conflicts_with_all = ["resume", "shard", "stats"])]
    pub watch: bool,
    /// Form of the progress report; without it a bar on a terminal, elsewhere a line for each frame, and for one picture
    /// a line a minute
    #[arg(long, value_name = "FORM")]
    pub progress: Option<ProgressForm>,
    /// Ctrl-C and SIGTERM end a picture after the samples that have begun and write the mean of its samples so far, without AOVs
    /// and not denoised; without this option nothing is written
    #[arg(long)]
    pub keep_partial: bool,
    /// Write a picture so far again and again while it is rendered, such as every 10s or 2m, without AOVs and not
    /// denoised, in place of the output
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    pub write_every: Option<Duration>,
    /// Render only the I-th of N parts of the frames, for several machines
    #[arg(long, value_name = "I/N", value_parser = parse_shard)]
    pub shard: Option<Shard>,
    /// Settings of the pictures
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Print pass times, shares by source and cause, rays and memory; a software adapter renders a first
    /// sub-frame twice, once to compile
    #[arg(long, value_name = "FORM")]
    pub stats: Option<StatsForm>,
    /// With --stats, also count march steps, traversals, visited BVH nodes and tested triangles, in one
    /// more frame; the counts do not depend on the machine
    #[arg(long, requires = "stats")]
    pub counters: bool,
}

impl RenderArgs {
    /// Arguments for pictures of a scene that another command writes.
    pub fn for_pictures(scene: Option<&Path>, picture: &PictureArgs) -> Self {
        Self {
            scene: scene.map(Path::to_owned),
            output: None,
            frames: None,
            resume: false,
            watch: false,
            progress: None,
            keep_partial: false,
            write_every: None,
            shard: None,
            picture: picture.clone(),
            stats: None,
            counters: false,
        }
    }

    /// File to write; empty as long as the project has not given it.
    pub fn output(&self) -> &Goal {
        static NONE: Goal = Goal::typed(PathBuf::new());
        self.output.as_ref().unwrap_or(&NONE)
    }
}

/// `preview`
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Left drag orbits, right drag looks around and flies with W A S D Q E, the \
                        wheel goes closer, a click selects an instance and its material, F frames \
                        it, Esc lets it go, Space plays and pauses, the arrow keys step by \
                        frames, B wipes between two methods or textures, X maps the error \
                        against rt, F12 writes what is shown, H lists all keys. Script \
                        parameters have sliders. After a mistake in a file the last good picture \
                        stays, with the place of the mistake over it."
)]
pub struct PreviewArgs {
    /// Scene file or model; without one, the built-in atrium
    pub scene: Option<PathBuf>,
    /// Overrides of scene values
    #[command(flatten)]
    pub from: SceneArgs,
    /// Width and height of the window, or the name of a size of the project
    #[arg(long, value_name = "WxH", value_parser = parse_size_or_name)]
    pub size: Option<SizeArg>,
    /// Reflection method to show first
    #[arg(long, value_parser = method())]
    pub method: Option<Method>,
    /// Camera of the scene to look through at first; without it `main`, else the first
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Read the shaders from a folder instead of the built-in ones, and reload them when they change
    #[arg(long, value_name = "DIR")]
    pub shaders: Option<PathBuf>,
    /// Folder for screenshots (F12); without it, the current folder
    #[arg(long, value_name = "DIR")]
    pub screenshots: Option<PathBuf>,
    /// Refuse to start where Intel Open Image Denoise, which denoises pictures at rest, is not installed
    #[arg(long)]
    pub denoise: bool,
    /// Show pictures at rest with their noise
    #[arg(long, conflicts_with = "denoise")]
    pub no_denoise: bool,
    /// Show a page for browsers instead of the window, and print its address with a token; on a free port of this
    /// machine alone, unless an address is given: HOST:PORT, HOST or :PORT
    #[cfg(feature = "serve")]
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "", conflicts_with = "screenshots")]
    pub serve: Option<String>,
    /// Use the GPU adapter whose name contains this text, or a `software` one; also REFLET_ADAPTER
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// `check`
#[derive(Clone, Debug, Args)]
pub struct CheckArgs {
    /// Scene files or models; of a folder all, and of the folders below; - reads scene text from standard input
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Overrides of scene values
    #[command(flatten)]
    pub from: SceneArgs,
    /// Also list what to write in scenes of that version, whose defaults have changed, for their look of then
    #[arg(long, value_name = "VERSION", value_parser = [VERSION])]
    pub since: Option<String>,
    /// Print all messages as a SARIF 2.1.0 log, for editors and continuous integration
    #[arg(long)]
    pub json: bool,
}

/// Format of printed statistics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StatsForm {
    /// One JSON object on standard output
    Json,
    /// A table
    Text,
}

/// Form in which progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressForm {
    /// A bar with the remaining time, on standard error; nothing where that is no terminal
    Bar,
    /// A line for each frame, or for each ten seconds of one picture, on standard error
    Lines,
    /// A JSON object for each frame, or for each sample of one picture, on standard output
    Json,
    /// Lines that a worker of Open Job Description reads, on standard output
    Openjd,
}

/// Parser of a method of reflections.
fn method() -> impl TypedValueParser<Value = Method> {
    let words = Method::WORDS.iter();
    PossibleValuesParser::new(words.map(|word| PossibleValue::new(word.name).help(word.summary)))
        .map(|name| Method::from_name(&name).expect("one of the possible values"))
}

/// Words of an option on a command line. A value that begins with a hyphen is joined to its option, since it would be
/// read as another option.
pub fn option_words(name: &str, value: &str) -> Vec<String> {
    match value.starts_with('-') {
        true => vec![format!("{name}={value}")],
        false => vec![name.to_owned(), value.to_owned()],
    }
}
