//! The pose that skins and morph targets of a model have: that of the scene's first frame.

use super::Source;
use crate::{
    scene::desc::SceneDesc,
    world::gltf::{FrozenPose, Model},
};

/// What the first placement of a model plays, at the time of the first frame.
pub fn first_frame(desc: &SceneDesc, model: usize) -> Option<FrozenPose> {
    let entry = &desc.models[model];
    let mut instances = desc.instances.iter();
    let played = match instances.find(|i| i.model.value == entry.name) {
        Some(instance) => desc.played_by(instance),
        None => entry.value.animation.as_ref(),
    };
    let timeline = desc.timeline.as_ref();
    Some(FrozenPose {
        played: played?.clone(),
        time_s: timeline.map_or(0.0, |t| f64::from(t.start) / f64::from(t.fps)),
    })
}

/// For each model that deforms the key of its pose: texts with other keys must be loaded anew.
pub fn keys(desc: &SceneDesc, sources: &[Source], loaded: &[Model]) -> Vec<Option<Option<String>>> {
    let key = |(index, source): (usize, &Source)| match source {
        Source::File(at) if loaded[*at].deforms => {
            Some(first_frame(desc, index).map(|pose| pose.key()))
        }
        _ => None,
    };
    sources.iter().enumerate().map(key).collect()
}
