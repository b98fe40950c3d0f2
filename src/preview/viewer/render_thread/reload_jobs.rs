//! Reload jobs: scripts run on threads of their own; meanwhile the last good scene is rendered.

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
    live::{FinishedJob, ReloadJob},
    viewer::mailbox::Mailbox,
};
use reflet_scene::script::Halt;

/// Time that a picture waits for a script: most scripts end within it, which saves rendering twice.
const SCRIPT_WAIT: Duration = Duration::from_millis(30);
/// Time that an outdated job may continue after a newer request, so that pictures appear while a
/// slider moves.
pub(super) const GRACE_PERIOD: Duration = Duration::from_millis(300);

/// A reload job on its thread; dropping it halts its scripts.
pub(super) struct RunningJob {
    halt: Halt,
    answer: Receiver<FinishedJob>,
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
            // Sending fails for a halted job.
            if done.is_some_and(|done| sender.send(done).is_ok()) {
                mailbox.wake();
            }
        };
        let thread = thread::Builder::new().name("reload job".into());
        // Without a free thread, pictures wait for the script.
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

    /// Whether the job poses a frame other than this.
    pub(super) fn poses_other_frame(&self, frame: u32) -> bool {
        self.frame != frame && self.poses.load(Ordering::Relaxed)
    }

    /// Result of the job, if it ends within `SCRIPT_WAIT` of its start.
    pub(super) fn answer(&self) -> Option<FinishedJob> {
        let patience = SCRIPT_WAIT.saturating_sub(self.started.elapsed());
        // A job catches its own panics, so that a result always comes.
        self.answer.recv_timeout(patience).ok()
    }
}

impl Drop for RunningJob {
    fn drop(&mut self) {
        self.halt.halt();
    }
}

/// Running jobs.
#[derive(Default)]
pub(super) struct ReloadJobs {
    pub(super) reading: Option<RunningJob>,
    pub(super) posing: Option<RunningJob>,
    /// Start of the oldest running job, as reported last.
    pub(super) reported_start: Option<Instant>,
    /// When to check the running jobs again.
    pub(super) next_check: Option<Instant>,
}

impl ReloadJobs {
    /// Whether an outdated job is in its grace period; schedules the check at its end.
    pub(super) fn in_grace_period(&mut self, started: Instant) -> bool {
        let end = started + GRACE_PERIOD;
        let in_grace_period = Instant::now() < end;
        if in_grace_period {
            self.check_at(end);
        }
        in_grace_period
    }

    /// Whether a read runs that is in its grace period.
    pub(super) fn reads_in_grace_period(&mut self) -> bool {
        let started = self.reading.as_ref().map(|running| running.started);
        started.is_some_and(|started| self.in_grace_period(started))
    }

    pub(super) fn check_at(&mut self, time: Instant) {
        self.next_check = Some(self.next_check.map_or(time, |next| next.min(time)));
    }
}
