//! Reloads: starts the jobs that read or pose the requested scene and frame, and adopts their
//! results.

use std::time::Instant;

use super::{
    event_loop::OWN_RELOAD_WAIT,
    reload_jobs::{GRACE_PERIOD, ReloadJobs, RunningJob},
    worker::Worker,
};
use crate::{
    live::{Live, ReadRequest, ReloadJob},
    viewer::{mailbox::Mailbox, protocol::Report},
    watch::{Changes, Watcher},
};

impl Worker {
    /// Reloads shaders; queues a read of the scene for all other changes.
    pub(super) fn reload(&mut self, changes: &Changes, since: Instant) {
        let before = self.live.reload_shaders(changes);
        match Live::reuse_after(changes) {
            Some(reuse) => self.live.request_read(ReadRequest {
                reuse,
                saved_at: Some(since),
                before,
            }),
            None => {
                self.reloads.push((before, since));
                self.send_summary();
            }
        }
    }

    /// Time at which the loop must run again without a new view or task.
    pub(super) fn next_wakeup(&self) -> Option<Instant> {
        let is_behind = self.reload_jobs.posing.is_none()
            && self
                .wanted_frame()
                .is_some_and(|(frame, _)| self.live.pose_job(frame).is_some());
        if is_behind || self.is_refining() {
            Some(Instant::now())
        } else {
            let times = self.reload_jobs.next_check.into_iter();
            let waits = self.own_write.filter(|_| !self.waiting.is_empty());
            let waits = waits.map(|written| written + OWN_RELOAD_WAIT);
            times.chain(self.summary_due()).chain(waits).min()
        }
    }

    /// Starts requested jobs and adopts finished ones; returns whether the picture changes.
    pub(super) fn run_jobs(&mut self, mailbox: &Mailbox, watcher: Option<&Watcher>) -> bool {
        self.reload_jobs.next_check = None;
        let mut is_new = false;
        while let Some(is_shown) = self.read_scene(mailbox, watcher) {
            is_new |= is_shown;
        }
        is_new |= self.pose(mailbox, watcher);
        let (reading, posing) = (&self.reload_jobs.reading, &self.reload_jobs.posing);
        let since = [
            reading.as_ref().map(|running| running.started),
            posing.as_ref().map(|running| running.started),
        ];
        let since = since.into_iter().flatten().min();
        if reading.is_some() {
            // The imports of a running script become known one by one, and may be edited meanwhile.
            self.reload_jobs.check_at(Instant::now() + GRACE_PERIOD);
            if self.live.watch_list().0 != self.watched {
                self.watch(watcher);
            }
        }
        if since != self.reload_jobs.reported_start {
            self.reload_jobs.reported_start = since;
            self.send(Report::ScriptRunning(since));
        }
        is_new
    }

    /// Reads the scene; returns whether a new one is shown, `None` while none is ready.
    fn read_scene(&mut self, mailbox: &Mailbox, watcher: Option<&Watcher>) -> Option<bool> {
        let (frame, plays) = self.wanted_frame().unwrap_or((0, false));
        let jobs = &mut self.reload_jobs;
        let is_left = |running: &RunningJob| !plays && running.poses_other_frame(frame);
        if jobs.reading.as_ref().is_some_and(is_left) && !jobs.reads_in_grace_period() {
            jobs.reading = None;
            self.live.leave_read();
        }
        if let Some(wanted) = self.live.requested_read() {
            // A save ends the read that runs; other values wait, so that pictures appear while a slider moves.
            let waits = wanted.saved_at.is_none() && self.reload_jobs.reads_in_grace_period();
            if !waits && let Some(reload_job) = self.live.begin_read(frame) {
                self.reload_jobs.reading = Some(RunningJob::start(reload_job, mailbox));
            }
        }
        let done = self.reload_jobs.reading.as_ref()?.answer()?;
        self.reload_jobs.reading = None;
        self.reload_jobs.posing = None; // the job poses the previous scene
        let saved_at = (self.live.running_read()).and_then(|request| request.saved_at);
        let Some(reload) = self.live.finish_job(done) else {
            return Some(false);
        };
        self.watch(watcher);
        let refusal = self.live.refusal();
        if saved_at.is_some() {
            self.own_write = None;
        }
        match (&refusal, saved_at) {
            (_, Some(since)) => self.reloads.push((reload, since)),
            (None, None) => self.send(Report::ParametersApplied(reload)),
            (Some(_), None) => {}
        }
        match &refusal {
            Some(_) => self.unwritten = None,
            None if reload.ok => {
                self.write_parameters();
                self.note_writes();
            }
            None => {}
        }
        if let Some(refusal) = refusal {
            self.send(Report::Refused(Box::new(refusal)));
        }
        self.send_summary();
        Some(reload.ok)
    }

    /// Requested frame, and whether the timeline is playing: from the first frame request, else from
    /// the view.
    fn wanted_frame(&self) -> Option<(u32, bool)> {
        let on_demand = self.frame_requests.front().map(|of| (of.view.frame, false));
        on_demand.or_else(|| self.view.as_ref().map(|view| (view.frame, view.plays)))
    }

    /// Poses the requested frame, and reports problems with it and their end.
    /// Returns whether the picture changes.
    fn pose(&mut self, mailbox: &Mailbox, watcher: Option<&Watcher>) -> bool {
        let Some((frame, plays)) = self.wanted_frame() else {
            return false;
        };
        let reload_job = self.live.pose_job(frame);
        let wanted = reload_job.as_ref().map(ReloadJob::frame);
        let old = self.reload_jobs.posing.take();
        // Playback shows each finished frame, however late.
        let goes_on = |old: &RunningJob, reload_jobs: &mut ReloadJobs| {
            plays
                || wanted == Some(old.frame)
                || (wanted.is_some() && reload_jobs.in_grace_period(old.started))
        };
        let old = old.filter(|old| goes_on(old, &mut self.reload_jobs));
        let new = |reload_job| RunningJob::start(reload_job, mailbox);
        self.reload_jobs.posing = old.or_else(|| reload_job.map(new));
        let Some(done) = self
            .reload_jobs
            .posing
            .as_ref()
            .and_then(RunningJob::answer)
        else {
            return false;
        };
        self.reload_jobs.posing = None;
        let before = self.live.problems.clone();
        let is_shown = self.live.finish_job(done).is_some_and(|reload| reload.ok);
        if self.live.problems != before {
            // The job may have adopted a saved scene.
            self.watch(watcher);
            self.send_summary();
        }
        is_shown
    }
}
