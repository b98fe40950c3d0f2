//! Rebuild counts of changes; errors keep the last good picture.

use reflet::{render::RebuildSummary, scene::desc::Method};
use reflet_preview::live::{BuildProblem, Reload};

use crate::{kit::*, saves::rounds, scripts::Session};

impl Session {
    /// Replaces text in the scene and reloads.
    fn edit(&mut self, from: &str, to: &str) -> Reload {
        let text = fs::read_to_string(&self.scene).expect("written");
        assert!(text.contains(from), "{from}");
        fs::write(&self.scene, text.replacen(from, to, 1)).expect("written");
        self.live.reload(&[Change::Scene].into())
    }

    /// The picture of a new session with the files on disk.
    fn new_picture(&self) -> Vec<u8> {
        picture(&self.gpu, &mut open(&self.gpu, &self.scene, None))
    }

    /// Rebuild summary of an edit; checks that the picture equals a new session's.
    fn shown(&mut self, from: &str, to: &str) -> RebuildSummary {
        let before = self.picture();
        let reload = self.edit(from, to);
        assert!(reload.ok, "{:?}", self.live.problems);
        assert!(!reload.files, "{from}: no file needs reading");
        assert_eq!((reload.shaders, reload.pipelines), (0, 0), "{from}");
        let after = self.picture();
        assert!(after != before, "{from}: the picture did not change");
        assert!(
            after == self.new_picture(),
            "{from}: not what a fresh start shows"
        );
        reload.rebuilt
    }
}

const NOTHING: RebuildSummary = RebuildSummary {
    upload: false,
    trees: false,
    poses: false,
    materials: false,
    passes: false,
};

const MATERIALS: RebuildSummary = RebuildSummary {
    materials: true,
    passes: true,
    ..NOTHING
};

#[test]
fn an_edit_rebuilds_only_its_own_data() {
    let mut session = or_skip!(Session::open(Folder::new(), SCENE));
    let trees = RebuildSummary {
        trees: true,
        ..MATERIALS
    };
    for (from, to, rebuilt) in [
        ("position = [2, 4, 3]", "position = [-2, 4, 3]", NOTHING),
        ("intensity_cd = 30", "intensity_cd = 60", NOTHING),
        ("eye = [0, 2, 5]", "eye = [1, 2, 5]", NOTHING),
        (
            "color = [0.2, 0.2, 0.3]",
            "color = [0.5, 0.2, 0.3]",
            NOTHING,
        ),
        ("32]", "32]\nexposure_ev = 1", NOTHING),
        ("[image]", "reflection.ray_length_u = 0.5\n[image]", NOTHING),
        (
            "color = [0.9, 0.1, 0.1]",
            "color = [0.1, 0.9, 0.1]",
            MATERIALS,
        ),
        ("reflectivity = 0.5", "reflectivity = 0.9", MATERIALS),
        ("translation = [0,", "translation = [0.5,", trees),
    ] {
        assert_eq!(session.shown(from, to), rebuilt, "{from}");
    }
}

#[test]
fn moved_dynamic_instance_rebuilds_only_the_top_level() {
    let text = SCENE.replace(
        "translation = [0, 0.5, 0]",
        "translation = [0, 0.5, 0]\ndynamic = true",
    );
    let mut session = or_skip!(Session::open(Folder::new(), &text));
    let poses = RebuildSummary {
        poses: true,
        ..NOTHING
    };
    let moved = ("translation = [0, 0.5, 0]", "translation = [0.5, 0.7, 0]");
    assert_eq!(session.shown(moved.0, moved.1), poses);
}

#[test]
fn another_shape_reads_the_scene_whole() {
    let text = SCENE.replace("[image]", "[reflection]\nmethod = \"hybrid\"\n[image]");
    let mut session = or_skip!(Session::open(Folder::new(), &text));
    let reload = session.edit("kind = \"box\"", "kind = \"sphere\"");
    assert!(reload.ok && reload.files && reload.rebuilt.upload && reload.rebuilt.trees);
    assert_eq!(reload.shaders, 0, "the text of the shaders is the same");
    assert!(session.picture() == session.new_picture());
}

#[test]
fn broken_then_good_keeps_the_last_picture() {
    let mut session = or_skip!(Session::open(Folder::new(), SCENE));
    for round in 0..rounds(50) {
        let before = session.picture();
        let good = fs::read_to_string(&session.scene).expect("written");
        let broken = match round % 3 {
            0 => good.replace("reflectivity = ", "reflectivit = "),
            1 => good[..good.len() / 2].to_owned(),
            _ => good.replace("material = \"red\"", "material = \"rde\""),
        };
        fs::write(&session.scene, broken).expect("written");
        let reload = session.live.reload(&[Change::Scene].into());
        assert!(!reload.ok);
        let problem = &session.live.problems.scene[0];
        assert!(problem.span.source.is_some(), "{problem:?} has no place");
        assert!(session.picture() == before, "round {round}");
        fs::write(&session.scene, good).expect("written");
        let from = format!("intensity_cd = {}", 30 + round);
        let reload = session.edit(&from, &format!("intensity_cd = {}", 31 + round));
        assert!(reload.ok && session.live.problems.is_empty());
        if round % 10 == 0 {
            assert!(session.picture() == session.new_picture());
        }
    }
}

#[test]
fn a_second_renderer_on_a_device_compiles_nothing() {
    let text = SCENE.replace("[image]", "[reflection]\nmethod = \"hybrid\"\n[image]");
    let mut session = or_skip!(Session::open(Folder::new(), &text));
    let first = session.picture();
    let stats = &session.gpu.compile_stats;
    let made = (stats.shaders(), stats.pipelines());
    let second = picture(&session.gpu, &mut open(&session.gpu, &session.scene, None));
    assert!(made.1 > 0 && second == first);
    assert_eq!((stats.shaders(), stats.pipelines()), made);
}

#[test]
fn methods_share_what_they_have_in_common() {
    let text = SCENE.replace("[image]", "[reflection]\nmethod = \"hybrid\"\n[image]");
    let mut session = or_skip!(Session::open(Folder::new(), &text));
    let first = session.picture();
    let set_overrides = |session: &mut Session, method| {
        let overrides = ViewOverrides {
            method: Some(method),
            ..ViewOverrides::default()
        };
        let made = session.gpu.compile_stats.pipelines();
        session.live.set_view(overrides).expect("builds");
        session.gpu.compile_stats.pipelines() - made
    };
    assert!(
        set_overrides(&mut session, Method::Rt) <= 1,
        "only the march is another"
    );
    assert!(session.picture() != first || session.live.renderer().plan().bounces > 0);
    // The march, the pyramid, in which nothing is to be verified, and the passes that bind the scene: where nothing is
    // traced, no tree is among its bindings. A device of another test may have some of them.
    let made = set_overrides(&mut session, Method::Ssr);
    assert!(made <= 6, "{made} pipelines");
    for known in [Method::Hybrid, Method::Ssr, Method::Hybrid] {
        assert_eq!(set_overrides(&mut session, known), 0, "{known:?}");
    }
    assert!(session.picture() == first, "the same as before");
}

#[test]
fn trees_are_built_when_rays_are_first_followed_and_kept_from_then_on() {
    let moving = "translation = [0, 0.5, 0]\ndynamic = true";
    let text = SCENE
        .replace("[image]", "[reflection]\nmethod = \"ssr\"\n[image]")
        .replace("translation = [0, 0.5, 0]", moving);
    let mut session = or_skip!(Session::open(Folder::new(), &text));
    let held = |session: &mut Session| {
        let stats = session.live.render(&first_camera).expect("renders");
        let of = |wanted: &str| stats.bytes.iter().find(|(name, _)| name == wanted);
        (of("tree_nodes").map(|b| b.1), of("lists").map(|b| b.1))
    };
    // Two words per pixel, and a pyramid of 64 × 64 pixels.
    let lists = Some(4 * (2 * 48 * 32 + 4096 + 1024 + 256 + 64 + 16 + 4 + 1));
    assert_eq!(
        held(&mut session),
        (Some(80), lists),
        "a stand-in for trees"
    );

    // Shading of movable instances uses records that exist without BVHs too.
    let moved = session.shown(
        "translation = [0, 0.5, 0]",
        "rotation_deg = [0, 40, 20]\ntranslation = [0.5, 0.7, 0]",
    );
    assert!(moved.poses && !moved.trees);

    let switch = |session: &mut Session, from: &str, to: &str| {
        let (from, to) = (format!("method = \"{from}\""), format!("method = \"{to}\""));
        let reload = session.edit(&from, &to);
        assert!(reload.ok, "{:?}", session.live.problems);
        assert!(session.picture() == session.new_picture(), "{to}");
        reload.rebuilt.trees
    };
    assert!(switch(&mut session, "ssr", "hybrid"));
    let built = held(&mut session);
    assert!(built.0 > Some(80) && built.1 == lists);
    assert!(!switch(&mut session, "hybrid", "ssr"));
    assert_eq!(held(&mut session), (built.0, lists));
    assert!(!switch(&mut session, "ssr", "rt"), "they were kept");
}

#[test]
fn a_shader_edit_rebuilds_its_own_pipelines_and_a_mistake_none() {
    let (gpu, folder) = (or_skip!(new_gpu()), Folder::new());
    let scene = folder.write("scene.toml", SCENE);
    let shaders = copy_shaders(&folder);
    let mut live = open(&gpu, &scene, Some(&shaders));
    let before = picture(&gpu, &mut live);
    let tone = shaders.join("tone.wgsl");
    let good = fs::read_to_string(&tone).expect("readable");

    fs::write(&tone, good.replace("fn main", "fn main(")).expect("written");
    let reload = live.reload(&[Change::Shader].into());
    assert!(!reload.ok && reload.pipelines == 0);
    let Some(BuildProblem::Shader(error)) = live.problems.unbuilt_shaders.clone() else {
        panic!("{:?}", live.problems);
    };
    let place = error.location.expect("has a place");
    assert!(
        place.file.ends_with("tone.wgsl") && place.line > 1,
        "{place:?}"
    );
    assert!(picture(&gpu, &mut live) == before);

    let edited = good.replace("srgb(saturate(c))", "(1.0 - srgb(saturate(c)))");
    assert!(edited != good, "the shader writes its result otherwise now");
    fs::write(&tone, edited).expect("written");
    let reload = live.reload(&[Change::Shader].into());
    assert!(reload.ok && live.problems.is_empty(), "{:?}", live.problems);
    assert_eq!((reload.shaders, reload.pipelines), (1, 1));
    assert_eq!((reload.files, reload.rebuilt.trees), (false, false));
    assert!(picture(&gpu, &mut live) != before);

    fs::write(&tone, &good).expect("written");
    assert!(live.reload(&[Change::Shader].into()).ok);
    assert!(picture(&gpu, &mut live) == before);
}

#[test]
fn maps_show_what_an_edited_shader_captures() {
    let (gpu, folder) = (or_skip!(new_gpu()), Folder::new());
    let probe = "[reflection]\nmethod = \"probe\"\n[probe.middle]\nposition = [0, 1, 0]\n[image]";
    let scene = folder.write("scene.toml", SCENE.replace("[image]", probe));
    let shaders = copy_shaders(&folder);
    let mut live = open(&gpu, &scene, Some(&shaders));
    let before = picture(&gpu, &mut live);
    let capture = shaders.join("methods/probes/capture.wgsl");
    let good = fs::read_to_string(&capture).expect("readable");
    let edited = good.replace("mean.xyz /", "mean.zyx * 9.0 /");
    assert!(edited != good);
    for (text, is_same) in [(&edited, false), (&good, true)] {
        fs::write(&capture, text).expect("written");
        assert!(live.reload(&[Change::Shader].into()).ok);
        assert_eq!(picture(&gpu, &mut live) == before, is_same);
    }
}

#[test]
fn an_asset_that_changes_or_comes_late_is_read() {
    let png = |color: [u8; 3]| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_pixel(4, 4, image::Rgb(color));
        picture
            .write_to(&mut bytes, image::ImageFormat::Png)
            .expect("encodes");
        bytes.into_inner()
    };
    let text = SCENE.replace(
        "base_color = [0.9, 0.1, 0.1]",
        "base_color_texture = \"paint.png\"",
    );
    let mut session = or_skip!(Session::open(Folder::new(), SCENE));
    fs::write(&session.scene, &text).expect("written");
    assert!(
        !session.live.reload(&[Change::Scene].into()).ok,
        "no paint yet"
    );

    let watch = Watch::new();
    let (list, since) = session.live.watch_list();
    let paint = session.folder.path("paint.png");
    assert!(list.files.contains(&(paint.clone(), Change::Asset)));
    watch.watcher.watch(list, since);
    session.folder.write("paint.png", png([0, 0, 255]));
    let shared = std::cell::RefCell::new(&mut session);
    watch.until(
        |changes| {
            shared.borrow_mut().live.reload(changes);
        },
        || shared.borrow().live.problems.is_empty(),
    );
    let blue = session.picture();
    session.folder.write("paint.png", png([0, 255, 0]));
    let read = std::ptr::from_ref(session.live.desc());
    let reload = session.live.reload(&[Change::Asset].into());
    assert!(reload.ok && reload.files);
    let green = session.picture();
    assert!(green != blue && green == session.new_picture());
    let is_read_again = |live: &Live| !std::ptr::eq(live.desc(), read);
    assert!(!is_read_again(&session.live), "no text has changed");

    // Texts that failed together with an image are read again with the next image.
    fs::write(&session.scene, "version = 2").expect("written");
    let both = [Change::Asset, Change::Scene].into();
    assert!(!session.live.reload(&both).ok);
    fs::write(&session.scene, &text).expect("written");
    assert!(session.live.reload(&[Change::Asset].into()).ok);
    assert!(is_read_again(&session.live));
    assert!(session.picture() == green);
}
