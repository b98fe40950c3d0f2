//! What the rendering thread does on demand: compare with `rt`, write a picture, tell the material
//! under the pointer.

use super::{
    canvas::Canvas,
    desk::free_name,
    facts::{Inspect, Inspection, Judged, Look, Report, View},
    worker::State,
};
use crate::{
    app::{aov, output},
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
                Inspect::Shot(folder, stem) => {
                    let said = match self.shot(&view) {
                        Ok(png) => {
                            let path = free_name(&folder, &stem);
                            match crate::files::write_whole(&path, &png) {
                                Ok(()) => format!("wrote {}", path.display()),
                                Err(error) => format!("cannot write {}: {error}", path.display()),
                            }
                        }
                        Err(error) => format!("no screenshot: {error}"),
                    };
                    self.tell(Report::Note(said));
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
        let heat = Canvas::of_size(&self.gpu, self.heat.take(), size)?;
        let rgb = flip::heat(&maps.flip);
        let rgba: Vec<u8> = rgb
            .chunks_exact(3)
            .flat_map(|p| [p[0], p[1], p[2], 255])
            .collect();
        heat.write(&self.gpu, &rgba);
        self.heat = Some(heat.clone());
        self.tell(Report::Judged(Box::new(Judged {
            view,
            edits,
            scores: maps.scores(None),
            heat,
        })));
        Ok(())
    }

    /// What is shown, or left of the wipe: the finished picture or another texture, at full size.
    fn shot(&mut self, view: &View) -> Result<Vec<u8>, String> {
        let read = self.read(view, view.a.method);
        let (size, mut rgba) = read.map_err(|error| error.to_string())?;
        if let Look::Aov(shown) = view.a.look {
            let camera = self.camera(&view.eye);
            let plane = shown.plane(&self.gpu, self.live.renderer(), &camera);
            rgba = aov::view(&plane.map_err(|error| error.to_string())?);
        }
        output::encode_png(size, &rgba, None)
    }

    pub(super) fn pick(&mut self, at: [f32; 2]) -> Result<(), RenderError> {
        let [width, height] = self.live.renderer().targets().size;
        let ids: Vec<[u32; 2]> = self.live.renderer().read(&self.gpu, Target::Ids)?;
        let pixel = |part: f32, side: u32| ((part * side as f32) as u32).min(side - 1);
        let index = pixel(at[1], height) * width + pixel(at[0], width);
        let instances = &self.live.world().instances;
        let instance = instances.get(ids[index as usize][0] as usize);
        self.tell(Report::Picked(instance.map(|found| found.material)));
        Ok(())
    }
}
