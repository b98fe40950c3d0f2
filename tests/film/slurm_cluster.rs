//! Slurm scripts on a cluster of one machine, the local one. Prints `SKIPPED` where Slurm is not installed, or the
//! user is not root.

use std::{env, net::TcpListener, process::Child, thread::sleep};

use super::*;

/// Folders of daemons in Debian, which are missing from the path of users.
const PATHS: &str = "/usr/sbin:/usr/local/sbin";

struct Cluster {
    folder: PathBuf,
    daemons: Vec<Child>,
}

impl Drop for Cluster {
    fn drop(&mut self) {
        for daemon in self.daemons.iter_mut().rev() {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
        let _ = fs::remove_dir_all(&self.folder);
    }
}

fn output(command: &mut Command) -> String {
    let output = command.output().expect("it starts");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {text}{errors}");
    text
}

fn is_installed(tool: &str) -> bool {
    let paths = env::var("PATH").unwrap_or_default();
    let folders = paths.split(':').chain(PATHS.split(':'));
    folders
        .into_iter()
        .any(|f| Path::new(f).join(tool).exists())
}

impl Cluster {
    /// Starts the cluster; `None` after printing `SKIPPED`.
    fn start() -> Option<Self> {
        let tools = [
            "munged",
            "slurmctld",
            "slurmd",
            "sbatch",
            "squeue",
            "scancel",
            "sinfo",
        ];
        if let Some(tool) = tools.into_iter().find(|tool| !is_installed(tool)) {
            eprintln!("SKIPPED: {tool} is not installed");
            return None;
        }
        let user = output(Command::new("id").arg("-u"));
        if user.trim() != "0" {
            eprintln!("SKIPPED: the daemons of Slurm run as root");
            return None;
        }
        // A folder outside of the target folder: a socket's path has at most 108 bytes.
        let folder = env::temp_dir().join(format!("reflet-slurm-{}", std::process::id()));
        let mut cluster = Self {
            folder,
            daemons: Vec::new(),
        };
        cluster.write_settings();
        let at = |name: &str| cluster.folder.join(name).display().to_string();
        let munged = [
            "--foreground".to_owned(),
            "--force".to_owned(),
            format!("--key-file={}", at("munge.key")),
            format!("--socket={}", at("munge.socket")),
            format!("--pid-file={}", at("munge.pid")),
            format!("--seed-file={}", at("munge.seed")),
            format!("--log-file={}", at("munge.log")),
        ];
        let socket = cluster.folder.join("munge.socket");
        cluster.spawn("munged", &munged);
        cluster.wait_until("the socket", |_| socket.exists());
        for daemon in ["slurmctld", "slurmd"] {
            cluster.spawn(daemon, &["-D".to_owned()]);
        }
        cluster.wait_until("an idle node", |cluster| {
            let sinfo = cluster.command("sinfo").args(["-h", "-o", "%T"]).output();
            sinfo.is_ok_and(|found| found.stdout == b"idle\n")
        });
        Some(cluster)
    }

    fn write_settings(&self) {
        let folder = self.folder.display();
        for name in ["", "state", "spool"] {
            fs::create_dir_all(self.folder.join(name)).expect("temporary folder");
        }
        let key = self.folder.join("munge.key");
        fs::write(&key, [b'k'; 128]).expect("temporary key");
        // The key must not be readable by others.
        output(Command::new("chmod").arg("600").arg(&key));
        let host = fs::read_to_string("/proc/sys/kernel/hostname").expect("Linux has a name");
        let host = host.trim().split('.').next().expect("a name");
        let port = || {
            let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
            listener.local_addr().expect("an address").port()
        };
        let settings = include_str!("slurm.conf")
            .replace("HOST", host)
            .replace("FOLDER", &folder.to_string())
            .replace("FIRST_PORT", &port().to_string())
            .replace("SECOND_PORT", &port().to_string());
        fs::write(self.folder.join("slurm.conf"), settings).expect("temporary file");
    }

    fn command(&self, program: &str) -> Command {
        let binary = Path::new(env!("CARGO_BIN_EXE_reflet"))
            .parent()
            .expect("a folder");
        let paths = env::var("PATH").unwrap_or_default();
        let mut command = Command::new(program);
        command
            .env("PATH", format!("{}:{paths}:{PATHS}", binary.display()))
            .env("SLURM_CONF", self.folder.join("slurm.conf"));
        command
    }

    fn log(&self, daemon: &str) -> PathBuf {
        self.folder.join(format!("{daemon}.out"))
    }

    fn spawn(&mut self, daemon: &str, arguments: &[String]) {
        let mut command = self.command(daemon);
        let log = fs::File::create(self.log(daemon)).expect("temporary file");
        let (again, nothing) = (log.try_clone().expect("a file"), Stdio::null());
        command.args(arguments).stdin(nothing);
        command.stdout(log).stderr(again);
        self.daemons
            .push(command.spawn().expect("the daemon starts"));
    }

    /// Waits until the condition holds; the timeout is so long that only a failure reaches it.
    fn wait_until(&self, what: &str, is_so: impl Fn(&Self) -> bool) {
        for _ in 0..3000 {
            if is_so(self) {
                return;
            }
            sleep(Duration::from_millis(100));
        }
        let logs = ["munged", "slurmctld", "slurmd"].map(|daemon| {
            let text = fs::read_to_string(self.log(daemon)).unwrap_or_default();
            format!("{daemon}: {text}")
        });
        panic!("there is still not {what}\n{}", logs.join("\n"));
    }

    fn is_at_rest(&self) -> bool {
        output(self.command("squeue").arg("-h")).is_empty()
    }
}

/// Output of the tasks of all jobs.
fn said(folder: &Path) -> String {
    let files = fs::read_dir(folder).expect("it is there").flatten();
    let outputs = files.filter(|f| f.file_name().to_string_lossy().ends_with(".out"));
    outputs
        .map(|f| fs::read_to_string(f.path()).unwrap_or_default())
        .collect()
}

#[test]
fn a_cancelled_array_goes_on_where_it_is_sent_again() {
    or_skip!(gpu_or_skip());
    let cluster = or_skip!(Cluster::start());
    let folder = folder("slurm-cluster");
    let parts = folder.join("parts");
    fs::create_dir(&parts).expect("temporary folder");
    let mut job = cluster.command(env!("CARGO_BIN_EXE_reflet"));
    job.args(words("job slurm scene.toml -o film.sh --chunk 3"));
    job.args(["--pictures", "parts/f.##.png"])
        .current_dir(&folder);
    output(&mut job);
    let sbatch = |arguments: &[&str]| {
        let mut command = cluster.command("sbatch");
        output(command.args(arguments).arg("film.sh").current_dir(&folder))
    };
    let id = sbatch(&["--parsable"]);
    cluster.wait_until("a picture", |_| !pictures(&parts).is_empty());
    output(cluster.command("scancel").arg(id.trim()));
    cluster.wait_until("an end", Cluster::is_at_rest);
    let before = pictures(&parts).len();
    sbatch(&["--wait"]);
    let said = said(&folder);
    assert!(said.matches("kept").count() >= before, "{before}: {said}");
    render(&folder, "-o f.##.png", 0);
    assert_eq!(pictures(&parts), pictures(&folder));
}
