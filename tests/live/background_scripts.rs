//! Slow scripts in the background: views are rendered meanwhile, and a newer request ends the script.

use std::{
    sync::{Mutex, MutexGuard, PoisonError, mpsc::RecvTimeoutError},
    thread,
    time::Instant,
};

use reflet::{
    render::picture::png_file,
    scene::desc::{CameraDesc, Method, ParamValue},
};
use reflet_preview::viewer::{
    opening::open,
    picture_filter::PictureFilter,
    protocol::{
        FinishedFrame, FrameAction, FrameRequest, Screenshot, Side, Task, View, ViewCamera,
    },
    render_thread::RenderThread,
    scene_summary::SceneSummary,
    view_channel::ViewChannel,
};

use crate::{
    kit::*,
    scripts::{SCRIPT, Session},
};

/// Timeout of a test.
const MOST: Duration = Duration::from_secs(60);

/// An endless script: each step reads a long text, so that the time limit ends it before the step
/// limit.
const SLOW: &str = "let text = \"abcdefgh\"; for i in 0..16 { text += text; } \
                    loop { text.contains(\"no\"); }";

/// Only one endless script at a time: each uses a whole core.
static TURN: Mutex<()> = Mutex::new(());

pub struct Watched {
    pub worker: RenderThread,
    _turn: MutexGuard<'static, ()>,
    pub folder: Folder,
    pub view: View,
    /// Whether a background script runs.
    runs: bool,
    /// Output of the scripts in the newest summary.
    log: Vec<String>,
}

impl Watched {
    /// The session's scene in the preview's thread, drawn once.
    pub fn new(session: Session) -> Self {
        let Session {
            gpu, folder, live, ..
        } = session;
        Self::start(gpu, folder, live, false)
    }

    /// Starts a scene in the preview's thread, drawn once.
    pub fn start(gpu: Arc<Gpu>, folder: Folder, live: Live, is_waiting: bool) -> Self {
        Self::start_filtered(gpu, folder, live, is_waiting, None)
    }

    /// Starts a scene like [`Self::start`], with a filter of pictures at rest.
    pub fn start_filtered(
        gpu: Arc<Gpu>,
        folder: Folder,
        live: Live,
        is_waiting: bool,
        filter: Option<PictureFilter>,
    ) -> Self {
        let worker = RenderThread::start(gpu, live, is_waiting, filter, || ());
        Self::of_thread(worker, folder)
    }

    /// Draws the scene of a thread once.
    pub fn of_thread(worker: RenderThread, folder: Folder) -> Self {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let side = Side {
            method: Method::Hybrid,
            channel: ViewChannel::Picture,
        };
        let mut this = Self {
            _turn: turn,
            worker,
            folder,
            view: View {
                camera: ViewCamera::Scene("main".to_owned()),
                chosen: None,
                frame: 0,
                plays: false,
                size: [24, 16],
                a: side,
                b: None,
                draft_ms: None,
                rest_ms: 1000.0,
                left_out: Default::default(),
                samples: None,
                denoises: true,
            },
            runs: false,
            log: Vec::new(),
        };
        this.show(|_| ());
        this.shown(|_| true);
        this
    }

    pub fn show(&mut self, change: impl FnOnce(&mut View)) {
        change(&mut self.view);
        self.worker.mailbox.post_view(self.view.clone());
    }

    /// Saves the script with a line that `setup` prints.
    pub fn save_script(&self, text: &str, line: &str) {
        let text = text.replace(
            "fn setup(ctx) {",
            &format!("fn setup(ctx) {{ print(\"{line}\");"),
        );
        // Atomically: a partial script is an error.
        let temporary = self.folder.write("next.rhai", text);
        fs::rename(temporary, self.folder.path("sub/move.rhai")).expect("renamed");
    }

    /// The file of a screenshot of the view.
    pub fn screenshot(&mut self) -> Vec<u8> {
        let folder = Folder::new();
        let screenshot = FrameAction::Screenshot(Screenshot {
            goal: crate::kit::file_goal(&folder, "view"),
            wipe_at: 0.5,
            error_map: false,
        });
        self.worker.mailbox.post(Task::Frame(Box::new(FrameRequest {
            view: self.view.clone(),
            action: screenshot,
        })));
        let note = self.until("a note", |report| match report {
            Report::Message(note) => Some(note.clone()),
            _ => None,
        });
        fs::read(folder.path("view-001.png")).expect(&note)
    }

    /// Waits for a report that `found` accepts; no earlier report may have errors.
    pub fn until<T>(&mut self, what: &str, mut found: impl FnMut(&Report) -> Option<T>) -> T {
        let deadline = Instant::now() + MOST;
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let report = match self.worker.reports.recv_timeout(left) {
                Ok(report) => report,
                Err(RecvTimeoutError::Timeout) => panic!("{what} never came"),
                Err(RecvTimeoutError::Disconnected) => panic!("it ended before {what}"),
            };
            match &report {
                Report::ScriptRunning(since) => self.runs = since.is_some(),
                Report::SceneSummary(facts) => {
                    assert!(facts.problems.is_empty(), "{:?}", facts.problems);
                    self.log.clone_from(&facts.log);
                }
                _ => {}
            }
            if let Some(found) = found(&report) {
                return found;
            }
        }
    }

    pub fn shown(&mut self, is_right: impl Fn(&FinishedFrame) -> bool) {
        self.until("a picture", |report| match report {
            Report::Frame(shown) => is_right(shown).then_some(()),
            _ => None,
        });
    }

    fn summary(&mut self, is_right: impl Fn(&SceneSummary) -> bool) {
        self.until("facts", |report| match report {
            Report::SceneSummary(facts) => is_right(facts).then_some(()),
            _ => None,
        });
    }

    /// Waits until the script that prints this line is shown.
    pub fn wait_until_adopted(&mut self, line: &str) {
        let line = format!(": {line}"); // after its place
        let is_in = |log: &[String]| log.iter().any(|known| known.ends_with(&line));
        // It may have come while something else was waited for.
        if !is_in(&self.log) {
            self.summary(|facts| is_in(&facts.log));
        }
    }

    pub fn wait_for_start(&mut self) {
        self.until("a long script", |report| {
            matches!(report, Report::ScriptRunning(Some(_))).then_some(())
        });
    }

    /// Waits for a report of a running script, also of a save that is read twice.
    fn is_running(&mut self) {
        if !self.runs {
            self.wait_for_start();
        }
    }

    /// A picture from this camera while a script runs.
    fn move_camera(&mut self, x: f32) {
        let camera = CameraDesc {
            eye: Vec3::new(x, 2.0, 5.0),
            ..CameraDesc::default()
        };
        self.show(|view| view.camera = ViewCamera::Free(camera.clone()));
        self.shown(|shown| shown.camera == camera);
        assert!(self.runs, "the script has ended first");
    }

    /// Waits until no script runs.
    fn wait_until_idle(&mut self) {
        while self.runs {
            self.until("a rest", |report| {
                matches!(report, Report::ScriptRunning(None)).then_some(())
            });
        }
    }
}

#[test]
fn a_save_with_an_endless_setup_leaves_everything_usable_until_the_next_save() {
    let session = or_skip!(Session::new());
    let mut preview = Watched::new(session);
    let slow = SCRIPT.replace("let all = [];", &format!("{SLOW} let all = [];"));
    preview.save_script(&slow, "slow");
    preview.wait_for_start();
    for step in 0..3 {
        preview.move_camera(step as f32);
        preview.show(|view| view.frame += 7);
        let frame = preview.view.frame;
        preview.shown(|shown| shown.frame == frame);
        assert!(preview.runs, "the script has ended first");
    }
    // A newer endless script, and one in a file that only the new script imports, also end the script.
    let slow = preview.folder.write("parts/new.rhai", SLOW);
    preview.save_script(
        &format!("import \"parts/new\" as other;\n{SCRIPT}"),
        "mended",
    );
    preview.wait_for_start();
    preview.move_camera(4.0);
    let mended = preview.folder.write("next.rhai", "fn x() {}");
    fs::rename(mended, slow).expect("renamed");
    preview.wait_until_adopted("mended");
    preview.wait_until_idle();
}

#[test]
fn an_endless_frame_keeps_the_one_before_and_is_left_for_another() {
    let session = or_skip!(Session::new());
    let mut preview = Watched::new(session);
    let slow = format!("fn frame(ctx) {{\n if ctx.frame == 9 {{ {SLOW} }}");
    let slow = SCRIPT.replace("fn frame(ctx) {", &slow);
    preview.save_script(&slow, "slow");
    preview.wait_until_adopted("slow");
    preview.show(|view| view.frame = 9);
    preview.is_running();
    preview.move_camera(1.0);
    preview.show(|view| view.frame = 3);
    preview.shown(|shown| shown.frame == 3);
    // Return to that frame, and then to the shown one: no work.
    preview.show(|view| view.frame = 9);
    preview.is_running();
    preview.show(|view| view.frame = 3);
    preview.wait_until_idle();
    // A save that is endless in the requested frame is adopted with the next requested frame.
    preview.save_script(&slow.replace("== 9", "== 3"), "other");
    preview.is_running();
    preview.move_camera(2.0);
    preview.show(|view| view.frame = 5);
    preview.wait_until_adopted("other");
    preview.wait_until_idle();
    // The script ends with the window.
    preview.show(|view| view.frame = 3);
    preview.is_running();
}

#[test]
fn what_is_asked_of_a_frame_is_done_with_that_frame_whatever_is_shown() {
    let mut session = or_skip!(Session::new());
    // Pictures do not wait for the script at frame 9.
    let late = "fn frame(ctx) { if ctx.frame == 9 { let text = \"abcdefgh\"; \
                for i in 0..16 { text += text; } for i in 0..3000 { text.contains(\"no\"); } }";
    assert!(
        session
            .save_script(&SCRIPT.replace("fn frame(ctx) {", late))
            .ok
    );
    let size = session.live.renderer().targets().size;
    let wanted = png_file::encode(size, &session.afresh(9, &[]), &[]).expect("encodes");
    let screenshots = Folder::new();
    let mut preview = Watched::new(session);
    preview.show(|view| view.size = size);
    let ask = |preview: &Watched, frame, with| {
        let view = View {
            frame,
            ..preview.view.clone()
        };
        let inspection = FrameRequest { view, action: with };
        preview.worker.mailbox.post(Task::Frame(inspection.into()));
    };
    let screenshot = FrameAction::Screenshot(Screenshot {
        goal: crate::kit::file_goal(&screenshots, "nine"),
        wipe_at: 0.5,
        error_map: false,
    });
    ask(&preview, 9, screenshot);
    let note = preview.until("a note", |report| match report {
        Report::Frame(shown) => {
            assert_eq!(shown.frame, 0, "it is not what is looked at");
            None
        }
        Report::Message(note) => Some(note.clone()),
        _ => None,
    });
    let written = fs::read(screenshots.path("nine-001.png")).expect(&note);
    assert!(written == wanted, "it is another frame");
    ask(&preview, 9, FrameAction::Compare(3));
    preview.until("an error", |report| match report {
        Report::Compared(comparison) => {
            assert_eq!((comparison.view.frame, comparison.edits), (9, 3));
            Some(())
        }
        _ => None,
    });
    // The view continues at its last frame.
    preview.shown(|shown| shown.frame == 0);
}

#[test]
fn material_numbers_are_reported_during_playback() {
    let session = or_skip!(Session::new());
    let mut preview = Watched::new(session);
    let told = Duration::from_millis(300); // longer ago than they are told again
    thread::sleep(told);
    preview.show(|view| (view.frame, view.plays, view.draft_ms) = (5, true, Some(1e3)));
    preview.summary(|facts| {
        let red = facts.materials.iter().find(|row| row.name == "red");
        red.is_some_and(|row| row.numbers.roughness == Some(0.55))
    });
}

#[test]
fn other_parameters_take_the_place_of_those_whose_setup_is_endless() {
    let session = or_skip!(Session::new());
    let count = session.live.declared()[0].1.clone();
    let mut preview = Watched::new(session);
    let slow = format!("if ctx.params.count == 3 {{ {SLOW} }} let all = [];");
    preview.save_script(&SCRIPT.replace("let all = [];", &slow), "slow");
    preview.wait_until_adopted("slow");
    let set_count = |preview: &Watched, to| {
        let mut overrides = reflet::runtime::parameters::ParameterOverrides::default();
        overrides.set("count", ParamValue::Integer(to), &count);
        preview.worker.mailbox.post(Task::SetParameters(overrides));
    };
    set_count(&preview, 3);
    preview.wait_for_start();
    preview.move_camera(1.0);
    set_count(&preview, 4);
    let seen = |facts: &SceneSummary| facts.bounds.max.x > 2.9; // four boxes
    preview.summary(seen);
    preview.wait_until_idle();
}

#[test]
fn a_scene_whose_script_is_slow_from_the_start_opens_empty_and_is_shown_once_mended() {
    let Session {
        gpu, folder, live, ..
    } = or_skip!(Session::new());
    let endless = SCRIPT.replace("fn setup(ctx) {", &format!("fn setup(ctx) {{ {SLOW}"));
    folder.write("sub/move.rhai", endless);
    let (live, is_waiting) =
        open(&gpu, live.source().clone(), ViewOverrides::default(), true).expect("it opens empty");
    assert!(is_waiting && live.problems.is_empty(), "it only waits");
    assert!(live.world().instances.is_empty());
    let mut preview = Watched::start(gpu, folder, live, is_waiting);
    preview.is_running();
    preview.save_script(SCRIPT, "mended");
    preview.wait_until_adopted("mended");
}
