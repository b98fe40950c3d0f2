//! Processor time of the process's threads, which load beside them does not lengthen as it does wall time.

use std::fs;

/// Processor time of all threads that live now, milliseconds; `None` but on Linux.
pub fn processor_ms() -> Option<f64> {
    let tasks = fs::read_dir("/proc/self/task").ok()?;
    let mut total_ns = 0;
    for task in tasks.flatten() {
        // A thread may end between the listing and the reading.
        let Ok(text) = fs::read_to_string(task.path().join("schedstat")) else {
            continue;
        };
        // Nanoseconds on a processor come first; Linux, Documentation/scheduler/sched-stats.rst.
        total_ns += text.split_whitespace().next()?.parse::<u64>().ok()?;
    }
    (total_ns > 0).then_some(total_ns as f64 * 1e-6)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn work_takes_processor_time() {
        let Some(before) = processor_ms() else {
            return; // a kernel without scheduler statistics
        };
        let mut x = 1u64;
        while processor_ms().expect("as before") <= before {
            for _ in 0..100_000 {
                x = std::hint::black_box(x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
            }
        }
    }
}
