//! Frames of a scene that `bench` measures, and the function that poses them.

use crate::{
    app::{error::AppError, scene::choose_camera},
    bench::run::{FrameSeries, Subject},
    output::frames::FrameList,
    runtime::scene_text::LoadedScene,
    scene::stages::Animator,
};

use super::subject;

/// Frame series of a loaded scene with the frames that `--timeline` lists; without it, with its first.
///
/// # Errors
/// A list with frames outside the scene's timeline, a frame that cannot be posed, a camera that does not exist.
pub fn frame_series(
    loaded: LoadedScene,
    name: String,
    camera: Option<&str>,
    list: Option<&str>,
) -> Result<FrameSeries, AppError> {
    let frames = frames(&loaded, list)?;
    let index = choose_camera(&loaded, camera)?;
    let scene = loaded.scene.clone();
    let subject = subject(loaded, name, camera)?;
    let Some(frames) = frames else {
        return Ok(FrameSeries::still(subject));
    };
    let mover = move |subject: &mut Subject, frame| {
        let state = Animator::new(&scene).pose(frame)?;
        subject.world.apply(&state)?;
        subject.camera = subject.world.cameras[index].value.clone();
        Ok(())
    };
    FrameSeries::moving(subject, &frames, Box::new(mover)).map_err(AppError::Scene)
}

/// Frames to measure; none for a still scene without a list.
fn frames(loaded: &LoadedScene, list: Option<&str>) -> Result<Option<Vec<u32>>, AppError> {
    let name = &loaded.name;
    match (list, &loaded.scene.timeline) {
        (Some(list), Some(timeline)) => {
            let frames = FrameList::parse("--timeline", list, timeline)?;
            Ok(Some(frames.0))
        }
        (Some(list), None) => Err(AppError::Usage(format!(
            "--timeline {list}: {name} has no [timeline], so it has no frames; write `[timeline]` \
             with `end = 47`, or leave --timeline out"
        ))),
        (None, timeline) => {
            if loaded.scene.is_still() {
                return Ok(None);
            }
            if let Some(timeline) = timeline.as_ref().filter(|t| t.end > t.start) {
                let (start, end) = (timeline.start, timeline.end);
                let step = (end - start).div_ceil(8);
                reflet_base::error_line!(
                    "note: {name}: of the frames {start} to {end} of its timeline only {start} is \
                     measured; with --timeline all, or such as {start}-{end}:{step}, others are"
                );
            }
            Ok(Some(vec![loaded.scene.first_frame()]))
        }
    }
}
