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

use crate::{
    app::{
        live::{Done, Reload, ReloadJob, Reuse},
        preview::mailbox::Mailbox,
    },
    scene::script::Halt,
};

/// So long a picture waits for a script: most are done by then, and no picture is drawn twice.
const PATIENCE: Duration = Duration::from_millis(30);
/// So long a script goes on though another frame or other parameters are wanted by now: something
/// is seen while a slider moves.
pub(super) const GRACE: Duration = Duration::from_millis(300);

/// Why the scene is read anew.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) keeps: Reuse,
    /// Since when a save is known; `None` for parameters.
    pub(super) saved: Option<Instant>,
    /// What was done for the same changes already.
    pub(super) before: Reload,
}

/// An errand on its thread; dropping it halts its scripts.
pub(super) struct Running {
    halt: Halt,
    answer: Receiver<Done>,
    pub(super) started: Instant,
    pub(super) frame: u32,
    poses: Arc<AtomicBool>,
}

impl Running {
    pub(super) fn start(reload_job: ReloadJob, mailbox: &Mailbox) -> Self {
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
    pub(super) fn poses_other(&self, frame: u32) -> bool {
        self.frame != frame && self.poses.load(Ordering::Relaxed)
    }

    /// What came of it, if it is done or soon will be.
    pub(super) fn answer(&self) -> Option<Done> {
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
    pub(super) wanted: Option<Wanted>,
    pub(super) reading: Option<(Running, Wanted)>,
    pub(super) posing: Option<Running>,
    /// Since when something runs, as it was told.
    pub(super) told: Option<Instant>,
    /// When what runs must be looked at again.
    pub(super) look: Option<Instant>,
}

impl ReloadJobs {
    pub(super) fn want(&mut self, new: Wanted) {
        self.wanted = Some(match self.wanted.take() {
            Some(old) => old.then(new),
            None => new,
        });
    }

    /// Whether something may go on; if so, only for a while.
    pub(super) fn has_grace(&mut self, running: &Running) -> bool {
        let end = running.started + GRACE;
        let has_grace = Instant::now() < end;
        if has_grace {
            self.look_at(end);
        }
        has_grace
    }

    pub(super) fn look_at(&mut self, time: Instant) {
        self.look = Some(self.look.map_or(time, |look| look.min(time)));
    }
}

impl Wanted {
    pub(super) fn then(self, new: Self) -> Self {
        Self {
            keeps: self.keeps.and(new.keeps),
            saved: new.saved.or(self.saved),
            before: self.before.and(new.before),
        }
    }
}
