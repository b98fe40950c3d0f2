//! Gaussian splats (KHR_gaussian_splatting) as points, until they are more.

use glam::{Vec3, Vec4};

use super::{
    Fault, Notes,
    accessor::{self, Component},
    primitive_context::Context,
};
use crate::Mesh;
use reflet_base::math::linear_from_srgb;

/// Namespace of the extension's attributes.
const PREFIX: &str = "KHR_gaussian_splatting";
/// Constant part of the spherical harmonics.
const SH_0: f32 = 0.282_094_8;

/// Gives the points the constant part of the splats' color; returns the mean of their diameters, two standard
/// deviations, in meters. `None` for a primitive without splats.
///
/// # Errors
/// Attributes that are broken.
pub fn read(
    context: &Context<'_>,
    mesh: &mut Mesh,
    notes: &mut Notes,
) -> Result<Option<f64>, Fault> {
    let Some(splats) = &context.primitive.extensions.splats else {
        return Ok(None);
    };
    let values = |name: &str, accept: fn(Component, bool) -> bool| {
        let index = context.attribute(&format!("{PREFIX}:{name}"))?;
        let read = index.map(|index| context.floats::<3>(index, accept));
        read.transpose().map_err(|f| f.placed(name))
    };
    let is_encoded = splats.color_space.as_deref() != Some("lin_rec709_display");
    if let Some(colors) = values("SH_DEGREE_0_COEF_0", accessor::float_only)? {
        let color = |c: [f32; 3]| {
            let shown = (Vec3::from(c) * SH_0 + 0.5).clamp(Vec3::ZERO, Vec3::ONE);
            match is_encoded {
                true => Vec3::from(shown.to_array().map(linear_from_srgb)),
                false => shown,
            }
        };
        mesh.colors = colors
            .into_iter()
            .map(|c| Vec4::from((color(c), 1.0)))
            .collect();
    }
    let scales = values("SCALE", accessor::float_or_signed)?.unwrap_or_default();
    let logarithms = scales.as_flattened().iter().filter(|v| v.is_finite());
    let (sum, count) = logarithms.fold((0.0, 0.0), |(sum, count), v| {
        (sum + f64::from(*v), count + 1.0)
    });
    let what = "primitives are Gaussian splats and are shown as opaque points of their mean size";
    notes.add("splats-approximated", 1, what, &mesh.name);
    Ok((count > 0.0).then(|| 2.0 * (sum / count).exp()))
}
