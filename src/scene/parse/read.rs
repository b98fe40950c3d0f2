//! The readers: one per table of the scene text, one line per key. What a key takes is written here
//! and nowhere else; the manual and the JSON Schema come from running the same readers.

use std::path::PathBuf;

use glam::{EulerRot, Mat4, Quat, Vec3};

use super::{
    table::{Either, Section, Table},
    value::{ABOVE_0, ANY, FROM_0, Range, Scale, UNIT, Version, range},
};
use crate::scene::{desc::*, diagnostic::Diagnostic};

/// Divisions around a curved shape.
const SEGMENTS: Range = range(3.0, 4096.0);
/// Most copies of one instance.
const MOST_COPIES: u64 = 100_000;
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
        };
        if let Some(light) = scene.lights.get(MOST_LIGHTS) {
            let message = format!(
                "`{}` is one light too many: at most {MOST_LIGHTS}",
                light.name
            );
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
        let file = t.find("file", ANY).map(ModelSource::File);
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
            let message = "`lights` is for files: shapes have none";
            t.refuse("wrong-source", "lights", message, "remove `lights`");
        }
        Some(Self {
            source: file.or(shape)?,
            material,
            overrides,
            lights,
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

impl Section for InstanceDesc {
    const TYPE: &'static str = "InstanceDesc";
    const ALSO: &'static [&'static str] = &["PlacementDesc"];
    const HEADING: &'static str = "[[instance]]";

    fn read(t: &mut Table) -> Option<Self> {
        let name = t.find("name", ANY);
        let model = t.need("model", ANY);
        let placement = placement(t);
        let dynamic = t.get("dynamic", ANY, false);
        let repeat = t.table("repeat");
        let material = t.name_or_table("material").map(|material| match material {
            Either::Name(name) => InstanceMaterialDesc::Named(name),
            Either::Nested(desc) => InstanceMaterialDesc::Override(Box::new(desc)),
        });
        Some(Self {
            name,
            model: model?,
            placement,
            dynamic,
            repeat,
            material,
            at: t.start(),
        })
    }
}

fn placement(t: &mut Table) -> PlacementDesc {
    t.one_of(
        false,
        &[
            &["matrix"],
            &["translation", "rotation_deg", "rotation_quat", "scale"],
        ],
    );
    t.one_of(false, &[&["rotation_deg"], &["rotation_quat"]]);
    let translation = t.get("translation", ANY, Vec3::ZERO);
    let euler = t.get("rotation_deg", ANY, Vec3::ZERO);
    let quat = t.find::<[f32; 4]>("rotation_quat", ANY);
    let Scale(scale) = t.get("scale", ANY, Scale(Vec3::ONE));
    let matrix = t.find::<[f32; 16]>("matrix", ANY);
    if let Some(columns) = matrix {
        check_matrix(t, &columns);
        return PlacementDesc::Matrix(Mat4::from_cols_array(&columns));
    }
    if t.has("scale") && scale.as_dvec3().element_product().abs() < SMALLEST_VOLUME {
        let help = "0 would flatten the model; leave `scale` out for the model's own size";
        t.refuse("singular", "scale", "`scale` must not be 0", help);
    }
    let rotation = match quat {
        // Degrees are reduced first, so that thousands of turns stay exact.
        None => {
            let turns = euler.as_dvec3() % 360.0;
            let [x, y, z] = turns.to_array().map(f64::to_radians);
            glam::DQuat::from_euler(EulerRot::ZYX, z, y, x).as_quat()
        }
        Some(q) => {
            let q = glam::DVec4::from_array(q.map(f64::from));
            if q.length() == 0.0 {
                let help = "write `[0, 0, 0, 1]` for no rotation";
                t.refuse(
                    "zero-direction",
                    "rotation_quat",
                    "`rotation_quat` must not be zero",
                    help,
                );
                return PlacementDesc::Trs {
                    translation,
                    rotation: Quat::IDENTITY,
                    scale,
                };
            }
            glam::DQuat::from_vec4(q.normalize()).as_quat()
        }
    };
    PlacementDesc::Trs {
        translation,
        rotation,
        scale,
    }
}

/// Scales whose volume is smaller have no inverse in 32-bit floats.
const SMALLEST_VOLUME: f64 = 1e-30;

fn check_matrix(t: &mut Table, columns: &[f32; 16]) {
    if [3, 7, 11, 15].map(|i| columns[i]) != [0.0, 0.0, 0.0, 1.0] {
        let message = "the last row of `matrix` must be 0 0 0 1";
        let help = "numbers go column by column: every fourth one is of the last row, and the \
                    translation is numbers 13 to 15";
        t.refuse("bad-matrix", "matrix", message, help);
        return;
    }
    let matrix = glam::DMat4::from_cols_array(&columns.map(f64::from));
    if matrix.determinant().abs() < SMALLEST_VOLUME {
        let message = "`matrix` is singular: it flattens the model";
        t.refuse(
            "singular",
            "matrix",
            message,
            "its first three columns must span space",
        );
    }
}

impl Section for RepeatDesc {
    const TYPE: &'static str = "RepeatDesc";
    const HEADING: &'static str = "repeat = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let count: Option<[u32; 3]> = t.need("count", range(1.0, MOST_COPIES as f64));
        let step = t.need("step", ANY);
        let copies = count.map_or(1, |c| c.iter().map(|&n| u64::from(n)).product::<u64>());
        if copies > MOST_COPIES {
            let message = format!("`count` must be at most {MOST_COPIES} together, not {copies}");
            t.refuse("out-of-range", "count", &message, "");
        }
        Some(Self {
            count: count?,
            step: step?,
        })
    }
}

impl Section for LightDesc {
    const TYPE: &'static str = "LightDesc";
    const ALSO: &'static [&'static str] = &["LightKind"];
    const HEADING: &'static str = "[light.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let color = t.get("color", FROM_0, Vec3::ONE);
        let shadow = t.get("shadow", ANY, ShadowMode::default());
        let shadow_px = t.get("shadow_px", range(16.0, 4096.0), 1024);
        let kind = t.choose(
            "kind",
            &[
                ("point", point_light),
                ("spot", spot_light),
                ("directional", directional_light),
            ],
        );
        Some(Self {
            kind: kind?,
            color,
            shadow,
            shadow_px,
        })
    }
}

fn point_light(t: &mut Table) -> Option<LightKind> {
    let position = t.need("position", ANY);
    let intensity_cd = t.need("intensity_cd", FROM_0);
    Some(LightKind::Point {
        position: position?,
        intensity_cd: intensity_cd?,
    })
}

fn spot_light(t: &mut Table) -> Option<LightKind> {
    let position: Option<Vec3> = t.need("position", ANY);
    t.one_of(true, &[&["direction"], &["target"]]);
    let written: Option<Vec3> = t.find("direction", ANY);
    let target: Option<Vec3> = t.find("target", ANY);
    let key = if written.is_some() {
        "direction"
    } else {
        "target"
    };
    let towards = written.or_else(|| Some(target? - position?));
    let direction = direction(t, key, towards);
    let intensity_cd = t.need("intensity_cd", FROM_0);
    let inner_deg = t.get("inner_deg", range(0.0, 90.0).below(), 0.0);
    let outer_deg = t.get("outer_deg", range(0.0, 90.0).below().above(), 45.0);
    if t.clean() && inner_deg > outer_deg {
        let message = format!("`inner_deg` must be 0 to `outer_deg`, which is {outer_deg}");
        t.refuse("out-of-range", "inner_deg", &message, "");
    }
    Some(LightKind::Spot {
        position: position?,
        direction: direction?,
        intensity_cd: intensity_cd?,
        inner_deg,
        outer_deg,
    })
}

fn directional_light(t: &mut Table) -> Option<LightKind> {
    let written = t.need("direction", ANY);
    let direction = direction(t, "direction", written);
    let intensity_lux = t.need("intensity_lux", FROM_0);
    Some(LightKind::Directional {
        direction: direction?,
        intensity_lux: intensity_lux?,
    })
}

/// The unit vector along `towards`, or a message at `key`.
fn direction(t: &mut Table, key: &str, towards: Option<Vec3>) -> Option<Vec3> {
    let unit = towards?.as_dvec3().try_normalize().map(|d| d.as_vec3());
    if unit.is_none() {
        let message = match key {
            "target" => "`target` must differ from `position`",
            _ => "`direction` must not be zero",
        };
        t.refuse("zero-direction", key, message, "the light shines along it");
    }
    unit
}

impl Section for EnvironmentDesc {
    const TYPE: &'static str = "EnvironmentDesc";
    const HEADING: &'static str = "[environment]";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(false, &[&["color"], &["zenith", "horizon", "ground"]]);
        let color = t.find("color", FROM_0).unwrap_or(Vec3::ZERO);
        Some(Self {
            zenith: t.get("zenith", FROM_0, color),
            horizon: t.get("horizon", FROM_0, color),
            ground: t.get("ground", FROM_0, color),
        })
    }
}

impl Section for ReflectionDesc {
    const TYPE: &'static str = "ReflectionDesc";
    const HEADING: &'static str = "[reflection]";

    fn read(t: &mut Table) -> Option<Self> {
        let default = Self::default();
        Some(Self {
            method: t.get("method", ANY, default.method),
            ray_length_u: t.get("ray_length_u", ABOVE_0, default.ray_length_u),
            threshold_u: t.get("threshold_u", FROM_0, default.threshold_u),
            bounces: t.get("bounces", range(1.0, 16.0), default.bounces),
            steps: t.get("steps", range(8.0, 4096.0), default.steps),
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
            exposure_ev: t.get("exposure_ev", range(-20.0, 20.0), default.exposure_ev),
            tone_map: t.get("tone_map", ANY, default.tone_map),
        })
    }
}
