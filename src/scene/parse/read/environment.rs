//! The reader of the environment.

use glam::Vec3;

use crate::desc::{EnvironmentDesc, EnvironmentShadow, LightGroup};
use crate::range::{ANY, FROM_0};
use crate::table::{Section, Table, color::Color};

impl Section for EnvironmentDesc {
    const HEADING: &'static str = "[environment]";

    fn read(t: &mut Table) -> Option<Self> {
        let gradient: &[&str] = &["zenith", "horizon", "ground"];
        t.one_of(false, &[&["file"], &["color"], gradient]);
        let color = t.find("color", FROM_0).unwrap_or(Color(Vec3::ZERO));
        let default = Self::default();
        let has_colors = ["color", "zenith", "horizon", "ground"]
            .map(|key| t.has(key))
            .contains(&true);
        let environment = Self {
            zenith: t.get("zenith", FROM_0, color).0,
            horizon: t.get("horizon", FROM_0, color).0,
            ground: t.get("ground", FROM_0, color).0,
            file: t.find("file", ANY),
            layer: t.find("layer", ANY),
            rotation_deg: t.get("rotation_deg", ANY, default.rotation_deg),
            intensity: t.get("intensity", FROM_0, default.intensity),
            visible: t.get("visible", ANY, default.visible),
            shadow: t.find("shadow", ANY).unwrap_or(match has_colors {
                true => EnvironmentShadow::None,
                false => EnvironmentShadow::Ray,
            }),
            fog: t.table("fog"),
            light_group: LightGroup::find(t).unwrap_or_default(),
            is_written: has_colors || t.has("file"),
        };
        t.files("file", &["hdr", "exr"]);
        let of_file = t.needing("file", &["rotation_deg", "layer"]);
        if let Some(key) = of_file.first().filter(|_| t.clean()) {
            let does = if *key == "layer" { "is of" } else { "turns" };
            let message = format!("`{key}` {does} a `file`; there is none");
            t.refuse("wrong-source", key, &message, &format!("remove `{key}`"));
        }
        Some(environment)
    }
}
