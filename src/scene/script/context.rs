//! `ctx`: the view that a call has of the scene, and the values that it sets.

pub mod rig;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use glam::{Affine3A, DMat4, DVec3};
use rhai::{Dynamic, EvalAltResult, Map};

use super::{
    floats::Floats,
    format_value::named,
    setters::{field_bits, material_values, refuse_lacking, set_bits, values},
    value::{WrongKey, fail, fail_with, number, rotation, scale, vector},
};
use crate::{
    desc::{BRIGHTNESS, CAMERA, Entry, LIGHT, MATERIAL, ParamValue, TimelineDesc},
    motion::{
        DECAL, FrameState, Kind, MeshPose, Names, ScriptNames, ScriptedFields, wrong_with_camera,
        wrong_with_light,
    },
    range::ANY,
    suggest,
};

/// Bits of the parts of a node's transform in [`ScriptedFields`].
const TRANSLATION: u64 = 0b001;
const ROTATION: u64 = 0b010;
const TRANSFORM: u64 = 0b111;

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Time and parameters of a call.
#[derive(Clone, Debug)]
pub struct Call {
    /// Time of the frame, seconds.
    pub time_s: f64,
    /// Number of the frame.
    pub frame: i64,
    /// Frames per second.
    pub fps: f64,
    /// First and last frame of the timeline.
    pub range: [i64; 2],
    /// Parameters of the scene, `[params]`.
    pub params: Map,
}

impl Call {
    /// Time and parameters of the call for a frame.
    pub fn new(params: &[Entry<ParamValue>], timeline: Option<&TimelineDesc>, frame: u32) -> Self {
        let value = |value: &ParamValue| match value {
            ParamValue::Integer(i) => Dynamic::from(*i),
            ParamValue::Number(x) => Dynamic::from(*x),
            ParamValue::Switch(b) => Dynamic::from(*b),
            ParamValue::Text(text) => Dynamic::from(text.clone()),
            ParamValue::Numbers(list) => list
                .iter()
                .map(|x| Dynamic::from(*x))
                .collect::<Vec<_>>()
                .into(),
        };
        // From the 32-bit fps of the timeline, so that tracks have the same times.
        let fps = f64::from(timeline.map_or(24.0, |t| t.fps));
        Self {
            time_s: f64::from(frame) / fps,
            frame: i64::from(frame),
            fps,
            range: timeline.map_or([0, 0], |t| [t.start, t.end].map(i64::from)),
            params: params
                .iter()
                .map(|p| (p.name.as_str().into(), value(&p.value)))
                .collect(),
        }
    }
}

/// State of the scene while it is being posed, with the values that were set.
#[derive(Debug, Default)]
struct Scene {
    state: FrameState,
    touched: ScriptedFields,
}

/// The value `ctx` in scripts; all clones share one scene. Its methods take what Rhai hands to registered functions.
#[derive(Clone, Debug)]
pub struct Context {
    /// Time and parameters of the call.
    pub call: Arc<Call>,
    names: Option<ScriptNames>,
    scene: Arc<Mutex<Scene>>,
}

impl Context {
    /// Context for `setup`, which has no scene to pose yet.
    pub fn for_setup(call: Call) -> Self {
        Self {
            call: Arc::new(call),
            names: None,
            scene: Arc::default(),
        }
    }

    /// Context for `frame`.
    pub fn for_frame(call: Call, state: FrameState, names: ScriptNames) -> Self {
        let touched = ScriptedFields::default();
        Self {
            call: Arc::new(call),
            names: Some(names),
            scene: Arc::new(Mutex::new(Scene { state, touched })),
        }
    }

    /// State of the scene after the script, and the values that it has set.
    pub fn into_result(self) -> (FrameState, ScriptedFields) {
        let scene = std::mem::take(&mut *self.scene());
        (scene.state, scene.touched)
    }

    fn scene(&self) -> MutexGuard<'_, Scene> {
        self.scene.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn names(&self) -> Result<&ScriptNames> {
        let in_setup = "setup adds to the scene by what it returns; only frame can pose it: move this call into `fn frame(ctx)`";
        self.names.as_ref().ok_or_else(|| in_setup.into())
    }

    fn find(
        &self,
        kind: &str,
        name: &str,
        table: impl Fn(&Names) -> &std::collections::HashMap<String, usize>,
    ) -> Result<usize> {
        let names = self.names()?;
        let table = table(names);
        if let Some(index) = table.get(&names.full(name)) {
            return Ok(*index);
        }
        let mut known: Vec<_> = table.keys().filter_map(|full| names.own(full)).collect();
        known.sort_unstable();
        known.truncate(1000);
        let (full, shown) = (names.full(name), suggest::text(name));
        let others = [
            ("camera", &names.cameras),
            ("light", &names.lights),
            ("decal", &names.decals),
            ("material", &names.materials),
        ];
        let hint = if let Some((other, _)) = others.iter().find(|(_, all)| all.contains_key(&full))
        {
            format!("it is a {other}, which `ctx.{other}({shown}, #{{ … }})` changes")
        } else if names.models.contains_key(&full) {
            format!("it is a model: write `name = {shown}` in its [[instance]]")
        } else if known.is_empty() {
            format!("no {kind} of the scene has a name")
        } else if let Some(numbers) = numbers(name, &known) {
            numbers
        } else {
            suggest::hint(name, &known, suggest::text, &format!("the {kind}s are"))
        };
        fail(format!(
            "no {kind} is named {}; {hint}",
            suggest::text(name)
        ))
    }

    /// Index of an instance or group that may move; an error if it may not.
    fn movable(&self, name: &str) -> Result<usize> {
        let index = self.find("instance", name, |n| &n.instances)?;
        if self.names()?.known.dynamic[index] {
            return Ok(index);
        }
        let shown = suggest::text(name);
        fail(format!(
            "{shown} stands still; write `dynamic = true` in its [[instance]] or [group]"
        ))
    }

    /// Sets the transform of a node; `fields` are the bits of its parts that are set.
    fn put(
        &self,
        name: &str,
        fields: u64,
        pose: impl FnOnce(&Affine3A) -> Result<Affine3A>,
    ) -> Result<()> {
        let index = self.movable(name)?;
        let mut scene = self.scene();
        let slot = &mut scene.state.instances[index];
        let pose = pose(slot)?;
        let shown = suggest::text(name);
        if !pose.is_finite() {
            return fail(format!(
                "the pose of {shown} has a number that is not finite"
            ));
        }
        if !pose.to_cols_array().iter().all(|x| within(f64::from(*x))) {
            return fail(format!(
                "the numbers of the pose of {shown} must be between -1e12 and 1e12"
            ));
        }
        if pose.matrix3.determinant() == 0.0 {
            return fail(format!(
                "the pose of {shown} is flat: a scale is 0, or the matrix is singular"
            ));
        }
        *slot = pose;
        scene.touched.add(Kind::Node, index, fields);
        Ok(())
    }

    /// Shows or hides an instance or a group.
    pub fn show(&mut self, name: &str, shown: bool) -> Result<()> {
        let index = self.movable(name)?;
        self.scene().state.hidden[index] = !shown;
        Ok(())
    }

    /// Sets the position of a node, which keeps its rotation and scale, or its whole matrix.
    pub fn place(&mut self, name: &str, position: Dynamic) -> Result<()> {
        if let Some(matrix) = position.clone().try_cast::<DMat4>() {
            return self.put(name, TRANSFORM, |_| {
                Ok(Affine3A::from_mat4(matrix.as_mat4()))
            });
        }
        let position = vector(&position, "the position")?.as_vec3();
        self.put(name, TRANSLATION, |old| {
            Ok(Affine3A {
                translation: position.into(),
                ..*old
            })
        })
    }

    /// Sets position, rotation and scale of a node.
    pub fn place_all(
        &mut self,
        name: &str,
        position: Dynamic,
        turn: Dynamic,
        size: Dynamic,
    ) -> Result<()> {
        let position = vector(&position, "the position")?.as_vec3();
        let (turn, size) = (rotation(&turn)?.as_quat(), scale(&size)?.as_vec3());
        self.put(name, TRANSFORM, |_| {
            Ok(Affine3A::from_scale_rotation_translation(
                size, turn, position,
            ))
        })
    }

    /// Sets position and rotation of a node, which keeps its scale.
    pub fn turn(&mut self, name: &str, position: Dynamic, turn: Dynamic) -> Result<()> {
        let position = vector(&position, "the position")?.as_vec3();
        let turn = rotation(&turn)?.as_quat();
        self.put(name, TRANSLATION | ROTATION, |old| {
            let (size, _, _) = old.to_scale_rotation_translation();
            Ok(Affine3A::from_scale_rotation_translation(
                size, turn, position,
            ))
        })
    }

    /// World position of a node, as posed so far.
    pub fn position(&mut self, name: &str) -> Result<DVec3> {
        Ok(self.matrix(name)?.w_axis.truncate())
    }

    /// Transform of a node, as posed so far, from its model space to the world.
    pub fn matrix(&mut self, name: &str) -> Result<DMat4> {
        let index = self.find("instance", name, |n| &n.instances)?;
        let parents = &self.names()?.known.parents;
        let world = parents.world_of(&self.scene().state.instances, index);
        Ok(glam::Mat4::from(world).as_dmat4())
    }

    /// Sets the time inside the animations that an instance plays, seconds.
    pub fn animate(&mut self, name: &str, time_s: Dynamic) -> Result<()> {
        let index = self.find("instance", name, |n| &n.instances)?;
        if !self.names()?.known.playing[index] {
            let shown = suggest::text(name);
            return fail(format!(
                "instance {shown} plays nothing; write `animation = \"…\"` in its [[instance]]"
            ));
        }
        let time_s = number(&time_s, "time_s")?;
        if !within(time_s) {
            return fail(format!(
                "`time_s` must be between -1e12 and 1e12, not {time_s}"
            ));
        }
        self.scene().state.animation_s[index] = Some(time_s);
        Ok(())
    }

    /// Sets values of a camera.
    pub fn camera(&mut self, name: &str, keys: Map) -> Result<()> {
        let index = self.find("camera", name, |n| &n.cameras)?;
        let mut scene = self.scene();
        let mut camera = scene.state.cameras[index].clone();
        let values = values(&CAMERA, &keys, "a camera", |_| true)?;
        let fields = field_bits(&CAMERA, values.iter().map(|(field, _)| *field));
        for (field, value) in values {
            (field.put)(&mut camera, value);
        }
        if let Some(wrong) = wrong_with_camera(&camera) {
            let message = format!("camera {} {}", suggest::text(name), wrong.why);
            return fail_with(message, wrong.help);
        }
        scene.state.cameras[index] = camera;
        scene.touched.add(Kind::Camera, index, fields);
        Ok(())
    }

    /// Sets values of a light.
    pub fn light(&mut self, name: &str, keys: Map) -> Result<()> {
        let index = self.find("light", name, |n| &n.lights)?;
        let mut scene = self.scene();
        let mut light = scene.state.lights[index];
        let word = format!("a {} light", light.kind.name());
        let old = light;
        let values = values(&LIGHT, &keys, &word, |f| (f.get)(&old).is_some())?;
        let mut bright = BRIGHTNESS.iter().filter(|key| keys.contains_key(**key));
        if let Some((first, second)) = bright.next().zip(bright.next()) {
            return Err(WrongKey {
                key: (*second).to_owned(),
                message: format!("`{second}` cannot be combined with `{first}`"),
                help: Some(format!("remove `{second}` or `{first}`")),
            }
            .into());
        }
        let fields = field_bits(&LIGHT, values.iter().map(|(field, _)| *field));
        for (field, value) in values {
            (field.put)(&mut light, value);
        }
        if let Some([inner_deg, outer_deg]) = light.kind.cone_deg()
            && inner_deg > outer_deg
        {
            return fail(format!(
                "`inner_deg` must be 0 to `outer_deg`: {inner_deg} is more than {outer_deg}"
            ));
        }
        light.settle();
        if let Some(wrong) = wrong_with_light(&light) {
            let message = format!("light {} {}", suggest::text(name), wrong.why);
            return fail_with(message, wrong.help);
        }
        scene.state.lights[index] = light;
        scene.touched.add(Kind::Light, index, fields);
        Ok(())
    }

    /// Sets numbers of a `[material.NAME]`.
    pub fn material(&mut self, name: &str, keys: Map) -> Result<()> {
        let index = self.find("material", name, |n| &n.materials)?;
        let values = material_values(&keys)?;
        let mut scene = self.scene();
        let material = &mut scene.state.materials[index];
        refuse_lacking(&values, material, || {
            format!("`[material.{}]`", suggest::clip(name))
        })?;
        for (field, value) in MATERIAL.iter().zip(values) {
            if let Some(value) = value {
                (field.put)(material, value);
            }
        }
        let fields = set_bits(&values);
        scene.touched.add(Kind::Material, index, fields);
        Ok(())
    }

    /// Sets numbers of an instance's own `material = { … }`.
    pub fn instance_material(&mut self, name: &str, keys: Map) -> Result<()> {
        let index = self.find("instance", name, |n| &n.instances)?;
        let Some(own) = self.names()?.known.overrides.get(&index) else {
            let shown = suggest::text(name);
            return fail(format!(
                "instance {shown} has no `material = {{ … }}` of its own; write `material = {{}}` \
                 in its [[instance]]"
            ));
        };
        let values = material_values(&keys)?;
        let path = || format!("`material` of instance {}", suggest::text(name));
        refuse_lacking(&values, own, path)?;
        let mut scene = self.scene();
        scene.state.overrides[index].put(&values);
        scene.touched.add(Kind::Override, index, set_bits(&values));
        Ok(())
    }

    /// Sets numbers of a material inside a model's file.
    pub fn file_material(&mut self, model: &str, name: &str, keys: Map) -> Result<()> {
        let names = self.names()?;
        let (table, full) = (&names.file_materials, names.full(model));
        let Some(&index) = table.get(&(full.clone(), name.to_owned())) else {
            let of_model = table.keys().filter(|(m, _)| *m == full);
            let mut known: Vec<_> = of_model.map(|(_, material)| material.as_str()).collect();
            known.sort_unstable();
            let hint = if known.is_empty() {
                "only those with such a table can be set".to_owned()
            } else {
                suggest::hint(
                    name,
                    &known,
                    suggest::text,
                    "its materials with a table are",
                )
            };
            let path = [model, name].map(suggest::clip).join(".material.");
            return fail(format!("the scene has no table `[model.{path}]`; {hint}"));
        };
        let values = material_values(&keys)?;
        refuse_lacking(&values, &self.names()?.known.written[index], || {
            let [model, name] = [model, name].map(suggest::clip);
            format!("`[model.{model}.material.{name}]`")
        })?;
        let mut scene = self.scene();
        scene.state.file_materials[index].put(&values);
        let fields = set_bits(&values);
        scene.touched.add(Kind::FileMaterial, index, fields);
        Ok(())
    }
}

/// Whether scene text accepts a number of this size.
fn within(x: f64) -> bool {
    ANY.contains(x)
}

impl Context {
    /// Smooths the normals of a mesh whose vertices get other positions.
    pub fn mesh(&mut self, model: &str, positions: Dynamic) -> Result<()> {
        self.deform(model, &positions, None)
    }

    /// Gives other positions and normals to the vertices of a mesh.
    pub fn mesh_with(&mut self, model: &str, at: Dynamic, normals: Dynamic) -> Result<()> {
        self.deform(model, &at, Some(&normals))
    }

    /// Gives other positions to the vertices of a mesh, and normals, or smooth ones.
    fn deform(&self, model: &str, positions: &Dynamic, normals: Option<&Dynamic>) -> Result<()> {
        let index = self.find("model", model, |n| &n.models)?;
        let Some(vertices) = self.names()?.known.vertices[index] else {
            return fail(MeshPose::refusal(model));
        };
        let numbers = |value: &Dynamic, what: &str| match value.clone().try_cast::<Floats>() {
            Some(floats) => Ok(floats.shared()),
            None => fail(format!(
                "the {what} of a mesh must be `floats`, not {}",
                named(value)
            )),
        };
        let positions = numbers(positions, "positions")?;
        let normals = normals
            .map(|normals| numbers(normals, "normals"))
            .transpose()?;
        let pose = MeshPose::new(model, vertices, positions, normals).or_else(fail)?;
        self.scene().state.meshes.insert(index, pose);
        Ok(())
    }
}

/// The only number that a decal that stands still may change.
const OPACITY: &str = "opacity";

impl Context {
    /// Sets values of a decal.
    pub fn decal(&mut self, name: &str, keys: Map) -> Result<()> {
        let index = self.find("decal", name, |n| &n.decals)?;
        let values = values(&DECAL, &keys, "a decal", |_| true)?;
        let moved = values.iter().find(|(field, _)| field.key != OPACITY);
        if let Some((field, _)) =
            moved.filter(|_| !self.names().is_ok_and(|n| n.known.decals[index]))
        {
            let shown = suggest::text(name);
            return fail(format!(
                "decal {shown} stands still, so `{}` cannot be set; write `dynamic = true` in its `[decal.{}]`",
                field.key,
                suggest::clip(name)
            ));
        }
        let fields = field_bits(&DECAL, values.iter().map(|(field, _)| *field));
        let mut scene = self.scene();
        for (field, value) in values {
            (field.put)(&mut scene.state.decals[index], value);
        }
        scene.touched.add(Kind::Decal, index, fields);
        Ok(())
    }
}

/// Advice for a name with a number after the last one of several, or before the first.
fn numbers(name: &str, known: &[&str]) -> Option<String> {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let number: u32 = name[stem.len()..].parse().ok()?;
    let has = |number: u32| known.contains(&format!("{stem}{number}").as_str());
    match number.checked_sub(1) {
        Some(last) if has(last) && has(0) => Some(format!(
            "the last one is {}: they are numbered from 0, as by `for i in 0..{number}`",
            suggest::text(&format!("{stem}{last}"))
        )),
        None if has(1) => Some(format!(
            "the first one is {}",
            suggest::text(&format!("{stem}1"))
        )),
        _ => None,
    }
}
