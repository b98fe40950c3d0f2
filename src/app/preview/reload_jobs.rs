//! Scripts run beside the rendering thread, which goes on with the last good scene meanwhile.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, Receiver},
    },
    thread,
    time::{Duration, Instant},
};

use super::{mailbox::Mailbox, protocol::Report, render_thread::State};
use crate::{
    app::{
        live::{Done, Live, Reload, ReloadJob, Reuse},
        params::ParameterOverrides,
        watch::{Changes, Watcher},
    },
    scene::script::Halt,
};

/// So long a picture waits for a script: most are done by then, and no picture is drawn twice.
const PATIENCE: Duration = Duration::from_millis(30);
/// So long a script goes on though another frame or other parameters are wanted by now: something
/// is seen while a slider moves.
const GRACE: Duration = Duration::from_millis(300);

/// Why the scene is read anew.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    keeps: Reuse,
    /// Since when a save is known; `None` for parameters.
    saved: Option<Instant>,
    /// What was done for the same changes already.
    before: Reload,
}

/// An errand on its thread; dropping it halts its scripts.
struct Running {
    halt: Halt,
    answer: Receiver<Done>,
    started: Instant,
    frame: u32,
    poses: Arc<AtomicBool>,
}

impl Running {
    fn start(reload_job: ReloadJob, mailbox: &Mailbox) -> Self {
        let (frame, poses) = (reload_job.frame(), reload_job.poses.clone());
        let (sender, answer) = mpsc::channel();
        let halt = Halt::default();
        let (own, mailbox) = (halt.clone(), mailbox.clone());
        let reload_job = Arc::new(Mutex::new(Some(reload_job)));
        let shared = reload_job.clone();
        let work = move || {
            let reload_job = shared.lock().unwrap_or_else(PoisonError::into_inner).take();
            let done = reload_job.map(|reload_job| own.over(|| reload_job.run()));
            // Nobody waits for one that was halted.
            if done.is_some_and(|done| sender.send(done).is_ok()) {
                mailbox.wake();
            }
        };
        let thread = thread::Builder::new().name("errand".into());
        // Where the system has no thread left, pictures wait for the script.
        if thread.spawn(work.clone()).is_err() {
            work();
        }
        Self {
            halt,
            answer,
            started: Instant::now(),
            frame,
            poses,
        }
    }

    /// Whether it poses another frame than this.
    fn poses_other(&self, frame: u32) -> bool {
        self.frame != frame && self.poses.load(Ordering::Relaxed)
    }

    /// What came of it, if it is done or soon will be.
    fn answer(&self) -> Option<Done> {
        let patience = PATIENCE.saturating_sub(self.started.elapsed());
        // What panics in an errand is caught there, so that an answer comes.
        self.answer.recv_timeout(patience).ok()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.halt.halt();
    }
}

/// What runs, and what waits for it.
#[derive(Default)]
pub(super) struct ReloadJobs {
    wanted: Option<Wanted>,
    reading: Option<(Running, Wanted)>,
    posing: Option<Running>,
    /// Since when something runs, as it was told.
    told: Option<Instant>,
    /// When what runs must be looked at again.
    look: Option<Instant>,
}

impl ReloadJobs {
    fn want(&mut self, new: Wanted) {
        self.wanted = Some(match self.wanted.take() {
            Some(old) => old.then(new),
            None => new,
        });
    }

    /// Whether something may go on; if so, only for a while.
    fn has_grace(&mut self, running: &Running) -> bool {
        let end = running.started + GRACE;
        let has_grace = Instant::now() < end;
        if has_grace {
            self.look_at(end);
        }
        has_grace
    }

    fn look_at(&mut self, time: Instant) {
        self.look = Some(self.look.map_or(time, |look| look.min(time)));
    }
}

impl Wanted {
    fn then(self, new: Self) -> Self {
        Self {
            keeps: self.keeps.and(new.keeps),
            saved: new.saved.or(self.saved),
            before: self.before.and(new.before),
        }
    }
}

impl State {
    /// Takes over shaders; what else changed is read in [`State::errands`].
    pub(super) fn reload(&mut self, changes: &Changes, since: Instant) {
        let before = self.live.reload_shaders(changes);
        match Live::after(changes) {
            Some(keeps) => self.reload_jobs.want(Wanted {
                keeps,
                saved: Some(since),
                before,
            }),
            None => {
                self.reloads.push((before, since));
                self.tell_facts();
            }
        }
    }

    /// Has the scene read with other parameters.
    pub(super) fn tune(&mut self, tuned: ParameterOverrides) {
        self.live.tune(tuned);
        self.reload_jobs.want(Wanted {
            keeps: Reuse {
                files: true,
                edits: true,
            },
            saved: None,
            before: Reload {
                ok: true,
                ..Reload::default()
            },
        });
    }

    /// When there is something to do though nobody asks for anything.
    pub(super) fn until(&self) -> Option<Instant> {
        let is_behind = self.reload_jobs.posing.is_none()
            && (self.wanted()).is_some_and(|(frame, _)| self.live.posing(frame).is_some());
        if is_behind {
            Some(Instant::now())
        } else {
            self.reload_jobs.look
        }
    }

    /// Starts what is wanted and takes over what is done; whether there is something new to see.
    pub(super) fn reload_jobs(&mut self, mailbox: &Mailbox, watcher: Option<&Watcher>) -> bool {
        self.reload_jobs.look = None;
        let mut is_new = false;
        while let Some(is_shown) = self.read_scene(mailbox, watcher) {
            is_new |= is_shown;
        }
        is_new |= self.pose(mailbox, watcher);
        let (reading, posing) = (&self.reload_jobs.reading, &self.reload_jobs.posing);
        let since = [
            reading.as_ref().map(|(running, _)| running.started),
            posing.as_ref().map(|running| running.started),
        ];
        let since = since.into_iter().flatten().min();
        if reading.is_some() {
            // What it imports may be mended while it runs, and is looked for one by one.
            self.reload_jobs.look_at(Instant::now() + GRACE);
            if self.live.watch_list().0 != self.watched {
                self.watch(watcher);
            }
        }
        if since != self.reload_jobs.told {
            self.reload_jobs.told = since;
            self.tell(Report::Script(since));
        }
        is_new
    }

    /// Whether a scene that was read is shown; `None` while there is none.
    fn read_scene(&mut self, mailbox: &Mailbox, watcher: Option<&Watcher>) -> Option<bool> {
        let (frame, plays) = self.wanted().unwrap_or((0, false));
        if let Some((running, of)) = self.reload_jobs.reading.take() {
            let is_left = !plays && running.poses_other(frame);
            if is_left && !self.reload_jobs.has_grace(&running) {
                let wanted = self.reload_jobs.wanted.take();
                self.reload_jobs.wanted = Some(wanted.map_or(of, |wanted| of.then(wanted)));
            } else {
                self.reload_jobs.reading = Some((running, of));
            }
        }
        if let Some(wanted) = self.reload_jobs.wanted.take() {
            let old = self.reload_jobs.reading.take();
            match old {
                Some((running, of))
                    if wanted.saved.is_none() && self.reload_jobs.has_grace(&running) =>
                {
                    self.reload_jobs.reading = Some((running, of));
                    self.reload_jobs.wanted = Some(wanted);
                }
                old => {
                    let wanted = old.map_or(wanted, |(_, of)| of.then(wanted));
                    let reload_job = self.live.reading(wanted.keeps, frame);
                    self.reload_jobs.reading = Some((Running::start(reload_job, mailbox), wanted));
                }
            }
        }
        let (running, wanted) = self.reload_jobs.reading.as_ref()?;
        let (done, wanted) = (running.answer()?, *wanted);
        self.reload_jobs.reading = None;
        self.reload_jobs.posing = None; // of the scene before
        let reload = wanted.before.and(self.live.take(done));
        if self.live.reads_again() {
            self.reload_jobs.want(wanted);
            return Some(false);
        }
        self.watch(watcher);
        let refusal = self.live.refusal();
        match (&refusal, wanted.saved) {
            (_, Some(since)) => self.reloads.push((reload, since)),
            (None, None) => self.tell(Report::ParameterOverrides(reload)),
            (Some(_), None) => {}
        }
        if let Some(refusal) = refusal {
            self.tell(Report::Refused(Box::new(refusal)));
        }
        self.tell_facts();
        Some(reload.ok)
    }

    /// The frame that is wanted now, and whether others follow it by themselves: that of what is asked
    /// for on demand, else the view's.
    fn wanted(&self) -> Option<(u32, bool)> {
        let on_demand = self.inspections.front().map(|of| (of.view.frame, false));
        on_demand.or_else(|| self.view.as_ref().map(|view| (view.frame, view.plays)))
    }

    /// Goes to the wanted frame; what is wrong there is told, and told again when it is over.
    /// Whether another frame is shown.
    fn pose(&mut self, mailbox: &Mailbox, watcher: Option<&Watcher>) -> bool {
        let Some((frame, plays)) = self.wanted() else {
            return false;
        };
        let reload_job = self.live.posing(frame);
        let wanted = reload_job.as_ref().map(ReloadJob::frame);
        let old = self.reload_jobs.posing.take();
        // What plays shows each frame that is ready, however late.
        let goes_on = |old: &Running, reload_jobs: &mut ReloadJobs| {
            plays || wanted == Some(old.frame) || (wanted.is_some() && reload_jobs.has_grace(old))
        };
        let old = old.filter(|old| goes_on(old, &mut self.reload_jobs));
        let new = |reload_job| Running::start(reload_job, mailbox);
        self.reload_jobs.posing = old.or_else(|| reload_job.map(new));
        let Some(done) = self.reload_jobs.posing.as_ref().and_then(Running::answer) else {
            return false;
        };
        self.reload_jobs.posing = None;
        let before = self.live.problems.clone();
        let is_shown = self.live.take(done).ok;
        if self.live.problems != before {
            // A saved scene may only now have been taken over.
            self.watch(watcher);
            self.tell_facts();
        }
        is_shown
    }
}
