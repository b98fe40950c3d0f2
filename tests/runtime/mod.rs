//! The library's session: its renders equal the command line's, and bad input is an error.

mod error_bound;

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::common::{assert_says, folder::kept_folder, gpu_or_skip, program::exits};
use reflet::{
    gpu::GpuError,
    render::PlaneData,
    runtime::{Session, SessionError, SessionOptions, scene_text::SceneOptions},
};

/// A wall that fills the picture, 3 m away; the script moves it away, 1 m a frame, and says so.
const SCENE: &str = include_str!("scene.toml");
const SCRIPT: &str = include_str!("script.rhai");

fn folder(name: &str) -> PathBuf {
    kept_folder(
        &format!("session-{name}"),
        &[("scene.toml", SCENE), ("away.rhai", SCRIPT)],
    )
}

fn open(folder: &Path, options: &SessionOptions) -> Result<Session, SessionError> {
    Session::open(folder.join("scene.toml"), options)
}

/// Options of a session with `--set` overrides.
pub fn with_set(set: &[&str]) -> SessionOptions {
    SessionOptions {
        scene: SceneOptions {
            set: set.iter().map(|value| (*value).to_owned()).collect(),
            ..SceneOptions::default()
        },
        ..SessionOptions::default()
    }
}

/// Distance to the wall in the middle of the picture, meters.
#[track_caller]
fn depth_m(session: &mut Session) -> f32 {
    let picture = session.render(&["depth"]).expect("it renders");
    let PlaneData::F32(depths) = &picture.planes[0].data else {
        panic!("depths are floats")
    };
    let [width, height] = picture.size;
    assert_eq!(depths.len(), (width * height) as usize);
    depths[(height / 2 * width + width / 2) as usize]
}

/// Message of a result that must be an error.
#[track_caller]
fn refused<T>(result: Result<T, SessionError>) -> String {
    result.err().expect("an error").to_string()
}

#[test]
fn frames_and_cameras_show_what_stands_there() {
    or_skip!(gpu_or_skip());
    let folder = folder("frames");
    let mut session = open(&folder, &SessionOptions::default()).expect("it opens");
    let near = |depth: f32, wanted: f32| (depth - wanted).abs() < 1e-3;
    assert!(near(depth_m(&mut session), 3.0));
    let printed = session.pose(8).expect("it poses");
    assert!(
        printed.len() == 1 && printed[0].ends_with("away.rhai:2: frame 8"),
        "{printed:?}"
    );
    assert!(near(depth_m(&mut session), 6.0));
    session.set(["params.step=0.5"]).expect("it is set");
    assert!(near(depth_m(&mut session), 4.5), "the frame stays");
    session.set(["timeline.end=6"]).expect("it is set");
    assert!(
        near(depth_m(&mut session), 3.0),
        "the first, without frame 8"
    );
    let options = SessionOptions {
        camera: Some("near".to_owned()),
        ..SessionOptions::default()
    };
    let mut session = open(&folder, &options).expect("it opens");
    assert!(near(depth_m(&mut session), 2.0));
}

/// Changed sessions render like new ones, also when another mesh is needed or all files are reused.
#[test]
fn a_changed_session_renders_what_a_new_one_does() {
    or_skip!(gpu_or_skip());
    let folder = folder("set");
    let mut changed = open(&folder, &SessionOptions::default()).expect("it opens");
    let mut before = changed.render(&[]).expect("it renders").display;
    let mut all = Vec::new();
    for set in [
        &[
            "material.mirror.base_color=[0.9, 0.3, 0.1]",
            "image.size=[30, 10]",
        ][..],
        &["model.wall.shape={ kind = \"sphere\", radius = 1.5 }"],
        &["reflection.method=\"rt\"", "image.samples=3"],
    ] {
        changed.set(set.iter().copied()).expect("it is set");
        all.extend(set);
        let mut new = open(&folder, &with_set(&all)).expect("it opens");
        let [changed, new] = [&mut changed, &mut new].map(|session| {
            let picture = session.render(&["normal", "cause"]).expect("it renders");
            (picture.size, picture.color, picture.display, picture.planes)
        });
        assert!(changed == new, "{set:?}");
        assert!(changed.2 != before, "{set:?} changes nothing");
        before = changed.2;
    }
}

#[test]
fn session_and_command_line_write_the_same_pixels() {
    or_skip!(gpu_or_skip());
    let folder = folder("command-line");
    exits(
        &folder,
        "render scene.toml --output out.png --set image.samples=2",
        0,
    );
    let written = image::open(folder.join("out.png")).expect("a picture");
    let mut session = open(&folder, &with_set(&["image.samples=2"])).expect("it opens");
    let picture = session.render(&[]).expect("it renders");
    let rgb: Vec<u8> = (picture.display.chunks_exact(4))
        .flat_map(|rgba| rgba[..3].to_vec())
        .collect();
    assert!(written.to_rgb8().into_raw() == rgb);
    assert!(rgb.iter().any(|value| *value > 50), "the wall is lit");
}

#[test]
fn bad_input_is_refused_when_opened() {
    let folder = folder("bad-input");
    let missing = refused(Session::open(
        folder.join("none.toml"),
        &SessionOptions::default(),
    ));
    assert!(missing.contains("none.toml"), "{missing}");
    let size = refused(open(&folder, &with_set(&["image.size=[0, 16]"])));
    assert!(size.contains("image.size") && size.contains('0'), "{size}");
    let camera = SessionOptions {
        camera: Some("far".to_owned()),
        ..SessionOptions::default()
    };
    assert_eq!(
        refused(open(&folder, &camera)),
        "there is no camera `far`; there are `main`, `near`"
    );
    let shaders = SessionOptions {
        shaders: Some(folder.join("none")),
        ..SessionOptions::default()
    };
    let shaders = refused(open(&folder, &shaders));
    assert!(shaders.contains("none"), "{shaders}");
    fs::write(
        folder.join("scene.toml"),
        "version = 1\n[camera.main]\neyes = 1\n",
    )
    .expect("written");
    let mistake = refused(open(&folder, &SessionOptions::default()));
    assert!(mistake.contains("scene.toml:3:1"), "{mistake}");
}

#[test]
fn a_missing_adapter_is_an_error() {
    let folder = folder("adapter");
    let options = SessionOptions {
        adapter: Some("no adapter has this name".to_owned()),
        ..SessionOptions::default()
    };
    let error = open(&folder, &options).expect_err("an error");
    assert!(
        matches!(error, SessionError::Gpu(GpuError::NoAdapter(_))),
        "{error}"
    );
}

#[test]
fn bad_input_leaves_an_open_session_as_it_was() {
    or_skip!(gpu_or_skip());
    let folder = folder("stays");
    let mut session = open(&folder, &SessionOptions::default()).expect("it opens");
    session.pose(6).expect("it poses");
    let before = session.render(&["ids"]).expect("it renders");
    let size = refused(session.set(["image.size=[24, 0]"]));
    assert!(size.contains("image.size"), "{size}");
    let key = refused(session.set(["material.miror.roughness=1"]));
    assert!(key.contains("miror") && key.contains("mirror"), "{key}");
    let aov = refused(session.render(&["depth", "deepth"]));
    assert!(
        aov == "there is no AOV `deepth`; did you mean `depth`?",
        "{aov}"
    );
    let frame = refused(session.pose(9));
    assert_eq!(frame, "there is no frame 9; the timeline has 5 to 8");
    let thrown = refused(session.pose(7));
    assert_says(&thrown, &["away.rhai:3", "no frame 7"]);
    fs::remove_file(folder.join("scene.toml")).expect("removed");
    let gone = refused(session.set(["image.samples=2"]));
    assert!(gone.contains("scene.toml"), "{gone}");
    let after = session.render(&["ids"]).expect("it renders");
    assert!((before.display, before.planes) == (after.display, after.planes));
}

#[test]
fn a_lost_device_is_an_error() {
    or_skip!(gpu_or_skip());
    let folder = folder("lost");
    let mut session = open(&folder, &SessionOptions::default()).expect("it opens");
    session.gpu().device.destroy();
    for _ in 0..2 {
        let error = session.render(&["depth"]).expect_err("an error");
        assert!(matches!(error, SessionError::Gpu(_)), "{error}");
    }
}

/// A glowing bar that moves by its own width in a frame, by tracks or by a script that knows the time.
#[test]
fn an_open_shutter_smears_what_moves() {
    or_skip!(gpu_or_skip());
    let bar = |motion: &str| {
        format!(
            "version = 1\n{motion}\n[image]\nsize = [32, 2]\nsamples = 256\nshutter = 1\n\
             tone_map = \"none\"\n[timeline]\nfps = 2\nend = 4\n[camera.main]\neye = [0, 0, 8]\n\
             target = [0, 0, 0]\nfov_deg = 7.152669\n[environment]\ncolor = [0, 0, 0]\n\
             [material.glow]\nbase_color = [0, 0, 0]\nreflectivity = 0\nemission = [1, 1, 1]\n\
             [model.bar]\nshape = {{ kind = \"plane\", size = [2, 9] }}\nmaterial = \"glow\"\n\
             [[instance]]\nname = \"bar\"\nmodel = \"bar\"\nrotation_deg = [90, 0, 0]\ndynamic = true\n"
        )
    };
    let tracks = "[motion.instance.bar]\ntranslation = { rate = [4, 0, 0] }";
    let moves = "fn frame(ctx) { ctx.place(\"bar\", [4 * ctx.t, 0, 0]); }";
    for (name, motion, script) in [
        ("tracks", tracks, "fn setup(ctx) {}"),
        ("script", "script = \"moves.rhai\"", moves),
    ] {
        let folder = folder(name);
        fs::write(folder.join("moves.rhai"), script).expect("written");
        fs::write(folder.join("bar.toml"), bar(motion)).expect("written");
        let file = folder.join("bar.toml");
        let mut session = Session::open(&file, &SessionOptions::default()).expect("it opens");
        session.pose(0).expect("it poses");
        let picture = session.render(&[]).expect("it renders");
        // The picture shows 16 m; the middle of the bar moves from -1 m to 1 m.
        for (x, pixel) in picture.color[..4 * 32].chunks_exact(4).enumerate() {
            let at = (x as f32 + 0.5 - 16.0) / 2.0;
            let expected = (1.0 - at.abs() / 2.0).max(0.0);
            assert!(
                (pixel[0] - expected).abs() < 0.02,
                "{name}, {at} m: {}",
                pixel[0]
            );
        }
    }
}
