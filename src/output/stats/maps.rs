//! Text about the maps that a frame's method captures.

use super::mebibytes;
use reflet_render::renderer::stats::FrameStats;

/// Maps that the frame captured or kept, by their label; a capture is not part of the frame's time, and one before the
/// timed picture may have no time.
pub fn captured(frame: &FrameStats) -> Option<(&'static str, String)> {
    let maps = frame.maps.as_ref()?;
    let (text, bytes) = (&maps.facts.texts[0], mebibytes(maps.facts.bytes));
    let ms = maps.capture_ms;
    let when = match (maps.update_ms > 0.0, ms > 0.0) {
        (true, _) => format!("captured for this picture in {ms:.3} ms, apart from the passes"),
        (false, true) => format!("captured before in {ms:.3} ms, apart from the passes"),
        (false, false) => "captured before this picture was timed".to_owned(),
    };
    Some((maps.facts.label, format!("{text}, {bytes}; {when}")))
}
