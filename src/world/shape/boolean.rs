//! Union, difference and intersection of closed shapes, by boolmesh, which follows Manifold (Lalish; after Smith,
//! "Towards robust inexact geometric computation", 2009): faces that lie on each other are told apart by rule, not by
//! rounding.

use std::{
    collections::HashMap,
    ops::{Add, Mul},
};

use boolmesh::{
    compute_boolean,
    prelude::{Manifold, OpType},
};
use glam::{Affine3A, DVec2, DVec3, Mat3A, Vec3};
use reflet_scene::desc::{LatheSource, PartDesc, PlacementDesc, ShapeDesc};

use super::{
    Fault, Made, Supplies,
    crossing::{crossing, visit_near},
    solid::{Corner, Solid, check_size},
};
use crate::Mesh;

/// Largest number of triangles of two meshes that are combined.
const MOST_COMBINED: usize = 500_000;

/// Work for each pair of triangles that are near each other, in triangles.
const PAIR: usize = 4;

/// Normal and texture coordinates at a corner, which are interpolated where it is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Skin {
    normal: DVec3,
    uv: DVec2,
}

impl Add for Skin {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            normal: self.normal + other.normal,
            uv: self.uv + other.uv,
        }
    }
}

impl Mul<f64> for Skin {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            normal: self.normal * factor,
            uv: self.uv * factor,
        }
    }
}

/// Adds the combination of `parts`; returns warnings about them.
///
/// # Errors
/// `wrong-parts` for a part that is open, touches itself or passes through itself, and where nothing is left;
/// `shape-too-large`; errors of parts.
pub fn add(
    solid: &mut Solid,
    operation: OpType,
    parts: &[PartDesc],
    supplies: &Supplies,
) -> Result<Vec<Fault>, Fault> {
    let mut warnings = Vec::new();
    let mut whole: Option<Manifold<Skin>> = None;
    for (index, part) in parts.iter().enumerate() {
        let here = |fault: Fault| fault.placed(part.at.0.clone());
        let made = super::make(&part.shape, supplies).map_err(here)?;
        // The inside of a cutter is the outside of the part that it cuts.
        let is_cutter = operation == OpType::Subtract && index > 0;
        let own = match whole_surface(&part.shape, &made) {
            Ok(()) => manifold(&made.mesh, &part.placement, is_cutter),
            Err(what) => Err(what),
        };
        let own = own.map_err(|what| {
            let message = format!("part {} cannot be combined: {what}", index + 1);
            let help = "only closed shapes can, such as `box`, `sphere`, `extrude` and `text`, none of which passes through \
                        itself; `plane`, `disk`, `heightfield` and an open `lathe` have no inside";
            here(Fault::new("wrong-parts", message).help(help))
        })?;
        warnings.extend(made.warnings.into_iter().map(here));
        whole = Some(match whole {
            None => own,
            Some(before) => {
                warnings.extend(missing_cutter(index, &before, &own, is_cutter).map(here));
                let work = work(&before, &own, supplies.work.left());
                supplies.spend(work).map_err(here)?;
                combined(&before, &own, &operation).map_err(here)?
            }
        });
    }
    let Some(whole) = whole else {
        return Ok(warnings);
    };
    check_size(whole.nf, "`segments` of the parts")?;
    for (face, halves) in whole.hs.chunks_exact(3).enumerate() {
        let corner = |k: usize| {
            let Skin { normal, uv } = whole.vals[3 * face + k];
            Corner::new(whole.ps[halves[k].tail].to_array().into(), normal, uv)
        };
        solid.triangle([corner(0), corner(1), corner(2)]);
    }
    Ok(warnings)
}

/// A warning about a cutter whose box does not meet the box of the parts before it, so that it cuts nothing.
fn missing_cutter(
    index: usize,
    before: &Manifold<Skin>,
    own: &Manifold<Skin>,
    is_cutter: bool,
) -> Option<Fault> {
    let [whole, cutter] = [before, own].map(|mesh| {
        let places = mesh.ps.iter().map(|p| DVec3::from(p.to_array()));
        places.fold([DVec3::MAX, DVec3::MIN], |[low, high], at| {
            [low.min(at), high.max(at)]
        })
    });
    let axis = (0..3).find(|&k| cutter[0][k] >= whole[1][k] || cutter[1][k] <= whole[0][k]);
    let axis = axis.filter(|_| is_cutter)?;
    let range = |[low, high]: [DVec3; 2]| {
        let shown = |x: f64| (x * 1e3).round() / 1e3 + 0.0;
        format!("from {} to {}", shown(low[axis]), shown(high[axis]))
    };
    let name = ["X", "Y", "Z"][axis];
    let message = format!(
        "part {} cuts nothing: along {name} it is {}, and the parts before it {}",
        index + 1,
        range(cutter),
        range(whole)
    );
    Some(Fault::new("idle-part", message).help("move it by its `translation`"))
}

/// Work of combining two surfaces: their triangles, and the pairs of near ones, of which each may be cut.
fn work(before: &Manifold<Skin>, own: &Manifold<Skin>, left: u64) -> usize {
    let corners = |mesh: &Manifold<Skin>| {
        let place = |vertex: usize| DVec3::from(mesh.ps[vertex].to_array());
        let faces = mesh.hs.chunks_exact(3);
        let faces = faces.map(|halves| [0, 1, 2].map(|k| place(halves[k].tail)));
        faces.collect::<Vec<_>>()
    };
    let [one, other] = [before, own].map(corners);
    let (mut pairs, most) = (0, left as usize / PAIR);
    visit_near([one, other].map(Vec::into_iter), DVec3::ZERO, |_, _| {
        pairs += 1;
        pairs <= most
    });
    before.nf + own.nf + PAIR * pairs
}

/// Refuses a surface that passes through itself: where it is wound around twice, inside and outside are not known.
fn whole_surface(shape: &ShapeDesc, made: &Made) -> Result<(), String> {
    if let Some(folded) = made.warnings.iter().find(|w| w.name == "sweep-crosses") {
        return Err(folded.message.clone());
    }
    // The others are made of outlines without crossings, or cannot be bent.
    let can_cross = match shape {
        ShapeDesc::Sweep { .. } | ShapeDesc::Mesh { .. } | ShapeDesc::Displaced { .. } => true,
        ShapeDesc::Lathe { source, .. } => matches!(source, LatheSource::Points(_)),
        _ => false,
    };
    let mesh = &made.mesh;
    let corners = |triangle: &[u32; 3]| triangle.map(|i| mesh.positions[i as usize].as_dvec3());
    match can_cross.then(|| crossing(mesh.triangles.iter().map(corners))) {
        Some(Some(at)) => {
            let [x, y, z] = at.to_array().map(|x| (x * 1e4).round() / 1e4);
            Err(format!(
                "its surface passes through itself near [{x}, {y}, {z}]"
            ))
        }
        _ => Ok(()),
    }
}

fn combined(
    before: &Manifold<Skin>,
    own: &Manifold<Skin>,
    operation: &OpType,
) -> Result<Manifold<Skin>, Fault> {
    let count = before.nf + own.nf;
    if count > MOST_COMBINED {
        let message =
            format!("the parts so far have {count} triangles, of at most {MOST_COMBINED}");
        let help = "lower `segments` of the parts";
        return Err(Fault::new("shape-too-large", message).help(help));
    }
    let operation = match operation {
        OpType::Add => OpType::Add,
        OpType::Subtract => OpType::Subtract,
        OpType::Intersect => OpType::Intersect,
    };
    let nothing = || {
        let help =
            "check the places of the parts: they do not overlap, or one covers all of the others";
        Fault::new("wrong-parts", "nothing is left of the parts").help(help)
    };
    match compute_boolean(before, own, operation) {
        Ok(whole) if whole.nf == 0 => Err(nothing()),
        Ok(whole) => Ok(whole),
        Err(what) if what.contains("empty") => Err(nothing()),
        Err(what) => {
            let message = format!("the parts cannot be combined: {what}");
            let help = "move one of them a little, or change `segments`";
            Err(Fault::new("wrong-parts", message).help(help))
        }
    }
}

/// A placed mesh with vertices joined by their positions.
fn manifold(
    mesh: &Mesh,
    placement: &PlacementDesc,
    is_cutter: bool,
) -> Result<Manifold<Skin>, String> {
    let place = match placement {
        PlacementDesc::Trs {
            translation,
            rotation,
            scale,
        } => Affine3A::from_scale_rotation_translation(*scale, *rotation, *translation),
        PlacementDesc::Matrix(matrix) => Affine3A::from_mat4(*matrix),
    };
    let normals: Mat3A = place.matrix3.inverse().transpose();
    let is_mirrored = place.matrix3.determinant() < 0.0;
    let positions: Vec<Vec3> = (mesh.positions.iter())
        .map(|p| place.transform_point3(*p) + Vec3::ZERO)
        .collect();
    let (mut indices, mut skins) = (Vec::new(), Vec::new());
    let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
    for triangle in &mesh.triangles {
        let mut corners = triangle.map(|i| i as usize);
        if is_mirrored {
            corners.reverse();
        }
        let key = |i: usize| positions[i].to_array().map(f32::to_bits);
        let [a, b, c] = corners.map(key);
        if a == b || b == c || c == a {
            continue;
        }
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (ends, way) = if from < to {
                ([from, to], 1)
            } else {
                ([to, from], -1)
            };
            *edges.entry(ends).or_default() += way;
        }
        for i in corners {
            let normal = (normals * mesh.normals[i]).normalize_or(Vec3::Y).as_dvec3();
            indices.push(i);
            skins.push(Skin {
                normal: if is_cutter { -normal } else { normal },
                uv: mesh.uv0[i].as_dvec2(),
            });
        }
    }
    let open = edges.values().filter(|balance| **balance != 0).count();
    if open > 0 {
        return Err(format!(
            "it is open, with {open} edges that have a triangle on one side only"
        ));
    }
    if indices.is_empty() {
        return Err("it has no triangles here, as a `heightfield` has none".to_owned());
    }
    let flat: Vec<f64> = positions
        .iter()
        .flat_map(|p| p.as_dvec3().to_array())
        .collect();
    Manifold::new_with_values(&flat, &indices, &skins)
        .map_err(|_| "parts of it touch in an edge".to_owned())
}
