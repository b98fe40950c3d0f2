//! Function of `ctx` that deforms a mesh.

use rhai::Dynamic;

use super::{
    super::{floats::Floats, format_value::named, value::fail},
    Context, Result,
};
use crate::{motion::MeshPose, range::ANY, suggest};

impl Context {
    /// Gives other positions to the vertices of a mesh, and normals, or smooth ones.
    pub fn mesh(&self, model: &str, positions: &Dynamic, normals: Option<&Dynamic>) -> Result<()> {
        let index = self.find("model", model, |n| &n.models)?;
        let shown = suggest::text(model);
        let Some(vertices) = self.names()?.known.vertices[index] else {
            return fail(format!(
                "model {shown} cannot be deformed; its shape must be of `kind = \"mesh\"` with `dynamic = true`"
            ));
        };
        let numbers = |value: &Dynamic, what: &str| {
            let Some(floats) = value.clone().try_cast::<Floats>() else {
                return fail(format!(
                    "the {what} of a mesh must be `floats`, not {}",
                    named(value)
                ));
            };
            let (found, wanted) = (floats.numbers().len(), 3 * vertices);
            if found != wanted {
                return fail(format!(
                    "the {what} of model {shown} must be {wanted} numbers, 3 for each of its {vertices} vertices, \
                     not {found} numbers ({} vertices); `frame` moves vertices and cannot add or remove them",
                    found / 3
                ));
            }
            Ok(floats)
        };
        let positions = numbers(positions, "positions")?;
        let is_far = |x: &f32| !ANY.contains(f64::from(*x));
        if let Some(at) = positions.numbers().iter().position(is_far) {
            return fail(format!(
                "the positions of model {shown} must be between -1e12 and 1e12; number {at} is {}",
                positions.numbers()[at]
            ));
        }
        let normals = normals
            .map(|normals| numbers(normals, "normals"))
            .transpose()?;
        let pose = MeshPose {
            positions: positions.shared(),
            normals: normals.map(Floats::shared),
        };
        self.scene().state.meshes.insert(index, pose);
        Ok(())
    }
}
