//! Place of a session, which is lent to one call at a time.

use std::{
    mem, process,
    sync::{Condvar, Mutex, MutexGuard, PoisonError, atomic::AtomicBool},
    thread::{self, ThreadId},
    time::Duration,
};

use pyo3::prelude::*;

use crate::{
    errors::{Failure, exception},
    work::{self, Teller},
};
use reflet_render::runtime::Session;

/// Time between two looks for Ctrl-C while another thread has the session.
const TICK: Duration = Duration::from_millis(40);

/// A session, or why there is none.
enum State {
    /// It is here.
    Free(Box<Session>),
    /// A call on this thread has it.
    Lent(ThreadId),
    /// It was closed.
    Closed,
}

/// A session that calls take turns with.
pub struct Slot {
    state: Mutex<State>,
    /// Told when the session is back.
    back: Condvar,
    process: u32,
}

impl Slot {
    /// Place of an open session.
    pub fn new(session: Session) -> Self {
        Self {
            state: Mutex::new(State::Free(Box::new(session))),
            back: Condvar::new(),
            process: process::id(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the session, for which it waits while another thread has it.
    ///
    /// # Errors
    /// `ClosedError`; `ForkError` in a forked process; `Error` where the session's own progress function asks for it;
    /// `KeyboardInterrupt`.
    fn take(&self, py: Python<'_>) -> PyResult<Box<Session>> {
        if self.process != process::id() {
            work::check_fork(py)?;
        }
        let own = thread::current().id();
        loop {
            let taken = py.detach(|| {
                let mut state = self.lock();
                if matches!(&*state, State::Lent(thread) if *thread != own) {
                    let waited = self.back.wait_timeout(state, TICK);
                    state = waited.unwrap_or_else(PoisonError::into_inner).0;
                }
                match mem::replace(&mut *state, State::Lent(own)) {
                    State::Free(session) => Some(Ok(session)),
                    other => {
                        *state = other;
                        match &*state {
                            State::Closed => Some(Err(("ClosedError", "the session is closed"))),
                            State::Lent(thread) if *thread == own => {
                                let text =
                                    "the session is at work: its progress function cannot use it";
                                Some(Err(("Error", text)))
                            }
                            _ => None,
                        }
                    }
                }
            });
            match taken {
                Some(Ok(session)) => return Ok(session),
                Some(Err((class, text))) => return Err(exception(py, class, text)),
                None => py.check_signals()?,
            }
        }
    }

    fn put(&self, state: State) {
        *self.lock() = state;
        self.back.notify_all();
    }

    /// Reads from the session on the calling thread.
    ///
    /// # Errors
    /// Same errors as [`Slot::work`], but no errors of the work.
    pub fn read<T>(&self, py: Python<'_>, read: impl FnOnce(&Session) -> T) -> PyResult<T> {
        let session = self.take(py)?;
        let value = read(&session);
        self.put(State::Free(session));
        Ok(value)
    }

    /// Works with the session on a thread of its own.
    ///
    /// # Errors
    /// A session that cannot be taken, and errors of the work and of [`work::run`]. After a panic the session is
    /// closed.
    pub fn work<T: Send + 'static>(
        &self,
        py: Python<'_>,
        stop: &AtomicBool,
        teller: Option<&Teller<'_>>,
        work: impl FnOnce(&mut Session) -> Result<T, Failure> + Send + 'static,
    ) -> PyResult<T> {
        let mut session = self.take(py)?;
        let (done, raised) = work::run(py, stop, teller, move || {
            let done = work(&mut session);
            (session, done)
        });
        let done = match done {
            Ok((session, done)) => {
                self.put(State::Free(session));
                done
            }
            Err(failure) => {
                self.put(State::Closed);
                Err(failure)
            }
        };
        raised?;
        done.map_err(|failure| failure.into_py(py))
    }

    /// Closes the session and frees its device; a closed one stays closed.
    ///
    /// # Errors
    /// Same errors as [`Slot::read`], but a closed session is none.
    pub fn close(&self, py: Python<'_>) -> PyResult<()> {
        if self.is_closed() {
            return Ok(());
        }
        let session = self.take(py)?;
        self.put(State::Closed);
        py.detach(|| drop(session));
        Ok(())
    }

    /// Whether the session is closed.
    pub fn is_closed(&self) -> bool {
        self.process == process::id() && matches!(&*self.lock(), State::Closed)
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        // The threads of the device are missing in a forked process, where freeing it would wait for them.
        if self.process != process::id() {
            let state = self.state.get_mut().unwrap_or_else(PoisonError::into_inner);
            mem::forget(mem::replace(state, State::Closed));
        }
    }
}
