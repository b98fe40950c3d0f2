//! Function of `ctx` that deforms a mesh.

use rhai::Dynamic;

use super::{
    super::{floats::Floats, format_value::named, value::fail},
    Context, Result,
};
use crate::motion::MeshPose;

impl Context {
    /// Gives other positions to the vertices of a mesh, and normals, or smooth ones.
    pub fn mesh(&self, model: &str, positions: &Dynamic, normals: Option<&Dynamic>) -> Result<()> {
        let index = self.find("model", model, |n| &n.models)?;
        let Some(vertices) = self.names()?.known.vertices[index] else {
            return fail(MeshPose::refusal(model));
        };
        let numbers = |value: &Dynamic, what: &str| match value.clone().try_cast::<Floats>() {
            Some(floats) => Ok(floats.shared()),
            None => fail(format!(
                "the {what} of a mesh must be `floats`, not {}",
                named(value)
            )),
        };
        let positions = numbers(positions, "positions")?;
        let normals = normals
            .map(|normals| numbers(normals, "normals"))
            .transpose()?;
        let pose = MeshPose::new(model, vertices, positions, normals).or_else(fail)?;
        self.scene().state.meshes.insert(index, pose);
        Ok(())
    }
}
