//! Scripts and frames in a live scene: rebuilds after script edits, posing, and the last good
//! picture after errors.

use std::cell::RefCell;

use reflet::{
    render::RebuildSummary,
    runtime::parameters::ParameterOverrides,
    scene::desc::{MATERIAL, ParamValue},
};
use reflet_preview::{
    live::{Edit, Reload},
    viewer::scene_summary::SceneSummary,
};

use crate::{
    kit::*,
    saves::{SAVES, Save, rounds},
};

pub const SCRIPT: &str = include_str!("scripts/script.rhai");

const PATH: &str = "fn place(i, t) { vec3(i - 1 + 0.4 * t, 0.5, 0) }\n";

/// A scene on disk, opened; `new` has a script.
pub struct Session {
    pub gpu: Arc<Gpu>,
    pub folder: Folder,
    pub scene: PathBuf,
    pub live: Live,
}

impl Session {
    /// Writes a scene into a folder, and opens it.
    pub fn open(folder: Folder, text: &str) -> Option<Self> {
        let gpu = gpu()?;
        let scene = folder.write("scene.toml", text);
        let live = open(&gpu, &scene, None);
        Some(Self {
            gpu,
            folder,
            scene,
            live,
        })
    }

    /// A scene with a script, opened.
    pub fn new() -> Option<Self> {
        let folder = Folder::new();
        let text = format!("script = \"sub/move.rhai\"\n{SCENE}").replace(
            "[[instance]]\nmodel = \"box\"\ntranslation = [0, 0.5, 0]\n",
            "",
        ) + "[timeline]\nfps = 10\nend = 40\n[params]\ncount = 2\nspeed = 1.5\n[reflection]\nmethod = \"hybrid\"\n";
        folder.write("sub/move.rhai", SCRIPT);
        folder.write("parts/path.rhai", PATH);
        Self::open(folder, &text)
    }

    pub fn picture(&mut self) -> Vec<u8> {
        picture(&self.gpu, &mut self.live)
    }

    /// Picture of a frame in a new session.
    pub fn afresh(&self, frame: u32, set: &[&str]) -> Vec<u8> {
        let mut live = open_with(&self.gpu, &self.scene, None, set);
        assert!(live.pose_now(frame));
        picture(&self.gpu, &mut live)
    }

    pub fn save_script(&mut self, text: &str) -> Reload {
        self.folder.write("sub/move.rhai", text);
        self.live.reload(&[Change::Script].into())
    }

    /// Error location as `file:line`.
    pub fn place(&self) -> String {
        let problems = &self.live.problems;
        let problem = problems.scene.iter().chain(&problems.pose).next();
        let span = &problem.expect("a problem").span;
        let source = span.source.as_ref().expect("a place");
        let file = source.path.file_name().expect("a name").to_string_lossy();
        format!("{file}:{}", source.place(span.range.start).line)
    }
}

/// Rebuild summary of a change that only poses the scene.
const POSES: RebuildSummary = RebuildSummary {
    upload: false,
    trees: false,
    poses: true,
    materials: false,
    passes: false,
};

#[test]
fn the_script_and_its_imports_are_watched_also_while_they_are_broken() {
    let mut session = or_skip!(Session::new());
    let is_watched = |session: &Session, name: &str| {
        let wanted = session.folder.path(name);
        let list = session.live.watch_list().0;
        let found: Vec<Change> = (list.files.iter())
            .filter(|(path, _)| *path == wanted)
            .map(|(_, change)| *change)
            .collect();
        found == [Change::Script]
    };
    for name in ["sub/move.rhai", "parts/path.rhai"] {
        assert!(is_watched(&session, name), "{name}");
    }
    let reload = session.save_script("import \"parts/later\" as later;\nfn frame(ctx) {}\n");
    assert!(!reload.ok);
    assert!(is_watched(&session, "parts/later.rhai"), "before it exists");
    session.folder.write("parts/later.rhai", "fn x() {");
    assert!(!session.live.reload(&[Change::Script].into()).ok);
    assert!(
        session.place().starts_with("later.rhai:1"),
        "{}",
        session.place()
    );
    session.folder.write("parts/later.rhai", "fn x() { 1 }");
    assert!(session.live.reload(&[Change::Script].into()).ok);
    assert!(
        !is_watched(&session, "parts/path.rhai"),
        "no longer imported"
    );
}

#[test]
fn edit_of_frame_only_poses_again() {
    let mut session = or_skip!(Session::new());
    assert!(session.live.pose_now(20));
    let before = session.picture();
    assert!(before == session.afresh(20, &[]));
    let reload = session.save_script(&SCRIPT.replace("path::place(i, ctx.t)", "vec3(i, 1, 0)"));
    assert!(reload.ok && !reload.files, "{:?}", session.live.problems);
    assert_eq!((reload.shaders, reload.pipelines), (0, 0));
    assert_eq!(reload.rebuilt, POSES);
    let after = session.picture();
    assert!(after != before && after == session.afresh(20, &[]));
    // An import counts like the script itself.
    session.save_script(SCRIPT);
    let path = PATH.replace("0.4 * t", "0.1 * t");
    session.folder.write("parts/path.rhai", path);
    let reload = session.live.reload(&[Change::Script].into());
    assert!(reload.ok && reload.rebuilt == POSES);
    let after = session.picture();
    assert!(after != before && after == session.afresh(20, &[]));
    // An edit of the scene text at a frame keeps the script's values: the lamp has the script's intensity.
    let text = fs::read_to_string(&session.scene).expect("readable");
    let text = text.replace("[2, 4, 3]", "[-2, 4, 3]");
    fs::write(&session.scene, text).expect("written");
    let reload = session.live.reload(&[Change::Scene].into());
    assert!(reload.ok && reload.rebuilt == RebuildSummary::default());
    assert!(session.picture() == session.afresh(20, &[]));
}

#[test]
fn frames_are_what_a_fresh_start_shows_in_any_order() {
    let mut session = or_skip!(Session::new());
    for frame in [30, 3, 40, 0, 99, 30] {
        let made = (
            session.gpu.compile_stats.shaders(),
            session.gpu.compile_stats.pipelines(),
        );
        assert!(session.live.pose_now(frame));
        assert_eq!(session.live.scene().frame, frame.min(40));
        let now = session.picture();
        let made_now = (
            session.gpu.compile_stats.shaders(),
            session.gpu.compile_stats.pipelines(),
        );
        assert_eq!(made_now, made, "posing makes nothing");
        assert!(now == session.afresh(frame, &[]), "frame {frame}");
    }
}

#[test]
fn broken_then_good_keeps_the_last_picture() {
    let mut session = or_skip!(Session::new());
    session.live.pose_now(8);
    for round in 0..rounds(20) {
        let before = session.picture();
        let (broken, line) = match round % 4 {
            0 => (SCRIPT.replace("fn setup(ctx) {", "fn setup(ctx {"), 2),
            1 => (SCRIPT.replace("`box${i}`, path", "`bax${i}`, path"), 11),
            2 => (SCRIPT.replace("model: \"box\"", "modle: \"box\""), 5),
            _ => (SCRIPT.replace("parts/path", "parts/gone"), 1),
        };
        assert!(!session.save_script(&broken).ok, "round {round}");
        let place = session.place();
        assert!(place.ends_with(&format!(":{line}")), "{place} in {round}");
        assert!(session.picture() == before, "round {round}");
        let good = SCRIPT.replace("intensity_cd: 30", &format!("intensity_cd: {}", 31 + round));
        assert!(session.save_script(&good).ok && session.live.problems.is_empty());
        assert!(session.picture() != before);
    }
    assert!(session.picture() == session.afresh(8, &[]));
}

#[test]
fn every_way_of_saving_a_script_ends_with_its_last_text() {
    let session = or_skip!(Session::new());
    let watch = Watch::settled(session.live.watch_list().0);
    let path = session.folder.path("sub/move.rhai");
    let session = RefCell::new(session);
    let burst: Save = |folder, path, text| {
        for i in 0..1000 {
            fs::write(path, format!("{} // {i}", &text[..i.min(text.len())])).expect("written");
        }
        folder.write("sub/neighbor.rhai", "fn x() {}");
        fs::write(path, text).expect("written");
    };
    let bursts = ("a burst", burst, rounds(6));
    let ways = SAVES.into_iter().map(|(way, save)| (way, save, rounds(20)));
    for (way, save, count) in ways.chain([bursts]) {
        for round in 0..count {
            let text = format!("{SCRIPT}// {way} {round}\n");
            save(&session.borrow().folder, &path, &text);
            watch.until(
                |changes| {
                    assert_eq!(
                        changes.iter().collect::<Vec<_>>(),
                        [&Change::Script],
                        "{way}"
                    );
                    let live = &mut session.borrow_mut().live;
                    live.reload(changes);
                    let (list, since) = live.watch_list();
                    watch.watcher.watch(list, since);
                },
                || {
                    let live = &session.borrow().live;
                    let script = live.desc().script.as_ref().expect("a script");
                    live.problems.is_empty() && script.texts[0].1 == text
                },
            );
        }
    }
    let mut session = session.into_inner();
    assert!(session.picture() == session.afresh(0, &[]));
}

#[test]
fn an_edited_material_wins_over_motion_until_the_next_save() {
    let mut session = or_skip!(Session::new());
    let red = |session: &Session| {
        let materials = &session.live.world().materials;
        materials.iter().position(|m| m.name == "red").expect("red")
    };
    session.live.pose_now(10);
    let material = red(&session);
    let mut edit = Edit::new(material);
    for (field, value) in MATERIAL.iter().zip(&mut edit.values) {
        *value = match field.key {
            "reflectivity" => Some(Vec3::splat(0.9)),
            "roughness" => Some(Vec3::ZERO),
            "metallic" => Some(Vec3::ONE),
            "emission" => Some(Vec3::new(0.0, 0.5, 2.0)),
            "emission_strength" => Some(Vec3::splat(2.0)),
            _ => None,
        };
    }
    session.live.edit(edit).expect("is taken");
    session.live.edit(edit).expect("is taken");
    let shiny = |session: &Session| {
        let now = &session.live.world().materials[red(session)];
        let dielectric = (now.reflectivity, now.roughness, now.metallic);
        // Applying the same edit twice does not multiply the strength twice.
        dielectric == (0.9, 0.0, 1.0) && now.emission == Vec3::new(0.0, 1.0, 4.0)
    };
    assert!(shiny(&session));
    session.live.pose_now(30);
    assert!(shiny(&session), "also in another frame");
    let count = session.live.declared()[0].1.clone();
    let mut overrides = ParameterOverrides::default();
    overrides.set("count", ParamValue::Integer(4), &count);
    assert!(
        session.live.set_parameters_now(overrides).ok && shiny(&session),
        "with other parameters"
    );
    assert!(session.save_script(&format!("{SCRIPT}// saved\n")).ok);
    assert!(shiny(&session), "materials are written in the scene");
    let text = fs::read_to_string(&session.scene).expect("it is there");
    fs::write(&session.scene, text + "# saved\n").expect("writable");
    assert!(session.live.reload(&[Change::Scene].into()).ok);
    assert!(!shiny(&session));
    assert!(session.picture() == session.afresh(30, &["params.count=4"]));
}

#[test]
fn where_nothing_stands_still_lengths_do_not_depend_on_the_frame() {
    let mut session = or_skip!(Session::new());
    let text = fs::read_to_string(&session.scene).expect("readable");
    let text = text.replace(
        "[[instance]]\nmodel = \"floor\"",
        "[[instance]]\nname = \"floor\"\nmodel = \"floor\"\ndynamic = true",
    );
    fs::write(&session.scene, &text).expect("written");
    assert!(session.live.reload(&[Change::Scene].into()).ok);
    let unit_m = session.live.renderer().unit_m();
    session.live.pose_now(40);
    fs::write(&session.scene, format!("{text}# edited\n")).expect("written");
    assert!(session.live.reload(&[Change::Scene].into()).ok);
    assert_eq!(session.live.renderer().unit_m(), unit_m);
    assert!(session.picture() == session.afresh(40, &[]));
}

/// Materials with the same name, one in each box.
#[test]
fn edits_of_materials_of_one_name_stay_with_their_own() {
    let mut session = or_skip!(Session::new());
    let own = "dynamic: true, material: #{ metallic: 0.5 * i } }";
    let script = SCRIPT.replace("dynamic: true }", own);
    assert!(session.save_script(&script).ok);
    let material = |session: &Session, name: &str| {
        let world = session.live.world();
        let instance = world.instances.iter().find(|i| i.name == name);
        instance.expect(name).material
    };
    let (first, second) = (material(&session, "box0"), material(&session, "box1"));
    let names = SceneSummary::from_live(&session.live).materials;
    assert_eq!(names[second].name, format!("{}#2", names[first].name));
    let mut edit = Edit::new(second);
    for (field, value) in MATERIAL.iter().zip(&mut edit.values) {
        *value = (field.key == "emission").then_some(Vec3::Y);
    }
    session.live.edit(edit).expect("is taken");
    assert!(session.save_script(&format!("{script}\n")).ok);
    let emission = |name: &str| {
        let material = material(&session, name);
        session.live.world().materials[material].emission
    };
    assert_eq!((emission("box0"), emission("box1")), (Vec3::ZERO, Vec3::Y));
}
