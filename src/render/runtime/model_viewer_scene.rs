//! Viewer scenes: a scene made for a bare model, with daylight and its animations, or for a panorama, with a ball that
//! mirrors it.

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
    sync::Arc,
};

pub use reflet_scene::desc::is_bare;
use reflet_scene::{
    desc::is_stage,
    diagnostic::{Diagnostic, Source},
    parse::{Document, Texts},
    reach::Border,
    syntax::{Content, made},
};
use reflet_world::{
    gltf::{Fault, Playable, Sandbox},
    load::{Forgiven, LoadOptions},
    usd,
};

/// Default frame rate.
const FPS: f64 = 24.0;
/// Maximum frame number of a timeline.
const LAST_FRAME: f64 = 1e6;

/// Prefix of overrides that choose parts of a USD stage.
const USD_PREFIX: &str = "model.model.usd";

/// Scene that shows one model. All its animations play once if no two move the same property of a node, else only the
/// first one; the timeline has their length. A USD stage keeps its frame numbers. A file with light of images, such as a
/// stage with dome lights, is lit by that alone. A glTF file that is read here is cached in `options`
/// for the load.
///
/// # Errors
/// A stage that cannot be converted. Errors of a glTF file are reported by the load.
pub fn model_viewer_scene(
    path: &Path,
    options: &LoadOptions,
    overrides: &[String],
) -> Result<Source, Box<Diagnostic>> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let playable =
        playable(path, &name, options, &choice_of(path, &name, overrides)).or_else(|fault| {
            match is_stage(path) {
                true => Err(Box::new(fault.in_file(path))),
                false => Ok(Playable::default()),
            }
        })?;
    let mut model = made([("file", Content::from(&*name))]);
    let mut root = made([("version", Content::from(1))]);
    if !playable.has_image_light {
        let sun = sun(is_unlit(&playable, overrides));
        root.extend(made([
            ("light", made([("sun", sun)]).into()),
            ("environment", sky()),
        ]));
    }
    if let Some((name, duration_s)) = chosen(&playable) {
        let range = frame_range(duration_s, &playable, fps_of(overrides));
        let animation = made([
            ("name", Content::from(name)),
            ("repeat", "once".into()),
            ("start_s", range.animation_start_s.into()),
        ]);
        model.extend(made([("animation", animation.into())]));
        let timeline = made([
            ("fps", range.fps.into()),
            ("start", range.frames[0].into()),
            ("end", range.frames[1].into()),
        ]);
        root.extend(made([("timeline", timeline.into())]));
    }
    root.extend(made([("model", made([("model", model.into())]).into())]));
    Ok(Source::generated(path, root))
}

/// Scene that shows a panorama: behind a ball that mirrors all of it.
pub fn panorama_viewer_scene(path: &Path) -> Source {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let shape = made([("kind", Content::from("sphere"))]);
    let chrome = made([("metallic", Content::from(1)), ("roughness", 0.into())]);
    let ball = made([("shape", shape.into()), ("material", "chrome".into())]);
    let main = [("eye", [0.0, 0.0, 2.0].into()), ("fov_deg", 45.into())];
    let root = made([
        ("version", Content::from(1)),
        ("camera", made([("main", made(main).into())]).into()),
        (
            "environment",
            made([("file", Content::from(&*name))]).into(),
        ),
        ("material", made([("chrome", chrome.into())]).into()),
        ("model", made([("ball", ball.into())]).into()),
    ]);
    Source::generated(path, root)
}

/// Whether nothing of a model is lit, so that the sun needs no shadows.
fn is_unlit(playable: &Playable, overrides: &[String]) -> bool {
    // Other materials may be lit.
    playable.is_unlit && !overrides.iter().any(|text| text.contains("material"))
}

/// Sun from above.
pub fn sun(is_shadowless: bool) -> Content {
    let mut sun = made([
        ("kind", Content::from("directional")),
        ("direction", [-0.5, -1.0, -0.7].into()),
        ("intensity_lux", 2.5.into()),
        ("shadow_px", 2048.into()),
    ]);
    if is_shadowless {
        sun.extend(made([("shadow", "none".into())]));
    }
    sun.into()
}

/// Daylight.
pub fn sky() -> Content {
    let colors = [[0.5, 0.55, 0.65], [0.6, 0.6, 0.6], [0.25, 0.23, 0.2]];
    let [zenith, horizon, ground] = colors.map(Content::from);
    made([("zenith", zenith), ("horizon", horizon), ("ground", ground)]).into()
}

/// Parts of the stage that `--set model.model.usd.…` chooses. Errors are reported when the scene is read.
fn choice_of(path: &Path, name: &str, overrides: &[String]) -> usd::Choice {
    let asked = overrides
        .iter()
        .filter(|o| o.trim_start().starts_with(USD_PREFIX));
    let asked: Vec<_> = asked.cloned().collect();
    let model = made([("file", Content::from(name))]);
    let root = made([
        ("version", Content::from(1)),
        ("model", made([("model", model.into())]).into()),
    ]);
    let texts = Texts::collect(Arc::new(Source::generated(path, root)), &Border::default());
    let scene = Document::new(&texts, &asked.as_slice().into()).read(None);
    let models = scene.map_or(Vec::new(), |(desc, _)| desc.models);
    let model = models.first();
    model.map_or_else(usd::Choice::default, |model| {
        usd::Choice::from_desc(&model.value.usd)
    })
}

/// Animations of the model, and metadata of its stage.
fn playable(
    path: &Path,
    name: &str,
    options: &LoadOptions,
    choice: &usd::Choice,
) -> Result<Playable, Fault> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let folders: Vec<PathBuf> = [folder.to_owned()]
        .into_iter()
        .chain(options.assets.iter().cloned())
        .collect();
    let roots: Vec<PathBuf> = folders.into_iter().chain(options.project.clone()).collect();
    let sandbox = Sandbox::new(roots.iter().map(PathBuf::as_path), options.max_file_bytes)
        .with_dependencies(&options.dependencies);
    let path = sandbox.resolve(folder, name)?;
    if !is_stage(&path) {
        let forgiven = Forgiven {
            lenient: options.lenient,
            strict: options.strict,
        };
        return Ok(options.preloaded_models.read(&path, &sandbox, forgiven));
    }
    let glb = usd::convert(&path, "model", choice, &roots)?.glb;
    let folder = glb.parent().unwrap_or(Path::new("."));
    let sandbox = Sandbox::new([folder], options.max_file_bytes);
    let forgiven = Forgiven {
        lenient: false,
        strict: options.strict,
    };
    Ok(options.preloaded_models.read(&glb, &sandbox, forgiven))
}

/// Name and duration, s, of the animation to play; broken animations are skipped.
fn chosen(playable: &Playable) -> Option<(&str, f64)> {
    let clips = playable.clips.iter();
    let whole: Vec<_> = clips
        .filter_map(|clip| Some((clip.name.as_str(), clip.animation.as_ref().ok()?)))
        .collect();
    let (name, first) = whole.first()?;
    let animations = || whole.iter().map(|(_, animation)| animation);
    let channels = animations().flat_map(|a| &a.channels);
    let weights = animations().flat_map(|a| &a.weights);
    let mut moved = channels
        .map(|channel| (channel.node, Some(channel.property)))
        .chain(weights.map(|track| (track.node, None)));
    let mut known = HashSet::new();
    if whole.len() > 1 && moved.all(|part| known.insert(part)) {
        let ends = whole.iter().map(|(_, animation)| animation.duration_s);
        return Some(("*", f64::from(ends.fold(0.0, f32::max))));
    }
    Some((name, f64::from(first.duration_s)))
}

/// Frame rate, time of the animation's beginning, and first and last frame, at which that may have begun long ago.
struct FrameRange {
    fps: f64,
    animation_start_s: f64,
    frames: [f64; 2],
}

fn frame_range(duration_s: f64, playable: &Playable, asked_fps: Option<f64>) -> FrameRange {
    if let Some(stage) = playable.stage
        && asked_fps.is_none_or(|fps| fps == stage.rate)
        && stage.rate > 0.0
        && stage.rate <= 1000.0
    {
        // Time codes of the stage are used as frame numbers if they are whole and not negative.
        let end = stage.origin + duration_s * stage.rate;
        let end = stage.end_time_code.map_or(end, |code| code.max(end));
        // Tolerance for times rounded to 32 bits, frames.
        let last = (end - 1e-3).ceil();
        let first = stage.start_time_code.unwrap_or(stage.origin);
        let whole = first.fract() == 0.0 && first >= 0.0 && last <= LAST_FRAME;
        if whole {
            return FrameRange {
                fps: stage.rate,
                animation_start_s: stage.origin / stage.rate,
                frames: [first, last.max(first)],
            };
        }
    }
    let fps = asked_fps.unwrap_or(FPS);
    let last = (duration_s * fps - 1e-3).ceil();
    FrameRange {
        fps,
        animation_start_s: 0.0,
        frames: [0.0, last.clamp(0.0, LAST_FRAME)],
    }
}

/// Frame rate from `--set timeline.fps=…`; the duration stays.
fn fps_of(overrides: &[String]) -> Option<f64> {
    let of = |text: &String| {
        let (key, value) = text.split_once('=')?;
        (key.trim() == "timeline.fps").then(|| value.trim().parse().ok())?
    };
    let fps = overrides.iter().rev().find_map(of);
    fps.filter(|fps| *fps > 0.0 && *fps <= 1000.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_world::gltf::StageTime;

    #[test]
    fn timelines_are_as_long_as_their_animation() {
        let none = Playable::default();
        let frames = |duration: f64, playable: &Playable, fps: Option<f64>| {
            let range = frame_range(duration, playable, fps);
            (range.fps, range.frames)
        };
        assert_eq!(frames(2.0, &none, None), (24.0, [0.0, 48.0]));
        assert_eq!(frames(2.01, &none, None), (24.0, [0.0, 49.0]));
        assert_eq!(frames(0.0, &none, None), (24.0, [0.0, 0.0]));
        assert_eq!(frames(2.0, &none, Some(10.0)), (10.0, [0.0, 20.0]));
        assert_eq!(frames(1e9, &none, None), (24.0, [0.0, 1e6]));
        let mut stage = StageTime {
            rate: 30.0,
            origin: 101.0,
            start_time_code: None,
            end_time_code: None,
        };
        let of = |stage| Playable {
            stage: Some(stage),
            ..Playable::default()
        };
        let f32_end = f64::from(49.0_f32 / 30.0);
        assert_eq!(frames(f32_end, &of(stage), None), (30.0, [101.0, 150.0]));
        assert_eq!(frames(1.0, &of(stage), Some(15.0)), (15.0, [0.0, 15.0]));
        stage.end_time_code = Some(200.0);
        assert_eq!(frames(1.0, &of(stage), None), (30.0, [101.0, 200.0]));
        stage.origin = -5.0;
        stage.start_time_code = Some(120.0);
        assert_eq!(frames(1.0, &of(stage), None), (30.0, [120.0, 200.0]));
        stage.start_time_code = None;
        assert_eq!(frames(1.0, &of(stage), None), (24.0, [0.0, 24.0]));
    }

    #[test]
    fn finds_the_requested_fps() {
        let asked =
            |texts: &[&str]| fps_of(&texts.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>());
        assert_eq!(asked(&["image.samples=2", "timeline.fps = 12"]), Some(12.0));
        assert_eq!(asked(&["timeline.fps=12", "timeline.fps=30"]), Some(30.0));
        for wrong in ["timeline.fps=x", "timeline.fps=-1", "timeline.fps", "fps=5"] {
            assert_eq!(asked(&[wrong]), None, "{wrong}");
        }
    }
}
