//! Readers of shapes.

use glam::Vec3;

use super::outlined;
use crate::syntax::Node;
use crate::{
    desc::ShapeDesc,
    parse::table::{Section, Table},
    range::{ABOVE_0, ANY, Range, range},
    suggest,
};

/// Range of the divisions around a curved shape.
pub(super) const SEGMENTS: Range = range(3.0, 1024.0);
/// Range of a part of a turn, degrees.
pub(super) const TURN_DEG: Range = range(0.0, 360.0).above();
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
                ("box", cuboid),
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
                ("disk", |t| {
                    Some(Self::Disk {
                        radius: t.get("radius", ABOVE_0, 0.5),
                        segments: t.get("segments", SEGMENTS, 64),
                    })
                }),
                ("torus", torus),
                ("capsule", capsule),
                ("lathe", outlined::lathe),
                ("extrude", outlined::extrude),
                ("sweep", outlined::sweep),
                ("heightfield", heightfield),
            ],
        )
    }

    fn instead(key: &str, value: &Node) -> Option<String> {
        let kind = suggest::text(value.get_ref().as_str()?);
        Some(format!("write `{key} = {{ kind = {kind} }}`"))
    }
}

fn torus(t: &mut Table) -> Option<ShapeDesc> {
    let radius = t.get("radius", ABOVE_0, 0.5);
    let tube_radius = t.get("tube_radius", ABOVE_0, 0.15);
    if t.clean() && tube_radius > radius {
        let message = format!("`tube_radius` must be at most `radius`, which is {radius}");
        let help = "a larger tube would pass through itself in the middle";
        t.refuse("out-of-range", "tube_radius", &message, help);
    }
    Some(ShapeDesc::Torus {
        radius,
        tube_radius,
        segments: t.get("segments", SEGMENTS, 96),
        angle_deg: t.get("angle_deg", TURN_DEG, 360.0),
    })
}

fn capsule(t: &mut Table) -> Option<ShapeDesc> {
    let radius = t.get("radius", ABOVE_0, 0.25);
    let height = t.get("height", ABOVE_0, 1.0);
    if t.clean() && height < 2.0 * radius {
        let message = format!("`height` must be at least twice `radius`, which is {radius}");
        let help = "it is from end to end; a sphere has `height` of twice the radius";
        t.refuse("out-of-range", "height", &message, help);
    }
    Some(ShapeDesc::Capsule {
        radius,
        height,
        segments: t.get("segments", SEGMENTS, 64),
    })
}

fn cuboid(t: &mut Table) -> Option<ShapeDesc> {
    let size: Vec3 = t.get("size", ABOVE_0, Vec3::ONE);
    let most = size.min_element() / 2.0;
    let bevel = outlined::bevel(t, most, "half of the shortest length");
    Some(ShapeDesc::Box { size, bevel })
}

fn heightfield(t: &mut Table) -> Option<ShapeDesc> {
    let file = t.need("file", ANY);
    let size = t.get("size", ABOVE_0, Vec3::new(1.0, 0.25, 1.0));
    Some(ShapeDesc::Heightfield { file: file?, size })
}
