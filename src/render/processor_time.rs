//! Processor time of the process's threads, which load beside them does not lengthen as it does wall time.

/// Processor time of all threads of the process, milliseconds; `None` but on Linux.
#[cfg(target_os = "linux")]
#[expect(
    unsafe_code,
    reason = "one system call; the files of /proc that say it take a hundred, which pictures of small passes show"
)]
pub fn processor_ms() -> Option<f64> {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: writes to the structure alone.
    let failed = unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut time) };
    (failed == 0).then_some(time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6)
}

/// Processor time of all threads of the process, milliseconds; `None` but on Linux.
#[cfg(not(target_os = "linux"))]
pub fn processor_ms() -> Option<f64> {
    None
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn work_takes_processor_time() {
        let before = processor_ms().expect("Linux has the clock");
        let mut x = 1u64;
        while processor_ms().expect("as before") <= before {
            for _ in 0..100_000 {
                x = std::hint::black_box(x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
            }
        }
    }
}
