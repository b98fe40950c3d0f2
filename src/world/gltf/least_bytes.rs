//! Lower bound of a primitive's memory, by the sizes in the JSON: a file that is too large is refused before any of
//! it is decoded.

use super::{
    accessor::{Data, Layout},
    morph,
    primitive::{self, TRIANGLES},
    primitive_context::Context,
    wire,
};

/// Least number of bytes that reading the primitive takes. A broken primitive counts 0: its error is reported when
/// it is read.
pub fn least_bytes(context: &Context<'_>) -> u64 {
    let (data, primitive) = (context.data, context.primitive);
    let count = |index: usize| data.count(index).unwrap_or(0);
    let Some(&position) = primitive.attributes.get("POSITION") else {
        return 0;
    };
    let num_vertices = count(position);
    let num_corners = primitive.indices.map_or(num_vertices, count);
    let attributes = Attributes {
        data,
        are_few_used: primitive::uses_few(num_corners, num_vertices),
    };
    let index_bytes = match primitive.indices {
        Some(_) => num_corners as u64 * 4,
        None => 0,
    };
    let wire_bytes = match primitive.mode.unwrap_or(TRIANGLES) {
        mode if mode < TRIANGLES => wire::bytes(mode, num_corners),
        _ => 0,
    };
    let named = primitive.attributes.iter();
    let used = named.filter(|(name, _)| is_read(context, name));
    let targets = morph::used(context).into_iter();
    let offsets = targets.flat_map(|target| &primitive.targets[target]);
    let offsets = offsets.filter(|(name, _)| morph::is_read(context, name));
    let arrays = used.chain(offsets).map(|(_, &i)| attributes.bytes(i));
    [
        index_bytes,
        wire_bytes,
        primitive::own_bytes(context, num_vertices, num_corners),
    ]
    .into_iter()
    .chain(arrays)
    .fold(0, u64::saturating_add)
}

/// Whether an attribute is read.
fn is_read(context: &Context<'_>, name: &str) -> bool {
    match name {
        "POSITION" | "NORMAL" | "COLOR_0" => true,
        "TANGENT" => context.primitive.attributes.contains_key("NORMAL"),
        name => {
            let set = name.strip_prefix("TEXCOORD_").and_then(|n| n.parse().ok());
            set.is_some_and(|set| context.uv_sets.contains(&set))
        }
    }
}

struct Attributes<'a> {
    data: &'a Data<'a>,
    /// Whether only the vertices that the indices name are read.
    are_few_used: bool,
}

impl Attributes<'_> {
    fn bytes(&self, index: usize) -> u64 {
        let is_sparse = |i| self.data.accessor(i).is_ok_and(|a| a.sparse.is_some());
        if self.are_few_used && !is_sparse(index) {
            return 0; // the number of used vertices is known when the indices are read
        }
        let bytes = |layout: Layout| layout.count as u64 * layout.lanes as u64 * 4;
        self.data.layout(index).map_or(0, bytes)
    }
}
