//! Event loop of the rendering thread: takes the newest view and every task, draws, reports, and
//! sleeps when nothing changed.

use std::{
    sync::{Arc, atomic::AtomicBool},
    time::{Duration, Instant},
};

use super::{dynamic_resolution::RestBudget, worker::Worker};
use crate::{
    live::Edit,
    viewer::{
        mailbox::Mailbox,
        protocol::{FinishedFrame, Picked, Report, Task, View, Visualization},
        view_channel::ViewChannel,
    },
    watch::Watcher,
};
use reflet_gpu::GpuError;
use reflet_render::RenderError;

/// Minimum interval of summaries while playing.
const SUMMARY_INTERVAL: Duration = Duration::from_millis(250);

/// Longest wait of an edit for the reload of a text that the edit before it has written.
pub(super) const OWN_RELOAD_WAIT: Duration = Duration::from_secs(2);

impl Worker {
    pub(super) fn run(mut self, mailbox: &Mailbox, watcher: Option<&Watcher>) {
        self.send_summary();
        while let Some((view, tasks)) = mailbox.take(self.next_wakeup()) {
            let mut redraw = false;
            if let Some(view) = view {
                redraw |= self.view.as_ref().is_none_or(|old| view.differs_from(old));
                self.view = Some(view);
            }
            for task in tasks {
                redraw |= self.take(task);
            }
            redraw |= self.run_jobs(mailbox, watcher);
            redraw |= self.take_waiting();
            if self.reloads.iter().any(|(reload, _)| reload.ok) {
                redraw = true;
                self.saves += 1;
                self.show_item_again();
            }
            if redraw {
                let rest_ms = self.view.as_ref().map_or(0.0, |view| view.rest_ms);
                self.rest_budget = RestBudget::starting(rest_ms);
            }
            // A picture that was given up for these requests, or that is to have more sub-frames.
            let is_unfinished = std::mem::take(&mut self.is_interrupted) || self.is_refining();
            if (redraw || is_unfinished) && !self.renders_other_frame() {
                self.rest_budget.grow();
                self.draw_unless(mailbox.news());
            }
            if self.summary_due().is_some_and(|due| due <= Instant::now()) {
                self.send_summary();
            }
            for (reload, since) in std::mem::take(&mut self.reloads) {
                let ms = since.elapsed().as_secs_f64() * 1e3;
                self.send(Report::Reloaded(reload, ms));
            }
            self.handle_frame_requests();
            let is_over = mailbox.is_empty() && self.frame_requests.is_empty();
            if is_over && !self.is_interrupted && !self.is_refining() {
                self.send(Report::Idle);
            }
        }
    }

    /// Performs a task; one that writes waits until the reload of an earlier written text is over, since it starts from
    /// the shown scene. Returns whether the picture changes.
    fn take(&mut self, task: Task) -> bool {
        if task.writes() && (self.awaits_reload() || !self.waiting.is_empty()) {
            self.waiting.push_back(task);
            return false;
        }
        self.perform(task)
    }

    fn take_waiting(&mut self) -> bool {
        let mut redraw = false;
        while !self.awaits_reload()
            && let Some(task) = self.waiting.pop_front()
        {
            redraw |= self.perform(task);
        }
        redraw
    }

    fn awaits_reload(&self) -> bool {
        (self.own_write).is_some_and(|written| written.elapsed() < OWN_RELOAD_WAIT)
    }

    /// Notes that a text was written, if one was.
    pub(super) fn note_writes(&mut self) {
        let writes = self.live.writes();
        if std::mem::replace(&mut self.own_writes, writes) != writes {
            self.own_write = Some(Instant::now());
        }
    }

    fn perform(&mut self, task: Task) -> bool {
        let mut redraw = false;
        match task {
            Task::Reload(changes, since) => self.reload(&changes, since),
            Task::Edit(edit) => {
                self.edit(*edit);
                redraw = true;
            }
            Task::SetParameters(overrides) => self.live.set_parameters(overrides),
            Task::Unwatched(why) => self.send(Report::Unwatched(why)),
            Task::Frame(request) => self.frame_requests.push_back(*request),
            Task::Unpick => self.unpick(),
            Task::Select(item) => {
                self.select(item);
                redraw = true;
            }
            Task::Drag(item, numbers) => redraw = self.drag(item, &numbers),
            Task::DropDrag => redraw = self.drop_drag(),
            Task::Write(item, numbers) => redraw = self.write(item, &numbers),
            Task::WriteMaterial(material, numbers) => self.write_material(material, &numbers),
            Task::WriteParameters(values) => {
                self.unwritten = Some(values);
                self.write_parameters();
            }
            Task::Key(edit) => self.edit_key(&edit),
            Task::Flight(camera, points) => self.write_flight(&camera, &points),
            Task::Undo(again) => self.undo(again),
        }
        self.note_writes();
        redraw
    }

    /// Whether the posed frame belongs to a pending request, not to the view.
    fn renders_other_frame(&self) -> bool {
        let posed = self.live.scene().frame;
        let is_posed = |frame: u32| frame == posed;
        (self.frame_requests.front()).is_some_and(|of| is_posed(of.view.frame))
            && !(self.view.as_ref()).is_some_and(|view| is_posed(view.frame))
    }

    /// Whether the view rests with fewer sub-frames than the scene wants.
    pub(super) fn is_refining(&self) -> bool {
        let rests = self.view.as_ref().is_some_and(|v| v.draft_ms.is_none());
        rests && self.rest_budget.is_short() && !self.renders_other_frame()
    }

    /// Time at which the summary of the shown frame is to be sent; `None` if that was sent.
    pub(super) fn summary_due(&self) -> Option<Instant> {
        let is_shown = self.rendered_view.is_some() && !self.renders_other_frame();
        let is_stale = is_shown && self.summary_frame != self.live.scene().frame;
        is_stale.then(|| self.summary_sent_at + SUMMARY_INTERVAL)
    }

    fn edit(&mut self, edit: Edit) {
        match self.live.edit(edit) {
            Ok(_) => self.send_summary(),
            Err(error) => self.report_error(&error),
        }
    }

    /// Shows the scene coarsely first, while most of its pipelines are not built.
    fn draw_coarse(&mut self, view: &View) -> Result<(), RenderError> {
        if view.a.channel == ViewChannel::Picture && view.b.is_none() {
            let stats = self.render_coarse(view)?;
            let side = self.visualize(view.a, view, stats, None)?;
            self.textures = vec![side.texture.clone()];
            self.finish(view, vec![side], None);
        }
        Ok(())
    }

    fn finish(&mut self, view: &View, sides: Vec<Visualization>, picked: Option<Picked>) {
        self.number += 1;
        let number = self.number;
        self.send(Report::Frame(Box::new(FinishedFrame {
            number,
            saves: self.saves,
            frame: self.live.scene().frame,
            camera: self.camera(&view.camera),
            size: view.size,
            is_draft: view.draft_ms.is_some(),
            sides,
            picked,
        })));
    }

    /// Draws the view. A picture at rest is given up where `news` come: input never waits for it. Pictures of motion
    /// are drafts, which take little time, and would never end if the next move gave them up.
    fn draw_unless(&mut self, news: Arc<AtomicBool>) {
        let rests = self.view.as_ref().is_some_and(|v| v.draft_ms.is_none());
        self.gpu.interrupt_by(rests.then_some(news));
        self.draw();
        self.gpu.interrupt_by(None);
    }

    fn draw(&mut self) {
        let Some(view) = self.view.clone() else {
            return;
        };
        let was_coarse = self.live.is_coarse();
        if was_coarse && let Err(error) = self.draw_coarse(&view) {
            return self.not_drawn(&error);
        }
        match self
            .render_sides(&view)
            .and_then(|s| Ok((s, self.picked()?)))
        {
            Ok((sides, picked)) => {
                self.rendered_view = Some(view.clone());
                let had_problem = self.live.problems.undrawn.take().is_some();
                self.finish(&view, sides, picked);
                // Animated values are sent at intervals, and once they rest.
                let is_new = self.summary_frame != self.live.scene().frame;
                let is_time =
                    view.draft_ms.is_none() || self.summary_sent_at.elapsed() >= SUMMARY_INTERVAL;
                if had_problem || was_coarse || (is_new && is_time) {
                    self.send_summary();
                }
            }
            Err(error) => self.not_drawn(&error),
        }
    }

    fn not_drawn(&mut self, error: &RenderError) {
        match error {
            RenderError::Gpu(GpuError::Interrupted) => self.is_interrupted = true,
            error => self.report_error(error),
        }
    }

    fn render_sides(&mut self, view: &View) -> Result<Vec<Visualization>, RenderError> {
        let mut sides: Vec<Visualization> = Vec::new();
        for (index, side) in std::iter::once(view.a).chain(view.b).enumerate() {
            let last = sides.last().filter(|_| view.a.method == side.method);
            let stats = match last {
                Some(last) => last.stats.clone(),
                None => self.render(view, side.method)?,
            };
            let old = self.textures.get(index).cloned();
            let (begun, frame_ms) = (Instant::now(), stats.frame_ms);
            let visualization = self.visualize(side, view, stats, old)?;
            if self.rest_budget.is_short() {
                // Denoising takes time too.
                let ms = begun.elapsed().as_secs_f64() * 1e3;
                self.rest_budget.fall_short(frame_ms + ms);
            }
            self.textures.truncate(index);
            self.textures.push(visualization.texture.clone());
            sides.push(visualization);
        }
        Ok(sides)
    }
}
