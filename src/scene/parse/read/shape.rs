//! Readers of shapes.

use glam::Vec3;

use crate::syntax::Node;
use crate::{
    desc::ShapeDesc,
    parse::{
        points::Points,
        table::{Section, Table},
    },
    range::{ABOVE_0, ANY, Range, range},
    suggest,
};

/// Range of the divisions around a curved shape.
const SEGMENTS: Range = range(3.0, 1024.0);
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
                ("disk", |t| {
                    Some(Self::Disk {
                        radius: t.get("radius", ABOVE_0, 0.5),
                        segments: t.get("segments", SEGMENTS, 64),
                    })
                }),
                ("torus", torus),
                ("capsule", capsule),
                ("lathe", lathe),
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

/// Largest number of points of an outline.
const MOST_POINTS: usize = 1000;

fn lathe(t: &mut Table) -> Option<ShapeDesc> {
    let points = t.need("points", ANY);
    let segments = t.get("segments", SEGMENTS, 64);
    let Points(points) = points?;
    let flat = |pair: &[[f32; 2]]| pair[0] == pair[1];
    let wrong = if !(2..=MOST_POINTS).contains(&points.len()) {
        Some(format!(
            "`points` must be 2 to {MOST_POINTS} points, not {}",
            points.len()
        ))
    } else if let Some([radius, _]) = points.iter().find(|[radius, _]| *radius < 0.0) {
        Some(format!(
            "a point of `points` must be 0 or more from the axis, not {radius}"
        ))
    } else if points.windows(2).any(flat) {
        Some("two points of `points` in a row must differ".to_owned())
    } else if points.iter().all(|[radius, _]| *radius == 0.0) {
        Some("`points` must not all lie on the axis".to_owned())
    } else {
        None
    };
    if let Some(message) = wrong {
        let help =
            "write the outline from below upwards: `points = [[0.3, 0], [0.5, 0.4], [0, 0.8]]`";
        t.refuse("out-of-range", "points", &message, help);
        return None;
    }
    Some(ShapeDesc::Lathe { points, segments })
}

fn heightfield(t: &mut Table) -> Option<ShapeDesc> {
    let file = t.need("file", ANY);
    let size = t.get("size", ABOVE_0, Vec3::new(1.0, 0.25, 1.0));
    Some(ShapeDesc::Heightfield { file: file?, size })
}
