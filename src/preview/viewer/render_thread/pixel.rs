//! The pixel inspector: values of the last picture's AOVs at one pixel.

use super::worker::Worker;
use crate::viewer::protocol::{PixelValue, View};
use reflet_render::{
    PlaneData, RenderError,
    layout::types::NONE,
    picture::aov::Aov,
    pipeline::{
        cause::{Cause, Source},
        targets::Target,
    },
};
use reflet_scene::declared::Words as _;

/// AOVs that are shown, most informative first.
const SHOWN: [Aov; 12] = [
    Aov::Ids,
    Aov::Depth,
    Aov::Source,
    Aov::Cause,
    Aov::HitDistance,
    Aov::HitIds,
    Aov::Reflection,
    Aov::Radiance,
    Aov::Specular,
    Aov::Normal,
    Aov::BaseColor,
    Aov::Material,
];

impl Worker {
    /// Values at a pixel, by its index, of the last picture, which was rendered for `view`.
    pub(super) fn pixel(&self, view: &View, index: usize) -> Result<Vec<PixelValue>, RenderError> {
        let renderer = self.live.renderer();
        let width = renderer.targets().size[0] as usize;
        let (x, y) = (index % width, index / width);
        let camera = self.camera(&view.camera);
        let display: Vec<u8> = renderer.read(&self.gpu, Target::Display)?;
        let [r, g, b] = [0, 1, 2].map(|c| display[4 * index + c]);
        let mut values = vec![
            value("pixel", format!("{x}, {y}")),
            value("shown", format!("#{r:02x}{g:02x}{b:02x}")),
        ];
        for aov in SHOWN {
            let plane = aov.plane(&self.gpu, renderer, &camera)?;
            let channels = plane.channels.len();
            let at = channels * index..channels * (index + 1);
            values.push(value(
                aov.name(),
                match &plane.data {
                    PlaneData::F32(all) => floats(aov, &all[at]),
                    PlaneData::U32(all) => self.numbers(aov, &all[at]),
                },
            ));
        }
        Ok(values)
    }

    /// Text of an integer AOV's values: names of causes, sources and instances.
    fn numbers(&self, aov: Aov, numbers: &[u32]) -> String {
        match (aov, numbers) {
            (Aov::Cause, [cause]) => {
                Cause::from_number(*cause).map_or_else(String::new, |c| c.name().to_owned())
            }
            (Aov::Source, [source]) => {
                let known = Source::WORDS.get(*source as usize);
                known.map_or("", |word| word.summary).to_owned()
            }
            (_, [NONE, _]) => "nothing".to_owned(),
            (_, [instance, triangle]) => {
                let world = self.live.world();
                let instance = world.instances.get(*instance as usize);
                let name = instance.map_or("", |instance| &instance.name);
                format!("{name}, triangle {triangle}")
            }
            _ => String::new(),
        }
    }
}

fn value(name: &'static str, text: String) -> PixelValue {
    PixelValue { name, text }
}

fn floats(aov: Aov, values: &[f32]) -> String {
    match (aov, values) {
        (Aov::Depth | Aov::HitDistance, [distance]) if distance.is_finite() => {
            format!("{distance:.4} m")
        }
        (Aov::Depth | Aov::HitDistance, _) => "nothing".to_owned(),
        (Aov::Material, [roughness, metallic, reflectivity]) => format!(
            "roughness {roughness:.3}, metallic {metallic:.3}, reflectivity {reflectivity:.3}"
        ),
        _ => {
            let texts: Vec<_> = values.iter().map(|x| format!("{x:.4}")).collect();
            texts.join(", ")
        }
    }
}
