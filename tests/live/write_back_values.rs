//! Values besides places that the preview writes into the scene text: materials, lights, cameras, the environment and
//! parameters, each in the layer that says it; and values that tracks, scripts and the command line set, which are not
//! written.

use reflet::{runtime::parameters::ParameterOverrides, scene::desc::ParamValue};
use reflet_preview::{
    viewer::protocol::{Report, Task},
    write_back::{FlightPoint, KeyChange, KeyEdit, Numbers, SceneItem},
};

use crate::{kit::*, models::write_model};

const MORE: &str = include_str!("write_back_values/more.toml");

const SHOT: &str =
    "version = 1\nbase = \"base.toml\"\n[material.red] # dull\nroughness = 0.5 # half\n";

pub fn numbers(key: &'static str, values: &[f64]) -> Numbers {
    let values = values.to_vec();
    Numbers { key, values }
}

pub fn read(path: &Path) -> String {
    fs::read_to_string(path).expect("it is there")
}

/// Index of the first instance of the world whose name begins so.
fn instance(live: &Live, name: &str) -> usize {
    let mut all = live.world().instances.iter();
    let found = all.position(|instance| instance.name.starts_with(name));
    found.unwrap_or_else(|| panic!("no {name}"))
}

fn material(live: &Live, name: &str) -> (usize, Option<usize>) {
    let index = instance(live, name);
    (live.world().instances[index].material, Some(index))
}

#[test]
fn materials_are_written_in_the_layer_that_says_them() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    write_model(&folder);
    let base_text = SCENE.to_owned() + MORE;
    let base = folder.write("base.toml", &base_text);
    let shot = folder.write("scene.toml", SHOT);
    let mut live = open(&gpu, &shot, None);
    let write = |live: &mut Live, name: &str, number: Numbers| {
        let before = [read(&base), read(&shot)];
        let written = {
            let found = material(live, name);
            live.write_material(found.0, found.1, &number)
        };
        written.unwrap_or_else(|why| panic!("{name}: {why}"));
        assert!(live.reload(&[Change::Scene].into()).ok);
        assert_ne!([read(&base), read(&shot)], before, "{name}");
        let (index, _) = material(live, name);
        live.world().materials[index].clone()
    };
    // The shot says the roughness, the base the color; nobody the metalness, which the shot's table gets first, as in
    // the manual.
    let red = write(&mut live, "box", numbers("roughness", &[0.25]));
    assert_eq!(red.roughness, 0.25);
    let red = write(&mut live, "box", numbers("base_color", &[0.9, 0.25, 0.1]));
    assert_eq!(red.base_color.y, 0.25);
    let red = write(&mut live, "box", numbers("metallic", &[1.0]));
    assert_eq!(red.metallic, 1.0);
    assert_eq!(read(&shot), SHOT.replace("= 0.5 #", "= 0.25 #"));
    let with_red = base_text.replacen(
        "base_color = [0.9, 0.1, 0.1]\n",
        "base_color = [0.9, 0.25, 0.1]\nmetallic = 1\n",
        1,
    );
    assert_eq!(read(&base), with_red);
    // An instance's own table, and a material of a model's file, which no table names yet.
    let own = write(&mut live, "own", numbers("metallic", &[0.5]));
    assert_eq!((own.metallic, own.roughness), (0.5, 0.75));
    let left = write(&mut live, "sign", numbers("roughness", &[0.125]));
    assert_eq!(left.roughness, 0.125);
    let left = write(&mut live, "sign", numbers("base_color", &[0.5, 1.0, 1.0]));
    assert_eq!(left.base_color.x, 0.5);
    let all = with_red
        .replace(
            "{ roughness = 0.75 }",
            "{ metallic = 0.5, roughness = 0.75 }",
        )
        .replace(
            "# two\n",
            "# two\n\n[model.quads.material.left]\nbase_color = [0.5, 1, 1]\nroughness = 0.125\n",
        );
    assert_eq!(read(&base), all);
    while live
        .undo(false)
        .expect("it can be undone")
        .starts_with("undid")
    {}
    assert_eq!((read(&base), read(&shot)), (base_text, SHOT.to_owned()));
}

const SCRIPT: &str = "fn frame(ctx) { ctx.material(\"floor\", #{ roughness: 0.5 }); }";

const CHANGING: &str = include_str!("write_back_values/changing.toml");

#[test]
fn what_does_not_rest_is_said_and_not_written() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    folder.write("move.rhai", SCRIPT);
    let text =
        SCENE.replacen("version = 1\n", "version = 1\nscript = \"move.rhai\"\n", 1) + CHANGING;
    let path = folder.write("scene.toml", &text);
    let set = ["light.lamp.color=[1, 0, 0]", "params.height=3.0"];
    let mut live = open_with(&gpu, &path, None, &set);
    let (red, floor) = (material(&live, "box"), material(&live, "floor"));
    let lamp = SceneItem::Light(0);
    let refused = [
        (
            live.write(lamp, &numbers("intensity_cd", &[5.0])),
            "`[motion.light.lamp]`",
        ),
        (
            live.write(lamp, &numbers("color", &[1.0; 3])),
            "`--set light.lamp.color=",
        ),
        (
            live.write(SceneItem::Light(1), &numbers("direction", &[1.0; 3])),
            "`[motion.light.spot]`",
        ),
        (
            live.write_material(red.0, red.1, &numbers("roughness", &[0.5]))
                .map(drop),
            "`[motion.material.red]`",
        ),
        (
            live.write_material(floor.0, floor.1, &numbers("roughness", &[0.7]))
                .map(drop),
            "the script sets it",
        ),
    ];
    for (done, why) in refused {
        let said = done.expect_err(why);
        assert!(said.contains(why), "{said}");
    }
    let inspected = live.inspect(lamp).expect("it is there");
    let held: Vec<_> = inspected.held.iter().map(|(key, _)| *key).collect();
    assert_eq!(held, ["intensity_cd", "color"]);
    let mut height = ParameterOverrides::default();
    height.set("height", ParamValue::Number(2.0), &ParamValue::Number(3.0));
    let said = live.write_parameters(&height).expect_err("--set");
    assert!(said.contains("`--set params.height="), "{said}");
    assert_eq!(read(&path), text, "nothing is written");
    // Another number of the same table rests, and is written.
    let done = live.write_material(floor.0, floor.1, &numbers("reflectivity", &[0.25]));
    assert_eq!(done.as_deref(), Ok("[material.floor]"));
    assert_eq!(
        read(&path),
        text.replace("reflectivity = 0.5", "reflectivity = 0.25")
    );
    // A light has the one number of its brightness that is written, as it is written.
    let spot = live.inspect(SceneItem::Light(1)).expect("it is there");
    let keys = ["intensity_cd", "flux_lm", "power_w"];
    let bright = spot.numbers.into_iter().filter(|n| keys.contains(&n.key));
    assert_eq!(bright.collect::<Vec<_>>(), [numbers("flux_lm", &[100.0])]);
}

#[test]
fn cameras_environment_and_parameters_are_written() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let text = SCENE.to_owned() + "[params]\nheight = 1.5 # m\nsteps = 3\n";
    let path = folder.write("scene.toml", &text);
    let live = open(&gpu, &path, None);
    let mut preview = Watched::start(gpu, folder, live, false);
    let until = |preview: &mut Watched, after: &str| {
        preview.until("the text", |_| (read(&path) == after).then_some(()));
    };
    let is_reloaded = |report: &Report| matches!(report, Report::Reloaded(..)).then_some(());
    let mut after = text.replace("color = [0.2, 0.2, 0.3]", "color = [0.2, 0.5, 0.3]");
    let write = |preview: &Watched, item, key, values: &[f64]| {
        preview
            .worker
            .mailbox
            .post(Task::Write(item, numbers(key, values)));
    };
    preview
        .worker
        .mailbox
        .post(Task::Select(SceneItem::Environment));
    write(&preview, SceneItem::Environment, "color", &[0.2, 0.5, 0.3]);
    until(&mut preview, &after);
    preview.until("the reload", is_reloaded);
    // Out of its range: the nearest value inside.
    write(&preview, SceneItem::Camera(0), "fov_deg", &[500.0]);
    after = after.replace(
        "target = [0, 0.5, 0]\n",
        "target = [0, 0.5, 0]\nfov_deg = 170\n",
    );
    until(&mut preview, &after);
    preview.until("the reload", is_reloaded);
    let mut values = ParameterOverrides::default();
    values.set("height", ParamValue::Number(2.0), &ParamValue::Number(1.5));
    values.set("steps", ParamValue::Integer(4), &ParamValue::Integer(3));
    // Written once it is in the picture.
    preview
        .worker
        .mailbox
        .post(Task::SetParameters(values.clone()));
    preview.worker.mailbox.post(Task::WriteParameters(values));
    after = after.replace("height = 1.5 # m\nsteps = 3", "height = 2.0 # m\nsteps = 4");
    until(&mut preview, &after);
}

const KEYED: &str = include_str!("write_back_values/keyed.toml");

#[test]
fn keys_are_moved_added_and_deleted_in_the_text() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let text = SCENE.to_owned() + KEYED;
    let path = folder.write("scene.toml", &text);
    let mut live = open(&gpu, &path, None);
    let tracks = live.key_tracks();
    let times: Vec<_> = tracks.iter().map(|track| track.at_s.clone()).collect();
    assert_eq!(times, [vec![0.0, 1.0], vec![0.0, 0.5]]);
    let edit = |live: &mut Live, track: usize, change: KeyChange| {
        let track = tracks[track].track.clone();
        let done = live.edit_key(&KeyEdit { track, change });
        assert!(live.reload(&[Change::Scene].into()).ok);
        done
    };
    let mut after = text.clone();
    let mut expect = |from: &str, to: &str| {
        assert!(after.contains(from), "{from}");
        after = after.replacen(from, to, 1);
        assert_eq!(read(&path), after);
    };
    edit(&mut live, 0, KeyChange::Move(1, 0.75)).expect("moved");
    expect("at_s = 1,", "at_s = 0.75,");
    // Halfway between its neighbors, with their comments in place.
    edit(&mut live, 0, KeyChange::Add(0.375)).expect("added");
    expect(
        "# from here\n",
        "# from here\n  { at_s = 0.375, value = [1, 2, 5] },\n",
    );
    edit(&mut live, 1, KeyChange::Add(1.0)).expect("added");
    // A third of the way back to the begin of the loop.
    expect(
        "value = 20 }",
        "value = 20 }, { at_s = 1, value = 16.666666 }",
    );
    // Never past a neighbor, or the end of the loop.
    edit(&mut live, 1, KeyChange::Move(2, 9.0)).expect("moved");
    expect("at_s = 1,", "at_s = 1.999,");
    edit(&mut live, 1, KeyChange::Move(1, -3.0)).expect("moved");
    expect("at_s = 0.5,", "at_s = 0.001,");
    let twice = edit(&mut live, 0, KeyChange::Add(0.75)).expect_err("a key is there");
    assert!(twice.contains("a key at this time"), "{twice}");
    // Times that the text cannot have, or past the end of the loop.
    for (track, at_s) in [(0, 1e300), (0, f64::NAN), (1, 2.5), (1, -1.0)] {
        let refused =
            edit(&mut live, track, KeyChange::Add(at_s)).expect_err("it would not be read");
        assert!(refused.contains("cannot stand"), "{refused}");
    }
    edit(&mut live, 1, KeyChange::Delete(2)).expect("deleted");
    expect(", { at_s = 1.999, value = 16.666666 }", "");
    edit(&mut live, 1, KeyChange::Delete(0)).expect("deleted");
    expect("{ at_s = 0, value = 10 }, ", "");
    let last = edit(&mut live, 1, KeyChange::Delete(0)).expect_err("it is the last");
    assert!(last.contains("at least one key"), "{last}");
}

#[test]
fn a_recorded_flight_is_written_as_keys_that_fly_it() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let text = SCENE.to_owned() + "[timeline]\nend = 24\n\n# to come\n";
    let path = folder.write("scene.toml", &text);
    let mut live = open(&gpu, &path, None);
    // A quarter of a circle, then straight on; the target rests.
    let eye = |frame: u32| {
        let turn = 0.5 * std::f32::consts::PI * frame.min(12) as f32 / 12.0;
        let on = frame.saturating_sub(12) as f32;
        Vec3::new(5.0 * turn.sin(), 2.0, 5.0 * turn.cos() - 0.1 * on)
    };
    let points: Vec<_> = (0..=24)
        .map(|frame| FlightPoint {
            at_s: f64::from(frame) / 24.0,
            eye: eye(frame),
            target: Vec3::new(0.0, 0.5, 0.0),
        })
        .collect();
    let count = live.write_flight("main", &points).expect("written");
    assert!((4..20).contains(&count), "{count} keys");
    assert!(live.reload(&[Change::Scene].into()).ok);
    for frame in 0..=24 {
        assert!(live.pose_now(frame));
        let off = live.world().cameras[0].value.eye.distance(eye(frame));
        assert!(off < 0.05, "frame {frame}: {off} m");
    }
    let keys: Vec<_> = live.key_tracks().iter().map(|t| t.at_s.len()).collect();
    assert_eq!(keys, [count, count]);
    let written = read(&path);
    assert!(written.contains("\n\n[motion.camera.main]\n"), "{written}");
    // A second flight takes the place of the first.
    live.write_flight("main", &points[..2]).expect("written");
    assert!(live.reload(&[Change::Scene].into()).ok);
    assert_eq!(live.key_tracks()[0].at_s, [0.0, 0.041_667]);
    let said = live
        .write_flight("other", &points)
        .expect_err("no such camera");
    assert!(said.contains("is not one of the scene text"), "{said}");
}
