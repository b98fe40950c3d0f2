//! Machine and program of a measurement: adapter, driver, system, commit.

use std::{env, fs, path::Path, process::Command, thread, time::UNIX_EPOCH};

use serde::Serialize;

use reflet_gpu::{Gpu, Timer};

/// Machine and program, as every sample names them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Host {
    /// Name of the adapter.
    pub adapter: String,
    /// Driver and its version.
    pub driver: String,
    /// Graphics API.
    pub backend: String,
    /// Whether the adapter renders on the CPU.
    pub software: bool,
    /// Timing method of passes: `gpu_timestamps`, or `cpu_waits` where each pass is submitted alone and the
    /// CPU waits for it.
    pub timing: &'static str,
    /// Operating system and architecture.
    pub os: String,
    /// Processor, with the number of threads available to the process.
    pub cpu: String,
    /// Version of Reflet.
    pub version: &'static str,
    /// Newest commit that is older than the program, with `-dirty` where files differ from the last
    /// commit; `unknown` outside its repository.
    pub commit: String,
}

impl Host {
    /// Reads the values from the adapter, the system and Git.
    pub fn detect(gpu: &Gpu) -> Self {
        let info = &gpu.adapter_info;
        let driver = [info.driver.as_str(), info.driver_info.as_str()].join(" ");
        let timing = if gpu.is_software() {
            "cpu_waits"
        } else if Timer::new(gpu).is_ok_and(|timer| timer.is_available()) {
            "gpu_timestamps"
        } else {
            "none"
        };
        Self {
            adapter: info.name.clone(),
            driver: driver.trim().to_owned(),
            backend: info.backend.to_string(),
            software: gpu.is_software(),
            timing,
            os: os(),
            cpu: cpu(),
            version: env!("CARGO_PKG_VERSION"),
            commit: commit(),
        }
    }
}

fn os() -> String {
    let release = fs::read_to_string("/etc/os-release").unwrap_or_default();
    let pretty = release.lines().find_map(|l| l.strip_prefix("PRETTY_NAME="));
    let name = pretty.map_or(env::consts::OS, |name| name.trim_matches('"'));
    format!("{name}, {}", env::consts::ARCH)
}

fn cpu() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find(|l| l.starts_with("model name"));
    let name = model.and_then(|l| l.split_once(':'));
    let name = name.map_or("unnamed processor", |(_, name)| name.trim());
    let threads = thread::available_parallelism().map_or(1, usize::from);
    format!("{name}, {threads} threads")
}

/// Commit that was named at build time, otherwise the current commit of the repository around the program.
fn commit() -> String {
    if let Some(commit) = option_env!("REFLET_COMMIT") {
        return commit.to_owned();
    }
    let program = env::current_exe().ok();
    program
        .as_deref()
        .and_then(commit_before)
        .unwrap_or_else(|| "unknown".to_owned())
}

/// Newest commit that is older than `program`, if the repository around it is Reflet's own:
/// commits that were made after the build say nothing about it.
fn commit_before(program: &Path) -> Option<String> {
    let folder = program.parent()?;
    let built = fs::metadata(program).ok()?.modified().ok()?;
    let built_s = built.duration_since(UNIX_EPOCH).ok()?.as_secs();
    let git = |arguments: &[&str]| {
        let mut command = Command::new("git");
        let output = command.current_dir(folder).args(arguments).output().ok()?;
        if !output.status.success() {
            return None;
        }
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let root = git(&["rev-parse", "--show-toplevel"])?;
    let manifest = fs::read_to_string(Path::new(&root).join("Cargo.toml")).ok()?;
    if !manifest.contains("name = \"reflet\"") {
        return None; // someone else's repository
    }
    let before = format!("--before={built_s}");
    let commit = git(&[
        "rev-list",
        "--first-parent",
        "-1",
        "--abbrev-commit",
        "--abbrev=12",
        &before,
        "HEAD",
    ])?;
    let changes = git(&["status", "--porcelain", "--untracked-files=no"])?;
    let dirty = if changes.is_empty() { "" } else { "-dirty" };
    (!commit.is_empty()).then(|| commit + dirty)
}
