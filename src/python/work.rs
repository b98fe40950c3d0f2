//! Work that runs beside the interpreter: on a thread of its own, while the calling thread looks for Ctrl-C and tells
//! the progress.

use std::{
    any::Any,
    panic::{AssertUnwindSafe, catch_unwind},
    process,
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, AtomicU32, Ordering},
        mpsc::{self, RecvTimeoutError},
    },
    thread,
    time::Duration,
};

use pyo3::{exceptions::PyRuntimeError, prelude::*};

use crate::errors::{Failure, exception};
use reflet_gpu::Gpu;

/// Time between two looks for Ctrl-C.
const TICK: Duration = Duration::from_millis(40);

/// Stack of a thread that works, bytes, as of a program's first thread on Linux.
const STACK: usize = 8 << 20;

/// Process in which threads were started; 0 before that.
static PROCESS: AtomicU32 = AtomicU32::new(0);

/// Refuses to work in a process that was forked from one that has worked: its threads are missing here, and the
/// driver's locks may be held for ever.
///
/// # Errors
/// `reflet.ForkError`.
pub fn check_fork(py: Python<'_>) -> PyResult<()> {
    let own = process::id();
    match PROCESS.compare_exchange(0, own, Ordering::Relaxed, Ordering::Relaxed) {
        Err(other) if other != own => {
            let text = "this process was forked from one that used Reflet, whose device does not survive that; start \
                        processes by multiprocessing.get_context(\"spawn\"), or open no scene before the fork";
            Err(exception(py, "ForkError", text))
        }
        _ => Ok(()),
    }
}

/// How far a picture is.
#[derive(Default)]
pub struct Progress {
    /// Device that counts sub-frames; none before the picture has begun. Nothing else of Python keeps it, so that a
    /// closed session frees it.
    gpu: OnceLock<Arc<Gpu>>,
    /// Count of the device's sub-frames when the picture began.
    began: AtomicU32,
    /// Number of sub-frames of the picture; 0 before it has begun, and where an error bound decides.
    total: AtomicU32,
    /// Signal that ends the picture.
    pub stop: Arc<AtomicBool>,
}

impl Progress {
    /// Notes that a picture of so many sub-frames begins; 0 where an error bound decides.
    pub fn begin(&self, gpu: &Arc<Gpu>, total: u32) {
        self.began
            .store(gpu.sub_frames.load(Ordering::Relaxed), Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
        self.gpu.get_or_init(|| Arc::clone(gpu));
    }

    /// Number of finished sub-frames, and of all where it is known; `None` before the first.
    fn counts(&self) -> Option<(u32, Option<u32>)> {
        let gpu = self.gpu.get()?;
        let began = self.began.load(Ordering::Relaxed);
        let done = gpu.sub_frames.load(Ordering::Relaxed).wrapping_sub(began);
        let total = self.total.load(Ordering::Relaxed);
        Some((done, (total > 0).then_some(total)))
    }
}

/// Function of the user that is told the progress.
pub struct Teller<'a> {
    /// Function of the number of finished sub-frames, and of all or `None`.
    pub function: &'a Bound<'a, PyAny>,
    /// The picture.
    pub progress: Arc<Progress>,
}

impl Teller<'_> {
    fn tell(&self, told: &mut Option<u32>) -> PyResult<()> {
        match self.progress.counts() {
            Some((done, total)) if *told != Some(done) => {
                *told = Some(done);
                self.function.call1((done, total)).map(drop)
            }
            _ => Ok(()),
        }
    }
}

/// Does work on a thread of its own and waits for it. After Ctrl-C, or an error of the user's function, `stop` is set,
/// the end of the work is waited for, and its result is handed to `keep` all the same.
///
/// # Errors
/// `KeyboardInterrupt`, whatever the user's function raised, a thread that cannot be started.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    stop: &AtomicBool,
    teller: Option<&Teller<'_>>,
    work: impl FnOnce() -> T + Send + 'static,
) -> (Result<T, Failure>, PyResult<()>) {
    let (sender, mut receiver) = mpsc::channel();
    let body = move || {
        // Unwind safe: after a panic nothing of the work is used again.
        let done =
            catch_unwind(AssertUnwindSafe(work)).map_err(|panic| Failure::Bug(text_of(&*panic)));
        // The receiver waits until it has an answer.
        let _ = sender.send(done);
    };
    let thread = thread::Builder::new()
        .name("reflet".to_owned())
        .stack_size(STACK);
    let thread = match thread.spawn(body) {
        Ok(thread) => thread,
        Err(error) => {
            let text = format!("cannot start a thread: {error}");
            return (
                Err(Failure::Bug(text.clone())),
                Err(PyRuntimeError::new_err(text)),
            );
        }
    };
    let (mut told, mut raised) = (None, Ok(()));
    let done = loop {
        let got;
        (receiver, got) = py.detach(move || {
            let got = receiver.recv_timeout(TICK);
            (receiver, got)
        });
        match got {
            Ok(done) => break done,
            Err(RecvTimeoutError::Disconnected) => {
                break Err(Failure::Bug("a thread ended".to_owned()));
            }
            Err(RecvTimeoutError::Timeout) if raised.is_err() => {}
            Err(RecvTimeoutError::Timeout) => {
                let tell = |()| teller.map_or(Ok(()), |teller| teller.tell(&mut told));
                raised = py.check_signals().and_then(tell);
                stop.store(raised.is_err(), Ordering::Relaxed);
            }
        }
    };
    // Destructors of the thread's own values end before another call begins.
    py.detach(move || drop(thread.join()));
    if raised.is_ok() && done.is_ok() {
        raised = teller.map_or(Ok(()), |teller| teller.tell(&mut told));
    }
    (done, raised)
}

/// Message of a panic.
fn text_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("it panicked").to_owned()
}
