//! CPU time, which other work on the machine does not lengthen as it does wall time.

use std::time::Duration;

/// CPU time of this thread so far; `None` where the system does not tell.
pub fn of_thread() -> Option<Duration> {
    #[cfg(unix)]
    return clock(libc::CLOCK_THREAD_CPUTIME_ID);
    #[cfg(not(unix))]
    None
}

/// CPU time of all threads of the process so far; `None` where the system does not tell.
pub fn of_process() -> Option<Duration> {
    #[cfg(unix)]
    return clock(libc::CLOCK_PROCESS_CPUTIME_ID);
    #[cfg(not(unix))]
    None
}

#[cfg(unix)]
#[expect(
    unsafe_code,
    reason = "the standard library has no such clock; /proc has it on Linux only, in a file for each thread"
)]
fn clock(id: libc::clockid_t) -> Option<Duration> {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: the call writes the one `timespec` that it is given.
    let failed = unsafe { libc::clock_gettime(id, &raw mut time) };
    let nanos = u32::try_from(time.tv_nsec).ok()?;
    (failed == 0).then_some(Duration::new(time.tv_sec.try_into().ok()?, nanos))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn work_takes_processor_time() {
        for now in [of_thread, of_process] {
            let before = now().expect("Unix has the clock");
            let mut x = 1u64;
            while now().expect("as before") <= before {
                for _ in 0..100_000 {
                    x = std::hint::black_box(
                        x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1),
                    );
                }
            }
        }
    }
}
