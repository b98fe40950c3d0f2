//! Number of shader bindings of each array of the scene's geometry, where a scene needs more than a device binds at
//! once.

use std::fmt::Write as _;

use reflet_gpu::{Gpu, GpuError};

/// Number of a pass's storage buffers beside the geometry: instances, materials, lists, counters.
const OTHER_BUFFERS: u32 = 4;

/// Number of bindings of each array, which shaders are generated for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chunks {
    /// Number of bindings of BVH nodes.
    pub nodes: u32,
    /// Number of bindings of triangles in leaf order.
    pub triangles: u32,
    /// Whether nodes and triangles are textures.
    pub tree_texels: bool,
    /// Number of bindings of vertices.
    pub vertices: u32,
    /// Number of bindings of indices and second texture coordinates.
    pub mesh_data: u32,
    /// Whether vertices, indices and second texture coordinates are textures.
    pub mesh_texels: bool,
    /// Whether instances and materials are textures.
    pub record_texels: bool,
    /// Whether all these textures, light trees and squares of the panorama are storage textures.
    pub storage_texels: bool,
    /// Size of each of several bindings, bytes, a power of two.
    pub bytes: u64,
}

impl Default for Chunks {
    fn default() -> Self {
        Self::WHOLE
    }
}

impl Chunks {
    /// One binding for each array.
    pub const WHOLE: Self = Self {
        nodes: 1,
        triangles: 1,
        tree_texels: false,
        vertices: 1,
        mesh_data: 1,
        mesh_texels: false,
        record_texels: false,
        storage_texels: false,
        bytes: 0,
    };

    /// These numbers of bindings on this device, for arrays of `bytes` in total.
    ///
    /// # Errors
    /// More bindings than the device allows per stage.
    pub fn on(self, gpu: &Gpu, bytes: u64) -> Result<Self, GpuError> {
        let chunks = Self {
            bytes: chunk_bytes(gpu),
            ..self
        };
        let count = chunks.nodes + chunks.triangles + chunks.vertices + chunks.mesh_data;
        if count == 4 {
            return Ok(Self { bytes: 0, ..chunks });
        }
        let allowed = most_chunks(gpu);
        if count > allowed {
            return Err(GpuError::Limit {
                what: "the scene's geometry".to_owned(),
                wanted: bytes,
                limit: u64::from(allowed) * chunks.bytes,
                unit: "bytes",
            });
        }
        Ok(chunks)
    }

    /// Shader text with the functions of `shaders/lib/trees_whole.wgsl` and `geometry_whole.wgsl` for these
    /// bindings.
    pub fn wgsl(&self) -> String {
        let ending = |is_texels| if is_texels { "texels" } else { "whole" };
        let are_trees_whole = (self.nodes, self.triangles) == (1, 1);
        let are_meshes_whole = (self.vertices, self.mesh_data) == (1, 1);
        let mut text = String::new();
        if are_trees_whole {
            let _ = writeln!(text, "#import trees_{}", ending(self.tree_texels));
        }
        if are_meshes_whole {
            let _ = writeln!(text, "#import geometry_{}", ending(self.mesh_texels));
        }
        let mut binding = FIRST_FREE_BINDING;
        let mut array = |name: &str, of: &str, first: u32, (count, size): (u32, u64)| {
            for chunk in 0..count {
                let at = if chunk == 0 { first } else { binding };
                binding += u32::from(chunk > 0);
                let name = chunk_name(name, chunk);
                let _ = writeln!(
                    text,
                    "@group(1) @binding({at}) var<storage, read> {name}: array<{of}>;"
                );
            }
            let shift = (self.bytes / size).trailing_zeros();
            Array {
                name: name.to_owned(),
                count,
                shift,
            }
        };
        let mut functions = Vec::new();
        if !are_trees_whole {
            let nodes = array("nodes", "vec4u", 0, (self.nodes, 16));
            let triangles = array("triangles", "vec4u", 1, (self.triangles, 16));
            functions.push(("node_words", nodes, "", "vec4u"));
            functions.push(("triangle_words", triangles, "", "vec4u"));
        }
        if !are_meshes_whole {
            let vertices = array("vertices", "Vertex", 3, (self.vertices, 32));
            let mesh_data = array("mesh_data", "u32", 4, (self.mesh_data, 4));
            functions.push(("mesh_word", mesh_data, "", "u32"));
            functions.push(("vertex_at", vertices, "", "Vertex"));
        }
        for (function, array, member, of) in &functions {
            write_function(&mut text, function, array, member, of);
        }
        text
    }
}

/// First binding number of group 1 that no shader file declares.
const FIRST_FREE_BINDING: u32 = 19;

/// An array of shaders in chunks.
#[derive(Clone)]
struct Array {
    name: String,
    count: u32,
    /// log2 of the number of elements of a chunk.
    shift: u32,
}

/// Writes a function that returns a member, of the type `of`, of an element by its index in all chunks.
fn write_function(text: &mut String, function: &str, array: &Array, member: &str, of: &str) {
    let Array {
        name: array,
        count,
        shift,
    } = array;
    let _ = writeln!(text, "fn {function}(i: u32) -> {of} {{");
    if *count == 1 {
        let _ = writeln!(text, "    return {array}[i]{member};\n}}");
        return;
    }
    let mask = (1u32 << shift) - 1;
    let _ = writeln!(
        text,
        "    let at = i & {mask}u;\n    switch i >> {shift}u {{"
    );
    for chunk in 0..*count {
        let label = match chunk + 1 == *count {
            true => "default".to_owned(),
            false => format!("case {chunk}u"),
        };
        let name = chunk_name(array, chunk);
        let _ = writeln!(text, "        {label}: {{ return {name}[at]{member}; }}");
    }
    let _ = writeln!(text, "    }}\n}}");
}

/// Variable name of a chunk in shaders: `nodes`, `nodes_1`, …
fn chunk_name(array: &str, chunk: u32) -> String {
    match chunk {
        0 => array.to_owned(),
        _ => format!("{array}_{chunk}"),
    }
}

/// Array name and chunk number of a variable name in shaders.
pub fn chunk_of(name: &str) -> (&str, usize) {
    let numbered = name.rsplit_once('_');
    let numbered = numbered.and_then(|(array, chunk)| Some((array, chunk.parse().ok()?)));
    numbered.unwrap_or((name, 0))
}

/// Size of one of several bindings, bytes.
pub fn chunk_bytes(gpu: &Gpu) -> u64 {
    1 << gpu.largest_storage_buffer().ilog2()
}

/// Maximum number of bindings of all arrays together.
fn most_chunks(gpu: &Gpu) -> u32 {
    let limit = gpu.limits.max_storage_buffers_per_shader_stage;
    limit.saturating_sub(OTHER_BUFFERS)
}

/// Maximum size of an array of the BVHs, bytes, beside vertices and indices of these sizes.
pub fn largest_tree_array(gpu: &Gpu, vertex_bytes: u64, index_bytes: u64) -> u64 {
    let chunk = chunk_bytes(gpu);
    let taken = [vertex_bytes, index_bytes].map(|bytes| bytes.div_ceil(chunk).max(1));
    // The other array of the BVHs takes at least one binding.
    let left = u64::from(most_chunks(gpu)).saturating_sub(taken.iter().sum::<u64>() + 1);
    match left {
        0 | 1 => gpu.largest_storage_buffer(),
        _ => left * chunk,
    }
}

/// Checks that a device can hold a scene's geometry, as far as that is known before BVHs are built: their nodes are
/// not counted.
///
/// # Errors
/// [`GpuError::Limit`] for geometry past the device's bindings.
pub fn check_size(gpu: &Gpu, sizes: Sizes) -> Result<(), GpuError> {
    let chunk = chunk_bytes(gpu);
    let largest = gpu.largest_storage_buffer();
    let buffers = |bytes: u64| match bytes <= largest {
        true => 1,
        false => bytes.div_ceil(chunk),
    };
    let arrays = [sizes.vertices, sizes.mesh_data, sizes.triangles];
    let count = 1 + arrays.map(buffers).iter().sum::<u64>();
    let allowed = u64::from(most_chunks(gpu));
    if count <= allowed || count == 4 {
        return Ok(());
    }
    Err(GpuError::Limit {
        what: "the scene's geometry".to_owned(),
        wanted: arrays.iter().sum(),
        limit: allowed * chunk,
        unit: "bytes",
    })
}

/// Sizes of the arrays of a scene's geometry, bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Size of the vertices, bytes.
    pub vertices: u64,
    /// Size of the indices and second texture coordinates, bytes.
    pub mesh_data: u64,
    /// Size of the triangles in the BVHs, bytes.
    pub triangles: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_of_several_buffers_are_read_by_shift_and_mask() {
        let chunks = Chunks {
            triangles: 3,
            vertices: 2,
            bytes: 1 << 20,
            ..Chunks::WHOLE
        };
        let text = chunks.wgsl();
        for line in [
            "@group(1) @binding(1) var<storage, read> triangles: array<vec4u>;",
            "@group(1) @binding(19) var<storage, read> triangles_1: array<vec4u>;",
            "@group(1) @binding(20) var<storage, read> triangles_2: array<vec4u>;",
            "@group(1) @binding(21) var<storage, read> vertices_1: array<Vertex>;",
            "    switch i >> 16u {",
            "        case 1u: { return triangles_1[at]; }",
            "        default: { return triangles_2[at]; }",
            "    let at = i & 32767u;",
            "    return nodes[i];",
        ] {
            assert!(text.contains(line), "{line} in\n{text}");
        }
        assert_eq!(chunk_of("triangles_2"), ("triangles", 2));
        assert_eq!(chunk_of("mesh_data"), ("mesh_data", 0));
    }

    #[test]
    fn no_shader_file_declares_the_bindings_of_further_buffers() {
        let library = reflet_gpu::ShaderLibrary::embedded();
        let mut most = 0;
        for (_, text) in library.texts() {
            for declared in text.split("@group(1) @binding(").skip(1) {
                let number = declared.split(')').next().unwrap_or_default();
                most = most.max(number.parse().expect("a number"));
            }
        }
        assert_eq!(most + 1, FIRST_FREE_BINDING);
    }
}
