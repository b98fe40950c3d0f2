//! Functions of `ctx` that pose the inside of instances' files: nodes and morph targets.

use rhai::{Dynamic, Map};

use super::{
    super::value::{WrongKey, fail, number, rotation, scale, vector},
    Context, Result, within,
};
use crate::{
    motion::{JointPose, Names},
    suggest,
};

/// Keys of the map argument of `ctx.joint`.
pub const KEYS: [&str; 4] = ["translation", "rotation", "scale", "turn"];

impl Context {
    /// Poses a node of an instance's file, relative to its parent.
    pub fn joint(&mut self, name: &str, joint: &str, keys: Map) -> Result<()> {
        let place = self.listed(name, joint, "joint", |names| &names.known.joints)?;
        let mut scene = self.scene();
        let mut pose = scene.state.joints.get(&place).copied().unwrap_or_default();
        for (key, value) in &keys {
            set(&mut pose, key, value).map_err(WrongKey::in_key(key))?;
        }
        scene.state.joints.insert(place, pose);
        Ok(())
    }

    /// Sets the weight of a morph target of an instance's file.
    pub fn morph(&mut self, name: &str, target: &str, weight: Dynamic) -> Result<()> {
        let place = self.listed(name, target, "morph", |names| &names.known.morphs)?;
        let weight = number(&weight, "weight")?;
        if !within(weight) {
            return fail(format!(
                "`weight` must be between -1e12 and 1e12, not {weight}"
            ));
        }
        self.scene().state.morphs.insert(place, weight as f32);
        Ok(())
    }

    /// Index of an instance, and index of a name in its list that scene text calls `kind` and "s".
    fn listed(
        &self,
        instance: &str,
        name: &str,
        kind: &str,
        lists: impl Fn(&Names) -> &Vec<Vec<String>>,
    ) -> Result<(usize, usize)> {
        let index = self.find("instance", instance, |n| &n.instances)?;
        let list = lists(self.names()?)
            .get(index)
            .map_or(&[][..], Vec::as_slice);
        if let Some(place) = list.iter().position(|known| known == name) {
            return Ok((index, place));
        }
        let instance = suggest::text(instance);
        let shown = suggest::text(name);
        if list.is_empty() {
            return fail(format!(
                "instance {instance} has no {kind}s that scripts pose; write `{kind}s = [{shown}]` in \
                 its [[instance]]"
            ));
        }
        let known: Vec<_> = list.iter().map(String::as_str).collect();
        let hint = suggest::hint(name, &known, suggest::text, &format!("its `{kind}s` are"));
        fail(format!(
            "the `{kind}s` of instance {instance} do not name {shown}; {hint}"
        ))
    }
}

fn set(pose: &mut JointPose, key: &str, value: &Dynamic) -> Result<()> {
    match key {
        "translation" => pose.translation = Some(vector(value, "`translation`")?.as_vec3()),
        "rotation" => pose.rotation = Some(rotation(value)?.as_quat()),
        "scale" => pose.scale = Some(scale(value)?.as_vec3()),
        "turn" => pose.turn = Some(rotation(value)?.as_quat()),
        _ => {
            let known = KEYS.map(|key| format!("`{key}`")).join(", ");
            return fail(format!(
                "a joint has no {} that can be set; there are {known}",
                suggest::key(key)
            ));
        }
    }
    Ok(())
}
