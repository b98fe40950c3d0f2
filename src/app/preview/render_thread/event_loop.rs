//! The loop of the rendering thread: takes the newest view and every task, draws, reports, and
//! sleeps when nothing changed.

use std::time::Duration;

use super::worker::State;
use crate::{
    app::{
        live::Edit,
        preview::{
            mailbox::Mailbox,
            protocol::{Report, Shown, Task, View, Visualization},
        },
        watch::Watcher,
    },
    render::RenderError,
};

/// While frames follow each other, their numbers are told this often: they are read, not seen.
const TELL: Duration = Duration::from_millis(250);

impl State {
    pub(super) fn run(mut self, mailbox: &Mailbox, watcher: Option<&Watcher>) {
        self.tell_facts();
        while let Some((view, tasks)) = mailbox.take(self.until()) {
            let mut redraw = false;
            if let Some(view) = view {
                redraw = self.view.as_ref().is_none_or(|old| view.looks_other(old));
                self.view = Some(view);
            }
            for task in tasks {
                match task {
                    Task::Reload(changes, since) => self.reload(&changes, since),
                    Task::Edit(edit) => {
                        redraw = true;
                        self.edit(edit);
                    }
                    Task::Tune(tuned) => self.tune(tuned),
                    Task::Unwatched(why) => self.tell(Report::Unwatched(why)),
                    Task::Inspect(inspection) => self.inspections.push_back(inspection),
                    Task::Unpick => self.unpick(),
                }
            }
            redraw |= self.reload_jobs(mailbox, watcher);
            redraw |= self.reloads.iter().any(|(reload, _)| reload.ok);
            if redraw && !self.is_aside() {
                self.draw();
            }
            for (reload, since) in std::mem::take(&mut self.reloads) {
                let ms = since.elapsed().as_secs_f64() * 1e3;
                self.tell(Report::Reloaded(reload, ms));
            }
            self.inspect();
            if mailbox.is_empty() && self.inspections.is_empty() {
                self.tell(Report::Idle);
            }
        }
    }

    /// Whether the posed frame is not the view's, but that of something on demand.
    fn is_aside(&self) -> bool {
        let posed = self.live.posed_frame();
        let is_posed = |frame: u32| frame == posed;
        (self.inspections.front()).is_some_and(|of| is_posed(of.view.frame))
            && !(self.view.as_ref()).is_some_and(|view| is_posed(view.frame))
    }

    fn edit(&mut self, edit: Edit) {
        match self.live.edit(edit) {
            Ok(_) => self.tell_facts(),
            Err(error) => self.refuse(&error),
        }
    }

    fn draw(&mut self) {
        let Some(view) = self.view.clone() else {
            return;
        };
        match self.sides(&view).and_then(|s| Ok((s, self.picked()?))) {
            Ok((sides, picked)) => {
                self.drawn = Some(view.clone());
                self.number += 1;
                let had_problem = self.live.problems.refused.take().is_some();
                let number = self.number;
                self.tell(Report::Shown(Box::new(Shown {
                    number,
                    frame: self.live.posed_frame(),
                    camera: self.camera(&view.eye),
                    size: view.size,
                    sides,
                    picked,
                })));
                // Numbers that move are told now and then, and when they rest.
                let is_new = self.told_frame != self.live.posed_frame();
                let is_time = view.draft_ms.is_none() || self.told_at.elapsed() >= TELL;
                if had_problem || (is_new && is_time) {
                    self.tell_facts();
                }
            }
            Err(error) => self.refuse(&error),
        }
    }

    fn sides(&mut self, view: &View) -> Result<Vec<Visualization>, RenderError> {
        let mut sides: Vec<Visualization> = Vec::new();
        for (index, side) in std::iter::once(view.a).chain(view.b).enumerate() {
            let last = sides.last().filter(|_| view.a.method == side.method);
            let stats = match last {
                Some(last) => last.stats.clone(),
                None => self.render(view, side.method)?,
            };
            let old = self.canvases.get(index).cloned();
            let drawn = self.drawn(side, view, stats, old)?;
            self.canvases.truncate(index);
            self.canvases.push(drawn.canvas.clone());
            sides.push(drawn);
        }
        Ok(sides)
    }
}
