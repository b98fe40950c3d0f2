//! How much memory this process has, and may still take, where the system tells it (Linux).

use std::{fs, path::Path};

/// Peak resident memory of this process.
pub fn peak_resident_bytes() -> Option<u64> {
    kibibytes(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM")
}

/// What this process can still take without being ended for it: of the machine's memory and swap, of its
/// control groups (version 2) and of its address space, the least.
pub fn available_bytes() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| machine_bytes(&text));
    let group = read("/proc/self/cgroup").and_then(|text| group_bytes(&text, CONTROL_GROUPS));
    let space = read("/proc/self/limits").zip(read("/proc/self/status"));
    let space = space.and_then(|(limits, status)| space_bytes(&limits, &status));
    [machine, group, space].into_iter().flatten().min()
}

/// A budget of so many bytes, or of three quarters of what is left, if that is less: what is read is also
/// copied, and others take memory too.
pub fn budget(bytes: u64) -> u64 {
    let left = available_bytes().unwrap_or(u64::MAX);
    bytes.min(left - left / 4)
}

const CONTROL_GROUPS: &str = "/sys/fs/cgroup";

/// The number of a line `name: 12 kB`, in bytes.
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

/// Of the group that the text of `/proc/self/cgroup` names, and of those around it.
fn group_bytes(cgroup: &str, mount: &str) -> Option<u64> {
    let path = cgroup.lines().find_map(|line| line.strip_prefix("0::"))?;
    let group = Path::new(mount).join(path.trim_start_matches('/'));
    let groups = group.ancestors().take_while(|at| at.starts_with(mount));
    groups.filter_map(left_in_group).min()
}

/// Without what is cached of files, which is given back where memory is short.
fn left_in_group(folder: &Path) -> Option<u64> {
    let number = |file: &str| -> Option<u64> {
        let text = fs::read_to_string(folder.join(file)).ok()?;
        text.trim().parse().ok()
    };
    let (most, now) = (number("memory.max")?, number("memory.current")?);
    let stat = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let cached = stat
        .lines()
        .find_map(|line| line.strip_prefix("inactive_file ")?.trim().parse().ok());
    Some(most.saturating_sub(now.saturating_sub(cached.unwrap_or(0))))
}

fn space_bytes(limits: &str, status: &str) -> Option<u64> {
    let mut lines = limits.lines();
    let limit = lines.find_map(|line| line.strip_prefix("Max address space"))?;
    // `unlimited` is no number.
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
        let left = |text: &str| group_bytes(text, mount.to_str().unwrap());
        let found = [
            left("0::/outer/inner\n"),
            left("0::/\n"),
            left("1:memory:/outer\n"),
        ];
        fs::remove_dir_all(&mount).unwrap();
        assert_eq!(found, [Some(500), None, None]);
    }

    #[test]
    fn linux_says_what_is_left() {
        if cfg!(target_os = "linux") {
            let total = fs::read_to_string("/proc/meminfo").unwrap();
            let total = kibibytes(&total, "MemTotal").unwrap();
            let left = available_bytes().unwrap();
            assert!(left > 0, "{left} of {total}");
            assert!(peak_resident_bytes().unwrap() < total);
            let most = budget(u64::MAX);
            assert!(0 < most && most < total, "{most}");
            assert_eq!(budget(1), 1);
        }
    }
}
