//! Readers of shapes.

use glam::Vec3;

use super::{
    instance::placement,
    mesh,
    outline::SEGMENTS,
    outlined::{self, TURN_DEG},
};
use crate::declared::{Described, TypeDoc};
use crate::syntax::Node;
use crate::table::{Section, Table};
use crate::{
    desc::{NoiseDesc, PartDesc, PlacementDesc, ShapeDesc},
    range::{ABOVE_0, ANY, FROM_0, range},
    suggest,
};

impl Section for ShapeDesc {
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
                ("text", outlined::text),
                ("union", |t| Some(Self::Union { parts: parts(t)? })),
                ("difference", |t| {
                    Some(Self::Difference { parts: parts(t)? })
                }),
                ("intersection", |t| {
                    Some(Self::Intersection { parts: parts(t)? })
                }),
                ("displaced", displaced),
                ("mesh", mesh::mesh),
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

/// Largest number of shapes of a shape.
const MOST_PARTS: usize = 100;

fn parts(t: &mut Table) -> Option<Vec<PartDesc>> {
    t.one_of(true, &[&["parts"]]);
    let errors = t.report.errors();
    let parts = t.list::<PartDesc>("parts");
    let count = parts.len();
    let is_read = t.has("parts") && t.report.errors() == errors;
    if is_read && !(2..=MOST_PARTS).contains(&count) {
        let message = format!("`parts` must be 2 to {MOST_PARTS} shapes, not {count}");
        let help =
            "write `parts = [{ shape = { kind = \"box\" } }, { shape = { kind = \"sphere\" } }]`";
        t.refuse("out-of-range", "parts", &message, help);
    }
    (!parts.is_empty()).then_some(parts)
}

impl Section for PartDesc {
    const ALSO: &'static [&'static TypeDoc] = &[PlacementDesc::DOC];
    const HEADING: &'static str = "parts = [{ shape = { … }, … }]";

    fn read(t: &mut Table) -> Option<Self> {
        let at = t.written("shape");
        let shape = t.need_table("shape", "{ kind = \"box\" }");
        refuse_dynamic(t, shape.as_ref());
        let placement = placement(t);
        Some(Self {
            shape: shape?,
            placement,
            at,
        })
    }
}

/// Refuses a mesh that scripts deform as a part of another shape, which is made of it once.
fn refuse_dynamic(t: &mut Table, shape: Option<&ShapeDesc>) {
    if shape.is_some_and(|shape| shape.deforming_vertices().is_some()) {
        t.refuse(
            "wrong-source",
            "shape",
            "a mesh with `dynamic = true` cannot be a part of another shape, which is made of it once",
            "leave out `dynamic`, or make it the shape of a model of its own",
        );
    }
}

fn displaced(t: &mut Table) -> Option<ShapeDesc> {
    let shape = t.need_table("shape", "{ kind = \"sphere\" }");
    refuse_dynamic(t, shape.as_ref());
    let subdivide = t.get("subdivide", range(0.0, 8.0), 3);
    let smooth = t.get("smooth", ANY, false);
    let noise = NoiseDesc {
        height: t.get("height", FROM_0, 0.0),
        size: t.get("size", ABOVE_0, 0.2),
        octaves: t.get("octaves", range(1.0, 8.0), 4),
        seed: t.get("seed", range(0.0, 1e6), 0),
    };
    Some(ShapeDesc::Displaced {
        shape: Box::new(shape?),
        subdivide,
        smooth,
        noise,
    })
}
