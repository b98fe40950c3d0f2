//! Flat regions turned around the axis Y.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{
    Fault,
    contour::Column,
    region::Region,
    solid::{Corner, Solid, check_size},
};

/// A whole turn or a part of it, in equal steps.
struct Turn {
    /// Number of steps.
    steps: u32,
    /// Its angle, radians.
    angle: f64,
    /// Whether it is a whole turn.
    is_whole: bool,
}

impl Turn {
    /// Direction from the axis after some steps, from +Z towards +X; after a whole turn the first one exactly.
    fn out(&self, step: f64) -> DVec3 {
        let steps = f64::from(self.steps);
        let step = if self.is_whole { step % steps } else { step };
        let (sin, cos) = (self.angle * step / steps).sin_cos();
        DVec3::new(sin, 0.0, cos)
    }

    fn corner(&self, column: &Column, step: f64, share: f64) -> Corner {
        let out = self.out(step);
        let place = |v: DVec2| out * v.x + DVec3::Y * v.y;
        let uv = DVec2::new(step / f64::from(self.steps), 1.0 - share);
        Corner::new(place(column.at), place(column.normal), uv)
    }
}

/// Adds the solid that a region passes through when it is turned: its x is the distance from the axis.
///
/// # Errors
/// `wrong-outline` for a region that reaches over the axis; `shape-too-large`.
pub fn add(solid: &mut Solid, region: &Region, segments: u32, angle_deg: f32) -> Result<(), Fault> {
    let share = f64::from(angle_deg) / 360.0;
    let turn = Turn {
        steps: (share * f64::from(segments) - 1e-9).ceil().max(1.0) as u32,
        angle: TAU * share,
        is_whole: share >= 1.0,
    };
    check_size(
        2 * region.sides() * turn.steps as usize,
        "`segments` of the shape or of its outline",
    )?;
    let [low, high] = region.bounds();
    if low.x < 0.0 {
        let message = format!(
            "the outline reaches over the axis: its least x is {}, of at least 0",
            low.x as f32
        );
        let help = "x is the distance from the axis; move the outline to its right side";
        return Err(Fault::new("wrong-outline", message).help(help));
    }
    for [a, b] in region.contours().flat_map(|contour| &contour.sides) {
        for step in 0..turn.steps {
            let (left, right) = (f64::from(step), f64::from(step + 1));
            // A corner on the axis is in the middle of its triangle's base.
            let middle = left + 0.5;
            let of = |column: &Column, step: f64| {
                let step = if column.at.x == 0.0 { middle } else { step };
                turn.corner(column, step, column.share)
            };
            let [low, high] = [[of(a, left), of(a, right)], [of(b, left), of(b, right)]];
            solid.quad([high[0], low[0], low[1], high[1]]);
        }
    }
    if turn.is_whole {
        return Ok(());
    }
    for corners in region.fill(&region.places())? {
        for is_end in [false, true] {
            let out = turn.out(if is_end { f64::from(turn.steps) } else { 0.0 });
            // Towards larger angles.
            let onward = DVec3::Y.cross(out);
            let mut face = corners.map(|place| {
                let at = out * place.x + DVec3::Y * place.y;
                let uv = (place - low) / (high - low);
                let u = if is_end { 1.0 - uv.x } else { uv.x };
                let normal = if is_end { onward } else { -onward };
                Corner::new(at, normal, DVec2::new(u, 1.0 - uv.y))
            });
            if is_end {
                face.reverse();
            }
            solid.triangle(face);
        }
    }
    Ok(())
}
