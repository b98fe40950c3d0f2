//! Instances that reflection rays skip in a frame, because they are too small there.

use serde::Serialize;

use super::first;

use crate::{
    app::error::AppError,
    render::{
        RenderOptions,
        decide::skip::{Kept, Skipping},
        settings::view::View,
    },
    runtime::scene_text::LoadedScene,
};

/// Instances that reflection rays skip in a frame, and reasons for the others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SkippedInfo {
    /// Frame of the timeline.
    pub frame: u32,
    /// Setting `reflection.skip_px`.
    pub skip_px: f32,
    /// Names of the skipped instances.
    pub instances: Vec<String>,
    /// Numbers of the other instances, by the reason why they are not skipped.
    pub kept: Vec<KeptInfo>,
    /// Reason why nothing is skipped; `None` where something may be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

/// Number of instances that are not skipped for one reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct KeptInfo {
    /// The reason.
    pub reason: Kept,
    /// Number of instances.
    pub count: usize,
}

/// Instances that reflection rays skip in a frame, by default the first; `None` where `skip_px` is 0.
///
/// # Errors
/// A frame outside the timeline, or one that cannot be posed.
pub fn skipped(
    loaded: &LoadedScene,
    options: &RenderOptions,
    frame: Option<u32>,
) -> Result<Option<SkippedInfo>, AppError> {
    let settings = &options.reflection;
    let (first, last) = match &loaded.scene.timeline {
        Some(timeline) => (timeline.start, timeline.end),
        None => (loaded.scene.first_frame(), loaded.scene.first_frame()),
    };
    let frame = frame.unwrap_or(first);
    if !(first..=last).contains(&frame) {
        return Err(AppError::Usage(format!(
            "--at {frame}: the scene's frames are {first} to {last}"
        )));
    }
    if settings.skip_px <= 0.0 {
        return Ok(None);
    }
    let world = loaded.first_frame();
    let skipping = Skipping::for_world(&world, options);
    let mut world = world.into_owned();
    if let Some(state) = loaded.scene.pose(frame).map_err(AppError::Scene)? {
        world.apply(&state).map_err(AppError::Scene)?;
    }
    let camera = world.cameras.get(loaded.camera_at(frame));
    let camera = camera.map(|c| c.value.clone()).unwrap_or_default();
    let view = View::new(&camera, options.image.size, options.unit_m(&world));
    let indices = skipping.skipped(&world, &view, settings);
    let kept = skipping.kept(&world, &indices).into_iter();
    Ok(Some(SkippedInfo {
        frame,
        skip_px: settings.skip_px,
        instances: (indices.iter())
            .map(|index| world.instances[*index].name.clone())
            .collect(),
        kept: kept
            .map(|(reason, count)| KeptInfo { reason, count })
            .collect(),
        refused: skipping.refused,
    }))
}

/// Lines of the text output.
pub fn lines(info: &SkippedInfo) -> Vec<(&'static str, String)> {
    let (frame, px, count) = (info.frame, info.skip_px, info.instances.len());
    if let Some(why) = &info.refused {
        return vec![("skipped", format!("nothing in reflections: {why}"))];
    }
    let all = count + info.kept.iter().map(|kept| kept.count).sum::<usize>();
    let mut text =
        format!("{count} of {all} instances in reflections of frame {frame}, smaller than {px} px");
    if count > 0 {
        text += &format!(": {}", first(&info.instances));
    }
    let mut lines = vec![("skipped", text)];
    if !info.kept.is_empty() {
        let of = |kept: &KeptInfo| format!("{} {}", kept.count, kept.reason.name());
        let kept: Vec<String> = info.kept.iter().map(of).collect();
        lines.push(("not skipped", kept.join(", ")));
    }
    lines
}
