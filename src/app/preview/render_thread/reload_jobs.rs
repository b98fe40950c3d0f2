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
const SCRIPT_WAIT: Duration = Duration::from_millis(30);
/// So long a script goes on though another frame or other parameters are wanted by now: something
/// is seen while a slider moves.
pub(super) const GRACE_PERIOD: Duration = Duration::from_millis(300);

/// Why the scene is read anew.
#[derive(Clone, Copy, Debug)]
pub(super) struct PendingRead {
    pub(super) keeps: Reuse,
    /// Since when a save is known; `None` for parameters.
    pub(super) saved: Option<Instant>,
    /// What was done for the same changes already.
    pub(super) before: Reload,
}

/// An errand on its thread; dropping it halts its scripts.
pub(super) struct RunningJob {
    halt: Halt,
    answer: Receiver<Done>,
    pub(super) started: Instant,
    pub(super) frame: u32,
    poses: Arc<AtomicBool>,
}

impl RunningJob {
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
    pub(super) fn poses_other_frame(&self, frame: u32) -> bool {
        self.frame != frame && self.poses.load(Ordering::Relaxed)
    }

    /// What came of it, if it is done or soon will be.
    pub(super) fn answer(&self) -> Option<Done> {
        let patience = SCRIPT_WAIT.saturating_sub(self.started.elapsed());
        // What panics in an errand is caught there, so that an answer comes.
        self.answer.recv_timeout(patience).ok()
    }
}

impl Drop for RunningJob {
    fn drop(&mut self) {
        self.halt.halt();
    }
}

/// What runs, and what waits for it.
#[derive(Default)]
pub(super) struct ReloadJobs {
    pub(super) wanted: Option<PendingRead>,
    pub(super) reading: Option<(RunningJob, PendingRead)>,
    pub(super) posing: Option<RunningJob>,
    /// Since when something runs, as it was told.
    pub(super) told: Option<Instant>,
    /// When what runs must be looked at again.
    pub(super) next_check: Option<Instant>,
}

impl ReloadJobs {
    pub(super) fn queue(&mut self, new: PendingRead) {
        self.wanted = Some(match self.wanted.take() {
            Some(old) => old.then(new),
            None => new,
        });
    }

    /// Whether something may go on; if so, only for a while.
    pub(super) fn in_grace_period(&mut self, running: &RunningJob) -> bool {
        let end = running.started + GRACE_PERIOD;
        let in_grace_period = Instant::now() < end;
        if in_grace_period {
            self.check_at(end);
        }
        in_grace_period
    }

    pub(super) fn check_at(&mut self, time: Instant) {
        self.next_check = Some(self.next_check.map_or(time, |next| next.min(time)));
    }
}

impl PendingRead {
    pub(super) fn then(self, new: Self) -> Self {
        Self {
            keeps: self.keeps.and(new.keeps),
            saved: new.saved.or(self.saved),
            before: self.before.and(new.before),
        }
    }
}
