//! Frame requests: picks, screenshots, and the comparison of the left side's method with
//! `rt`.

use super::{pixels::Pixels, worker::Worker};
use crate::viewer::{
    frame_texture::FrameTexture,
    protocol::{Comparison, FrameAction, FrameRequest, Report, View},
};
use reflet_metric::{
    Maps, flip,
    picture::{Pair, Picture},
};
use reflet_render::{RenderError, pipeline::targets::Target};
use reflet_scene::desc::Method;

impl Worker {
    /// Handles requests whose frames are posed.
    pub(super) fn handle_frame_requests(&mut self) {
        while let Some(first) = self.frame_requests.front() {
            if self.live.pose_job(first.view.frame).is_some() {
                return;
            }
            let Some(FrameRequest { view, action }) = self.frame_requests.pop_front() else {
                return;
            };
            if !self.live.problems.pose.is_empty() {
                let text = "cannot be posed, so no picture was rendered";
                self.send(Report::Message(format!("frame {} {text}", view.frame)));
                continue;
            }
            let done = match action {
                FrameAction::Compare(edits) => self.compare(view, edits),
                FrameAction::Pick(at) => self.pick(&view, at),
                FrameAction::Screenshot(screenshot) => {
                    self.write_screenshot(&view, &screenshot);
                    Ok(())
                }
            };
            if let Err(error) = done {
                self.report_error(&error);
            }
        }
    }

    /// Renders one method at full size and reads it back.
    fn read(&mut self, view: &View, method: Method) -> Result<([u32; 2], Vec<u8>), RenderError> {
        let view = View {
            draft_ms: None,
            ..view.clone()
        };
        let stats = self.render(&view, method)?;
        let rgba = self.live.renderer().read(&self.gpu, Target::Display)?;
        Ok((stats.size, rgba))
    }

    fn compare(&mut self, view: View, edits: u64) -> Result<(), RenderError> {
        let (size, reference) = self.read(&view, Method::Rt)?;
        let (test_size, test) = self.read(&view, view.a.method)?;
        let picture = |rgba: &[u8]| {
            let rgb: Vec<u8> = rgba
                .chunks_exact(4)
                .flat_map(|p| [p[0], p[1], p[2]])
                .collect();
            Picture::from_rgb8(size[0] as usize, size[1] as usize, &rgb)
        };
        let (Ok(test), Ok(reference)) = (picture(&test), picture(&reference)) else {
            return Ok(());
        };
        let Ok(pair) = Pair::new(&test, &reference) else {
            self.send(Report::Message(format!("{test_size:?} is not {size:?}")));
            return Ok(());
        };
        let maps = Maps::compare(&pair);
        let old = self.error_map.take().map(|(texture, _)| texture);
        let error_map = FrameTexture::of_size(&self.gpu, old, size)?;
        let rgb = flip::heat(&maps.flip);
        let rgba: Vec<u8> = rgb
            .chunks_exact(3)
            .flat_map(|p| [p[0], p[1], p[2], 255])
            .collect();
        error_map.write(&self.gpu, &rgba);
        self.error_map = Some((error_map.clone(), Pixels { size, rgba }));
        self.send(Report::Compared(Box::new(Comparison {
            view,
            edits,
            scores: maps.scores(None),
            error_map,
        })));
        Ok(())
    }
}
