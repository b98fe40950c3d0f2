//! Instances and materials on the GPU: in a buffer, and for shaders in a texture as well where drivers read textures
//! faster; and the functions by which shaders read their fields.

use std::{collections::BTreeSet, fmt::Write as _};

use bytemuck::{Pod, cast_slice};

use reflet_gpu::{Gpu, GpuError};

use super::{geometry::buffer, gpu_material::GpuMaterial};
use crate::{
    buffers::texel_array::TexelArray,
    layout::{gpu_struct::StructSpec, types::GpuInstance},
};

/// Size of a texel, bytes.
const TEXEL: usize = 16;

/// An array of structs that is read by shaders, one element at a time.
#[derive(Clone, Debug)]
pub struct RecordArray {
    buffer: wgpu::Buffer,
    /// Copy that shaders read; without, they read the buffer.
    texels: Option<TexelArray>,
}

impl RecordArray {
    /// Creates an initialized array, never of zero size.
    ///
    /// # Errors
    /// A size past the adapter's limit, named by `name`, or a wgpu error.
    pub fn new<T: Pod>(
        gpu: &Gpu,
        name: &str,
        records: impl ExactSizeIterator<Item = T> + Clone,
        usage: wgpu::BufferUsages,
        in_texels: bool,
    ) -> Result<Self, GpuError> {
        let texels = in_texels.then(|| TexelArray::new(gpu, name, records.clone()));
        let usage = usage | wgpu::BufferUsages::STORAGE;
        Ok(Self {
            texels: texels.transpose()?,
            buffer: buffer(gpu, name, records, usage)?,
        })
    }

    /// Writes elements, starting at index `first`.
    pub fn write<T: Pod>(&self, gpu: &Gpu, first: usize, records: &[T]) {
        let offset = (first * size_of::<T>()) as u64;
        gpu.queue
            .write_buffer(&self.buffer, offset, cast_slice(records));
        if let Some(texels) = &self.texels {
            texels.write(gpu, first, records);
        }
    }

    /// The buffer.
    pub const fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Whether shaders read the array from a texture.
    pub const fn is_texels(&self) -> bool {
        self.texels.is_some()
    }

    /// Binding for shaders.
    pub fn resource(&self) -> wgpu::BindingResource<'_> {
        match &self.texels {
            Some(texels) => texels.resource(),
            None => self.buffer.as_entire_binding(),
        }
    }

    /// Total size of buffer and texture, bytes.
    pub fn size(&self) -> u64 {
        self.buffer.size() + self.texels.as_ref().map_or(0, TexelArray::size)
    }
}

/// Whether shaders had better read this number of instances and of materials from textures.
pub fn are_texels_preferred(gpu: &Gpu, instances: usize, materials: usize) -> bool {
    TexelArray::is_preferred::<GpuInstance>(gpu, instances)
        && TexelArray::is_preferred::<GpuMaterial>(gpu, materials)
}

/// Shader text with the bindings of both arrays and, for each field, a function of the element's index; an array's has
/// a second parameter, the slot. `instance_values` and `material_values` return all fields but arrays, and read each
/// texel once.
pub fn wgsl(in_texels: bool) -> String {
    let mut text = String::new();
    if in_texels {
        text.push_str("#import texels\n");
    }
    for (spec, array, binding) in [
        (&GpuInstance::LAYOUT, "instances", 2),
        (&GpuMaterial::LAYOUT, "materials", 5),
    ] {
        let (space, of) = match in_texels {
            true => ("", "VectorTexels".to_owned()),
            false => ("<storage, read>", format!("array<{}>", spec.name)),
        };
        let _ = writeln!(
            text,
            "@group(1) @binding({binding}) var{space} {array}: {of};"
        );
        for field in spec.fields {
            let element = array.trim_end_matches('s');
            let (name, slot, at_slot) = match field.listed {
                Some(_) => (field.name.trim_end_matches('s'), ", slot: u32", "[slot]"),
                None => (field.name, "", ""),
            };
            let ty = match field.listed {
                Some(spec) => spec.name.to_owned(),
                None => (field.wgsl)(),
            };
            let _ = writeln!(text, "fn {element}_{name}(i: u32{slot}) -> {ty} {{");
            if in_texels {
                let element_texels = spec.size / TEXEL;
                let slots = field.listed.map_or_else(String::new, |spec| {
                    format!(" + {}u * slot", spec.size / TEXEL)
                });
                let texel = format!("{element_texels}u * i{slots}");
                let value = match field.listed {
                    Some(spec) => whole_value(spec, array, &texel, field.offset),
                    None => value(array, &texel, field.offset, &ty),
                };
                let _ = writeln!(text, "    return {value};\n}}");
            } else {
                let _ = writeln!(text, "    return {array}[i].{}{at_slot};\n}}", field.name);
            }
        }
        text += &values(spec, array, in_texels);
    }
    text
}

/// Struct of all fields but arrays, and the function that returns them for an element's index.
fn values(spec: &StructSpec, array: &str, in_texels: bool) -> String {
    let (name, element, size) = (spec.name, array.trim_end_matches('s'), spec.size / TEXEL);
    let mut declared = String::new();
    let (mut read, mut values) = (BTreeSet::new(), Vec::new());
    for field in spec.fields.iter().filter(|field| field.listed.is_none()) {
        let ty = (field.wgsl)();
        // Writing to a string cannot fail.
        let _ = writeln!(declared, "    {}: {ty},", field.name);
        if in_texels {
            read.extend(field.offset / TEXEL..(field.offset + field.size).div_ceil(TEXEL));
            values.push(part(field.offset, &ty, |k| format!("t{k}")));
        } else {
            values.push(format!("{array}[i].{}", field.name));
        }
    }
    let read = read.iter();
    let read = read.map(|k| format!("    let t{k} = vector_at({array}, {size}u * i + {k}u);\n"));
    let (read, values) = (read.collect::<String>(), values.join(", "));
    format!(
        "struct {name}Values {{\n{declared}}}\n\
         fn {element}_values(i: u32) -> {name}Values {{\n{read}    return {name}Values({values});\n}}\n"
    )
}

/// Expression for a value at `offset` bytes past the texel of an array that the expression `texel` numbers.
fn value(array: &str, texel: &str, offset: usize, ty: &str) -> String {
    part(offset, ty, |k| {
        format!("vector_at({array}, {texel} + {k}u)")
    })
}

/// Expression for a value at `offset` bytes in an element, of whose texels `texel` has the expressions.
fn part(offset: usize, ty: &str, texel: impl Fn(usize) -> String) -> String {
    let load = |at: usize| texel(offset / TEXEL + at);
    let first = (offset % TEXEL) / 4;
    let part = |count: usize| &"xyzw"[first..first + count];
    match ty {
        "u32" => format!("{}.{}", load(0), part(1)),
        "f32" => format!("bitcast<f32>({}.{})", load(0), part(1)),
        "mat3x4f" => {
            let rows = [0, 1, 2].map(|row| format!("bitcast<vec4f>({})", load(row)));
            format!("mat3x4f({})", rows.join(", "))
        }
        _ => {
            let count = ty.as_bytes()[3] - b'0';
            format!("bitcast<{ty}>({}.{})", load(0), part(count.into()))
        }
    }
}

/// Expression for a struct at `offset` bytes past a texel.
fn whole_value(spec: &StructSpec, array: &str, texel: &str, offset: usize) -> String {
    let values = spec.fields.iter();
    let values: Vec<_> = values
        .map(|field| value(array, texel, offset + field.offset, &(field.wgsl)()))
        .collect();
    format!("{}({})", spec.name, values.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_from_buffers_and_from_texels() {
        let lines = |in_texels: bool, wanted: &[&str]| {
            let text = wgsl(in_texels);
            for line in wanted {
                assert!(text.contains(line), "{line} in\n{text}");
            }
        };
        lines(
            false,
            &[
                "@group(1) @binding(2) var<storage, read> instances: array<Instance>;",
                "fn instance_material(i: u32) -> u32 {\n    return instances[i].material;",
                "fn material_texture(i: u32, slot: u32) -> TextureUse {\n    return materials[i].textures[slot];",
                "    return InstanceValues(instances[i].world_from_object, ",
            ],
        );
        lines(
            true,
            &[
                "@group(1) @binding(5) var materials: VectorTexels;",
                "return vector_at(instances, 8u * i + 7u).y;",
                "t7 = vector_at(instances, 8u * i + 7u);\n    return InstanceValues(mat3x4f(bitcast<vec4f>(t0), ",
                "return bitcast<vec3f>(vector_at(materials, 87u * i + 1u).xyz);",
                "return TextureUse(bitcast<vec3f>(vector_at(materials, 87u * i + 3u * slot + 13u).xyz), ",
            ],
        );
    }
}
