//! Memory that this process uses and may still allocate, and the budget that its loads share. Only Linux tells what
//! is left; elsewhere the budget is one of Reflet's own.

use std::{
    fs,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

/// Peak resident memory of this process, bytes.
pub fn peak_resident_bytes() -> Option<u64> {
    kibibytes(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM")
}

/// Bytes that this process can still allocate without being killed for it: the least of the machine's free memory
/// and swap, the room in its control groups, and the room in its address space.
pub fn available_bytes() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| machine_bytes(&text));
    let group = read("/proc/self/cgroup").and_then(|text| group_bytes(&text, CONTROL_GROUPS));
    let space = read("/proc/self/limits").zip(read("/proc/self/status"));
    let space = space.and_then(|(limits, status)| space_bytes(&limits, &status));
    [machine, group, space].into_iter().flatten().min()
}

/// Bytes that are assumed to be available where the system does not tell it (macOS, Windows).
pub const ASSUMED_BYTES: u64 = 8 << 30;

/// Bytes that the parts of one load may still allocate; clones share the same budget.
#[derive(Clone, Debug)]
pub struct Budget(Arc<AtomicU64>);

impl Default for Budget {
    /// Budget without a limit.
    fn default() -> Self {
        Self::new(u64::MAX)
    }
}

impl Budget {
    /// Budget of this many bytes.
    pub fn new(bytes: u64) -> Self {
        Self(Arc::new(AtomicU64::new(bytes)))
    }

    /// Budget for the memory that this process can allocate now.
    pub fn of_machine() -> Self {
        Self::from_available(available_bytes())
    }

    /// Budget of three quarters of the available memory, or of [`ASSUMED_BYTES`] where that is unknown: data that is
    /// read is also copied, and other processes allocate memory too.
    fn from_available(available_bytes: Option<u64>) -> Self {
        let left = available_bytes.unwrap_or(ASSUMED_BYTES);
        Self::new(left - left / 4)
    }

    /// Bytes that may still be taken.
    pub fn left(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }

    /// Takes bytes from the budget, or none where fewer are left; returns whether it took them.
    #[must_use]
    pub fn take(&self, bytes: u64) -> bool {
        let taken = |left: u64| left.checked_sub(bytes);
        (self.0)
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, taken)
            .is_ok()
    }

    /// Takes bytes until the result is dropped: memory that is freed again, such as a decoder's. `None` where fewer
    /// are left.
    #[must_use]
    pub fn hold(&self, bytes: u64) -> Option<Reservation> {
        let budget = self.clone();
        self.take(bytes).then(|| Reservation { budget, bytes })
    }
}

/// Bytes taken from a [`Budget`], which are given back when this is dropped.
#[derive(Debug)]
pub struct Reservation {
    budget: Budget,
    bytes: u64,
}

impl Drop for Reservation {
    fn drop(&mut self) {
        // No overflow: these bytes were taken before.
        (self.budget.0).fetch_add(self.bytes, Ordering::Relaxed);
    }
}

/// Number of jobs, at least 1, that fit in `left` bytes at once, of jobs that each take so many bytes for a while.
pub fn wave_length(job_bytes: impl Iterator<Item = u64>, left: u64) -> usize {
    let mut bytes = 0u64;
    let fits = |own: &u64| {
        bytes = bytes.saturating_add(*own);
        bytes <= left
    };
    job_bytes.take_while(fits).count().max(1)
}

const CONTROL_GROUPS: &str = "/sys/fs/cgroup";

/// Number in the line `name: 12 kB` of a text, in bytes.
fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let mut lines = text.lines();
    let value = lines.find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    let number: u64 = value.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(number * 1024)
}

fn machine_bytes(meminfo: &str) -> Option<u64> {
    let swap = kibibytes(meminfo, "SwapFree").unwrap_or(0);
    Some(kibibytes(meminfo, "MemAvailable")? + swap)
}

/// File names of one version of control groups, and the folder that this version is mounted at.
struct GroupFiles {
    folder: &'static str,
    most: &'static str,
    now: &'static str,
    /// Prefix of the line of `memory.stat` with the bytes of cached files.
    cached: &'static str,
}

const VERSION_1: GroupFiles = GroupFiles {
    folder: "memory",
    most: "memory.limit_in_bytes",
    now: "memory.usage_in_bytes",
    cached: "total_inactive_file ",
};
const VERSION_2: GroupFiles = GroupFiles {
    folder: "",
    most: "memory.max",
    now: "memory.current",
    cached: "inactive_file ",
};

/// Least room, bytes, in the memory control groups that the text of `/proc/self/cgroup` names, and in their parents.
fn group_bytes(cgroup: &str, mount: &str) -> Option<u64> {
    let left = |line: &str| {
        // A line is `7:cpu,memory:/path`; in version 2 it is `0::/path`.
        let (controllers, path) = line.split_once(':')?.1.split_once(':')?;
        let files = match controllers {
            "" => &VERSION_2,
            some if some.split(',').any(|name| name == "memory") => &VERSION_1,
            _ => return None,
        };
        let mount = Path::new(mount).join(files.folder);
        let group = mount.join(path.trim_start_matches('/'));
        // Inside a container, the path may be the host's; the mount is then the container's own group.
        let groups = group.ancestors().take_while(|at| at.starts_with(&mount));
        groups.filter_map(|at| left_in_group(at, files)).min()
    };
    cgroup.lines().filter_map(left).min()
}

/// Bytes left in one control group; cached file content does not count as used, since it is freed under pressure.
fn left_in_group(folder: &Path, files: &GroupFiles) -> Option<u64> {
    let number = |file: &str| -> Option<u64> {
        let text = fs::read_to_string(folder.join(file)).ok()?;
        text.trim().parse().ok()
    };
    let (most, now) = (number(files.most)?, number(files.now)?);
    let stat = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let cached = stat
        .lines()
        .find_map(|line| line.strip_prefix(files.cached)?.trim().parse().ok());
    Some(most.saturating_sub(now.saturating_sub(cached.unwrap_or(0))))
}

fn space_bytes(limits: &str, status: &str) -> Option<u64> {
    let mut lines = limits.lines();
    let limit = lines.find_map(|line| line.strip_prefix("Max address space"))?;
    // `unlimited` does not parse as a number and gives `None`.
    let limit: u64 = limit.split_whitespace().next()?.parse().ok()?;
    Some(limit.saturating_sub(kibibytes(status, "VmSize")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_texts_of_linux_are_read() {
        let meminfo =
            "MemTotal:  100 kB\nMemFree:  10 kB\nMemAvailable:   64 kB\nSwapFree:  6 kB\n";
        assert_eq!(machine_bytes(meminfo), Some(70 * 1024));
        assert_eq!(machine_bytes("MemTotal: 100 kB"), None);
        let limits = |most: &str| {
            format!("Limit  Soft  Hard  Units\nMax address space   {most}  unlimited  bytes\n")
        };
        let status = "Name:\treflet\nVmPeak:\t 9 kB\nVmSize:\t 2 kB\n";
        assert_eq!(space_bytes(&limits("10000"), status), Some(10000 - 2048));
        assert_eq!(space_bytes(&limits("1000"), status), Some(0));
        assert_eq!(space_bytes(&limits("unlimited"), status), None);
    }

    #[test]
    fn the_least_of_all_groups_counts() {
        let mount = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("target/tmp")
            .join(format!("groups-{}", std::process::id()));
        let inner = mount.join("outer/inner");
        fs::create_dir_all(&inner).unwrap();
        let write = |file: &str, text: &str| fs::write(mount.join(file), text).unwrap();
        write("outer/memory.max", "1000\n");
        write("outer/memory.current", "700\n");
        write(
            "outer/memory.stat",
            "anon 5\ninactive_file 200\nactive_file 9\n",
        );
        write("outer/inner/memory.max", "max\n");
        write("outer/inner/memory.current", "600\n");
        // Version 1, in a container whose own group is the mount; "unlimited" is a huge number there.
        fs::create_dir_all(mount.join("memory/job")).unwrap();
        write("memory/memory.limit_in_bytes", "2000\n");
        write("memory/memory.usage_in_bytes", "900\n");
        write(
            "memory/memory.stat",
            "inactive_file 7\ntotal_inactive_file 100\n",
        );
        write("memory/job/memory.limit_in_bytes", "9223372036854771712\n");
        write("memory/job/memory.usage_in_bytes", "500\n");
        let left = |text: &str| group_bytes(text, mount.to_str().unwrap());
        let found = [
            left("0::/outer/inner\n"),
            left("0::/\n"),
            left("5:cpu,memory:/job\n"),
            left("1:name=systemd:/\n5:memory:/docker/12ab\n0::/\n"),
            left("5:memory:/job\n0::/outer\n"),
            left("5:cpuset:/outer\n"),
        ];
        fs::remove_dir_all(&mount).unwrap();
        let expected = [Some(500), None, Some(1200), Some(1200), Some(500), None];
        assert_eq!(found, expected);
    }

    #[test]
    fn linux_says_what_is_left() {
        if cfg!(target_os = "linux") {
            let total = fs::read_to_string("/proc/meminfo").unwrap();
            let total = kibibytes(&total, "MemTotal").unwrap();
            let left = available_bytes().unwrap();
            assert!(left > 0, "{left} of {total}");
            assert!(peak_resident_bytes().unwrap() < total);
            let most = Budget::of_machine().left();
            assert!(0 < most && most < total, "{most}");
        }
    }

    #[test]
    fn parts_share_a_budget() {
        let budget = Budget::from_available(Some(1000));
        let part = budget.clone();
        assert_eq!(part.left(), 750);
        assert!(part.take(700) && !budget.take(51) && budget.take(50) && !part.take(1));
        assert_eq!((budget.left(), part.left()), (0, 0));
    }

    #[test]
    fn what_is_held_is_given_back() {
        let budget = Budget::new(100);
        let held = budget.hold(60).unwrap();
        assert_eq!(budget.left(), 40);
        assert!(budget.clone().hold(41).is_none());
        drop(held);
        assert_eq!(budget.left(), 100);
    }

    #[test]
    fn as_many_jobs_run_at_once_as_fit() {
        let length = |left: u64| wave_length([40, 30, 50].into_iter(), left);
        assert_eq!([119, 120, 70, 69, 0].map(length), [2, 3, 2, 1, 1]);
    }

    #[test]
    fn systems_that_tell_nothing_have_a_budget_too() {
        assert_eq!(Budget::from_available(None).left(), ASSUMED_BYTES / 4 * 3);
    }
}
