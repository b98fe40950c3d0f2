//! Flat regions with a thickness.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};

use super::{
    Fault,
    region::Region,
    solid::{Corner, Solid, check_size},
};
use reflet_scene::desc::BevelDesc;

/// A row of vertices around the side of an extruded region.
#[derive(Clone, Copy)]
struct Row {
    /// How far it lies inside the outline, meters.
    inset: f64,
    /// Height, meters.
    z: f64,
    /// Normal, as its parts along the outline's normal and along Z.
    normal: DVec2,
    /// Texture coordinate.
    v: f64,
}

/// Adds a region extruded along Z, from z = 0 to its face at `depth`.
///
/// # Errors
/// `wrong-bevel` for a bevel that the region is too narrow for, which says the largest one; `shape-too-large`.
pub fn add(solid: &mut Solid, region: &Region, depth: f32, bevel: &BevelDesc) -> Result<(), Fault> {
    let bands = bands(f64::from(depth), f64::from(bevel.width), bevel.segments);
    let triangles = region.sides() * (2 * bands.len() + 2);
    check_size(triangles, "`segments` or `bevel_segments`")?;
    let mut insets: Vec<f64> = bands.iter().flatten().map(|row| row.inset).collect();
    insets.sort_by(f64::total_cmp);
    insets.dedup();
    let places = match bevel.width > 0.0 {
        true => region
            .insets(&insets)
            .ok_or_else(|| too_wide(region, bevel))?,
        false => vec![region.places()],
    };
    let mut first = 0;
    for contour in region.contours() {
        let count = contour.sides.len();
        for (side, columns) in contour.sides.iter().enumerate() {
            let ends = [first + side, first + (side + 1) % count];
            let row = |row: &Row| {
                let ring = insets.partition_point(|inset| *inset < row.inset);
                [0, 1].map(|end| {
                    let column = &columns[end];
                    let normal = (column.normal * row.normal.x).extend(row.normal.y);
                    let at = places[ring][ends[end]].extend(row.z);
                    Corner::new(at, normal, DVec2::new(column.share, row.v))
                })
            };
            for [front, back] in &bands {
                let (front, back) = (row(front), row(back));
                solid.quad([front[0], back[0], back[1], front[1]]);
            }
        }
        first += count;
    }
    let faces = region.fill(&places[places.len() - 1])?;
    add_faces(solid, &faces, region.bounds(), f64::from(depth));
    Ok(())
}

/// Adds the face and the back.
fn add_faces(solid: &mut Solid, faces: &[[DVec2; 3]], [low, high]: [DVec2; 2], depth: f64) {
    for corners in faces {
        for (z, out) in [(depth, 1.0), (0.0, -1.0)] {
            let mut face = corners.map(|place| {
                let uv = (place - low) / (high - low);
                // Seen from outside, right is +X in front and -X behind.
                let u = if out > 0.0 { uv.x } else { 1.0 - uv.x };
                Corner::new(place.extend(z), DVec3::Z * out, DVec2::new(u, 1.0 - uv.y))
            });
            if out < 0.0 {
                face.reverse();
            }
            solid.triangle(face);
        }
    }
}

fn too_wide(region: &Region, bevel: &BevelDesc) -> Fault {
    let (width, largest) = (bevel.width, region.largest_inset(f64::from(bevel.width)));
    let message = format!(
        "`bevel` is larger than the outline has room for: {width} of at most {}",
        rounded_down(largest)
    );
    let help = "lower `bevel`: it takes its width from both sides of every part";
    Fault::new("wrong-bevel", message).help(help)
}

/// The number with three digits that is not above `x`.
fn rounded_down(x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let digit = 10.0_f64.powf(x.log10().floor() - 2.0);
    // Through text, so that no binary fraction shows.
    let text = format!("{:.12}", (x / digit).floor() * digit);
    text.parse().unwrap_or(x)
}

/// Bands of the side, from the face to the back, each its first and last row.
fn bands(depth: f64, width: f64, steps: u32) -> Vec<[Row; 2]> {
    let row = |inset, z, normal, v| Row {
        inset,
        z,
        normal,
        v,
    };
    if width == 0.0 {
        let [front, back] = [(depth, 0.0), (0.0, 1.0)];
        return vec![[
            row(0.0, front.0, DVec2::X, front.1),
            row(0.0, back.0, DVec2::X, back.1),
        ]];
    }
    let (steps, arc) = (steps.max(1), FRAC_PI_2 * width);
    let whole = 2.0 * arc + (depth - 2.0 * width);
    // The bevel of the face, from its edge down to the side.
    let at = |step: u32| {
        let share = f64::from(step) / f64::from(steps);
        let (sin, cos) = match step {
            0 => (1.0, 0.0),
            step if step == steps => (0.0, 1.0),
            _ => (FRAC_PI_2 * (1.0 - share)).sin_cos(),
        };
        let z = width * (1.0 - sin);
        row(
            width * (1.0 - cos),
            z,
            DVec2::new(cos, sin),
            share * arc / whole,
        )
    };
    let mut bands = Vec::new();
    for step in 0..steps {
        let mut band = [at(step), at(step + 1)];
        if steps == 1 {
            band.iter_mut().for_each(|row| row.normal = DVec2::ONE);
        }
        bands.push(band);
    }
    let front = |row: Row| Row {
        z: depth - row.z,
        ..row
    };
    let back = |row: Row| Row {
        normal: DVec2::new(row.normal.x, -row.normal.y),
        v: 1.0 - row.v,
        ..row
    };
    let down: Vec<[Row; 2]> = bands.iter().map(|band| band.map(front)).collect();
    let up = bands.iter().rev().map(|[a, b]| [back(*b), back(*a)]);
    let last = Row {
        normal: DVec2::X,
        ..at(steps)
    };
    let side = [front(last), back(last)];
    let side = (depth > 2.0 * width).then_some(side);
    down.into_iter().chain(side).chain(up).collect()
}
