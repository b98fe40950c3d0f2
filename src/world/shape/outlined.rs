//! Shapes that are made of outlines, bevelled and flat-ended ones among them.

use boolmesh::prelude::OpType;
use glam::DVec2;
use reflet_scene::desc::{LatheSource, ShapeDesc};

use super::{
    Fault, Made, Supplies, boolean,
    curve::Curve,
    displaced, extrude,
    flatten::{Chord, Loop},
    region::Region,
    rounded_box,
    solid::Solid,
    sweep::{self, Along},
    text, turn,
};

/// Makes a shape of outlines or of shapes, text, a box with a bevel or a part of a torus, without bounds; `None` for
/// any other shape.
///
/// # Errors
/// `wrong-outline`, `wrong-bevel`, `wrong-curve`, `wrong-font`, `wrong-svg`, `wrong-parts` and `shape-too-large`.
pub fn make(shape: &ShapeDesc, supplies: &Supplies) -> Result<Option<Made>, Fault> {
    let mut solid = Solid::default();
    let added = match shape.parts() {
        [] => add_figure(&mut solid, shape, supplies)?,
        parts => {
            let operation = match shape {
                ShapeDesc::Union { .. } => OpType::Add,
                ShapeDesc::Difference { .. } => OpType::Subtract,
                _ => OpType::Intersect,
            };
            Some(boolean::add(&mut solid, operation, parts, supplies)?)
        }
    };
    let mesh = solid.into_mesh();
    Ok(added.map(|warnings| Made { mesh, warnings }))
}

/// Adds a shape that is not of parts; returns its warnings, or `None` for a shape that is made elsewhere.
fn add_figure(
    solid: &mut Solid,
    shape: &ShapeDesc,
    supplies: &Supplies,
) -> Result<Option<Vec<Fault>>, Fault> {
    let mut warnings = Vec::new();
    match shape {
        ShapeDesc::Box { size, bevel } if bevel.width > 0.0 => {
            let half = size.as_dvec3() / 2.0;
            rounded_box::add(solid, half, f64::from(bevel.width), bevel.segments);
        }
        ShapeDesc::Torus { .. } | ShapeDesc::Lathe { .. } => {
            let Some((region, segments, angle_deg)) = turned(shape, supplies)? else {
                return Ok(None);
            };
            let outline = match shape {
                ShapeDesc::Lathe {
                    source: LatheSource::Outline(outline),
                    ..
                } => Some(outline),
                _ => None,
            };
            let at = |fault: Fault| match outline {
                Some(outline) => fault.placed(outline.at.0.clone()),
                None => fault,
            };
            turn::add(solid, &region, segments, angle_deg).map_err(at)?;
        }
        ShapeDesc::Extrude {
            outline,
            depth,
            bevel,
        } => {
            let region = Region::enclosed(outline, supplies)?;
            let at = |fault: Fault| fault.placed(outline.at.0.clone());
            extrude::add(solid, &region, *depth, bevel).map_err(at)?;
        }
        ShapeDesc::Sweep { .. } => warnings.extend(add_sweep(solid, shape, supplies)?),
        ShapeDesc::Text { .. } => warnings.extend(text::add(solid, shape, supplies)?),
        ShapeDesc::Displaced {
            shape,
            subdivide,
            smooth,
            noise,
        } => {
            let inner = super::make(shape, supplies)?;
            displaced::add(solid, &inner, *subdivide, *smooth, noise)?;
            warnings = inner.warnings;
        }
        _ => return Ok(None),
    }
    Ok(Some(warnings))
}

/// The region that a part of a torus or a lathe turns, with its divisions and its angle in degrees; `None` for a whole
/// torus and whole turns of points.
fn turned(shape: &ShapeDesc, supplies: &Supplies) -> Result<Option<(Region, u32, f32)>, Fault> {
    Ok(match shape {
        ShapeDesc::Torus {
            radius,
            tube_radius,
            segments,
            angle_deg,
        } if *angle_deg < 360.0 => {
            let tube = circle(*radius, *tube_radius, (segments / 2).max(3));
            let region = Region::of_loops(vec![tube], supplies)?;
            Some((region, *segments, *angle_deg))
        }
        ShapeDesc::Lathe {
            source,
            segments,
            angle_deg,
        } => {
            let region = match source {
                LatheSource::Outline(outline) => Region::enclosed(outline, supplies)?,
                LatheSource::Points(_) if *angle_deg >= 360.0 => return Ok(None),
                LatheSource::Points(points) => joined_to_axis(points, supplies)?,
            };
            Some((region, (*segments).max(3), *angle_deg))
        }
        _ => None,
    })
}

/// Adds a sweep; returns a warning where it passes through itself.
fn add_sweep(
    solid: &mut Solid,
    shape: &ShapeDesc,
    supplies: &Supplies,
) -> Result<Option<Fault>, Fault> {
    let ShapeDesc::Sweep {
        outline,
        points,
        curve,
        closed,
        twist_deg,
        taper,
        segments,
        at,
    } = shape
    else {
        return Ok(None);
    };
    let region = Region::enclosed(outline, supplies)?;
    let along = Along {
        twist: f64::from(*twist_deg).to_radians(),
        taper: f64::from(*taper),
    };
    let here = |fault: Fault| fault.placed(at.0.clone());
    let curve = Curve::through(points, *curve, *closed, *segments).map_err(here)?;
    let crossed = sweep::add(solid, &region, &curve, along).map_err(here)?;
    Ok(crossed.map(|point| {
        let message = format!(
            "the profile is wider than the bend of the curve after its point {}: the surface passes through itself",
            point + 1
        );
        let help = "make the profile smaller, or the bend wider";
        Fault::new("sweep-crosses", message).help(help).placed(at.0.clone())
    }))
}

/// The tube of a torus.
fn circle(radius: f32, tube_radius: f32, segments: u32) -> Loop {
    let (center, radius) = (DVec2::new(f64::from(radius), 0.0), f64::from(tube_radius));
    super::flatten::circle(center, radius, segments)
}

/// The region between points from below upwards and the axis.
fn joined_to_axis(points: &[[f32; 2]], supplies: &Supplies) -> Result<Region, Fault> {
    let mut corners: Vec<DVec2> = points
        .iter()
        .map(|p| DVec2::from(p.map(f64::from)))
        .collect();
    let [first, last] = [corners[0], corners[corners.len() - 1]];
    corners.push(DVec2::new(0.0, last.y));
    corners.push(DVec2::new(0.0, first.y));
    let next = corners.iter().cycle().skip(1);
    let chords = corners.iter().zip(next);
    let around = chords
        .filter_map(|(a, b)| Chord::straight(*a, *b))
        .collect();
    Region::of_loops(vec![around], supplies)
}
