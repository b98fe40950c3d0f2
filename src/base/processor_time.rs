//! CPU time, which other work on the machine does not lengthen as it does wall time.

use std::{thread::JoinHandle, time::Duration};

use super::clock::Instant;

/// CPU time of this thread so far; `None` where the system does not tell.
pub fn of_thread() -> Option<Duration> {
    #[cfg(unix)]
    return clock(libc::CLOCK_THREAD_CPUTIME_ID);
    #[cfg(not(unix))]
    None
}

/// CPU time of another thread so far; `None` where the system does not tell.
pub fn of_other_thread<T>(thread: &JoinHandle<T>) -> Option<Duration> {
    #[cfg(target_os = "linux")]
    {
        use std::os::unix::thread::JoinHandleExt as _;
        clock_of(thread.as_pthread_t()).and_then(clock)
    }
    #[cfg(not(target_os = "linux"))]
    {
        let _ = thread;
        None
    }
}

/// CPU time of all threads of the process so far; `None` where the system does not tell.
pub fn of_process() -> Option<Duration> {
    #[cfg(unix)]
    return clock(libc::CLOCK_PROCESS_CPUTIME_ID);
    #[cfg(not(unix))]
    None
}

/// Times of some work of the process, from its start.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    started: Instant,
    processor: Option<Duration>,
}

impl Stopwatch {
    /// Starts to measure.
    pub fn start() -> Self {
        Self {
            processor: of_process(),
            started: Instant::now(),
        }
    }

    /// Wall time since the start, milliseconds.
    pub fn wall_ms(&self) -> f64 {
        self.started.elapsed().as_secs_f64() * 1e3
    }

    /// CPU time of the process since the start, milliseconds; `None` where the system does not tell.
    pub fn processor_ms(&self) -> Option<f64> {
        let (before, after) = self.processor.zip(of_process())?;
        Some(after.saturating_sub(before).as_secs_f64() * 1e3)
    }

    /// Cost of work of an adapter since the start, milliseconds: CPU time where it draws on the processor and the
    /// system tells it, else wall time.
    pub fn cost_ms(&self, is_software: bool) -> f64 {
        let processor = self.processor_ms().filter(|_| is_software);
        processor.unwrap_or_else(|| self.wall_ms())
    }
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

#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "the standard library has no such clock")]
fn clock_of(thread: libc::pthread_t) -> Option<libc::clockid_t> {
    let mut id = 0;
    // SAFETY: the handle of the thread exists, so that its number is valid; the call writes the one clock.
    let failed = unsafe { libc::pthread_getcpuclockid(thread, &raw mut id) };
    (failed == 0).then_some(id)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_stopwatch_tells_work_from_waiting() {
        let watch = Stopwatch::start();
        std::thread::sleep(Duration::from_millis(20));
        let wall_ms = watch.wall_ms();
        assert!(wall_ms >= 20.0 && watch.cost_ms(false) >= wall_ms);
        assert_eq!(watch.processor_ms().is_some(), of_process().is_some());
        assert!(watch.cost_ms(true) >= 0.0);
    }

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
