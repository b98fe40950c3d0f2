//! The reader of the environment.

use glam::Vec3;

use crate::desc::{EnvironmentDesc, EnvironmentShadow, FogDesc};
use crate::range::{ABOVE_0, ANY, FROM_0, UNIT, range};
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
            rotation_deg: t.get("rotation_deg", ANY, default.rotation_deg),
            intensity: t.get("intensity", FROM_0, default.intensity),
            visible: t.get("visible", ANY, default.visible),
            shadow: t.find("shadow", ANY).unwrap_or(match has_colors {
                true => EnvironmentShadow::None,
                false => EnvironmentShadow::Ray,
            }),
            fog: t.table("fog"),
            light_group: t.find("light_group", ANY).unwrap_or_default(),
            is_written: has_colors || t.has("file"),
        };
        let turned = t.needing("file", &["rotation_deg"]);
        if !turned.is_empty() && t.clean() {
            let message = "`rotation_deg` turns a `file`; there is none";
            t.refuse(
                "wrong-source",
                "rotation_deg",
                message,
                "remove `rotation_deg`",
            );
        }
        Some(environment)
    }
}

impl Section for FogDesc {
    const HEADING: &'static str = "fog = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let density = t.need("density", FROM_0);
        let fog = Self {
            density: density.unwrap_or_default(),
            color: t.get("color", UNIT, Color(Vec3::ONE)).0,
            height_m: t.get("height_m", ANY, 0.0),
            falloff_m: t.find("falloff_m", ABOVE_0),
            anisotropy: t.get("anisotropy", range(-0.95, 0.95), 0.0),
        };
        if t.has("height_m") && !t.has("falloff_m") && t.clean() {
            t.refuse(
                "missing-key",
                "height_m",
                "`height_m` is where fog begins to thin out, which takes a `falloff_m`",
                "add `falloff_m`, the height in which the density falls to about a third",
            );
        }
        density.map(|_| fog)
    }
}
