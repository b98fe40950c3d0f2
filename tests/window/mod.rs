//! Preview in a real window, on a virtual display with any adapter: it opens,
//! loads, shows an edit of the scene on disk, keeps the picture after a mistake, writes screenshots
//! and closes. Prints `SKIPPED` if Xvfb or xdotool is missing.

use std::{
    fs,
    io::{BufRead as _, BufReader},
    path::PathBuf,
    process::{Child, Command, Stdio},
    sync::{Mutex, PoisonError},
    thread,
    time::{Duration, Instant},
};

/// Timeout; large, because software drivers on busy machines are slow.
const MOST: Duration = Duration::from_secs(90);

/// A process that ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Lock while a server starts: servers look for a free number, which another may take before it is bound.
static STARTING: Mutex<()> = Mutex::new(());

/// A virtual display that answers, and its name; `None` if none can be started.
fn display() -> Option<(Running, String)> {
    for tool in ["xdotool", "Xvfb"] {
        let found = Command::new("which").arg(tool).output();
        if !found.is_ok_and(|which| which.status.success()) {
            eprintln!("SKIPPED: {tool} is not installed");
            return None;
        }
    }
    let _alone = STARTING.lock().unwrap_or_else(PoisonError::into_inner);
    Some(until("a virtual display", start_server))
}

/// Starts an X server; `None` where it ends, or another one has taken its number, before it answers.
fn start_server() -> Option<(Running, String)> {
    // A server that resets after its last client would refuse the next one meanwhile.
    let mut child = Command::new("Xvfb")
        .args(["-displayfd", "1", "-noreset", "-nolisten", "tcp"])
        .args(["-screen", "0", "800x600x24"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("Xvfb starts");
    let mut number = String::new();
    let out = child.stdout.take().expect("piped");
    let mut server = Running(child);
    BufReader::new(out).read_line(&mut number).ok()?;
    let display = format!(":{}", number.trim());
    let answers = Command::new("xdotool")
        .arg("getdisplaygeometry")
        .env("DISPLAY", &display)
        .output()
        .is_ok_and(|ran| ran.status.success());
    let lives = matches!(server.0.try_wait(), Ok(None));
    (answers && lives).then_some((server, display))
}

/// The preview in its window; ends with the test.
struct Session {
    program: Running,
    _server: Running,
    display: String,
    folder: PathBuf,
    window: String,
}

impl Session {
    /// Opens `scene.toml` of a new folder that holds these files, in a window of this size in points; `None` where no
    /// window can be had.
    fn open(name: &str, size: &str, files: &[(&str, &str)]) -> Option<Self> {
        crate::common::gpu_or_skip()?;
        let (server, display) = display()?;
        let folder = std::env::temp_dir().join(format!("reflet-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("folder");
        for (file, text) in files {
            fs::write(folder.join(file), text).expect("written");
        }
        let program = Command::new(env!("CARGO_BIN_EXE_reflet"))
            .arg("preview")
            .arg(folder.join("scene.toml"))
            .arg("--screenshots")
            .arg(&folder)
            .args(["--size", size])
            .env("DISPLAY", &display)
            .env_remove("WAYLAND_DISPLAY")
            .spawn();
        let mut session = Self {
            program: Running(program.expect("starts")),
            _server: server,
            display,
            folder,
            window: String::new(),
        };
        session.window = until("a window", || {
            let found = session.xdotool(&["search", "--name", "Reflet"])?;
            found.lines().next().map(str::to_owned)
        });
        Some(session)
    }

    fn write(&self, file: &str, text: &str) {
        fs::write(self.folder.join(file), text).expect("written");
    }

    fn close(mut self) {
        until("the end", || {
            // A window that is busy may lose keys.
            self.key("ctrl+q");
            self.program.0.try_wait().expect("is waited for")
        });
        fs::remove_dir_all(&self.folder).expect("clean up");
    }

    fn xdotool(&self, arguments: &[&str]) -> Option<String> {
        let ran = Command::new("xdotool")
            .args(arguments)
            .env("DISPLAY", &self.display)
            .output()
            .expect("runs");
        let said = String::from_utf8_lossy(&ran.stdout).trim().to_owned();
        (ran.status.success() && !said.is_empty()).then_some(said)
    }

    fn key(&self, key: &str) {
        self.xdotool(&["windowfocus", &self.window]);
        self.xdotool(&["key", key]);
    }

    /// Presses F12 and waits for the screenshot, which is written atomically.
    fn screenshot(&self) -> Vec<u8> {
        let screenshots = || {
            let entries = fs::read_dir(&self.folder).expect("folder");
            let paths = entries.map(|entry| entry.expect("entry").path());
            let mut screenshots: Vec<PathBuf> = paths
                .filter(|path| path.extension().is_some_and(|e| e == "png"))
                .collect();
            screenshots.sort();
            screenshots
        };
        let before = screenshots().len();
        let path = until("a screenshot", || {
            // A window that is not ready yet loses keys.
            self.key("F12");
            let soon = Instant::now() + Duration::from_secs(5);
            while screenshots().len() == before && Instant::now() < soon {
                thread::sleep(Duration::from_millis(50));
            }
            screenshots().get(before).cloned()
        });
        let picture = image::open(&path).expect("decodes").into_rgb8();
        assert!(picture.width() > 64 && picture.height() > 64);
        picture.into_raw()
    }

    /// A picture that no longer changes: the first may change once, when the plan chooses another method.
    fn steady(&self) -> Vec<u8> {
        until("a picture that stays", || {
            let one = self.screenshot();
            (self.screenshot() == one).then_some(one)
        })
    }
}

fn until<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + MOST;
    loop {
        if let Some(value) = found() {
            return value;
        }
        assert!(Instant::now() < deadline, "{what} never came");
        thread::sleep(Duration::from_millis(100));
    }
}

fn brightness(picture: &[u8]) -> f64 {
    picture.iter().map(|v| f64::from(*v)).sum::<f64>() / picture.len() as f64
}

#[test]
fn preview_opens_follows_an_edit_survives_an_error_and_closes() {
    // Small, as a software driver draws all of the window at each change.
    let files = [("scene.toml", BALL)];
    let session = or_skip!(Session::open("window", "320x200", &files));
    let first = session.steady();
    assert!(brightness(&first) > 10.0, "something is seen");
    session.key("b");
    until("a wipe in the file as in the window", || {
        (session.screenshot() != first).then_some(())
    });
    session.key("b");
    until("one side again", || {
        (session.screenshot() == first).then_some(())
    });
    session.write(
        "scene.toml",
        &BALL.replace("segments = 12", "segments = 12, radius = 2"),
    );
    let second = until("the edit in the picture", || {
        let next = session.screenshot();
        (brightness(&next) > brightness(&first) + 5.0).then_some(next)
    });
    session.write("scene.toml", "version = 1\n[camera.main]\neye = 5\n");
    thread::sleep(Duration::from_millis(500));
    assert!(
        session.screenshot() == second,
        "a mistake keeps the last good picture"
    );

    for [width, height] in [["1", "1"], ["300", "240"]] {
        session.xdotool(&["windowsize", &session.window, width, height]);
        thread::sleep(Duration::from_millis(300));
    }
    until("a picture of another size", || {
        (session.screenshot().len() != second.len()).then_some(())
    });
    session.close();
}

/// A white ball. A software driver shades each pixel of a window again for each change.
const BALL: &str = include_str!("ball.toml");

/// A ball that moves.
const SCENE: &str = include_str!("scene.toml");

const SCRIPT: &str = r#"fn frame(ctx) { ctx.place("ball", [2 * sin(ctx.t), 0, 0]); }"#;

#[test]
#[ignore = "long: opens a window; tests without one play and edit scripts daily"]
fn preview_plays_pauses_and_follows_a_script_edit() {
    let files = [("scene.toml", SCENE), ("move.rhai", SCRIPT)];
    let session = or_skip!(Session::open("play", "480x360", &files));
    let first = session.steady();
    session.key("End");
    let last = until("the last frame", || {
        let next = session.screenshot();
        (next != first).then_some(next)
    });
    assert!(session.screenshot() == last, "still");
    session.key("Home");
    until("the first frame", || {
        (session.screenshot() == first).then_some(())
    });
    session.key("space");
    until("motion", || {
        (session.screenshot() != session.screenshot()).then_some(())
    });
    session.key("space");
    let paused = until("a rest", || {
        let next = session.screenshot();
        (next == session.screenshot()).then_some(next)
    });
    session.write(
        "move.rhai",
        &SCRIPT.replace("0, 0]", "0, 0], [0, 0, 0], 2.0"),
    );
    until("the edit in the picture", || {
        (brightness(&session.screenshot()) > 1.5 * brightness(&paused)).then_some(())
    });
    session.write("move.rhai", "fn frame(ctx) {");
    thread::sleep(Duration::from_millis(500));
    let kept = session.screenshot();
    assert!(
        brightness(&kept) > 1.5 * brightness(&paused),
        "the last good one"
    );
    session.close();
}

/// Clicks a ball in the middle, and moves it by a key: one line of the file changes, and the picture.
#[test]
#[ignore = "long: opens a window; tests without one write places back daily"]
fn preview_moves_an_instance_in_the_scene_text() {
    let session = or_skip!(Session::open("moves", "640x420", &[("scene.toml", BALL)]));
    let first = session.steady();
    let read = || fs::read_to_string(session.folder.join("scene.toml")).expect("it is there");
    until("a line of the file", || {
        // The sidebar takes the right of the window, three rows of the bar its top.
        let [x, y] = ["190", "236"];
        session.xdotool(&["mousemove", "--window", &session.window, x, y]);
        session.xdotool(&["click", "1"]);
        thread::sleep(Duration::from_millis(400));
        session.key("alt+Right");
        thread::sleep(Duration::from_millis(400));
        (read() != BALL).then_some(())
    });
    let after = read();
    let pairs = BALL.lines().zip(after.lines());
    let changed: Vec<_> = pairs.filter(|(a, b)| a != b).map(|(_, b)| b).collect();
    assert_eq!(changed.len(), 1, "{after}");
    assert!(
        changed[0].ends_with(", 0, 0.00] # in the middle"),
        "{after}"
    );
    assert_eq!(BALL.lines().count(), after.lines().count());
    until("the ball beside", || {
        (session.screenshot() != first).then_some(())
    });
    until("the file as it was", || {
        session.key("ctrl+z");
        thread::sleep(Duration::from_millis(400));
        (read() == BALL).then_some(())
    });
    session.close();
}
