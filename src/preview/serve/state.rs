//! State of the preview as JSON for a page.

use std::{iter::once, path::absolute};

use glam::Vec3;
use serde_json::{Value, json};

use crate::{
    live::Problems,
    viewer::{
        protocol::{FinishedFrame, Side},
        scene_summary::SceneSummary,
        timeline::Timeline,
        view_state::ViewState,
    },
    write_back::{
        Inspected, page, presses::KeyAction, selection::Selection, view_channel::ViewChannel,
    },
};
use reflet_render::runtime::parameters::ParameterOverrides;
use reflet_scene::{
    desc::{MaterialDesc, Method},
    diagnostic::{Place, Span},
    number::Field,
};

/// A message for the status line.
pub(super) fn message(text: &str) -> String {
    json!({ "message": text }).to_string()
}

/// All errors, as texts.
pub(super) fn problems(problems: &Problems) -> Vec<String> {
    let texts = problems.scene.iter().chain(&problems.pose);
    let texts = texts.map(|diagnostic| diagnostic.render(false));
    let unbuilt = problems.unbuilt().map(ToString::to_string);
    texts
        .chain(unbuilt)
        .chain(problems.undrawn.clone())
        .collect()
}

/// Places in texts that the scene's messages name, as they name them, each with the path of its file, if it is there, and
/// line and column.
fn places(summary: &SceneSummary) -> Vec<Value> {
    let Problems { scene, pose, .. } = &summary.problems;
    let messages = scene.iter().chain(pose).chain(&summary.warnings);
    let spans = messages.flat_map(|message| {
        let related = message.related.iter().map(|(span, _)| span);
        once(&message.span).chain(related)
    });
    let place = |span: &Span| {
        let source = span.source.as_ref().filter(|source| !source.generated)?;
        let (Place { line, column }, path) = (source.place(span.range.start), &source.path);
        let file = absolute(path).ok().filter(|file| file.is_file());
        let named = format!("{}:{line}:{column}", path.display());
        Some(json!([named, file, line, column]))
    };
    spans.filter_map(place).collect()
}

/// Parameters of the script.
pub(super) fn parameters(summary: &SceneSummary, overrides: &ParameterOverrides) -> String {
    json!({ "parameters": page::parameters(&summary.declared, overrides) }).to_string()
}

/// The value of a material's field that numbers of a page give, within its range.
pub(super) fn material_value(field: &Field<MaterialDesc>, values: &[f64]) -> Option<Vec3> {
    let lanes: Vec<f32> = values
        .iter()
        .map(|x| field.range.clamp(*x as f32))
        .collect();
    if !lanes.iter().all(|x| x.is_finite()) {
        return None;
    }
    match *lanes.as_slice() {
        _ if lanes.len() != field.form.lanes() => None,
        [x] => Some(Vec3::splat(x)),
        [x, y] => Some(Vec3::new(x, y, 0.0)),
        _ => Some(Vec3::from_slice(&lanes)),
    }
}

/// The shown material.
pub(super) fn material(state: &ViewState) -> String {
    let index = state.settings.material;
    let row = index.and_then(|index| Some((index, state.summary.materials.get(index)?)));
    let shown = row.map(|(index, row)| {
        let numbers = row.edit.over(&row.numbers);
        page::material(index, &row.told(), &numbers)
    });
    json!({ "material": shown }).to_string()
}

/// Keys of the tracks below the timeline, and whether a flight is being recorded.
pub(super) fn keys(state: &ViewState, selected: Option<&Inspected>) -> String {
    let tracks = page::tracks(&state.tracks_of(selected));
    json!({ "keys": tracks, "records": state.recording.is_some() }).to_string()
}

/// The scene: its choices, and its warnings.
pub(super) fn scene(state: &ViewState, name: &str) -> String {
    use KeyAction::{Close, Compare, Copy, SafeArea};
    let summary = &state.summary;
    let warnings = summary.warnings.iter().map(|warning| warning.render(false));
    let materials = summary.materials.iter().map(|row| &row.name);
    json!({ "scene": {
        "name": name,
        "materials": materials.collect::<Vec<_>>(),
        "cameras": summary.cameras.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        "cuts": !summary.cuts.is_empty(),
        "methods": page::methods().map(Method::name).collect::<Vec<_>>(),
        "channels": ViewChannel::of_frames().map(ViewChannel::name).collect::<Vec<_>>(),
        "keys": page::keys(&[Copy, Compare, SafeArea, Close], &[]),
        "items": page::rows(&summary.items, &state.settings.left_out),
        "timeline": summary.timeline.as_ref().map(|time| json!([time.start, time.end, time.fps])),
        "log": summary.log,
        "problems": problems(&summary.problems),
        "places": places(summary),
        "warnings": warnings.collect::<Vec<_>>(),
    }})
    .to_string()
}

/// Choices of the view.
pub(super) fn view(state: &ViewState) -> String {
    let (settings, time) = (&state.settings, state.timeline.as_ref());
    let side = |side: Side| json!([side.method.name(), side.channel.name()]);
    json!({ "view": {
        "sides": [side(settings.a), side(settings.b)],
        "wipe": settings.wipe,
        "samples": settings.samples,
        "denoises": settings.denoises,
        "camera": state.shown_camera(),
        "cuts": settings.follows_cuts,
        "frame": time.map(Timeline::frame),
        "plays": time.is_some_and(Timeline::is_playing),
        "loops": time.is_some_and(|time| time.repeats),
    }})
    .to_string()
}

/// The selected item.
pub(super) fn item(state: &ViewState, selection: &Selection) -> String {
    json!({ "item": page::item(selection, &state.summary.items) }).to_string()
}

/// Number of the last picture, after which nothing is left to draw.
pub(super) fn idle(number: u64) -> String {
    json!({ "idle": number }).to_string()
}

/// Statistics of the shown picture, which took `encode_ms` to be read back and encoded.
pub(super) fn statistics(shown: &FinishedFrame, encode_ms: f64) -> String {
    let sides = shown.sides.iter().map(|side| {
        let [width, height] = side.stats.size;
        json!({
            "size": [width, height],
            "method": side.stats.method.name(),
            "samples": side.stats.samples,
            "ms": side.stats.frame_ms,
            "rays": side.stats.rays,
            "passes": side.stats.passes_ms,
            "legend": side.legend,
        })
    });
    json!({ "statistics": {
        "picture": shown.number,
        "saves": shown.saves,
        "frame": shown.frame,
        "encode_ms": encode_ms,
        "sides": sides.collect::<Vec<_>>(),
    } })
    .to_string()
}
