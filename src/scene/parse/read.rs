//! The readers: one per table of the scene text, one line per key. What a key takes is written here
//! and nowhere else; the manual and the JSON Schema come from running the same readers.

mod animation;
mod environment;
mod instance;
mod light;
mod motion;
mod stage;

use std::path::PathBuf;

use glam::Vec3;

use super::{
    table::{Either, Section, Table},
    value::{Names, Version},
};
use crate::scene::range::{
    ABOVE_0, ANY, BOUNCES, EDGE_PX, FROM_0, RAY_LENGTH_U, Range, STEPS, THRESHOLD_U, UNIT, range,
};
use crate::scene::{desc::*, diagnostic::Diagnostic};

/// Divisions around a curved shape.
const SEGMENTS: Range = range(3.0, 1024.0);
/// Most lights of a scene.
const MOST_LIGHTS: usize = 64;

impl Section for SceneDesc {
    const TYPE: &'static str = "SceneDesc";
    const HEADING: &'static str = "the whole file";

    fn read(t: &mut Table) -> Option<Self> {
        t.need::<Version>("version", ANY);
        let scene = Self {
            folder: PathBuf::new(),
            cameras: t.entries("camera"),
            materials: t.entries("material"),
            models: t.entries("model"),
            instances: t.list("instance"),
            lights: t.entries("light"),
            environment: t.table("environment").unwrap_or_default(),
            reflection: t.table("reflection").unwrap_or_default(),
            image: t.table("image").unwrap_or_default(),
            timeline: t.table("timeline"),
            motion: t.table("motion").unwrap_or_default(),
            params: t.params("params"),
            includes: Vec::new(),
            script: None,
        };
        // Read before, because they add to the tables above; asked for here, so that they are keys.
        t.find::<Names>("include", ANY);
        t.find::<At<String>>("script", ANY);
        if let Some(light) = scene.lights.get(MOST_LIGHTS) {
            let message = format!("`{}` exceeds the limit of {MOST_LIGHTS} lights", light.name);
            let at = light.at.clone();
            t.report
                .push(Diagnostic::at("too-many-lights", at, message));
        }
        Some(scene)
    }
}

impl Section for CameraDesc {
    const TYPE: &'static str = "CameraDesc";
    const HEADING: &'static str = "[camera.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let default = Self::default();
        let camera = Self {
            eye: t.get("eye", ANY, default.eye),
            target: t.get("target", ANY, default.target),
            up: t.get("up", ANY, default.up),
            fov_deg: t.get("fov_deg", range(1.0, 170.0), default.fov_deg),
            near_m: t.get("near_m", ABOVE_0, default.near_m),
        };
        if !t.clean() {
            return Some(camera);
        }
        let forward = (camera.target - camera.eye).as_dvec3();
        let up = camera.up.as_dvec3();
        let key = ["target", "eye"]
            .into_iter()
            .find(|k| t.has(k))
            .unwrap_or("target");
        if forward.length() == 0.0 {
            let help = "move `eye` or `target`: the camera looks from one to the other";
            t.refuse(
                "zero-direction",
                key,
                "`target` must differ from `eye`",
                help,
            );
        } else if up.length() == 0.0 {
            t.refuse(
                "zero-direction",
                "up",
                "`up` must not be zero",
                "write `up = [0, 1, 0]`",
            );
        } else if forward.normalize().cross(up.normalize()).length() < 1e-6 {
            let key = if t.has("up") { "up" } else { key };
            let message = "`up` must not point along the view, from `eye` to `target`";
            let help = "for a view straight down or up, write `up = [0, 0, -1]`";
            t.refuse("zero-direction", key, message, help);
        }
        Some(camera)
    }
}

impl Section for MaterialDesc {
    const TYPE: &'static str = "MaterialDesc";
    const HEADING: &'static str = "[material.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(false, &[&["checker"], &["base_color_texture"]]);
        Some(Self {
            base_color: t.find("base_color", UNIT),
            base_color_texture: t.find("base_color_texture", ANY),
            checker: t.table("checker"),
            metallic: t.find("metallic", UNIT),
            roughness: t.find("roughness", UNIT),
            metallic_roughness_texture: t.find("metallic_roughness_texture", ANY),
            normal_texture: t.find("normal_texture", ANY),
            normal_scale: t.find("normal_scale", range(0.0, 4.0)),
            occlusion_strength: t.find("occlusion_strength", UNIT),
            emission: t.find("emission", FROM_0),
            emission_strength: t.find("emission_strength", FROM_0),
            emission_texture: t.find("emission_texture", ANY),
            uv_scale: t.find("uv_scale", ANY),
            alpha_cutoff: t.find("alpha_cutoff", UNIT),
            double_sided: t.find("double_sided", ANY),
            reflection: t.find("reflection", ANY),
            reflectivity: t.find("reflectivity", UNIT),
        })
    }
}

impl Section for CheckerDesc {
    const TYPE: &'static str = "CheckerDesc";
    const HEADING: &'static str = "checker = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let colors = t.need("colors", UNIT);
        let size_m = t.need("size_m", ABOVE_0);
        Some(Self {
            colors: colors?,
            size_m: size_m?,
        })
    }
}

impl Section for ModelDesc {
    const TYPE: &'static str = "ModelDesc";
    const ALSO: &'static [&'static str] = &["ModelSource"];
    const HEADING: &'static str = "[model.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(true, &[&["file"], &["shape"]]);
        let file = t.find::<At<String>>("file", ANY);
        let shape = t.table("shape").map(ModelSource::Shape);
        let (mut material, mut overrides) = (None, Vec::new());
        match t.name_or_entries("material") {
            Some(Either::Name(name)) => material = Some(name),
            Some(Either::Nested(entries)) => overrides = entries,
            None => {}
        }
        let lights = t.get("lights", ANY, true);
        if material.is_some() && t.has("file") {
            let message = "`material` of a file must be tables that override its materials by name";
            let help = "write `[model.NAME.material.\"*\"]` for all materials of the file";
            t.refuse("wrong-source", "material", message, help);
        }
        if t.has("shape") && material.is_none() && t.clean() && t.has("material") {
            let message = "`material` of a shape must be the name of a `[material.NAME]`";
            let help = "write `[material.NAME]` and `material = \"NAME\"`";
            t.refuse("wrong-source", "material", message, help);
        }
        if t.has("shape") && t.has("lights") {
            let message = "`lights` applies to files only; shapes have no lights";
            t.refuse("wrong-source", "lights", message, "remove `lights`");
        }
        let animation = animation::animation(t);
        if t.has("shape") && t.has("animation") {
            let message = "`animation` applies to files only; shapes have no animations";
            let help = "move its instance by `[motion.instance.NAME]`";
            t.refuse("wrong-source", "animation", message, help);
        }
        let usd = stage::stage(t, file.as_ref());
        let source = file.map(ModelSource::File).or(shape);
        Some(Self {
            source: source?,
            material,
            overrides,
            lights,
            animation,
            usd,
        })
    }
}

impl Section for ShapeDesc {
    const TYPE: &'static str = "ShapeDesc";
    const HEADING: &'static str = "shape = { kind = …, … }";

    fn read(t: &mut Table) -> Option<Self> {
        t.choose(
            "kind",
            &[
                ("plane", |t| {
                    Some(Self::Plane {
                        size: t.get("size", ABOVE_0, [1.0, 1.0]),
                    })
                }),
                ("box", |t| {
                    Some(Self::Box {
                        size: t.get("size", ABOVE_0, Vec3::ONE),
                    })
                }),
                ("sphere", |t| {
                    Some(Self::Sphere {
                        radius: t.get("radius", ABOVE_0, 0.5),
                        segments: t.get("segments", SEGMENTS, 128),
                    })
                }),
                ("cylinder", |t| {
                    Some(Self::Cylinder {
                        radius: t.get("radius", ABOVE_0, 0.5),
                        height: t.get("height", ABOVE_0, 1.0),
                        segments: t.get("segments", SEGMENTS, 64),
                    })
                }),
                ("cone", |t| {
                    Some(Self::Cone {
                        radius: t.get("radius", ABOVE_0, 0.5),
                        height: t.get("height", ABOVE_0, 1.0),
                        segments: t.get("segments", SEGMENTS, 64),
                    })
                }),
            ],
        )
    }
}

impl Section for ReflectionDesc {
    const TYPE: &'static str = "ReflectionDesc";
    const HEADING: &'static str = "[reflection]";

    fn read(t: &mut Table) -> Option<Self> {
        let default = Self::default();
        Some(Self {
            method: t.get("method", ANY, default.method),
            ray_length_u: t.get("ray_length_u", RAY_LENGTH_U, default.ray_length_u),
            accept: t.get("accept", ANY, default.accept),
            edge_px: t.get("edge_px", EDGE_PX, default.edge_px),
            threshold_u: t.get("threshold_u", THRESHOLD_U, default.threshold_u),
            bounces: t.get("bounces", BOUNCES, default.bounces),
            steps: t.get("steps", STEPS, default.steps),
            roughness_cutoff: t.get("roughness_cutoff", UNIT, default.roughness_cutoff),
            unit_m: t.find("unit_m", ABOVE_0),
            fade: t.get("fade", ANY, default.fade),
            blur_px: t.get("blur_px", range(0.0, 16.0), default.blur_px),
        })
    }
}

impl Section for ImageDesc {
    const TYPE: &'static str = "ImageDesc";
    const HEADING: &'static str = "[image]";

    fn read(t: &mut Table) -> Option<Self> {
        let default = Self::default();
        Some(Self {
            size: t.get("size", range(1.0, 16384.0), default.size),
            samples: t.get("samples", range(1.0, 4096.0), default.samples),
            light_rays: t.find("light_rays", range(1.0, 256.0)),
            exposure_ev: t.get("exposure_ev", range(-20.0, 20.0), default.exposure_ev),
            tone_map: t.get("tone_map", ANY, default.tone_map),
            visibility: t.get("visibility", ANY, default.visibility),
        })
    }
}
