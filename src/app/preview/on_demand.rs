//! What the rendering thread does on demand with the frame that is looked at, and how it compares
//! the left side's method with `rt`.

use super::{
    frame_texture::FrameTexture,
    protocol::{Inspect, Inspection, Judged, Report, View},
    render_thread::State,
    visualize::Pixels,
};
use crate::{
    bench::{
        metric::{Maps, flip},
        picture::{Pair, Picture},
    },
    render::{RenderError, targets::Target},
    scene::desc::Method,
};

impl State {
    /// Does what was asked for of frames, as far as these are posed.
    pub(super) fn inspect(&mut self) {
        while let Some(first) = self.inspections.front() {
            if self.live.posing(first.view.frame).is_some() {
                return;
            }
            let Some(Inspection { view, with }) = self.inspections.pop_front() else {
                return;
            };
            if !self.live.problems.pose.is_empty() {
                let text = "cannot be posed, so that nothing was made of it";
                self.tell(Report::Note(format!("frame {} {text}", view.frame)));
                continue;
            }
            let done = match with {
                Inspect::Judge(edits) => self.judge(view, edits),
                Inspect::Pick(at) => self.pick(&view, at),
                Inspect::Screenshot(shot) => {
                    self.shoot(&view, &shot);
                    Ok(())
                }
            };
            if let Err(error) = done {
                self.refuse(&error);
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

    fn judge(&mut self, view: View, edits: u64) -> Result<(), RenderError> {
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
            self.tell(Report::Note(format!("{test_size:?} is not {size:?}")));
            return Ok(());
        };
        let maps = Maps::of(&pair);
        let old = self.heat.take().map(|(canvas, _)| canvas);
        let heat = FrameTexture::of_size(&self.gpu, old, size)?;
        let rgb = flip::heat(&maps.flip);
        let rgba: Vec<u8> = rgb
            .chunks_exact(3)
            .flat_map(|p| [p[0], p[1], p[2], 255])
            .collect();
        heat.write(&self.gpu, &rgba);
        self.heat = Some((heat.clone(), Pixels { size, rgba }));
        self.tell(Report::Judged(Box::new(Judged {
            view,
            edits,
            scores: maps.scores(None),
            heat,
        })));
        Ok(())
    }
}
