//! Tests of the material panel without a window: every number has a control, and moving it requests an
//! edit.

use eframe::egui::accesskit::Role;
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};

use super::*;
use crate::{
    window::ui::panels::tests::summary,
    write_back::{Numbers, numbers_of},
};
use reflet_base::math::Bounds;
use reflet_scene::desc::{CheckerDesc, Method};

struct State {
    settings: ViewSettings,
    summary: SceneSummary,
    picked: Option<Picked>,
    requests: Vec<ViewRequest>,
}

/// Two materials: one with default values only, and one that sets every optional value.
fn harness<'a>() -> Harness<'a, State> {
    let mut summary = summary();
    summary.materials[0].numbers = PLAIN;
    let numbers = &mut summary.materials[1].numbers;
    *numbers = MaterialDesc {
        checker: Some(CheckerDesc {
            colors: [Vec3::ONE, Vec3::ZERO],
            size_m: 0.5,
            kind: Default::default(),
        }),
        ..PLAIN
    };
    for field in MATERIAL
        .iter()
        .filter(|field| (field.get)(&PLAIN).is_none())
    {
        field.put_clamped(numbers, Vec3::splat(0.5));
    }
    numbers.emission = Some(Vec3::new(0.0, 2.0, 4.0));
    let state = State {
        settings: ViewSettings::new(Method::Hybrid),
        summary,
        picked: None,
        requests: Vec::new(),
    };
    let draw = |ui: &mut Ui, state: &mut State| {
        let (summary, picked) = (&state.summary, state.picked.as_ref());
        panel(
            ui,
            &mut state.settings,
            summary,
            picked,
            &mut state.requests,
        );
        // The window shows an edit at once.
        if let Some(ViewRequest::Task(Task::Edit(edit))) = state.requests.last() {
            state.summary.materials[edit.material].edit = **edit;
        }
    };
    // The picker has a character that no font here has.
    let builder = Harness::builder().allow_missing_glyphs();
    builder.build_ui_state(draw, state)
}

fn select(harness: &mut Harness<'_, State>, label: &str) {
    harness.get_by_label(label).click();
    harness.run();
}

/// Values that the last requested edit sets.
fn requested(harness: &Harness<'_, State>) -> Vec<(&'static str, Vec3)> {
    let edits = harness.state().requests.iter().rev();
    let mut edits = edits.filter_map(|request| match request {
        ViewRequest::Task(Task::Edit(edit)) => Some(edit),
        _ => None,
    });
    let edit = edits.next().expect("an edit");
    let fields = MATERIAL.iter().zip(edit.values);
    fields.filter_map(|(f, v)| Some((f.key, v?))).collect()
}

#[test]
fn a_selected_material_shows_the_numbers_that_it_has() {
    let mut harness = harness();
    assert!(harness.query_by_label("reflectivity").is_none());
    select(&mut harness, "chrome  ×2");
    assert_eq!(harness.state().settings.material, Some(1));
    for field in &MATERIAL {
        let found = harness.query_all_by_label(field.key).count();
        assert!(found > 0, "{}", field.key);
    }
    select(&mut harness, "floor  ×2");
    for (key, is_there) in [
        ("base_color", true),
        ("reflectivity", true),
        ("alpha_cutoff", false),
        ("checker_a", false),
    ] {
        let found = harness.query_all_by_label(key).count();
        assert_eq!(found > 0, is_there, "{key}");
    }
    assert!(
        harness.state().requests.is_empty(),
        "looking changes nothing"
    );
    select(&mut harness, "floor  ×2");
    assert_eq!(harness.state().settings.material, None);
}

#[test]
fn click_in_the_picture_opens_and_names_the_material() {
    let mut harness = harness();
    select(&mut harness, "Materials");
    assert!(harness.query_by_label("chrome  ×2").is_none(), "folded");
    let state = harness.state_mut();
    (state.settings.material, state.settings.scrolls_to_material) = (Some(1), true);
    state.picked = Some(Picked {
        label: "ball (2 of 3)".to_owned(),
        material: 1,
        bounds: Bounds {
            min: Vec3::ZERO,
            max: Vec3::new(1.0, 2.0, 0.5),
        },
        triangles: 12,
        outline: None,
    });
    harness.run();
    for label in ["ball (2 of 3)", "12 triangles, 1.00 × 2.00 × 0.50 m"] {
        harness.get_by_label(label);
    }
    assert!(harness.query_all_by_label("reflectivity").count() > 0);
    assert!(!harness.state().settings.scrolls_to_material, "once");
    select(&mut harness, "Materials");
    assert!(harness.query_by_label("ball (2 of 3)").is_none(), "by hand");
}

#[test]
fn moved_control_requests_only_its_own_change() {
    let mut harness = harness();
    select(&mut harness, "chrome  ×2");
    let roughness = harness.get_all_by_role(Role::Slider).nth(1);
    roughness.expect("a slider").set_value_accesskit(0.25);
    harness.run();
    assert_eq!(requested(&harness), [("roughness", Vec3::splat(0.25))]);
}

/// Numbers that were requested to be written.
fn written(harness: &Harness<'_, State>) -> Vec<Numbers> {
    let requests = harness.state().requests.iter();
    let written = requests.filter_map(|request| match request {
        ViewRequest::Task(Task::WriteMaterial(1, numbers)) => Some(numbers.clone()),
        _ => None,
    });
    written.collect()
}

#[test]
fn a_number_is_written_once_where_its_drag_ends() {
    use eframe::egui::{Event, Modifiers, PointerButton, vec2};

    let mut harness = harness();
    select(&mut harness, "chrome  ×2");
    let slider = harness.get_all_by_role(Role::Slider).nth(1);
    let at = slider.expect("roughness").rect().center();
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let end = at - vec2(20.0, 0.0);
    for event in [
        Event::PointerMoved(at),
        button(at, true),
        Event::PointerMoved(at - vec2(10.0, 0.0)),
        Event::PointerMoved(end),
    ] {
        harness.event(event);
        harness.run();
    }
    let dragged = requested(&harness);
    assert_eq!(dragged[0].0, "roughness");
    assert!(written(&harness).is_empty(), "the drag goes on");
    harness.event(button(end, false));
    harness.run();
    harness.run();
    let value = numbers_of(Form::Number, dragged[0].1);
    assert_eq!(
        written(&harness),
        [Numbers {
            key: "roughness",
            values: value
        }]
    );
}

#[test]
fn emission_and_its_strength_are_set_together() {
    let mut harness = harness();
    select(&mut harness, "chrome  ×2");
    let strength = harness.get_by_role_and_label(Role::SpinButton, "emission_strength");
    strength.set_value_accesskit(3.0);
    harness.run();
    let emission = Vec3::new(0.0, 2.0, 4.0);
    assert_eq!(
        requested(&harness),
        [
            ("emission", emission),
            ("emission_strength", Vec3::splat(3.0))
        ]
    );
    let key = "emission_strength";
    let values = vec![3.0];
    assert_eq!(written(&harness), [Numbers { key, values }], "only the one");
}

#[test]
fn a_color_has_a_picker() {
    let mut harness = harness();
    select(&mut harness, "floor  ×2");
    let picker = harness.get_all_by_role(Role::ColorWell).next();
    picker.expect("of the base color").click();
    harness.run();
    // The picker's own numbers range to 255, the panel's to 1.
    harness
        .get_all_by_role(Role::SpinButton)
        .find(|n| n.accesskit_node().numeric_value() > Some(1.5))
        .expect("in the picker")
        .set_value_accesskit(0.0);
    harness.run();
    let requested = requested(&harness);
    assert!(
        requested.len() == 1 && requested[0].0 == "base_color",
        "{requested:?}"
    );
}

#[test]
fn a_material_as_scene_text_has_what_its_table_needs() {
    assert_eq!(scene_text(&PLAIN), "");
    let material = MaterialDesc {
        base_color: Some(Vec3::new(0.5, 0.25, 1.0)),
        metallic: Some(1.0),
        uv_scale: Some([2.0, 3.0]),
        checker: Some(CheckerDesc {
            colors: [Vec3::ONE, Vec3::ZERO],
            size_m: 0.5,
            kind: Default::default(),
        }),
        ..PLAIN
    };
    let text = scene_text(&material);
    let scene = format!("version = 1\n[material.a]\n{text}");
    let read = reflet_scene::stages::Scene::from_text(&scene, std::path::Path::new("a.toml"), &[]);
    let (scene, _) = read.unwrap_or_else(|e| panic!("{text}: {e:?}"));
    let read = &scene.materials[0].value;
    for field in &MATERIAL {
        let got = (field.get)(read).or((field.get)(&PLAIN));
        assert_eq!(got, (field.get)(&material), "{}", field.key);
    }
}
