//! Each stage in turn breaks and is mended: the last good picture stays, also where it is posed or resized meanwhile.
//! Reloads on the preview's threads end with the last request.

use std::thread;

use reflet::{
    render::picture::png_file,
    runtime::{SessionError, scene_text::SceneOptions},
};
use reflet_preview::live::{BuildProblem, Problems, SceneSource};

use crate::{
    kit::*,
    scripts::{SCRIPT, Session as Scripted},
};

/// A moving box, posed by a script.
fn scene() -> String {
    let text = SCENE.replace(
        "model = \"box\"",
        "model = \"box\"\nname = \"box\"\ndynamic = true",
    );
    format!("script = \"s.rhai\"\n{text}[timeline]\nend = 9\n")
}

/// A lamp with the largest shadow map.
macro_rules! lamp {
    ($name:literal) => {
        concat!(
            "[light.",
            $name,
            "]\nkind = \"point\"\nposition = [0, 3, 0]\nintensity_cd = 1\nshadow = \"map\"\nshadow_px = 4096\n"
        )
    };
}

/// Lamps whose shadow maps take 4.4 GB: more than a renderer takes.
const LARGE_MAPS: &str = concat!(
    lamp!("a"),
    lamp!("b"),
    lamp!("c"),
    lamp!("d"),
    lamp!("e"),
    lamp!("f"),
    lamp!("g"),
    lamp!("h"),
    lamp!("i"),
    lamp!("j"),
    lamp!("k"),
    "[environment]"
);

const MOVES: &str = "fn setup(ctx) { #{} }
fn frame(ctx) { ctx.place(\"box\", [0.1 * ctx.frame, 0.5, 0]); }
";

/// Whether some problem is of a stage.
type IsOf = fn(&Problems) -> bool;

/// A file to break, and how: stage, file, kind of change, good text, broken text, and where the error is told.
type Break = (
    &'static str,
    &'static str,
    Change,
    &'static str,
    &'static str,
    IsOf,
);

/// Declares breaks, a row each.
macro_rules! breaks {
    ($($stage:literal in $file:literal $change:ident: $good:literal => $broken:expr, $is_of:expr;)*) => {
        [$(($stage, $file, Change::$change, $good, $broken, $is_of)),*]
    };
}

const BREAKS: [Break; 7] = breaks! {
    "text" in "scene.toml" Scene: "reflectivity = " => "reflectivit = ", |problems| !problems.scene.is_empty();
    "setup of the script" in "s.rhai" Script: "fn setup(ctx) {" => "fn setup(ctx) { throw 1;", |problems| !problems.scene.is_empty();
    "frame of the script" in "s.rhai" Script: "fn frame(ctx) {" => "fn frame(ctx) { if ctx.frame > 2 { throw 1; }", |problems| !problems.pose.is_empty();
    "names of the world" in "scene.toml" Scene: "material = \"red\"" => "material = \"rde\"", |problems| !problems.scene.is_empty();
    "files of the world" in "scene.toml" Scene: "shape = { kind = \"box\" }" => "file = \"none.glb\"", |problems| !problems.scene.is_empty();
    "limits of the renderer" in "scene.toml" Scene: "[environment]" => LARGE_MAPS, |problems| problems.scene.is_empty() && problems.unbuilt_scene.is_some();
    "shaders" in "shaders/tone.wgsl" Shader: "fn main" => "fn main(", |problems| problems.unbuilt_shaders.is_some();
};

#[test]
fn a_broken_stage_keeps_the_last_good_picture_and_a_mended_one_shows() {
    let (gpu, folder) = (or_skip!(new_gpu()), Folder::new());
    let path = folder.write("scene.toml", scene());
    folder.write("s.rhai", MOVES);
    let shaders = copy_shaders(&folder);
    let mut live = open(&gpu, &path, Some(&shaders));
    assert!(live.pose_now(5));
    let sized = |size| ViewOverrides {
        size: Some(size),
        ..ViewOverrides::default()
    };
    for (stage, name, change, good, bad, is_of) in BREAKS {
        let before = picture(&gpu, &mut live);
        let text = fs::read_to_string(folder.path(name)).expect("readable");
        assert!(text.contains(good), "{stage}");
        folder.write(name, text.replacen(good, bad, 1));
        let reload = live.reload(&[change].into());
        assert!(
            !reload.ok && is_of(&live.problems),
            "{stage}: {:?}",
            live.problems
        );
        assert!(picture(&gpu, &mut live) == before, "{stage}");
        // The shown scene stays whole: it can be resized, and posed where no other scene waits for a frame.
        live.set_view(sized([24, 16])).expect(stage);
        assert_eq!(picture(&gpu, &mut live).len(), 4 * 24 * 16, "{stage}");
        live.set_view(sized([48, 32])).expect(stage);
        if live.problems.pose.is_empty() {
            assert!(
                live.pose_now(3) && picture(&gpu, &mut live) != before,
                "{stage}"
            );
            assert!(live.pose_now(5));
        }
        assert!(picture(&gpu, &mut live) == before, "{stage}");
        folder.write(name, text);
        let reload = live.reload(&[change].into());
        assert!(
            reload.ok && live.problems.is_empty(),
            "{stage}: {:?}",
            live.problems
        );
        assert!(
            live.scene().frame == 5 && picture(&gpu, &mut live) == before,
            "{stage}"
        );
    }
    let text = scene().replace("intensity_cd = 30", "intensity_cd = 60");
    folder.write("scene.toml", text);
    assert!(live.reload(&[Change::Scene].into()).ok);
    let mut afresh = open(&gpu, &path, Some(&shaders));
    assert!(afresh.pose_now(5));
    assert!(picture(&gpu, &mut live) == picture(&gpu, &mut afresh));
}

/// A shader that only some scenes need refuses those scenes alone. They are mended in their text, and a picture of
/// another scene meanwhile does not hide the error.
#[test]
fn a_scene_that_a_broken_shader_refuses_is_mended_in_its_text() {
    let (gpu, folder) = (or_skip!(new_gpu()), Folder::new());
    let path = folder.write("scene.toml", SCENE);
    let shaders = copy_shaders(&folder);
    let blur = fs::read_to_string(shaders.join("blur.wgsl")).expect("readable");
    folder.write("shaders/blur.wgsl", blur.replacen("fn main", "fn main(", 1));
    let mut live = open(&gpu, &path, Some(&shaders));
    let before = picture(&gpu, &mut live);
    folder.write("scene.toml", format!("{SCENE}[reflection]\nblur_px = 2\n"));
    assert!(!live.reload(&[Change::Scene].into()).ok);
    assert!(picture(&gpu, &mut live) == before);
    let Some(BuildProblem::Shader(error)) = &live.problems.unbuilt_scene else {
        panic!("{:?}", live.problems);
    };
    assert!(error.to_string().contains("blur.wgsl"), "{error}");
    folder.write("scene.toml", SCENE);
    let reload = live.reload(&[Change::Scene].into());
    assert!(reload.ok && live.problems.is_empty(), "{:?}", live.problems);
}

/// Files that the shown scene searched for stay watched while one that needs others is refused, with those.
#[test]
fn a_refused_scene_leaves_the_watched_files() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    folder.write("assets/points.csv", "x,y,z\n0,0,0\n1,0,0\n");
    let placed =
        |file: &str| format!("{SCENE}[[instance]]\nmodel = \"box\"\ninstances_from = \"{file}\"\n");
    let path = folder.write("scene.toml", placed("points.csv"));
    let source = SceneSource {
        options: SceneOptions {
            assets: vec![folder.path("assets")],
            ..SceneOptions::default()
        },
        ..source(&path)
    };
    let view = ViewOverrides::default();
    let mut live = Live::open(gpu, source, view, InitialBuild::Whole).expect("it opens");
    let watches = |live: &Live, name: &str| {
        let (list, _) = live.watch_list();
        list.files
            .iter()
            .any(|(path, _)| *path == folder.path(name))
    };
    assert!(
        watches(&live, "points.csv"),
        "it would be taken if it were there"
    );
    folder.write("scene.toml", placed("none.csv"));
    assert!(!live.reload(&[Change::Scene].into()).ok);
    assert!(watches(&live, "points.csv") && watches(&live, "none.csv"));
    folder.write("none.csv", "x,y,z\n0,0,0\n");
    let reload = live.reload(&[Change::Asset].into());
    assert!(reload.ok, "{:?}", live.problems);
    assert!(watches(&live, "none.csv") && !watches(&live, "points.csv"));
}

/// Values that replace each other do not add up.
#[test]
fn a_value_that_is_set_again_takes_the_place_of_the_earlier_one() {
    or_skip!(gpu_or_skip());
    let folder = Folder::new();
    let path = folder.write("scene.toml", SCENE);
    let mut session = Session::open(&path, &SessionOptions::default()).expect("it opens");
    for step in 0..3 {
        session
            .set([format!("light.lamp.intensity_cd={}", 30 + step)])
            .expect("set");
    }
    assert_eq!(session.source().options.set, ["light.lamp.intensity_cd=32"]);
}

#[test]
fn overrides_that_fail_leave_the_earlier_ones() {
    or_skip!(gpu_or_skip());
    let folder = Folder::new();
    let path = folder.write("scene.toml", scene());
    folder.write("s.rhai", MOVES);
    let mut session = Session::open(&path, &SessionOptions::default()).expect("it opens");
    session.pose(5).expect("it poses");
    session.set(["light.lamp.intensity_cd=60"]).expect("set");
    let display = |session: &mut Session| session.render(&[]).expect("renders").display;
    let before = display(&mut session);
    for bad in [
        "material.red.roughnes=1",
        "script=\"none.rhai\"",
        "material.red.base_color_texture=\"none.png\"",
        "model.floor.shape={ kind = \"plane\", size = [1e16, 8] }",
        "image.size=[16384, 16384]",
    ] {
        let refused = session.set([bad]);
        let refused = refused.expect_err(bad);
        assert!(
            matches!(refused, SessionError::Scene(_) | SessionError::Gpu(_)),
            "{bad}: {refused}"
        );
        assert!(display(&mut session) == before, "{bad}");
    }
    session.set(["image.exposure_ev=1"]).expect("set");
    let both = ["light.lamp.intensity_cd=60", "image.exposure_ev=1"];
    assert!(display(&mut session) == rendered(&path, 5, &both));
}

/// Display color of a frame in a new session.
fn rendered(path: &Path, frame: u32, set: &[&str]) -> Vec<u8> {
    let options = with_set(set);
    let mut session = or_panic!(Session::open(path, &options));
    session.pose(frame).expect("it poses");
    session.render(&[]).expect("renders").display
}

/// The file of a frame that a new session renders at this size.
fn png(path: &Path, size: [u32; 2]) -> Vec<u8> {
    let pixels = rendered(path, 0, &[&format!("image.size={size:?}")]);
    png_file::encode(size, &pixels, &[]).expect("encodes")
}

#[test]
fn a_resize_during_a_reload_is_shown_at_once_and_keeps_its_end() {
    let session = or_skip!(Scripted::new());
    let path = session.scene.clone();
    let mut preview = Watched::new(session);
    let slow = "let text = \"abcdefgh\"; for i in 0..16 { text += text; } \
                for i in 0..3000 { text.contains(\"no\"); } let all = [];";
    let script = SCRIPT
        .replace("let all = [];", slow)
        .replace("30 + 10", "60 + 10");
    preview.save_script(&script, "slow");
    preview.wait_for_start();
    for size in [[40, 20], [36, 30]] {
        preview.show(|view| view.size = size);
        preview.shown(|shown| shown.size == size);
    }
    preview.wait_until_adopted("slow");
    assert!(preview.screenshot() == png(&path, [36, 30]));
}

#[test]
fn ten_saves_in_a_second_end_in_the_picture_of_the_last() {
    let session = or_skip!(Scripted::new());
    let path = session.scene.clone();
    let text = fs::read_to_string(&path).expect("readable");
    let mut preview = Watched::new(session);
    let reflectivity = |save: u32| 0.05 * save as f32;
    for save in 1..=10 {
        let now = format!("reflectivity = {}", reflectivity(save));
        let next = preview
            .folder
            .write("next.toml", text.replace("reflectivity = 0.5", &now));
        fs::rename(next, &path).expect("renamed");
        thread::sleep(Duration::from_millis(80));
    }
    preview.until("the last save", |report| match report {
        Report::SceneSummary(summary) => {
            let floor = summary.materials.iter().find(|row| row.name == "floor");
            (floor?.numbers.reflectivity == Some(reflectivity(10))).then_some(())
        }
        _ => None,
    });
    assert!(preview.screenshot() == png(&path, preview.view.size));
}
