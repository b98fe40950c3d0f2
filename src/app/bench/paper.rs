//! `bench paper`: the experiments of Macedo and Rodrigues (2018), each as scenes, settings and
//! pictures; on the built-in atrium where their models are missing.

use std::path::{Path, PathBuf};

use super::{
    args::{PaperArgs, PaperExperiment},
    comparators, open_gpu, report,
    report_pictures::{ReportPicture, gallery},
    run, scenario2, subject,
};
use crate::{
    app::{error::AppError, scene::load, shaders},
    bench::{
        parameter::Parameter,
        run::{FrameSeries, Protocol, Subject, Sweep},
    },
    output::frames::FrameList,
    runtime::scene_text::{ATRIUM, SceneOptions, SceneText, asset_folders},
    scene::desc::{Accept, Method, ReflectionDesc},
};

/// Picture size without `--sizes`: a CPU renders it in a second.
const SIZE: [u32; 2] = [640, 360];

/// Frames without `--timeline`: ten frames of the walk.
const FRAMES: &str = "0-949:95";

/// Name of the scene of the paper's experiments.
const SPONZA: &str = "Sponza";

/// The paper's three thresholds, in U.
const THRESHOLDS: [f64; 3] = [0.005, 0.025, 0.065];

/// Ray lengths of Scenario 3, in U.
const RAY_LENGTHS: [u32; 2] = [4, 16];

/// Scene of an experiment, as text.
struct Stage {
    /// Name of the scene in tables.
    place: &'static str,
    /// File name in messages.
    file: &'static str,
    text: &'static str,
    /// Cases of the experiment: the name of each, and the changes to the scene.
    cases: Vec<(String, Vec<String>)>,
}

/// A surface of Scenario 3 and the changes to the scene that show it.
type Surface = (&'static str, &'static [&'static str]);

const ON_FLOOR: &str = "instance.0.translation=[-4.4, 0.0, 0.0]";

/// Reflective surfaces of the paper, and the surfaces of the atrium that replace them.
const SURFACES: [(Surface, Option<Surface>); 5] = [
    (
        ("ground", &[]),
        Some(("ground", &["material.floor.reflection=\"mirror\""])),
    ),
    (
        (
            "ground with normal map",
            &["model.surface.file=\"ground_10m_normalmap.glb\""],
        ),
        None,
    ),
    (
        (
            "sphere",
            &[
                "model.surface.file=\"sphere_25k.glb\"",
                "instance.0.scale=2.0",
                ON_FLOOR,
            ],
        ),
        Some(("sphere", &["material.chrome.reflection=\"mirror\""])),
    ),
    (
        (
            "sphere with normal map",
            &[
                "model.surface.file=\"sphere_25k_normalmap.glb\"",
                "instance.0.scale=2.0",
                ON_FLOOR,
            ],
        ),
        None,
    ),
    (
        (
            "bunny",
            &[
                "model.surface.file=\"bunny_69k.glb\"",
                "instance.0.scale=2.0",
                "instance.0.rotation_deg=[0, -90, 0]",
                ON_FLOOR,
            ],
        ),
        Some(("brass cone", &["material.brass.reflection=\"mirror\""])),
    ),
];

/// Reflective materials of the atrium.
const ATRIUM_REFLECTORS: [&str; 4] = ["floor", "chrome", "brass", "glass_mirror"];

/// Runs an experiment and draws its report.
///
/// # Errors
/// Same errors as [`super::bench`].
pub fn paper(args: &PaperArgs) -> Result<(), AppError> {
    if args.timeline.is_some() && args.figure != PaperExperiment::Scenario2 {
        return Err(AppError::Usage(
            "--timeline: only scenario2 is a walk of frames; leave it out".to_owned(),
        ));
    }
    if args.systems && (args.figure != PaperExperiment::Scenario2 || args.sizes.len() > 1) {
        return Err(AppError::Usage(
            "--systems: only scenario2 is a walk of frames, and it is measured at one size; write \
             `scenario2 --sizes 320x180 --systems`; the other scenes are files in scenes/paper for \
             `bench comparators`"
                .to_owned(),
        ));
    }
    let stage = stage(args.figure, &asset_folders(&args.assets));
    let sizes = if args.sizes.is_empty() {
        vec![SIZE]
    } else {
        args.sizes.clone()
    };
    let mut protocol = Protocol {
        methods: vec![Method::Ssr, Method::Hybrid, Method::Rt],
        sweep: match args.figure {
            PaperExperiment::Fig1 => Sweep::One(Parameter::ThresholdU, thresholds()),
            _ => Sweep::Nothing,
        },
        sizes,
        frames: args.run.frames,
        warm_up: args.run.warm_up,
        count: args.run.counters,
        split_trace: args.run.split_trace || args.figure == PaperExperiment::Scenario1,
    };
    let is_walk = args.figure == PaperExperiment::Scenario2;
    let list = args.timeline.as_deref().unwrap_or(FRAMES);
    let frames = FrameList::parse("--timeline", list, &scenario2::TIMELINE)?;
    let series_of = |subject| match is_walk {
        true => scenario2::frame_series(subject, stage.place == SPONZA, &frames.0),
        false => Ok(FrameSeries::still(subject)),
    };
    let subjects = stage.subjects(&args.assets)?.into_iter();
    let mut all_series = subjects.map(series_of).collect::<Result<Vec<_>, _>>()?;
    if let (true, [walk]) = (args.systems, all_series.as_mut_slice()) {
        return comparators::along_walk(&args.run, protocol.sizes[0], walk);
    }
    let gpu = open_gpu(&args.run, all_series.iter().any(FrameSeries::may_query))?;
    protocol.count |= gpu.is_software();
    let samples = run(&gpu, &args.run, &protocol, &mut all_series)?;
    let library = shaders::library(args.run.shaders.as_deref())?;
    let mut galleries = Vec::new();
    for series in &mut all_series {
        let subject = series
            .posed_at(scenario2::TIMELINE.end / 4)
            .map_err(AppError::Scene)?;
        let shots = shots(args.figure, &subject.reflection);
        galleries.push(gallery(&gpu, &library, subject, protocol.sizes[0], &shots)?);
    }
    let title = match args.figure {
        PaperExperiment::Fig1 => "The paper's Fig. 1: the threshold T",
        PaperExperiment::Scenario1 => "The paper's Scenario 1: where the time goes",
        PaperExperiment::Scenario2 => "The paper's Scenario 2: a walk among moving figures",
        PaperExperiment::Scenario3 => "The paper's Scenario 3: surfaces and ray lengths",
    };
    report(&args.run.output, title, &samples, &galleries)?;
    Ok(())
}

/// Thresholds in U: 24 values from 0.0005 to 0.5, equal steps in their logarithm, and the paper's three.
fn thresholds() -> Vec<f64> {
    let step = |i: i32| 0.0005 * 1000f64.powf(f64::from(i) / 23.0);
    // Three digits, so that a reader can type the value again.
    let rounded = |value: f64| {
        let unit = 10f64.powf(value.log10().floor() - 2.0);
        let text = format!("{:.7}", (value / unit).round() * unit);
        text.parse().unwrap_or(value)
    };
    let mut values: Vec<f64> = (0..24).map(step).map(rounded).chain(THRESHOLDS).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Scene with the paper's models where all are found, otherwise the atrium, with a note to the user.
fn stage(experiment: PaperExperiment, folders: &[PathBuf]) -> Stage {
    let (file, text, models) = match experiment {
        PaperExperiment::Fig1 => (
            "sponza.toml",
            include_str!("../../../scenes/paper/sponza.toml"),
            &["sponza.glb"][..],
        ),
        PaperExperiment::Scenario1 => (
            "scenario1.toml",
            include_str!("../../../scenes/paper/scenario1.toml"),
            &["sponza.glb"][..],
        ),
        PaperExperiment::Scenario2 => (
            "scenario2.toml",
            include_str!("../../../scenes/paper/scenario2.toml"),
            &["sponza.glb", "buddha_50k.glb"][..],
        ),
        PaperExperiment::Scenario3 => (
            "scenario3.toml",
            include_str!("../../../scenes/paper/scenario3.toml"),
            &[
                "sponza.glb",
                "armadillo_70k.glb",
                "trex_40k.glb",
                "ground_10m.glb",
                "ground_10m_normalmap.glb",
                "sphere_25k.glb",
                "sphere_25k_normalmap.glb",
                "bunny_69k.glb",
            ][..],
        ),
    };
    let is_missing = |model: &&&str| !folders.iter().any(|folder| folder.join(model).is_file());
    let missing: Vec<&str> = models.iter().filter(is_missing).copied().collect();
    let has_models = missing.is_empty();
    if !has_models {
        reflet_base::error_line!(
            "{} is in no folder of --assets or REFLET_ASSETS: this runs on the built-in atrium \
             instead",
            missing.join(", ")
        );
    }
    let cases = match experiment {
        PaperExperiment::Fig1 => vec![("Fig. 1".to_owned(), Vec::new())],
        PaperExperiment::Scenario1 => vec![("Scenario 1".to_owned(), Vec::new())],
        PaperExperiment::Scenario2 => vec![("Scenario 2".to_owned(), moving(has_models))],
        PaperExperiment::Scenario3 => surfaces(has_models),
    };
    if has_models {
        Stage {
            place: SPONZA,
            file,
            text,
            cases,
        }
    } else {
        Stage {
            place: "built-in atrium",
            file: "atrium.toml",
            text: ATRIUM,
            cases,
        }
    }
}

/// Overrides that make the ball and the cone of the atrium move; its objects are static in the file.
fn moving(has_models: bool) -> Vec<String> {
    let things = if has_models { &[][..] } else { &["12", "13"] };
    let dynamic = |index: &&str| format!("instance.{index}.dynamic=true");
    things.iter().map(dynamic).collect()
}

fn surfaces(has_models: bool) -> Vec<(String, Vec<String>)> {
    let mut cases = Vec::new();
    for (in_paper, in_atrium) in SURFACES {
        let shown = if has_models {
            Some(in_paper)
        } else {
            in_atrium
        };
        let Some((name, shows)) = shown else {
            let name = in_paper.0;
            reflet_base::error_line!(
                "{name}: the built-in atrium has no such surface, so it is left out"
            );
            continue;
        };
        let mut changes = Vec::new();
        if !has_models {
            // One reflector at a time, as in the paper.
            let none = |m: &str| format!("material.{m}.reflection=\"none\"");
            changes.extend(ATRIUM_REFLECTORS.map(none));
        }
        changes.extend(shows.iter().map(|c| (*c).to_owned()));
        for length in RAY_LENGTHS {
            let mut changes = changes.clone();
            changes.push(format!("reflection.ray_length_u={length}"));
            cases.push((format!("Scenario 3, {name}, ray length {length}"), changes));
        }
    }
    cases
}

impl Stage {
    fn subjects(&self, assets: &[PathBuf]) -> Result<Vec<Subject>, AppError> {
        let load = |(what, changes): &(String, Vec<String>)| {
            let from = SceneOptions {
                set: changes.clone(),
                assets: assets.to_vec(),
                ..SceneOptions::default()
            };
            let text = SceneText::new(self.text, Path::new(self.file), &from);
            let opened = text.open(&[], &<_>::default());
            let loaded = load(opened.map_err(AppError::Scene)?, self.file.to_owned())?;
            let name = format!("{what} ({})", self.place);
            subject(loaded, name, None)
        };
        self.cases.iter().map(load).collect()
    }
}

/// Pictures that are shown of every scene.
fn shots(experiment: PaperExperiment, settings: &ReflectionDesc) -> Vec<ReportPicture> {
    let with = |method| ReflectionDesc {
        method,
        ..*settings
    };
    let threshold = |method, t: &f64| ReflectionDesc {
        accept: Accept::Threshold,
        threshold_u: *t as f32,
        ..with(method)
    };
    match experiment {
        PaperExperiment::Fig1 => {
            let mut shots = vec![ReportPicture::Picture(with(Method::Rt))];
            for method in [Method::Ssr, Method::Hybrid] {
                let of = |t: &f64| ReportPicture::Picture(threshold(method, t));
                shots.extend(THRESHOLDS.iter().map(of));
            }
            let of = |t: &f64| ReportPicture::Source(threshold(Method::Hybrid, t));
            shots.extend(THRESHOLDS.iter().map(of));
            shots
        }
        _ => vec![
            ReportPicture::Picture(with(Method::Rt)),
            ReportPicture::Picture(with(Method::Hybrid)),
            ReportPicture::Picture(with(Method::Ssr)),
            ReportPicture::Source(with(Method::Hybrid)),
            ReportPicture::Difference(with(Method::Hybrid)),
            ReportPicture::Difference(with(Method::Ssr)),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sweep_has_27_values_in_order() {
        let values = thresholds();
        assert_eq!(values.len(), 27);
        assert!(
            values.windows(2).all(|pair| pair[0] < pair[1]),
            "{values:?}"
        );
        assert_eq!((values[0], values[26]), (0.0005, 0.5));
        assert!(THRESHOLDS.iter().all(|t| values.contains(t)));
    }

    #[test]
    fn without_models_every_experiment_runs_in_the_atrium() {
        for experiment in [
            PaperExperiment::Fig1,
            PaperExperiment::Scenario1,
            PaperExperiment::Scenario2,
            PaperExperiment::Scenario3,
        ] {
            let stage = stage(experiment, &[]);
            assert_eq!(stage.place, "built-in atrium");
            let subjects = stage.subjects(&[]).expect("loads");
            let expected = if experiment == PaperExperiment::Scenario3 {
                6
            } else {
                1
            };
            assert_eq!(subjects.len(), expected);
            let shows = |name| subjects.iter().any(|s| s.name.contains(name));
            assert_eq!(
                (shows("bunny"), shows("brass cone")),
                (false, expected == 6),
                "the atrium has no bunny"
            );
            let moves = subjects[0].world.instances.iter().any(|i| i.dynamic);
            assert_eq!(moves, experiment == PaperExperiment::Scenario2);
        }
    }
}
