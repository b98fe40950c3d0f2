//! What the rendering thread does on demand with the frame that is looked at, and how it compares
//! the left side's method with `rt`.

use super::{
    canvas::Canvas,
    drawn::Pixels,
    facts::{Judged, Report, Task},
    worker::State,
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
    /// Tasks that need a frame.
    pub(super) fn look(&mut self, task: Task) {
        let done = match task {
            Task::Judge(edits) => self.judge(edits),
            Task::Pick(at) => self.pick(at),
            Task::Unpick => {
                self.unpick();
                Ok(())
            }
            Task::Shot(shot) => {
                self.shoot(&shot);
                Ok(())
            }
            Task::Reload(..) | Task::Edit(_) | Task::Tune(_) => Ok(()),
        };
        if let Err(error) = done {
            self.refuse(&error);
        }
    }

    /// Renders one method at full size and reads it back.
    fn read(&mut self, method: Method) -> Result<([u32; 2], Vec<u8>), RenderError> {
        let Some(mut view) = self.view.clone() else {
            return Ok(([1, 1], vec![0; 4]));
        };
        view.draft_ms = None;
        let stats = self.render(&view, method)?;
        let rgba = self.live.renderer().read(&self.gpu, Target::Display)?;
        Ok((stats.size, rgba))
    }

    fn judge(&mut self, edits: u64) -> Result<(), RenderError> {
        let Some(view) = self.view.clone() else {
            return Ok(());
        };
        let method = view.a.method;
        let (size, reference) = self.read(Method::Rt)?;
        let (test_size, test) = self.read(method)?;
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
        let heat = Canvas::of_size(&self.gpu, old, size)?;
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
