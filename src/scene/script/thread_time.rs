//! Processor time of this thread, which other work on the machine does not lengthen as it does wall time.

use std::time::Duration;

/// Processor time of this thread so far; `None` where the system does not tell.
#[cfg(unix)]
#[expect(
    unsafe_code,
    reason = "the standard library has no such clock, and /proc has it on Linux only"
)]
pub fn processor_time() -> Option<Duration> {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: the call writes the one `timespec` that it is given.
    let failed = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    let nanos = u32::try_from(time.tv_nsec).ok()?;
    (failed == 0).then_some(Duration::new(time.tv_sec.try_into().ok()?, nanos))
}

/// Processor time of this thread so far; `None` where the system does not tell.
#[cfg(not(unix))]
pub fn processor_time() -> Option<Duration> {
    None
}
