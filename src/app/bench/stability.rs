//! `bench stability`: scores of failure modes, their report and their ratchet file.

use std::path::Path;

use super::{
    args::{RunArgs, StabilityArgs},
    methods, of_file, open_gpu, sample, subject,
    timeline::frame_series,
    write,
};
use crate::{
    app::{
        error::AppError,
        print_out,
        scene::{check_reports, load_scene},
        shaders,
    },
    bench::{
        hash::Hash,
        report::page::page,
        run::{FrameSeries, Protocol, Subject, Sweep},
        sample::{Sample, curve::THRESHOLD_SERIES},
        stability::{Cell, Mode, Part, ReferenceKind, cells, heat_map, ratchet::Ratchet, table},
    },
    files::{Goal, write_whole},
    runtime::scene_text::LoadedScene,
    scene::desc::{Method, Samples, ShadowMode},
};

mod pictures;
mod suite;

use suite::Choice;

/// Number of sub-frames of the truth.
const TRUTH_SAMPLES: u32 = 64;
/// Picture size of a new ratchet, pixels.
const RATCHET_SIZE: [u32; 2] = [160, 90];
/// Number of the mode about picture sizes, and the sizes at which it is scored beside its own.
const SIZES: (u32, [[u32; 2]; 2]) = (12, [[80, 45], [161, 91]]);
/// Number of the mode that is far from the origin, and the override that moves its truth to the origin.
const FAR_AWAY: (u32, &str) = (26, "params.distance_m=0.0");

/// Measurements of every scene.
struct Plan<'a> {
    args: &'a StabilityArgs,
    size: Option<[u32; 2]>,
    stills: bool,
    truth: bool,
}

/// Runs the command `bench stability`.
///
/// # Errors
/// Modes and files that do not exist, scenes that do not load, errors of the renderer, and
/// [`AppError::THRESHOLD`] where a score is worse than the ratchet allows.
pub fn stability(args: &StabilityArgs) -> Result<(), AppError> {
    let methods = methods(&args.methods);
    let ratchet = open_ratchet(args)?;
    let plan = Plan {
        args,
        size: args.size.or(ratchet.as_ref().map(|r| r.size)),
        stills: args.stills || ratchet.is_some(),
        truth: ratchet.is_none(),
    };
    let mut modes = Vec::new();
    let mut all_series = Vec::new();
    for choice in suite::choices(args, ratchet.as_ref())? {
        let (mode, series) = plan.load(&choice)?;
        modes.push(mode);
        all_series.extend(series);
    }
    let run = RunArgs {
        frames: 1,
        warm_up: 1,
        counters: false,
        split_trace: false,
        output: args.output.clone(),
        resume: args.resume,
        shaders: args.shaders.clone(),
        adapter: args.adapter.clone(),
    };
    let protocol = Protocol {
        sizes: plan.size.into_iter().collect(),
        frames: run.frames,
        warm_up: run.warm_up,
        count: false,
        split_trace: false,
        scores: true,
        sweep: Sweep::Rules,
        methods,
    };
    let gpu = open_gpu(&run, all_series.iter().any(FrameSeries::may_query))?;
    let (samples, stopped) = sample(&gpu, &run, &protocol, &mut all_series)?;
    if let Some(stopped) = stopped {
        return Err(stopped);
    }
    let columns = columns(&protocol.methods);
    let cells = cells(&modes, &columns, &samples);
    report(args, &cells, &samples)?;
    let library = shaders::library(args.shaders.as_deref())?;
    let shown = pictures::Shown {
        modes: &modes,
        columns: &columns,
        cells: &cells,
        samples: &samples,
        renders: args.pictures.then_some((&gpu, &library)),
    };
    let galleries = shown.galleries(&mut all_series)?;
    let anchors: Vec<&str> = galleries.iter().map(|g| g.anchor.as_str()).collect();
    let head = heat_map(&modes, &columns, &cells, &anchors);
    let path = args.output.join("stability.html");
    write(
        &path,
        page("Where methods fail", &head, &[], &galleries).as_bytes(),
    )?;
    reflet_base::error_line!("wrote {}", path.display());
    match (&args.ratchet, ratchet) {
        (Some(path), Some(ratchet)) => hold(path, ratchet, args.tighten, &modes, &columns, &cells),
        _ => Ok(()),
    }
}

/// Columns of the tables: `hybrid` has one for each rule of acceptance.
fn columns(methods: &[Method]) -> Vec<&'static str> {
    let of = |method: &Method| match method {
        Method::Hybrid => vec![THRESHOLD_SERIES, method.name()],
        _ => vec![method.name()],
    };
    methods.iter().flat_map(of).collect()
}

/// Ratchet in the file of `--ratchet`; a new one where the file is missing and may be written.
fn open_ratchet(args: &StabilityArgs) -> Result<Option<Ratchet>, AppError> {
    let Some(path) = &args.ratchet else {
        return Ok(None);
    };
    let usage = |text: String| AppError::Usage(format!("--ratchet {}: {text}", path.display()));
    match Ratchet::read(path).map_err(|d| of_file(*d))? {
        Some(ratchet) => match args.size.filter(|size| *size != ratchet.size) {
            Some([width, height]) => Err(usage(format!(
                "its scores are of {} x {}, not of {width} x {height}; leave --size out",
                ratchet.size[0], ratchet.size[1]
            ))),
            None => Ok(Some(ratchet)),
        },
        None if args.tighten => Ok(Some(Ratchet {
            size: args.size.unwrap_or(RATCHET_SIZE),
            cells: Vec::new(),
        })),
        None => Err(usage(
            "there is no such file; --tighten writes one".to_owned(),
        )),
    }
}

impl Plan<'_> {
    /// Loads a scene as a mode, with the frame series to measure for it.
    fn load(&self, choice: &Choice) -> Result<(Mode, Vec<FrameSeries>), AppError> {
        let loaded = self.scene(choice, &[])?;
        let reports = ["samples.csv", "stability.csv", "stability.html"];
        check_reports(&self.args.output, &reports, Some(&choice.path), &loaded)?;
        let mut mode = Mode {
            name: choice.name.clone(),
            about: first_comment(&loaded.text),
            parts: Vec::new(),
        };
        let mut all = Vec::new();
        let mut add = |series: FrameSeries, against| {
            mode.parts
                .push(Part::from_series(&series, self.size, against));
            all.push(series);
        };
        let name = loaded.name.clone();
        let timeline = loaded.scene.timeline.as_ref();
        let frames = timeline
            .filter(|_| !loaded.scene.is_still())
            .map(|t| match self.stills {
                true => t.start.to_string(),
                false => "all".to_owned(),
            });
        if frames.is_some() {
            add(
                frame_series(loaded, name, None, frames.as_deref())?,
                ReferenceKind::Rt,
            );
            return Ok((mode, all));
        }
        let still = subject(loaded, name.clone(), None)?;
        if self.truth {
            add(
                FrameSeries::still(self.against_truth(choice, &still)?),
                ReferenceKind::Truth,
            );
        }
        add(FrameSeries::still(still), ReferenceKind::Rt);
        if choice.number == Some(SIZES.0) && self.size.is_none() {
            for [width, height] in SIZES.1 {
                let size = format!("image.size=[{width}, {height}]");
                let loaded = self.scene(choice, &[size])?;
                let name = format!("{name} at {width} x {height}");
                add(
                    FrameSeries::still(subject(loaded, name, None)?),
                    ReferenceKind::Rt,
                );
            }
        }
        Ok((mode, all))
    }

    fn scene(&self, choice: &Choice, more: &[String]) -> Result<LoadedScene, AppError> {
        load_scene(Some(&choice.path), &self.args.from, more)
    }

    /// The same still subject with its truth as the reference.
    fn against_truth(&self, choice: &Choice, still: &Subject) -> Result<Subject, AppError> {
        let mut truth = still.clone();
        if choice.number == Some(FAR_AWAY.0) {
            let loaded = self.scene(choice, &[FAR_AWAY.1.to_owned()])?;
            truth = subject(loaded, still.name.clone(), None)?;
        }
        for world in [Some(&mut truth.world), truth.first.as_mut()] {
            for light in world.into_iter().flat_map(|world| &mut world.lights) {
                if light.desc.shadow != ShadowMode::None {
                    light.desc.shadow = ShadowMode::Ray;
                }
            }
        }
        truth.image.samples = Samples::Count(truth.image.samples.count().max(TRUTH_SAMPLES));
        let content = Hash::default()
            .with(still.content.to_le_bytes())
            .with(format!("truth of {TRUTH_SAMPLES} samples"));
        Ok(Subject {
            name: format!("{} against the truth", still.name),
            content: content.value(),
            truth: Some(Box::new(truth)),
            ..still.clone()
        })
    }
}

/// Comment at the beginning of a scene, in one line.
fn first_comment(text: &str) -> String {
    let lines = text.lines().map_while(|line| line.strip_prefix('#'));
    lines.map(str::trim).collect::<Vec<_>>().join(" ")
}

/// Writes the table, and names the cells that have no score.
fn report(args: &StabilityArgs, cells: &[Cell], samples: &[Sample]) -> Result<(), AppError> {
    for cell in cells {
        if let Err(why) = &cell.scores {
            reflet_base::error_line!("{}, {}: not scored: {why}", cell.mode, cell.method);
        }
    }
    let path = args.output.join("stability.csv");
    let adapter = samples.last().map_or("nothing", |s| s.adapter.as_str());
    write(&path, table(cells, adapter).as_bytes())?;
    reflet_base::error_line!("wrote {}", path.display());
    Ok(())
}

/// Compares the scores with the ratchet, and tightens it where that is requested.
fn hold(
    path: &Path,
    mut ratchet: Ratchet,
    tighten: bool,
    modes: &[Mode],
    columns: &[&str],
    cells: &[Cell],
) -> Result<(), AppError> {
    let names: Vec<&str> = modes.iter().map(|mode| mode.name.as_str()).collect();
    let worse = ratchet.regressions(&names, columns, cells);
    if tighten {
        let changed = ratchet.tighten(cells);
        if changed > 0 {
            write_whole(&Goal::typed(path.to_owned()), ratchet.text().as_bytes()).map_err(
                |error| {
                    AppError::Usage(format!(
                        "--ratchet: cannot write {}: {error}",
                        path.display()
                    ))
                },
            )?;
        }
        print_out(&format!(
            "{changed} numbers and cells are new in {}\n",
            path.display()
        ))?;
    }
    for sentence in &worse {
        print_out(&format!("worse: {sentence}\n"))?;
    }
    if worse.is_empty() {
        print_out(&format!(
            "no score is worse than {} allows\n",
            path.display()
        ))
    } else {
        Err(AppError::THRESHOLD)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_comment_is_one_line() {
        let text = "# 3 thin rails: rails\n# that are thin.\nversion = 1\n# more\n";
        assert_eq!(first_comment(text), "3 thin rails: rails that are thin.");
        assert_eq!(first_comment("version = 1\n"), "");
    }
}
