//! Names that a scene and its models' files offer to choose from.

use super::answer::{Choices, Cut, ModelContents, Parameter, Timeline};
use crate::runtime::{
    parameters::{slider_range, value_text},
    scene_text::LoadedScene,
};
use reflet_scene::desc::ParamValue;

/// Number of nodes of a file that are listed.
const MOST_NODES: usize = 1000;

impl Choices {
    /// Choices of a loaded scene.
    pub fn of_scene(loaded: &LoadedScene) -> Self {
        let scene = &loaded.scene;
        let models = loaded.world.models.iter().map(|listed| {
            let nodes = &listed.names.nodes;
            ModelContents {
                name: listed.model.clone(),
                file: listed.file.display().to_string(),
                materials: listed.names.materials.to_vec(),
                nodes: nodes.iter().take(MOST_NODES).cloned().collect(),
                node_count: nodes.len(),
                variants: listed.variants.clone(),
                shown_variant: listed.shown.clone(),
            }
        });
        let parameters = scene.params.iter().map(|param| Parameter {
            name: param.name.clone(),
            value: value_text(&param.value),
            place: param.at.in_words(),
            range: match param.value {
                ParamValue::Integer(own) => Some(slider_range(own as f64, 10.0)),
                ParamValue::Number(own) => Some(slider_range(own, 1.0)),
                _ => None,
            },
        });
        Self {
            models: models.collect(),
            scene_variants: scene.variants.iter().map(|v| v.value.clone()).collect(),
            parameters: parameters.collect(),
            timeline: scene.timeline.as_ref().map(|t| Timeline {
                start: t.start,
                end: t.end,
                fps: t.fps,
            }),
            cuts: (scene.cuts.iter())
                .map(|cut| Cut {
                    frame: cut.frame,
                    camera: cut.camera.value.clone(),
                })
                .collect(),
        }
    }
}
