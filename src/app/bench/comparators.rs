//! `bench comparators`: other ways of finding reflections beside Reflet's own.

mod measuring;

use std::path::Path;

use super::{args::ComparatorsArgs, create_folder, timeline::frame_series, write};
use crate::{
    app::{
        error::AppError,
        scene::{check_reports, load_scene},
        shaders,
    },
    bench::{
        report::{
            ChartFile,
            page::{Gallery, page},
            work::csv_table,
        },
        systems::{
            SceneRows, chart,
            frames::{self, Curves},
            overall::best,
            table::{self, Machine},
        },
    },
    gpu::{adapter, driver},
};
use reflet_scene::declared::Words as _;

use measuring::{ENOUGH_PX, MOST_DOUBLINGS, measure};

/// Number of systems in the chart over all scenes.
const BEST: usize = 5;
/// Files beside the charts.
const FILES: [&str; 4] = ["systems.csv", "best.csv", "frames.csv", "report.html"];

/// Runs the command.
///
/// # Errors
/// Scenes that do not load, a folder that cannot be written to, errors of the renderer.
pub fn comparators(args: &ComparatorsArgs) -> Result<(), AppError> {
    let mut all_series = Vec::new();
    for path in &args.scenes {
        let loaded = load_scene(Some(path), &args.from, &[])?;
        check_reports(&args.output, &FILES, Some(path), &loaded)?;
        let is_film = loaded.scene.timeline.is_some();
        let list = is_film.then_some(args.timeline.as_str());
        let name = path.display().to_string();
        all_series.push(frame_series(loaded, name, None, list)?);
    }
    create_folder(&args.output)?;
    let library = shaders::library(None)?;
    let gpu = driver::open_gpu(args.adapter.as_deref(), true)?;
    let mut scenes = Vec::new();
    for mut series in all_series {
        let is_moving = series.frames().count() > 1;
        let turns = if is_moving { 1 } else { args.frames };
        let size = measuring::scored_size(&gpu, &library, args.size, &mut series)?;
        let rows = measure(&gpu, &library, size, turns, &mut series)?;
        reflet_base::error_line!("measured {}", rows.scene);
        scenes.push(rows);
    }
    let machine = Machine {
        adapter: adapter::name(&gpu.adapter_info),
        is_processor: gpu.is_software(),
    };
    let best = best(&scenes, BEST);
    let tables = [
        table::by_scene(&scenes, &machine),
        table::over_all(&best),
        frames::table(&scenes),
    ];
    for (name, text) in FILES.iter().zip(&tables) {
        write(&args.output.join(name), text.as_bytes())?;
    }
    let mut galleries = vec![gallery(
        "The best over all scenes",
        vec![ChartFile {
            name: "best.svg".to_owned(),
            svg: chart::of_several(&best).map_err(AppError::Internal)?,
            caption: format!(
                "Of the {BEST} methods that come first: time over that of rt, geometric mean of the scenes with \
                 frames to score, and mean FLIP. A ring marks the front."
            ),
        }],
    )];
    for scene in &scenes {
        galleries.push(gallery(&scene.scene, charts(scene)?));
    }
    for chart in galleries.iter().flat_map(|gallery| &gallery.charts) {
        write(&args.output.join(&chart.name), chart.svg.as_bytes())?;
    }
    let time = match machine.is_processor {
        true => "processor time",
        false => "GPU time",
    };
    let about = format!(
        "{}. Milliseconds are the {time} of the passes that find reflections, medians of the pictures of a still ({} of \
         each system, in turns), or of all frames of a film. Errors are against rt with bounces = \"auto\" and without \
         reuse of light, inside the reflective pixels. A scene whose first frame has fewer than {ENOUGH_PX} reflective \
         pixels to score is measured at a larger size, {} times as wide and high at most.",
        machine.adapter,
        args.frames,
        1 << MOST_DOUBLINGS
    );
    let head = [
        csv_table("Systems in each scene", &about, &tables[0]),
        csv_table("The best over all scenes", "", &tables[1]),
    ]
    .concat();
    let path = args.output.join("report.html");
    write(&path, page("Systems", &head, &[], &galleries).as_bytes())?;
    reflet_base::error_line!("wrote {}", path.display());
    Ok(())
}

fn gallery(title: &str, charts: Vec<ChartFile>) -> Gallery {
    Gallery {
        title: title.to_owned(),
        charts,
        ..Gallery::default()
    }
}

/// Charts of a scene: time against error, and of a film the curves over its frames.
fn charts(scene: &SceneRows) -> Result<Vec<ChartFile>, AppError> {
    let stem = Path::new(&scene.scene).file_stem().unwrap_or_default();
    let stem = stem.to_string_lossy();
    let file = |ending: &str, svg, caption: &str| ChartFile {
        name: format!("{stem}{ending}.svg"),
        svg,
        caption: caption.to_owned(),
    };
    let svg = chart::of_scene(scene).map_err(AppError::Internal)?;
    let caption = "Time against error of each system; a ring marks the front";
    let mut charts = vec![file("", svg, caption)];
    for (curves, word) in Curves::ALL.into_iter().zip(Curves::WORDS) {
        if let Some(svg) = frames::draw(scene, curves).map_err(AppError::Internal)? {
            charts.push(file(word.name, svg, word.summary));
        }
    }
    Ok(charts)
}
