//! Decals as scripts set them.

use rhai::Map;

use super::{
    super::setters::{field_bits, values},
    Context, Result, fail,
};
use crate::{
    motion::{DECAL, Kind},
    suggest,
};

/// The only number that a decal that stands still may change.
const OPACITY: &str = "opacity";

impl Context {
    /// Sets values of a decal.
    pub fn decal(&self, name: &str, keys: &Map) -> Result<()> {
        let index = self.find("decal", name, |n| &n.decals)?;
        let values = values(&DECAL, keys, "a decal", |_| true)?;
        let moved = values.iter().find(|(field, _)| field.key != OPACITY);
        if let Some((field, _)) =
            moved.filter(|_| !self.names().is_ok_and(|n| n.known.decals[index]))
        {
            let shown = suggest::text(name);
            return fail(format!(
                "decal {shown} stands still, so `{}` cannot be set; write `dynamic = true` in its `[decal.{}]`",
                field.key,
                suggest::clip(name)
            ));
        }
        let fields = field_bits(&DECAL, values.iter().map(|(field, _)| *field));
        let mut scene = self.scene();
        for (field, value) in values {
            (field.put)(&mut scene.state.decals[index], value);
        }
        scene.touched.add(Kind::Decal, index, fields);
        Ok(())
    }
}
