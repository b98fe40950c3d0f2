//! Screenshots: both sides of a wipe with its line, or the error map, as a file. Labels and the
//! outline of the selection belong to the window and are left out.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{
    dynamic_resolution::RestBudget,
    pixels::{Pixels, compose_wipe},
    worker::Worker,
};
use crate::viewer::protocol::{Reply, Report, Screenshot, ScreenshotGoal, Side, View};
use reflet_base::files::{Goal, write_whole};
use reflet_render::picture::png_file;

impl Worker {
    /// Writes a screenshot and reports its path, or answers with it.
    pub(super) fn write_screenshot(&mut self, view: &View, screenshot: &Screenshot) {
        // A file has all samples, however many the view has so far.
        let all = RestBudget::starting(f64::INFINITY);
        let budget = std::mem::replace(&mut self.rest_budget, all);
        let rendered = self.render_screenshot(view, screenshot);
        self.rest_budget = budget;
        let (folder, stem) = match &screenshot.goal {
            ScreenshotGoal::File { folder, stem } => (folder, stem),
            ScreenshotGoal::Reply(Reply(reply)) => {
                // Whoever asked may be gone.
                let _ = reply.send(rendered);
                return;
            }
        };
        let path = free_name(folder, stem);
        let said = match rendered {
            Ok(png) => match write_whole(&Goal::in_folder(&path), &png) {
                Ok(()) => format!("wrote {}", path.display()),
                Err(error) => format!("cannot write {}: {error}", path.display()),
            },
            Err(error) => format!("no screenshot: {error}"),
        };
        self.send(Report::Message(said));
    }

    /// Renders at full size, also while something moves.
    fn render_screenshot(
        &mut self,
        view: &View,
        screenshot: &Screenshot,
    ) -> Result<Vec<u8>, String> {
        let view = View {
            draft_ms: None,
            ..view.clone()
        };
        let error_map = self.error_map.as_ref().filter(|_| screenshot.error_map);
        let left = match error_map.map(|(_, pixels)| pixels.clone()) {
            Some(pixels) => pixels,
            None => self.side(view.a, &view)?,
        };
        let whole = match view.b {
            None => left,
            Some(b) => {
                let right = self.side(b, &view)?;
                let size = if left.size == right.size {
                    left.size
                } else {
                    self.live.renderer().targets().size
                };
                compose_wipe(&left, &right, screenshot.wipe_at, size)
            }
        };
        png_file::encode(whole.size, &whole.rgba, &[])
    }

    fn side(&mut self, side: Side, view: &View) -> Result<Pixels, String> {
        let rendered = self.render(view, side.method);
        let pixels = rendered.and_then(|stats| self.pixels(side.channel, view, &stats));
        let (pixels, _) = pixels.map_err(|error| error.to_string())?;
        Ok(pixels)
    }
}

/// The first unused file name: `scene-001.png`.
fn free_name(folder: &Path, stem: &str) -> PathBuf {
    let name = |number: u32| folder.join(format!("{stem}-{number:03}.png"));
    let is_free = |path: &PathBuf| fs::symlink_metadata(path).is_err();
    let found = (1..u32::MAX).map(name).find(is_free);
    found.unwrap_or_else(|| name(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn screenshots_never_overwrite_each_other() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        assert_eq!(free_name(folder, "a"), folder.join("a-001.png"));
        for number in 1..=10_000 {
            fs::write(folder.join(format!("a-{number:03}.png")), "").expect("written");
        }
        let next = free_name(folder, "a");
        assert_eq!(next, folder.join("a-10001.png"));
    }
}
