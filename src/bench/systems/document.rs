//! The document that compares systems: what rivals do better comes first.

use std::fmt::Write as _;

use super::{
    LeftOut, SceneRows, SystemErrors,
    frames::Curves,
    overall::Overall,
    probe_seams::{self, SeamRow},
    rivals,
};
use reflet_base::digits::grouped;
use reflet_metric::mask::MIN_AREA_PX;

/// Conditions of the measurements.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Command that writes the document.
    pub command: String,
    /// Name of the adapter and its driver.
    pub adapter: String,
    /// Size of the pictures.
    pub size: [u32; 2],
    /// Number of timed pictures of each still.
    pub frames: u32,
    /// Whether times are those of the processor.
    pub is_processor: bool,
    /// Number of threads that a software adapter was told to use; none where it chose.
    pub threads: Option<String>,
    /// Number of reflective pixels with which a scene is measured at this size; with fewer pictures are larger.
    pub enough_px: usize,
    /// Maximum number of times that their size is doubled.
    pub most_doublings: u32,
}

/// Picture of what a system gets wrong, beside that of `rt`.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Name of the system.
    pub system: &'static str,
    /// Scene file.
    pub scene: String,
    /// Sentence about the failure.
    pub text: &'static str,
    /// Address of the picture.
    pub address: String,
}

/// Title, conditions and command.
fn head(about: &Conditions) -> String {
    let [width, height] = about.size;
    let time = match about.is_processor {
        true => "processor time",
        false => "GPU time",
    };
    let threads = match about.threads.as_deref() {
        Some("1") => " with one thread".to_owned(),
        Some(threads) => format!(" with {threads} threads"),
        None => String::new(),
    };
    format!(
        "<!-- Written by `reflet bench comparators --document`. -->\n# The systems beside it\n\nOther ways of finding \
         reflections, built as their authors build them, on the same scenes with the same surface and light code \
         ([methods.md](methods.md)). Pictures of {width} × {height} pixels on {}{threads}, {} times as wide and high at most \
         where fewer than {} reflective pixels were left to score in the first one. Times are the {time} of the passes \
         that find reflections, medians of {} pictures, or of all frames of a film, in which all systems take turns; errors are FLIP and SSIM against \
         `rt` with `bounces = \"auto\"` and without reuse of light, inside the reflective pixels; a frame with fewer than {MIN_AREA_PX} has \
         none. Maps of probes and of far things are captured apart from the frame, and structures of \
         ray queries are built apart from it: their bytes and time have columns of their own, and in films the median time in which \
         they are made anew for a frame, because the camera or something has moved. Tree nodes and \
         march steps are those of these passes in the first picture; they do not depend on the machine. Probes stand where a scene \
         has them; scenes without probes get a grid of two along their longest edge ([methods.md](methods.md#probes)).\n\n\
         ```sh\n{}\n```\n",
        about.adapter,
        1 << about.most_doublings,
        about.enough_px,
        about.frames,
        about.command
    )
}

/// The document as Markdown, with the best systems over all scenes and the address of their chart; `chart` gives the address
/// of a scene's chart, and of those that end by [`Curves::ALL`].
pub fn document(
    about: &Conditions,
    scenes: &[SceneRows],
    (best, best_chart): (&[Overall], &str),
    (failures, seams): (&[Failure], &[SeamRow]),
    chart: impl Fn(&SceneRows, &str) -> String,
) -> String {
    let mut out = head(about);
    out += "\n## What rivals do better\n\n";
    out += &rivals::section(scenes);
    over_all(&mut out, best, best_chart);
    failing(&mut out, failures);
    out += &probe_seams::section(seams);
    for scene in scenes {
        section(&mut out, scene, |ending| chart(scene, ending));
    }
    out += LEFT_OUT;
    out
}

/// Section of a scene: its charts, whose addresses `chart` gives by their endings, and its table.
pub fn section(out: &mut String, scene: &SceneRows, chart: impl Fn(&str) -> String) {
    let _ = write!(out, "\n## {}\n\n", scene.scene);
    let frames = match scene.frames {
        1 => "one picture".to_owned(),
        n => format!("{n} frames"),
    };
    let [width, height] = scene.size;
    let _ = writeln!(
        out,
        "{frames} of {width} × {height} pixels, {}, {} probe{}.\n\n![Time against error of each system; a ring marks the \
             front]({})\n",
        scored(scene),
        scene.probes,
        if scene.probes == 1 { "" } else { "s" },
        chart("")
    );
    if scene.frames > 1 {
        for (curves, ending) in Curves::ALL {
            if curves.ranges(scene).is_some() {
                let _ = writeln!(out, "![{}]({})\n", curves.caption(), chart(ending));
            }
        }
    }
    table(out, scene);
    left_out(out, &scene.left_out);
}

/// Words about the reflective pixels that are scored.
fn scored(scene: &SceneRows) -> String {
    let few = format!("fewer than {MIN_AREA_PX} reflective pixels");
    match scene.scored_px.iter().min() {
        None => format!("without errors, as they have {few}"),
        Some(px) if scene.scored_px.len() == scene.frames => {
            format!("{px} reflective pixels scored")
        }
        Some(px) => format!(
            "{} of them scored with {px} reflective pixels or more, the others without errors, as they have {few}",
            scene.scored_px.len()
        ),
    }
}

/// Table of the best systems over all scenes.
fn over_all(out: &mut String, best: &[Overall], chart: &str) {
    let _ = writeln!(
        out,
        "\n## The best over all scenes\n\nTime over that of `rt`, geometric mean of the scenes with frames to score, and mean FLIP, of the {} \
         methods that come first: those on the front, then those on the front of the rest, and so on, each by the setting \
         that errs least there.\n\n![Time against error of the best methods]({chart})\n\n| method | time over `rt` | \
         FLIP |\n|---|---|---|",
        best.len()
    );
    for of in best {
        let (ratio, flip) = (of.time_ratio, of.flip);
        let _ = writeln!(out, "| {} | {ratio:.2} | {flip:.4} |", of.system);
    }
}

/// Table of failures.
fn failing(out: &mut String, failures: &[Failure]) {
    if failures.is_empty() {
        return;
    }
    *out += "\n## How they fail\n\nLeft the system, right `rt`, where they differ most. The failures of `near-far` and \
             `ssr+box` are in [methods.md](methods.md#near-rays-far-maps).\n\n| system | picture | failure |\n|---|---|---|\n";
    for Failure {
        system,
        scene,
        text,
        address,
    } in failures
    {
        let _ = writeln!(
            out,
            "| {system} | ![{system} beside rt]({address}) | {text} `{scene}` |"
        );
    }
}

/// Systems that the document does not have, and why.
const LEFT_OUT: &str = "
## What is not here

Maps of the last frame are left out, because a frame here depends on no frame before it: probes stand for maps from before.
Planes in place of pixels (Widmer et al. 2015) were not built: the march skips cells of the depth pyramid, and an estimate finds
that planes would spare 5 of 24 steps, at most 3.5 % of the time ([speed.md](speed.md#what-was-tried)).
Time and error of all systems along the paper's walk, its Fig. 7, are in [paper.md](paper.md#all-systems-along-the-walk).
A system that an adapter lacks or a scene refuses is named below the table of the scene.
";

/// Sentences about systems without measurements, one for those that are refused for the same reason.
fn left_out(out: &mut String, systems: &[LeftOut]) {
    for (i, first) in systems.iter().enumerate() {
        if systems[..i].iter().any(|other| other.why == first.why) {
            continue;
        }
        let alike = systems.iter().filter(|other| other.why == first.why);
        let names: Vec<&str> = alike.map(|other| other.system).collect();
        let _ = writeln!(out, "\nNot measured: {}. {}.", names.join("; "), first.why);
    }
}

fn table(out: &mut String, scene: &SceneRows) {
    let is_film = scene.frames > 1;
    let [popping, anew] = match is_film {
        true => [" popping, % |", " made anew in, ms |"],
        false => ["", ""],
    };
    let line = if is_film { "---|---|" } else { "" };
    let _ = writeln!(
        out,
        "| system | ms | FLIP | p99 | SSIM | wrong instance, % |{popping} tree nodes | march steps | MiB | of maps or structures | made in, ms |{anew} front |\n\
         |---|---|---|---|---|---|{line}---|---|---|---|---|---|"
    );
    for (row, is_on_front) in scene.rows.iter().zip(scene.on_front()) {
        let mib = |bytes: u64| format!("{:.1}", bytes as f64 / f64::from(1 << 20));
        let popping = match (is_film, row.popping) {
            (true, Some(value)) => format!(" {:.0} |", 100.0 * value),
            (true, None) => " – |".to_owned(),
            (false, _) => String::new(),
        };
        let none = || "–".to_owned();
        let (bytes, ms) = (row.prepared_bytes, row.prepare_ms);
        let prepared = if bytes > 0 { mib(bytes) } else { none() };
        let ms_or_dash = |ms: f64| if ms > 0.0 { format!("{ms:.1}") } else { none() };
        let made_in = ms_or_dash(ms);
        let anew = match is_film {
            true => format!(" {} |", ms_or_dash(row.update_ms)),
            false => String::new(),
        };
        let _ = writeln!(
            out,
            "| {} | {:.2} | {} |{popping} {} | {} | {} | {prepared} | {made_in} |{anew} {} |",
            row.system,
            row.ms,
            error_cells(row.errors),
            count_or_dash(row.nodes),
            count_or_dash(row.steps),
            mib(row.bytes),
            if is_on_front { "●" } else { "" }
        );
    }
}

/// Cells of errors; dashes for none.
fn error_cells(errors: Option<SystemErrors>) -> String {
    let Some(of) = errors else {
        return "– | – | – | –".to_owned();
    };
    let ssim = of.ssim.map_or("–".to_owned(), |v| format!("{v:.4}"));
    let (flip, p99, wrong) = (of.flip, of.flip_p99, of.wrong_percent);
    format!("{flip:.4} | {p99:.3} | {ssim} | {wrong:.1}")
}

/// A count; a dash for 0.
fn count_or_dash(count: u64) -> String {
    match count {
        0 => "–".to_owned(),
        _ => grouped(count),
    }
}

#[cfg(test)]
#[path = "document_tests.rs"]
mod tests;
