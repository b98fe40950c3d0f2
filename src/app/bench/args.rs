//! Command-line arguments of `bench`.

use std::path::PathBuf;

use clap::{
    Arg, Args, Command, Id, Subcommand,
    builder::{PossibleValuesParser, TypedValueParser},
};

use super::reload::ReloadArgs;
use crate::{
    app::args::{SceneArgs, parse_size},
    bench::{choose::Bound, parameter::Parameter, sample::curve::compared_methods},
    scene::desc::Method,
};

/// Arguments that apply to a table that is drawn again (`--samples`); all others say how to measure.
const DRAWING: [&str; 3] = ["output", "choose", "samples"];

/// The command, whose `--samples` conflicts with all arguments that say how to measure.
fn without_measuring(command: Command) -> Command {
    let all = command.get_arguments().map(Arg::get_id);
    let measuring = all.filter(|id| !DRAWING.contains(&id.as_str()));
    let measuring: Vec<Id> = measuring.cloned().collect();
    command.mut_args(|arg| match arg.get_id() == "samples" {
        true => arg.conflicts_with_all(&measuring),
        false => arg,
    })
}

/// Parser of a method that can be compared.
fn compared() -> impl TypedValueParser<Value = Method> {
    PossibleValuesParser::new(compared_methods())
        .map(|name| Method::from_name(&name).expect("one of the possible values"))
}

/// Parser of a parameter.
fn varied() -> impl TypedValueParser<Value = Parameter> {
    PossibleValuesParser::new(Parameter::ALL.map(Parameter::name))
        .map(|name| Parameter::from_name(&name).expect("one of the possible values"))
}

/// `bench`
#[derive(Clone, Debug, Args)]
#[command(args_conflicts_with_subcommands = true, defer(without_measuring))]
pub struct BenchArgs {
    /// Experiment to run in place of a comparison
    #[command(subcommand)]
    pub experiment: Option<Experiment>,
    /// Scene files; without one, the built-in atrium
    pub scenes: Vec<PathBuf>,
    /// Changes to the scenes
    #[command(flatten)]
    pub from: SceneArgs,
    /// Methods to compare
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        value_parser = compared(),
        default_value = "ssr,hybrid,rt"
    )]
    pub methods: Vec<Method>,
    /// Parameter to vary; without it each method's own (ssr: steps, hybrid: threshold_u and edge_px, rt: bounces, both
    /// also reuse_light)
    #[arg(long, value_name = "PARAMETER", value_parser = varied())]
    pub parameter: Option<Parameter>,
    /// Values of the parameter, such as 0.005,0.025,0.065
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        requires = "parameter"
    )]
    pub values: Vec<f64>,
    /// Sizes such as 640x360,1280x720; without any, the scene's own
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_size)]
    pub sizes: Vec<[u32; 2]>,
    /// Frames of the scenes' timeline to pose and measure, each with every setting and size: all, or
    /// a list such as 0-95:8 or 1,3,5-9; without it, the first. --frames says how often each is
    /// timed
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub timeline: Option<String>,
    /// Also score every setting against a picture of method `path` with this many samples, 1 to 4096, as a scene "NAME
    /// against path": the model's error beside the method's. Still scenes only
    #[arg(
        long,
        value_name = "SAMPLES",
        value_parser = clap::value_parser!(u32).range(1..=4096),
        conflicts_with = "timeline"
    )]
    pub against_path: Option<u32>,
    /// Camera of the scenes; without it `main`, else the first
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Measurement and output options
    #[command(flatten)]
    pub run: RunArgs,
    /// Draw the report of this table of samples and measure nothing
    #[arg(long, value_name = "CSV")]
    pub samples: Option<PathBuf>,
    /// Print the cheapest setting that meets a bound as a `[reflection]` block: "ssim>=0.98", "psnr>=40", "flip<=0.01",
    /// "relmse<=0.001" or "ms<=4". Errors are measured inside the reflective pixels if all settings have enough of
    /// them, else in the whole frame; the block says which
    #[arg(long, value_name = "BOUND", value_parser = Bound::parse)]
    pub choose: Option<Bound>,
}

/// Options of the measurement, and the output folder.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// Timed frames of each setting, 1 to 100000; from 20 on, percentiles are reported. --timeline
    /// says which frames of an animation are timed
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: u32,
    /// Untimed frames of each setting before the timed ones, 1 to 1000
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub warm_up: u32,
    /// Count march steps, traversals, visited nodes and tested triangles in one more frame of each
    /// setting; always on a software adapter, where they say more than its milliseconds
    #[arg(long)]
    pub counters: bool,
    /// After each timed frame, time the rays of the trace pass without shading in a frame of its
    /// own
    #[arg(long)]
    pub split_trace: bool,
    /// Folder for samples.csv, bench.json, report.html and the charts; created if it is missing
    #[arg(short, long, value_name = "DIR", default_value = "bench")]
    pub output: PathBuf,
    /// Add to the samples that the folder holds, measuring only what they lack
    #[arg(long)]
    pub resume: bool,
    /// Read the shaders from a folder instead of the built-in ones
    #[arg(long, value_name = "DIR")]
    pub shaders: Option<PathBuf>,
    /// Use the adapter whose name contains this; also REFLET_ADAPTER
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Experiments other than a comparison of settings.
#[derive(Clone, Debug, Subcommand)]
pub enum Experiment {
    /// Measure the time that pictures take to error bounds (`samples = { error = … }`), and their error
    Bounds(BoundsArgs),
    /// Measure the time from a save to the new picture in the preview
    Reload(ReloadArgs),
    /// Compare the choice of `auto` with the fastest alternative
    Regret(RegretArgs),
    /// Set other ways of finding reflections beside Reflet's own
    Comparators(ComparatorsArgs),
    /// Find failures of methods: scores of a suite of failure modes, or of your own scenes
    Stability(StabilityArgs),
}

/// Arguments of `bench bounds`.
#[derive(Clone, Debug, Args)]
pub struct BoundsArgs {
    /// Scene file or model; without one, the built-in atrium. Its first frame is rendered, and its `samples` are
    /// ignored
    pub scene: Option<PathBuf>,
    /// Changes to the scene
    #[command(flatten)]
    pub from: SceneArgs,
    /// Bounds of the error
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "0.04,0.02,0.01"
    )]
    pub bounds: Vec<f64>,
    /// Largest number of samples, 16 to 4095
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(16..=4095))]
    pub at_most: u32,
    /// Samples of the reference, more than any picture has, 17 to 4096
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(17..=4096))]
    pub reference: u32,
    /// Width and height; without it, the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Folder for bounds.json and the charts; created if it is missing
    #[arg(short, long, value_name = "DIR", default_value = "bench")]
    pub output: PathBuf,
    /// Use the adapter whose name contains this; also REFLET_ADAPTER
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Arguments of `bench regret`.
#[derive(Clone, Debug, Args)]
pub struct RegretArgs {
    /// Scene files; without one, the built-in atrium. Their own method and visibility are ignored
    pub scenes: Vec<PathBuf>,
    /// Changes to the scenes
    #[command(flatten)]
    pub from: SceneArgs,
    /// Sizes; without any, 640x360,1280x720,1920x1080
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_size)]
    pub sizes: Vec<[u32; 2]>,
    /// Timed frames of each alternative, 1 to 10000, after one untimed frame
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub frames: u32,
    /// Print the table as JSON
    #[arg(long)]
    pub json: bool,
    /// Use the adapter whose name contains this; also REFLET_ADAPTER
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Arguments of `bench comparators`.
#[derive(Clone, Debug, Args)]
pub struct ComparatorsArgs {
    /// Scene files
    #[arg(required = true)]
    pub scenes: Vec<PathBuf>,
    /// Changes to the scenes
    #[command(flatten)]
    pub from: SceneArgs,
    /// Size of all pictures
    #[arg(long, value_name = "WxH", default_value = "192x108", value_parser = parse_size)]
    pub size: [u32; 2],
    /// Timed pictures of each system and still, 1 to 1000
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub frames: u32,
    /// Frames of scenes with a timeline, such as 0-23:2
    #[arg(long, value_name = "LIST", default_value = "all")]
    pub timeline: String,
    /// Folder for systems.csv, best.csv, frames.csv, report.html and the charts; created if it is missing
    #[arg(short, long, value_name = "DIR", default_value = "bench")]
    pub output: PathBuf,
    /// Use the adapter whose name contains this; also REFLET_ADAPTER
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Arguments of `bench stability`.
#[derive(Clone, Debug, Args)]
pub struct StabilityArgs {
    /// Modes of the suite, by number (3) or name (03-rails), or scene files; without any, the whole
    /// suite, or the modes in the file of --ratchet
    pub modes: Vec<String>,
    /// Changes to the scenes
    #[command(flatten)]
    pub from: SceneArgs,
    /// Folder of the suite's scenes, NN-name.toml
    #[arg(long, value_name = "DIR", default_value = "scenes/fail")]
    pub suite: PathBuf,
    /// Methods to score; hybrid by both of its rules of acceptance
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        value_parser = compared(),
        default_value = "ssr,hybrid,rt"
    )]
    pub methods: Vec<Method>,
    /// Size of all pictures; without it, the scenes' own, or the ratchet's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Score the first frame alone of scenes with a timeline
    #[arg(long)]
    pub stills: bool,
    /// Compare stills with the worst scores that this file allows (exit code 6 where one is worse)
    #[arg(long, value_name = "FILE")]
    pub ratchet: Option<PathBuf>,
    /// Write scores that are better than the ratchet's, and missing ones, into it; never worse ones
    #[arg(long, requires = "ratchet")]
    pub tighten: bool,
    /// Show pictures in stability.html: for each mode its worst one by each method, the sources of hybrid's
    /// reflections, and its errors
    #[arg(long)]
    pub pictures: bool,
    /// Folder for samples.csv, stability.csv and stability.html; created if it is missing
    #[arg(short, long, value_name = "DIR", default_value = "bench")]
    pub output: PathBuf,
    /// Add to the samples that the folder holds, measuring only what they lack
    #[arg(long)]
    pub resume: bool,
    /// Read the shaders from a folder instead of the built-in ones
    #[arg(long, value_name = "DIR")]
    pub shaders: Option<PathBuf>,
    /// Use the adapter whose name contains this; also REFLET_ADAPTER
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}
