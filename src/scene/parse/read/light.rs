//! Readers of lights.

use glam::Vec3;

use crate::declared::{Described, TypeDoc};
use crate::range::{ABOVE_0, ANY, FROM_0, range};
use crate::table::{Section, Table, color::Color};
use crate::{
    desc::{LightDesc, LightKind, ShadowMode},
    parse::hierarchy,
};

impl Section for LightDesc {
    const ALSO: &'static [&'static TypeDoc] = &[LightKind::DOC];
    const HEADING: &'static str = "[light.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        hierarchy::declare_parent(t);
        let Color(color) = t.get("color", FROM_0, Color(Vec3::ONE));
        let shadow = t.find("shadow", ANY);
        let shadow_px = t.get("shadow_px", range(16.0, 4096.0), 1024);
        let light_group = t.find("light_group", ANY).unwrap_or_default();
        let kind = t.choose(
            "kind",
            &[
                ("point", point_light),
                ("spot", spot_light),
                ("directional", directional_light),
                ("rect", rect_light),
                ("disk", disk_light),
            ],
        );
        let has_size = kind.is_some_and(|kind| kind.has_size());
        if has_size && shadow == Some(ShadowMode::Map) {
            let message = "`shadow = \"map\"` cannot show the soft shadow of a light with a size";
            let help = "write `shadow = \"ray\"`, or leave it out";
            t.refuse("wrong-shadow", "shadow", message, help);
        }
        let shadow = match shadow {
            None | Some(ShadowMode::Auto) if has_size => ShadowMode::Ray,
            shadow => shadow.unwrap_or_default(),
        };
        Some(Self {
            kind: kind?,
            color,
            shadow,
            shadow_px,
            light_group,
        })
    }
}

fn point_light(t: &mut Table) -> Option<LightKind> {
    let position = t.need("position", ANY);
    let intensity_cd = t.need("intensity_cd", FROM_0);
    let radius_m = t.get("radius_m", FROM_0, 0.0);
    Some(LightKind::Point {
        position: position?,
        intensity_cd: intensity_cd?,
        radius_m,
    })
}

fn spot_light(t: &mut Table) -> Option<LightKind> {
    let (position, direction, target) = aim(t);
    let intensity_cd = t.need("intensity_cd", FROM_0);
    let inner_deg = t.get("inner_deg", range(0.0, 90.0).below(), 0.0);
    let outer_deg = t.get("outer_deg", range(0.0, 90.0).below().above(), 45.0);
    if t.clean() && inner_deg > outer_deg {
        let message = format!("`inner_deg` must be 0 to `outer_deg`, which is {outer_deg}");
        t.refuse("out-of-range", "inner_deg", &message, "");
    }
    let radius_m = t.get("radius_m", FROM_0, 0.0);
    Some(LightKind::Spot {
        position: position?,
        direction: direction?,
        target,
        intensity_cd: intensity_cd?,
        inner_deg,
        outer_deg,
        radius_m,
    })
}

fn directional_light(t: &mut Table) -> Option<LightKind> {
    let written = t.need("direction", ANY);
    let direction = direction(t, "direction", written);
    let intensity_lux = t.need("intensity_lux", FROM_0);
    let angle_deg = t.get("angle_deg", range(0.0, 90.0), 0.0);
    Some(LightKind::Directional {
        direction: direction?,
        intensity_lux: intensity_lux?,
        angle_deg,
    })
}

fn rect_light(t: &mut Table) -> Option<LightKind> {
    let (position, direction, target) = aim(t);
    let up = t.get("up", ANY, Vec3::Y);
    if t.clean() && up == Vec3::ZERO {
        let help = "write `up = [0, 1, 0]`";
        t.refuse("zero-direction", "up", "`up` must not be zero", help);
    }
    let size = t.need("size", ABOVE_0);
    let intensity_cd = t.need("intensity_cd", FROM_0);
    Some(LightKind::Rect {
        position: position?,
        direction: direction?,
        target,
        up,
        size: size?,
        intensity_cd: intensity_cd?,
    })
}

fn disk_light(t: &mut Table) -> Option<LightKind> {
    let (position, direction, target) = aim(t);
    let radius_m = t.need("radius_m", ABOVE_0);
    let intensity_cd = t.need("intensity_cd", FROM_0);
    Some(LightKind::Disk {
        position: position?,
        direction: direction?,
        target,
        radius_m: radius_m?,
        intensity_cd: intensity_cd?,
    })
}

/// Position, unit direction and target of a light that has both a position and a direction.
fn aim(t: &mut Table) -> (Option<Vec3>, Option<Vec3>, Option<Vec3>) {
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
    (position, direction(t, key, towards), target)
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
