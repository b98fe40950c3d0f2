//! Numbers of an item that can be changed, at rest.

use std::sync::Arc;

use glam::{Affine3A, EulerRot, Vec3};

use super::{
    Inspected, Numbers,
    item::SceneItem,
    overridden::Layered,
    places::{self, places},
};
use reflet_scene::{
    desc::{BRIGHTNESS, CAMERA, ENVIRONMENT, LIGHT, LightDesc, PlacementDesc, SceneDesc, turned},
    diagnostic::Span,
    motion::{DECAL, DECAL_PLACES, DecalPose},
    number::{Field, Form},
    toml_text::toml_text,
};

/// File and line of a place.
pub fn shown_place(at: &Span) -> String {
    at.source.as_ref().map_or_else(String::new, |source| {
        let line = source.place(at.range.start).line;
        format!("{}:{line}", source.path.display())
    })
}

/// Editable numbers of an item, at rest.
pub fn inspect(scene: &Layered<'_>, item: SceneItem) -> Option<Inspected> {
    let desc = scene.desc;
    let (name, at) = item.named(desc)?;
    let (numbers, refused) = match numbers(desc, item).and_then(|all| {
        places::writable(at.source.as_ref().map(Arc::as_ref))?;
        Ok(all)
    }) {
        Ok(numbers) => (numbers, None),
        Err(why) => (Vec::new(), Some(why)),
    };
    let held = |n: &Numbers| Some((n.key, scene.held(item, n.key)?));
    Some(Inspected {
        item,
        label: item.label(desc),
        name: name.map(str::to_owned),
        place: shown_place(at),
        held: numbers.iter().filter_map(held).collect(),
        numbers,
        refused,
        world_from_parent: world_from_parent(desc, item),
    })
}

fn world_from_parent(desc: &SceneDesc, item: SceneItem) -> Affine3A {
    let parents = &desc.parents;
    let parent = match item {
        SceneItem::Instance(i) => parents.of_node(i),
        SceneItem::Group(i) => parents.of_node(desc.instances.len() + i),
        SceneItem::Decal(i) => parents.of_decal(i),
        SceneItem::Light(i) => parents.of_light(i),
        SceneItem::Camera(i) => parents.of_camera(i),
        SceneItem::Model(_) | SceneItem::Environment => None,
    };
    parent.map_or(Affine3A::IDENTITY, |parent| desc.rest()[parent])
}

fn numbers(desc: &SceneDesc, item: SceneItem) -> Result<Vec<Numbers>, String> {
    let placement = match item {
        SceneItem::Instance(i) => &desc.instances[i].placement,
        SceneItem::Group(i) => &desc.groups[i].value.placement,
        SceneItem::Decal(i) => &desc.decals[i].value.placement,
        SceneItem::Light(i) => return Ok(light(desc, item, &desc.lights[i].value)),
        SceneItem::Camera(i) => return Ok(fields(&desc.cameras[i].value, &CAMERA)),
        SceneItem::Environment => return Ok(environment(desc)),
        SceneItem::Model(i) => {
            let name = toml_text(&desc.models[i].name);
            let help = format!("write `[[instance]]` with `model = {name}` to move it");
            return Err(format!("no instance places it; {help}"));
        }
    };
    let PlacementDesc::Trs {
        translation,
        rotation,
        scale,
    } = *placement
    else {
        let help = "write `translation`, `rotation_deg` and `scale` in its place";
        return Err(format!("it is placed by `matrix`; {help}"));
    };
    let three = |v: Vec3| v.to_array().map(exact).to_vec();
    let written = item.subject(desc);
    let written = written.and_then(|item| places(desc, &[], &item, "rotation_deg"));
    let written = written.ok().and_then(|place| place.numbers("rotation_deg"));
    let agrees = |euler: &Vec<f64>| {
        let [x, y, z] = *euler.as_slice() else {
            return false;
        };
        let turn = turned(Vec3::new(x as f32, y as f32, z as f32));
        turn.angle_between(rotation) < 1e-3
    };
    let euler = written.filter(agrees).unwrap_or_else(|| {
        let (z, y, x) = rotation.as_dquat().to_euler(EulerRot::ZYX);
        [x, y, z]
            .map(|turn| exact(turn.to_degrees() as f32))
            .to_vec()
    });
    let numbers = |key, values| Numbers { key, values };
    let mut all = vec![
        numbers("translation", three(translation)),
        numbers("rotation_deg", euler),
        numbers("scale", three(scale)),
    ];
    if let SceneItem::Decal(i) = item {
        let decal = DecalPose::at_rest(&desc.decals[i].value);
        all.extend(fields(&decal, &DECAL[DECAL_PLACES..]));
    }
    Ok(all)
}

/// Numbers of a light; its brightness is under the key that is written.
fn light(desc: &SceneDesc, item: SceneItem, light: &LightDesc) -> Vec<Numbers> {
    let place = item.subject(desc);
    let place = place
        .and_then(|item| places(desc, &[], &item, BRIGHTNESS[0]))
        .ok();
    let has = |key: &&str| place.as_ref().is_some_and(|place| place.has(key));
    let written = BRIGHTNESS.into_iter().find(has).unwrap_or(BRIGHTNESS[0]);
    let mut all = fields(light, &LIGHT);
    all.retain(|n| n.key == written || !BRIGHTNESS.contains(&n.key));
    // Shown as it is written: the light keeps candela, and a flux that is computed from them again is rounded.
    if let Some(n) = all.iter_mut().find(|n| n.key == written)
        && let Some(text) = place.and_then(|place| place.numbers(written))
        && (text.iter().zip(&n.values)).all(|(a, b)| (a - b).abs() < 1e-5 * a.abs())
    {
        n.values = text;
    }
    all
}

/// Numbers of the kind of environment that the scene has.
fn environment(desc: &SceneDesc) -> Vec<Numbers> {
    let environment = &desc.environment;
    let subject = SceneItem::Environment.subject(desc);
    let place = subject.and_then(|item| places(desc, &[], &item, "color"));
    let is_color = !environment.is_written || place.is_ok_and(|place| place.has("color"));
    let has_file = environment.file.is_some();
    let is_shown = |n: &Numbers| match n.key {
        "color" => is_color && !has_file,
        "zenith" | "horizon" | "ground" => !is_color && !has_file,
        _ => true,
    };
    let mut all = fields(environment, &ENVIRONMENT);
    all.retain(is_shown);
    all
}

/// The double with the same shortest decimal text as the float.
pub fn exact(x: f32) -> f64 {
    // Turns -0 into 0.
    x.to_string().parse().unwrap_or(f64::from(x)) + 0.0
}

/// Numbers of a value of this form.
pub fn numbers_of(form: Form, value: Vec3) -> Vec<f64> {
    value.to_array().map(exact)[..form.lanes()].to_vec()
}

/// Editable fields of a light, a camera or the environment.
pub(super) fn fields<T>(of: &T, fields: &[Field<T>]) -> Vec<Numbers> {
    let one = |field: &Field<T>| {
        Some(Numbers {
            key: field.key,
            values: numbers_of(field.form, (field.get)(of)?),
        })
    };
    let mut all: Vec<_> = fields.iter().filter_map(one).collect();
    // A light with a target takes its direction from there.
    let has = |key: &str| all.iter().any(|n| n.key == key);
    if has("target") && has("direction") {
        all.retain(|n| n.key != "target");
    }
    all
}
