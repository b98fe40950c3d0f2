//! The preview's picture of a frame equals `render`'s, at the same size: both decide `auto` settings for the first
//! frame.

use reflet::{
    render::{Draft, RenderOptions, picture::png_file, pipeline::targets::Target},
    scene::desc::Method,
    world::World,
};

use crate::kit::*;

const SIZE: [u32; 2] = [40, 28];
/// A frame that differs much from the first.
const LATE: u32 = 8;

/// The lamp shines brighter from frame to frame, and the camera sinks until it does not see the mirror floor any
/// more; the second one looks into the dark. Method, exposure and shadows are `auto`.
fn scene() -> String {
    let text = SCENE
        .replace("visibility = \"raster\"", "exposure_ev = \"auto\"")
        .replace(
            "shadow_px = 64",
            "shadow_px = 64\nshadow = \"auto\"\n[camera.side]\neye = [3, 1, 0]\ntarget = [9, 1, 0]",
        )
        .replace(
            "model = \"box\"",
            "model = \"box\"\nname = \"box\"\ndynamic = true",
        )
        .replace(
            "base_color = [0.9, 0.1, 0.1]",
            "base_color = [0.9, 0.1, 0.1]\nreflection = \"none\"",
        )
        .replace("color = [0.2, 0.2, 0.3]", "color = [0.01, 0.01, 0.02]");
    // A wall that the floor reflects.
    let wall = "[[instance]]\nmodel = \"box\"\nscale = [8, 5, 0.5]\ntranslation = [0, 2, -3]\n";
    format!(
        "script = \"s.rhai\"\n{text}{wall}[timeline]\nstart = 2\nend = 9\n[params]\nheight = 0.5\n"
    )
}

const SCRIPT: &str = include_str!("same_as_render/script.rhai");

struct Fixture {
    gpu: Arc<Gpu>,
    folder: Folder,
    live: Live,
}

impl Fixture {
    fn new() -> Option<Self> {
        let gpu = gpu()?;
        let folder = Folder::new();
        folder.write("s.rhai", SCRIPT);
        let path = folder.write("scene.toml", scene());
        let mut live = open(&gpu, &path, None);
        live.set_view(view(None)).expect("it can be resized");
        Some(Self { gpu, folder, live })
    }

    /// The preview's picture of the posed frame, by the camera of this name.
    fn seen(&mut self, camera: &str) -> Vec<u8> {
        let camera = |world: &World| {
            let named = world.cameras.iter().find(|c| c.name == camera);
            named.expect("it is there").value.clone()
        };
        self.live.render(&camera).expect("renders");
        (self.live.renderer().read(&self.gpu, Target::Display)).expect("is read back")
    }

    fn rendered(&self, frame: u32, camera: Option<&str>) -> (Vec<u8>, RenderOptions) {
        rendered(&self.folder.path("scene.toml"), frame, camera, &[])
    }

    fn save(&mut self, text: &str) {
        fs::write(self.folder.path("scene.toml"), text).expect("written");
        let reload = self.live.reload(&[Change::Scene].into());
        assert!(reload.ok, "{:?}", self.live.problems);
    }
}

fn view(camera: Option<&str>) -> ViewOverrides {
    ViewOverrides {
        size: Some(SIZE),
        camera: camera.map(str::to_owned),
        ..ViewOverrides::default()
    }
}

/// Opens a scene as `render` does, with these values.
fn session(path: &Path, camera: Option<&str>, set: &[&str]) -> Session {
    let size = format!("image.size={SIZE:?}");
    let set = [&[size.as_str()], set].concat();
    let options = SessionOptions {
        camera: camera.map(str::to_owned),
        ..with_set(&set)
    };
    or_panic!(Session::open(path, &options))
}

/// Picture of a frame by `render`, and the options that it has decided.
fn rendered(
    path: &Path,
    frame: u32,
    camera: Option<&str>,
    set: &[&str],
) -> (Vec<u8>, RenderOptions) {
    let mut session = session(path, camera, set);
    session.pose(frame).expect("it poses");
    let picture = session.render(&[]).expect("it renders");
    (picture.display, *session.renderer().options())
}

#[test]
fn what_is_auto_is_decided_for_the_first_frame_in_preview_and_render() {
    let mut fixture = or_skip!(Fixture::new());
    let (wanted, first) = fixture.rendered(LATE, None);
    let path = fixture.folder.path("scene.toml");
    let (other, late) = rendered(&path, LATE, None, &[&format!("timeline.start={LATE}")]);
    assert_ne!(first.image.exposure_ev, late.image.exposure_ev);
    assert_ne!(first.rays_for_maps, late.rays_for_maps);
    assert!(wanted != other, "where it is decided shows");

    assert!(fixture.live.pose_now(LATE));
    assert!(fixture.seen("main") == wanted);
    // Whatever makes the preview decide again while that frame is shown.
    fixture.live.reload(&[Change::Script].into());
    assert!(fixture.seen("main") == wanted, "a save of the script");
    fixture.save(&format!("{}# saved\n", scene()));
    assert!(fixture.seen("main") == wanted, "a save of the text");
    fixture.live.reload(&[Change::Asset].into());
    assert!(fixture.seen("main") == wanted, "a save of a model");
    let larger = ViewOverrides {
        size: Some([64, 48]),
        ..view(None)
    };
    fixture.live.set_view(larger).expect("it can be resized");
    fixture.live.set_view(view(None)).expect("and back");
    assert!(fixture.seen("main") == wanted, "another size");
    assert!(fixture.live.pose_now(3));
    assert!(fixture.seen("main") == fixture.rendered(3, None).0);
}

#[test]
fn the_chosen_camera_decides() {
    let mut fixture = or_skip!(Fixture::new());
    assert!(fixture.live.pose_now(LATE));
    let by_main = fixture.live.renderer().options().image.exposure_ev;
    let side = view(Some("side"));
    fixture.live.set_view(side).expect("it can be chosen");
    let (wanted, options) = fixture.rendered(LATE, Some("side"));
    assert_ne!(by_main, options.image.exposure_ev);
    assert!(fixture.seen("side") == wanted);
    // One that the scene lacks leaves the choice to the scene.
    fixture.save(&scene().replace("camera.side", "camera.other"));
    assert!(fixture.seen("main") == fixture.rendered(LATE, None).0);
}

#[test]
fn a_draft_shows_what_was_decided_for_the_whole_picture() {
    let mut fixture = or_skip!(Fixture::new());
    assert!(fixture.live.pose_now(LATE));
    let whole = *fixture.live.renderer().options();
    let decisions = fixture.live.renderer().decisions().to_vec();
    let draft = ViewOverrides {
        draft: Some(Draft {
            size: [5, 4],
            samples: 1,
        }),
        ..view(None)
    };
    fixture.live.set_view(draft).expect("it can be drawn");
    let mut drawn = *fixture.live.renderer().options();
    assert_eq!(drawn.image.size, [5, 4]);
    assert_eq!(fixture.seen("main").len(), 4 * 5 * 4);
    drawn.image.size = whole.image.size;
    assert_eq!(drawn, whole);
    // Their reasons count pixels.
    assert_eq!(fixture.live.renderer().decisions(), decisions);
}

/// A set value that moves what the first frame shows decides as it does from the start, whichever frame is posed.
#[test]
fn a_session_that_is_changed_at_a_late_frame_decides_as_a_new_one() {
    let fixture = or_skip!(Fixture::new());
    let path = fixture.folder.path("scene.toml");
    let mut session = session(&path, None, &[]);
    session.pose(LATE).expect("it poses");
    for height in ["0.5", "1.5", "-3"] {
        let set = format!("params.height={height}");
        session.set([set.as_str()]).expect("it is set");
        // Their reasons count what the rays of the first frame meet.
        let mut new = self::session(&path, None, &[&set]);
        let decisions = new.renderer().decisions();
        assert_eq!(session.renderer().decisions(), decisions, "{height}");
        new.pose(LATE).expect("it poses");
        let [wanted, picture] =
            [&mut new, &mut session].map(|session| session.render(&[]).expect("it renders"));
        assert!(picture.display == wanted.display, "{height}");
    }
}

/// The window's own thread, with the menu's `auto`.
#[test]
fn a_screenshot_is_what_render_writes() {
    let Fixture {
        gpu, folder, live, ..
    } = or_skip!(Fixture::new());
    let (wanted, _) = rendered(&folder.path("scene.toml"), LATE, None, &[]);
    let wanted = png_file::encode(SIZE, &wanted, &[]).expect("encodes");
    let mut preview = Watched::start(gpu, folder, live, false);
    preview.show(|view| {
        (view.size, view.frame) = (SIZE, LATE);
        view.a.method = Method::Auto;
    });
    assert!(preview.screenshot() == wanted);
}
