//! The converter process: lookup, version and execution.

use std::{
    collections::BTreeMap,
    env,
    io::{self, BufRead as _, BufReader, ErrorKind, IsTerminal as _, Read, stderr},
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::{Mutex, PoisonError},
};

use super::{TOOL_ENV, advice::in_reflet};
use crate::gltf::Fault;
use reflet_base::{
    shell::shell_word,
    standard_error::{end_work, show_work},
};
use reflet_scene::diagnostic::printable_lines;

/// Prefix of the converter's progress lines.
const PROGRESS: &str = "converting: ";

/// The converter's command.
#[derive(Debug)]
pub(super) struct Tool {
    pub(super) path: PathBuf,
    /// Version and code hash, which identify it in the cache.
    pub(super) version: String,
}

impl Tool {
    /// Finds the converter: by [`TOOL_ENV`], else in the checkout of this binary, else in `PATH`. Its version is
    /// queried once per process.
    pub(super) fn find() -> Result<Self, Fault> {
        static VERSIONS: Mutex<BTreeMap<PathBuf, String>> = Mutex::new(BTreeMap::new());
        let path = place();
        let mut versions = VERSIONS.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(version) = versions.get(&path) {
            let version = version.clone();
            return Ok(Self { path, version });
        }
        let mut command = Command::new(&path);
        command.arg("--version").stdin(Stdio::null());
        end_with_this(&mut command);
        let output = command.output().map_err(|error| missing(&path, &error))?;
        let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        versions.insert(path.clone(), version.clone());
        Ok(Self { path, version })
    }

    /// Converts a stage, the file of the model `name`, to `glb`, with its sidecar; its progress is
    /// passed on.
    pub(super) fn convert(
        &self,
        stage: &Path,
        name: &str,
        choice: &[String],
        glb: &Path,
        roots: &[PathBuf],
    ) -> Result<(), Fault> {
        let mut command = Command::new(&self.path);
        command
            .arg("convert")
            .arg(stage)
            .args(choice)
            .arg("-o")
            .arg(glb)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        for root in roots.iter().filter(|root| root.is_dir()) {
            command.arg("--root").arg(root);
        }
        end_with_this(&mut command);
        let failed = |error: io::Error| missing(&self.path, &error);
        let mut child = command.spawn().map_err(failed)?;
        let errors = child.stderr.take().map(|said| pass_on(stage, said));
        if child.wait().map_err(failed)?.success() {
            return Ok(());
        }
        let errors = errors.unwrap_or_default();
        // The severity and the stage are dropped here, as the diagnostic adds them again.
        let start = format!("{}: ", stage.display());
        let plain = |line: &str| {
            let line = line.strip_prefix("error: ").unwrap_or(line);
            in_reflet(line.strip_prefix(&start).unwrap_or(line), name)
        };
        let errors: Vec<_> = errors.iter().map(|line| plain(line)).collect();
        let mut fault = Fault::new("usd-not-converted", errors.join("; "));
        // Only these errors may differ when the command is run by hand.
        let is_limit = errors.iter().any(|line| line.contains("-limit SECONDS`"));
        if is_limit || errors.is_empty() {
            if errors.is_empty() {
                fault.message = "the converter failed and did not say why".into();
            }
            fault.help = Some(format!(
                "try: {} convert {}{} -o out.glb",
                self.path.display(),
                stage.display(),
                choice
                    .iter()
                    .map(|word| format!(" {}", shell_word(word)))
                    .collect::<String>()
            ));
        }
        Err(fault)
    }
}

fn place() -> PathBuf {
    if let Some(named) = env::var_os(TOOL_ENV).filter(|name| !name.is_empty()) {
        return named.into();
    }
    let exe = env::current_exe().ok();
    let checkout = exe.iter().flat_map(|exe| exe.ancestors());
    let venvs = checkout.map(|folder| folder.join(".venv/bin/reflet-usd"));
    venvs
        .into_iter()
        .find(|tool| tool.is_file())
        .unwrap_or_else(|| "reflet-usd".into())
}

/// Shows progress, on a terminal in one transient line; returns the other lines without warnings,
/// which are in the sidecar.
fn pass_on(stage: &Path, said: impl Read) -> Vec<String> {
    let on_terminal = stderr().is_terminal();
    let mut errors = Vec::new();
    for line in BufReader::new(said).split(b'\n').map_while(Result::ok) {
        let line = printable_lines(String::from_utf8_lossy(&line).trim_end());
        match line.strip_prefix(PROGRESS) {
            Some(far) => {
                let line = format!("usd: converting {}: {far}", stage.display());
                match on_terminal {
                    true => show_work(format_args!("{line}")),
                    false => reflet_base::error_line!("{line}"),
                }
            }
            None if line.starts_with("warning") || line.is_empty() => {}
            None => errors.push(line),
        }
    }
    end_work();
    errors
}

/// Ends the process with its parent (PR_SET_PDEATHSIG). The signal is sent when the spawning thread
/// ends, so that thread must wait for the process.
#[cfg(target_os = "linux")]
#[expect(
    unsafe_code,
    reason = "only the new process itself can ask for the signal, between fork and exec"
)]
fn end_with_this(command: &mut Command) {
    use std::os::unix::process::CommandExt as _;
    let this = std::process::id();
    let ask = move || {
        // SAFETY: both are plain system calls without pointers, allowed between fork and exec.
        let (asked, parent) = unsafe {
            let signal = libc::SIGTERM as libc::c_ulong;
            (libc::prctl(libc::PR_SET_PDEATHSIG, signal), libc::getppid())
        };
        if asked != 0 {
            return Err(io::Error::last_os_error());
        }
        // The parent may have ended before the call.
        match u32::try_from(parent) == Ok(this) {
            true => Ok(()),
            false => Err(ErrorKind::BrokenPipe.into()),
        }
    };
    // SAFETY: `ask` makes system calls only; it neither allocates nor takes a lock.
    unsafe { command.pre_exec(ask) };
}

/// On other systems the converter's own limits end it.
#[cfg(not(target_os = "linux"))]
fn end_with_this(_command: &mut Command) {}

fn missing(tool: &Path, error: &io::Error) -> Fault {
    let text = if error.kind() == ErrorKind::NotFound && tool.is_file() {
        format!(
            "the command `{}` cannot start, because the Python that its first line names is gone",
            tool.display()
        )
    } else if error.kind() == ErrorKind::NotFound {
        format!(
            "USD stages need the Python tools, and the command `{}` was not found",
            tool.display()
        )
    } else {
        format!("the command `{}` did not start: {error}", tool.display())
    };
    let mut fault = Fault::new("usd-tool-missing", text);
    fault.help = Some(format!(
        "run `tools/setup.sh` in Reflet's folder (or `pip install ./tools` there, in a Python \
         environment of your own), or name the command in {TOOL_ENV}"
    ));
    fault
}
