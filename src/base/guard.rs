//! Boundaries around libraries that read strangers' data: a panic inside, or work that does not end, becomes an error.

use std::{
    cell::Cell,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::mpsc::{RecvTimeoutError, channel},
    thread,
    time::Duration,
};

use crate::processor_time;

thread_local! {
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Whether a panic of this thread becomes an error, so that nobody need be told of it.
pub fn is_guarded() -> bool {
    IS_GUARDED.get()
}

/// Result of work, whose data is dropped after a panic; `None` if it panicked.
pub fn catch<T>(work: impl FnOnce() -> T) -> Option<T> {
    let outer = IS_GUARDED.replace(true);
    let done = catch_unwind(AssertUnwindSafe(work));
    IS_GUARDED.set(outer);
    done.ok()
}

/// The reason why guarded work has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// It panicked.
    Panicked,
    /// It took too long. Its thread is left behind: only the end of the process ends it.
    TookTooLong,
}

/// Result of work on a thread of its own; in a page, which has but one, on that.
///
/// # Errors
/// The payload of a panic.
pub fn apart<T: Send>(
    thread: thread::Builder,
    work: impl FnOnce() -> T + Send,
) -> thread::Result<T> {
    if cfg!(target_arch = "wasm32") {
        return Ok(work());
    }
    thread::scope(|scope| {
        let worker = thread.spawn_scoped(scope, work);
        worker.expect("the system can start a thread").join()
    })
}

/// Result of work on a thread of its own, which may take this much processor time; wall time where the system does not
/// tell a thread's.
///
/// # Errors
/// A panic, and work that does not end by then.
pub fn within<T: Send + 'static>(
    most: Duration,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Ended> {
    if cfg!(target_arch = "wasm32") {
        return catch(work).ok_or(Ended::Panicked); // a page has one thread, which nothing can stop
    }
    let (sender, receiver) = channel();
    let worker = thread::spawn(move || sender.send(catch(work)));
    let mut left = most;
    loop {
        match receiver.recv_timeout(left) {
            Ok(done) => return done.ok_or(Ended::Panicked),
            Err(RecvTimeoutError::Disconnected) => return Err(Ended::Panicked),
            Err(RecvTimeoutError::Timeout) => {}
        }
        let used = processor_time::of_other_thread(&worker).unwrap_or(most);
        left = most.saturating_sub(used);
        if left.is_zero() {
            return Err(Ended::TookTooLong);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    };

    use super::*;

    #[test]
    fn work_that_panics_or_does_not_end_is_told() {
        let long = Duration::from_secs(600);
        assert_eq!(within(long, || 5), Ok(5));
        assert_eq!(
            within(long, || assert!(!is_guarded())),
            Err(Ended::Panicked)
        );
        assert_eq!(catch(is_guarded), Some(true));
        assert!(!is_guarded());
        // It ends as soon as it is told that it took too long.
        let goes_on = Arc::new(AtomicBool::new(true));
        let same = Arc::clone(&goes_on);
        let endless = move || while same.load(Ordering::Relaxed) {};
        assert_eq!(
            within(Duration::from_millis(20), endless),
            Err(Ended::TookTooLong)
        );
        goes_on.store(false, Ordering::Relaxed);
    }
}
