//! Edits that the preview writes into the scene text: one line, at its place, and never over text that was
//! saved meanwhile.

use reflet_preview::{
    viewer::protocol::{FrameAction, FrameRequest, Task},
    write_back::{Inspected, Numbers, SceneItem},
};

use crate::{common::assert_says, kit::*};

fn preview(files: &[(&str, &str)]) -> Option<Watched> {
    let gpu = gpu()?;
    let folder = Folder::new();
    for (name, text) in files {
        folder.write(name, text);
    }
    let live = open(&gpu, &folder.path("scene.toml"), None);
    Some(Watched::start(gpu, folder, live, false))
}

fn inspected(preview: &mut Watched) -> Option<Inspected> {
    preview.until("the numbers", |report| match report {
        Report::Inspected(found) => Some(found.as_deref().cloned()),
        _ => None,
    })
}

/// Values of an element, if it exists; reports of the previous selection may still arrive, since its file
/// is read again after each change.
fn selected(preview: &mut Watched, item: SceneItem) -> Option<Inspected> {
    preview.worker.mailbox.post(Task::Select(item));
    preview.until("the numbers", |report| match report {
        Report::Inspected(None) => Some(None),
        Report::Inspected(Some(found)) if found.item == item => Some(Some((**found).clone())),
        _ => None,
    })
}

fn select(preview: &mut Watched, item: SceneItem) -> Inspected {
    selected(preview, item).expect("it is there")
}

/// Waits until a key of the selected element is shown with these values.
fn until_shown(preview: &mut Watched, key: &str, wanted: &[f64]) {
    preview.until("the new numbers", |report| match report {
        Report::Inspected(Some(found)) => {
            let numbers = found.numbers.iter().find(|n| n.key == key)?;
            (numbers.values == wanted).then_some(())
        }
        _ => None,
    });
}

fn write(preview: &mut Watched, item: SceneItem, key: &'static str, values: &[f64]) {
    let values = values.to_vec();
    preview
        .worker
        .mailbox
        .post(Task::Write(item, Numbers { key, values }));
}

fn message(preview: &mut Watched) -> String {
    preview.until("a message", |report| match report {
        Report::Message(text) => Some(text.clone()),
        _ => None,
    })
}

fn values(inspected: &Inspected, key: &str) -> Vec<f64> {
    let found = inspected.numbers.iter().find(|n| n.key == key);
    found
        .unwrap_or_else(|| panic!("no {key}: {inspected:?}"))
        .values
        .clone()
}

/// Lines that differ between two texts of as many lines.
fn changed_lines(before: &str, after: &str) -> Vec<(String, String)> {
    assert_eq!(before.lines().count(), after.lines().count());
    let pairs = before.lines().zip(after.lines());
    let pairs = pairs.filter(|(a, b)| a != b);
    pairs.map(|(a, b)| (a.to_owned(), b.to_owned())).collect()
}

#[test]
fn a_drag_is_shown_before_it_is_written() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    folder.write("scene.toml", SCENE);
    let path = folder.path("scene.toml");
    let mut live = open(&gpu, &path, None);
    let drag = |live: &mut Live, x: f64| {
        let numbers = Numbers {
            key: "translation",
            values: vec![x, 0.5, 0.0],
        };
        let reload = live.drag(SceneItem::Instance(1), &numbers);
        assert!(reload.ok && !reload.files, "{reload:?}");
        numbers
    };
    let place = |live: &Live| live.world().instances[1].world_from_object.translation.x;
    assert_eq!(place(&live), 0.0);
    for x in [0.25, 0.5] {
        drag(&mut live, x);
        assert_eq!(place(&live), x as f32);
    }
    assert_eq!(fs::read_to_string(&path).expect("it is there"), SCENE);
    // Dropping a drag restores the values on disk.
    assert!(live.drop_drag() && !live.drop_drag());
    assert_eq!(place(&live), 0.0);
    drag(&mut live, 0.5);
    assert!(live.reload(&[Change::Scene].into()).ok);
    assert_eq!(place(&live), 0.0);
    let last = drag(&mut live, 0.75);
    live.write(SceneItem::Instance(1), &last)
        .expect("it is written");
    assert!(live.reload(&[Change::Scene].into()).ok);
    assert_eq!(place(&live), 0.75);
    let text = fs::read_to_string(&path).expect("it is there");
    assert_eq!(changed_lines(SCENE, &text).len(), 1);
}

#[test]
fn moving_what_was_clicked_changes_one_line_and_can_be_undone() {
    let text = SCENE.replace(
        "translation = [0, 0.5, 0]",
        "translation = [0, 0.50, 0] # on the floor",
    );
    let mut preview = or_skip!(preview(&[("scene.toml", &text)]));
    let path = preview.folder.path("scene.toml");
    let read = || fs::read_to_string(&path).expect("it is there");
    let pick = FrameRequest {
        view: preview.view.clone(),
        action: FrameAction::Pick([0.5, 0.5]),
    };
    preview.worker.mailbox.post(Task::Frame(pick.into()));
    let picked = inspected(&mut preview).expect("the box");
    assert_eq!(
        (picked.item, picked.refused.clone()),
        (SceneItem::Instance(1), None)
    );
    assert!(picked.place.ends_with("scene.toml:22"), "{}", picked.place);
    assert_eq!(values(&picked, "translation"), [0.0, 0.5, 0.0]);

    write(&mut preview, picked.item, "translation", &[0.3, 0.5, 0.0]);
    until_shown(&mut preview, "translation", &[0.3, 0.5, 0.0]);
    let want = (
        "translation = [0, 0.50, 0] # on the floor",
        "translation = [0.3, 0.50, 0] # on the floor",
    );
    assert_eq!(
        changed_lines(&text, &read()),
        [(want.0.to_owned(), want.1.to_owned())]
    );

    // A missing key is added as one line.
    write(&mut preview, picked.item, "scale", &[2.0, 2.0, 2.0]);
    until_shown(&mut preview, "scale", &[2.0, 2.0, 2.0]);
    let grown = format!("{}\nscale = [2, 2, 2]\n", want.1);
    assert!(read().contains(&grown), "{}", read());

    let (small, here, there) = ([1.0; 3], [0.0, 0.5, 0.0], [0.3, 0.5, 0.0]);
    for (again, said, key, wanted) in [
        (false, "undid", "scale", small),
        (false, "undid", "translation", here),
        (true, "redid", "translation", there),
        (false, "undid", "translation", here),
    ] {
        preview.worker.mailbox.post(Task::Undo(again));
        assert!(message(&mut preview).starts_with(said));
        until_shown(&mut preview, key, &wanted);
    }
    assert_eq!(read(), text);
    preview.worker.mailbox.post(Task::Undo(false));
    assert_eq!(message(&mut preview), "there is nothing to undo");
}

#[test]
fn what_must_not_be_written_is_named_and_stays() {
    let mut preview = or_skip!(preview(&[("scene.toml", SCENE)]));
    let path = preview.folder.path("scene.toml");
    let lamp = select(&mut preview, SceneItem::Light(0));
    assert_eq!(lamp.label, "light lamp");
    assert_eq!(values(&lamp, "intensity_cd"), [30.0]);
    let permissions = fs::metadata(&path).expect("it is there").permissions();
    let mut locked = permissions.clone();
    locked.set_readonly(true);
    fs::set_permissions(&path, locked).expect("they can be set");
    write(&mut preview, lamp.item, "intensity_cd", &[40.0]);
    let said = message(&mut preview);
    assert!(
        said.starts_with("not written: ") && said.ends_with("it is read-only"),
        "{said}"
    );
    fs::set_permissions(&path, permissions).expect("they can be set");
    assert_eq!(fs::read_to_string(&path).expect("it is there"), SCENE);

    // Numbers with which the scene would not be read any more.
    let gpu = gpu().expect("a device");
    let mut live = open(&gpu, &path, None);
    for (key, number, says) in [
        ("scale", 0.0, "must not be 0"),
        ("translation", 1e30, "-1e12 and 1e12"),
        ("rotation_deg", f64::INFINITY, "-1e12 and 1e12"),
    ] {
        let values = vec![number, 1.0, 1.0];
        let refused = live.write(SceneItem::Instance(0), &Numbers { key, values });
        let refused = refused.expect_err(key);
        assert!(refused.contains(says), "{refused}");
        assert_eq!(fs::read_to_string(&path).expect("it is there"), SCENE);
    }

    // An editor saved a mistake, so that the file is not shown.
    let broken = SCENE.replace("base_color = [0.4, 0.4, 0.4]", "base_color = [0.4, 0.4,");
    fs::write(&path, &broken).expect("it can be written");
    let numbers = Numbers {
        key: "intensity_cd",
        values: vec![40.0],
    };
    let refused = live
        .write(SceneItem::Light(0), &numbers)
        .expect_err("it has changed");
    assert_says(&refused, &["was changed on disk and is not shown yet"]);
    assert_eq!(fs::read_to_string(&path).expect("it is there"), broken);
}

const SHOT: &str = include_str!("write_back/shot.toml");

#[test]
fn changes_go_where_a_thing_is_written() {
    let rig = "version = 1\n[model.ball]\nshape = { kind = \"sphere\" }\n[[instance]]\nname = \"ball\"\nmodel = \"ball\"\nrotation_quat = [0, 0, 0, 1]\n";
    let script = "fn setup(ctx) { #{ instances: [#{ name: \"more\", model: \"box\" }] } }";
    let files = [
        ("base.toml", SCENE),
        ("rig.toml", rig),
        ("more.rhai", script),
        ("scene.toml", SHOT),
    ];
    let mut preview = or_skip!(preview(&files));
    let read = |preview: &Watched, name: &str| {
        fs::read_to_string(preview.folder.path(name)).expect("it is there")
    };
    let find = |preview: &mut Watched, label: &str| {
        let kinds: [fn(usize) -> SceneItem; 4] = [
            SceneItem::Instance,
            SceneItem::Group,
            SceneItem::Light,
            SceneItem::Camera,
        ];
        let all = kinds
            .iter()
            .flat_map(|kind| (0..4).map(kind))
            .collect::<Vec<_>>();
        for item in all {
            if let Some(found) = selected(preview, item).filter(|found| found.label == label) {
                return found;
            }
        }
        panic!("no {label}");
    };
    // A light of the base scene, whose intensity is overridden by the shot.
    let lamp = find(&mut preview, "light lamp");
    write(&mut preview, lamp.item, "intensity_cd", &[7.5]);
    until_shown(&mut preview, "intensity_cd", &[7.5]);
    assert!(read(&preview, "scene.toml").contains("intensity_cd = 7.5 # dim"));
    write(&mut preview, lamp.item, "position", &[2.0, 4.5, 3.0]);
    until_shown(&mut preview, "position", &[2.0, 4.5, 3.0]);
    assert_eq!(
        changed_lines(SCENE, &read(&preview, "base.toml")),
        [(
            "position = [2, 4, 3]".to_owned(),
            "position = [2, 4.5, 3]".to_owned()
        )]
    );
    // A placed scene moves by the instance that places it, its parts in its own file.
    let group = find(&mut preview, "group rig");
    write(&mut preview, group.item, "translation", &[0.0, 1.0, 0.0]);
    until_shown(&mut preview, "translation", &[0.0, 1.0, 0.0]);
    let text = read(&preview, "scene.toml");
    assert!(
        text.ends_with("model = { scene = \"rig.toml\" }\ntranslation = [0, 1, 0]\n"),
        "{text}"
    );
    let ball = find(&mut preview, "instance rig.ball");
    write(&mut preview, ball.item, "rotation_deg", &[0.0, 180.0, 0.0]);
    let rig = preview.folder.path("rig.toml");
    preview.until("the turned ball", |_| {
        let text = fs::read_to_string(&rig).expect("it is there");
        text.contains("rotation_quat = [0, 1, 0, 0]").then_some(())
    });
    let more = find(&mut preview, "instance more");
    let why = more.refused.expect("a script makes it");
    assert!(
        why.contains("it comes from `setup` of") && more.numbers.is_empty(),
        "{why}"
    );
}
