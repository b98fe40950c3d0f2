//! Numbers of materials over time: of those that the scene names, whose values at rest are known
//! here, and of those inside files, whose are not.

use glam::Vec3;

use super::track::Track;
use crate::scene::desc::{MaterialDesc, MaterialMotionDesc, SceneDesc};

/// Base color, metalness, roughness, normal scale, emission, its strength, reflectivity.
pub type Tracks<'a> = [Option<Track<'a>>; 7];

/// A material inside a model's file, or all of them as `"*"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileMaterial<'a> {
    /// Name of the `[model.NAME]`.
    pub model: &'a str,
    /// Name of the material.
    pub material: &'a str,
}

/// Every material inside a file that may change: those with motion, and, for a script, those with
/// a table `[model.NAME.material.M]`.
pub fn file_materials(desc: &SceneDesc) -> Vec<FileMaterial<'_>> {
    let mut found = Vec::new();
    let mut add = |model, material| {
        let new = FileMaterial { model, material };
        if !found.contains(&new) {
            found.push(new);
        }
    };
    if desc.script.as_ref().is_some_and(|s| s.has_frame()) {
        for model in &desc.models {
            (model.value.overrides.iter()).for_each(|e| add(model.name.as_str(), e.name.as_str()));
        }
    }
    for model in &desc.motion.models {
        (model.value.materials.iter()).for_each(|e| add(model.name.as_str(), e.name.as_str()));
    }
    found
}

/// What changes of a material whose values at rest only its file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialChange {
    /// Values in place of its own.
    pub set: MaterialDesc,
    /// What is then added to them.
    pub add: MaterialDesc,
}

/// The tracks of a material, made ready.
pub fn tracks(motion: &MaterialMotionDesc) -> Tracks<'_> {
    let m = motion;
    let all = [
        &m.base_color,
        &m.metallic,
        &m.roughness,
        &m.normal_scale,
        &m.emission,
        &m.emission_strength,
        &m.reflectivity,
    ];
    all.map(|track| track.as_ref().map(|t| Track::new(t, |_| None)))
}

/// Poses a `[material.NAME]`.
pub fn pose(material: &mut MaterialDesc, tracks: &Tracks, time_s: f64) {
    let change = change(tracks, time_s);
    let defaults = MaterialDesc {
        base_color: Some(Vec3::ONE),
        metallic: Some(0.0),
        roughness: Some(1.0),
        normal_scale: Some(1.0),
        emission: Some(Vec3::ZERO),
        emission_strength: Some(1.0),
        reflectivity: Some(0.04),
        ..MaterialDesc::default()
    };
    *material = change.over(material, &defaults);
}

/// What the tracks make of a material at a time, seconds.
pub fn change(tracks: &Tracks, time_s: f64) -> MaterialChange {
    let [
        base_color,
        metallic,
        roughness,
        normal_scale,
        emission,
        strength,
        reflectivity,
    ] = tracks;
    let mut change = MaterialChange::default();
    let MaterialChange { set, add } = &mut change;
    let color = |set: &mut Option<Vec3>, add: &mut Option<Vec3>, track: &Option<Track>| {
        if let Some(track) = track {
            let slot = if track.is_absolute() { set } else { add };
            *slot = Some(track.at(time_s, Vec3::ZERO, &[]));
        }
    };
    let number = |set: &mut Option<f32>, add: &mut Option<f32>, track: &Option<Track>| {
        if let Some(track) = track {
            let slot = if track.is_absolute() { set } else { add };
            *slot = Some(track.number_at(time_s, 0.0));
        }
    };
    color(&mut set.base_color, &mut add.base_color, base_color);
    number(&mut set.metallic, &mut add.metallic, metallic);
    number(&mut set.roughness, &mut add.roughness, roughness);
    number(&mut set.normal_scale, &mut add.normal_scale, normal_scale);
    color(&mut set.emission, &mut add.emission, emission);
    let (set_strength, add_strength) = (&mut set.emission_strength, &mut add.emission_strength);
    number(set_strength, add_strength, strength);
    number(&mut set.reflectivity, &mut add.reflectivity, reflectivity);
    change
}

impl MaterialChange {
    /// `desc` after the change; `rest` says what `desc` leaves open. What goes beyond a number's
    /// range is cut off there.
    pub fn over(&self, desc: &MaterialDesc, rest: &MaterialDesc) -> MaterialDesc {
        let (set, add) = (&self.set, &self.add);
        let color =
            |desc: Option<Vec3>, set: Option<Vec3>, add: Option<Vec3>, rest: Option<Vec3>, most| {
                let changed = set.is_some() || add.is_some();
                let value = set.or(desc).or(rest).unwrap_or(Vec3::ZERO) + add.unwrap_or(Vec3::ZERO);
                if changed {
                    Some(value.clamp(Vec3::ZERO, Vec3::splat(most)))
                } else {
                    desc
                }
            };
        let number =
            |desc: Option<f32>, set: Option<f32>, add: Option<f32>, rest: Option<f32>, most| {
                let changed = set.is_some() || add.is_some();
                let value = set.or(desc).or(rest).unwrap_or(0.0) + add.unwrap_or(0.0);
                if changed {
                    Some(value.clamp(0.0, most))
                } else {
                    desc
                }
            };
        let d = desc;
        MaterialDesc {
            base_color: color(
                d.base_color,
                set.base_color,
                add.base_color,
                rest.base_color,
                1.0,
            ),
            metallic: number(d.metallic, set.metallic, add.metallic, rest.metallic, 1.0),
            roughness: number(
                d.roughness,
                set.roughness,
                add.roughness,
                rest.roughness,
                1.0,
            ),
            normal_scale: number(
                d.normal_scale,
                set.normal_scale,
                add.normal_scale,
                rest.normal_scale,
                4.0,
            ),
            emission: color(d.emission, set.emission, add.emission, rest.emission, 1e12),
            emission_strength: number(
                d.emission_strength,
                set.emission_strength,
                add.emission_strength,
                rest.emission_strength,
                1e12,
            ),
            reflectivity: number(
                d.reflectivity,
                set.reflectivity,
                add.reflectivity,
                rest.reflectivity,
                1.0,
            ),
            ..desc.clone()
        }
    }

    /// Sets values from now on, whatever was added to them before.
    pub fn put(&mut self, values: &MaterialDesc) {
        self.set = self.set.overlaid(values);
        let add = &mut self.add;
        add.base_color = add.base_color.filter(|_| values.base_color.is_none());
        add.metallic = add.metallic.filter(|_| values.metallic.is_none());
        add.roughness = add.roughness.filter(|_| values.roughness.is_none());
        add.normal_scale = add.normal_scale.filter(|_| values.normal_scale.is_none());
        add.emission = add.emission.filter(|_| values.emission.is_none());
        let strength = values.emission_strength;
        add.emission_strength = add.emission_strength.filter(|_| strength.is_none());
        add.reflectivity = add.reflectivity.filter(|_| values.reflectivity.is_none());
    }
}

impl MaterialDesc {
    /// What `over` says, else what this says.
    pub fn overlaid(&self, over: &Self) -> Self {
        let (b, o) = (self, over);
        let text = |over: &Option<_>, base: &Option<_>| over.clone().or_else(|| base.clone());
        Self {
            base_color: o.base_color.or(b.base_color),
            base_color_texture: text(&o.base_color_texture, &b.base_color_texture),
            checker: o.checker.or(b.checker),
            metallic: o.metallic.or(b.metallic),
            roughness: o.roughness.or(b.roughness),
            metallic_roughness_texture: text(
                &o.metallic_roughness_texture,
                &b.metallic_roughness_texture,
            ),
            normal_texture: text(&o.normal_texture, &b.normal_texture),
            normal_scale: o.normal_scale.or(b.normal_scale),
            emission: o.emission.or(b.emission),
            emission_strength: o.emission_strength.or(b.emission_strength),
            emission_texture: text(&o.emission_texture, &b.emission_texture),
            uv_scale: o.uv_scale.or(b.uv_scale),
            alpha_cutoff: o.alpha_cutoff.or(b.alpha_cutoff),
            double_sided: o.double_sided.or(b.double_sided),
            reflection: o.reflection.or(b.reflection),
            reflectivity: o.reflectivity.or(b.reflectivity),
        }
    }
}
