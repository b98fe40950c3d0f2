//! Shader reflection: validates WGSL with naga and lists its declarations.

use std::{error::Error, sync::Arc};

use naga::{
    AddressSpace, Handle, ImageClass, ImageDimension, Module, ScalarKind, Span, StorageAccess,
    StorageFormat, TypeInner, WithSpan,
    front::wgsl,
    proc::Layouter,
    valid::{Capabilities, ModuleInfo, ValidationError, ValidationFlags, Validator},
};

use super::{
    shader::{ShaderError, ShaderSource},
    specialize::pruned,
};

/// Declarations of a validated shader.
#[derive(Clone, Debug)]
pub struct ShaderModuleInfo {
    /// Name of the shader, such as `ssr`.
    pub name: String,
    /// File of the shader, for messages.
    pub file: Arc<str>,
    /// Entry points, in the order of the text.
    pub entry_points: Vec<EntryPoint>,
    /// Bindings that at least one entry point uses, by group and then number.
    pub bindings: Vec<Binding>,
    /// Pipeline-overridable constants.
    pub overrides: Vec<Override>,
    /// Names of the functions beside the entry points.
    pub functions: Vec<String>,
    /// All structs, imported ones too.
    pub structs: Vec<StructLayout>,
}

/// An entry point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EntryPoint {
    /// Name of the function.
    pub name: String,
    /// Pipeline stage.
    pub stage: wgpu::ShaderStages,
    /// Number of threads of a workgroup in x, y and z; zeros outside compute.
    pub workgroup_size: [u32; 3],
}

/// A resource binding of a shader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// Number of the bind group: `@group`.
    pub group: u32,
    /// Number of the binding in its group: `@binding`.
    pub binding: u32,
    /// Name of the variable.
    pub name: String,
    /// Required resource type.
    pub ty: wgpu::BindingType,
    /// Stages that use the binding.
    pub visibility: wgpu::ShaderStages,
    /// Names of the entry points that use the binding.
    pub entry_points: Vec<String>,
    /// File and line of the declaration, for messages.
    pub declared_at: String,
}

/// A pipeline-overridable constant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// Key of the override in a pipeline's constants: the `@id`, else the name.
    pub key: String,
    /// Name of the constant.
    pub name: String,
    /// Whether the override has a default value.
    pub optional: bool,
}

/// Memory layout of a struct.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructLayout {
    /// Name of the struct.
    pub name: String,
    /// Size in bytes, padding included.
    pub size: u32,
    /// Members of the struct, in order.
    pub fields: Vec<FieldLayout>,
}

/// Memory layout of a struct member.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldLayout {
    /// Name of the member.
    pub name: String,
    /// Offset in bytes from the start of the struct.
    pub offset: u32,
    /// Size in bytes, without the padding that follows; one element for a runtime-sized array.
    pub size: u32,
}

impl ShaderModuleInfo {
    /// The entry point of that name.
    pub fn entry_point(&self, name: &str) -> Option<&EntryPoint> {
        self.entry_points.iter().find(|entry| entry.name == name)
    }

    /// The struct of that name.
    pub fn layout_of(&self, name: &str) -> Option<&StructLayout> {
        self.structs.iter().find(|layout| layout.name == name)
    }
}

/// The naga capabilities of a device with these optional features; `Features::empty()` gives the capabilities of every
/// device.
pub fn capabilities(features: wgpu::Features) -> Capabilities {
    let mut capabilities = Capabilities::CUBE_ARRAY_TEXTURES
        | Capabilities::MULTISAMPLED_SHADING
        | Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    capabilities.set(
        Capabilities::PRIMITIVE_INDEX,
        features.contains(wgpu::Features::PRIMITIVE_INDEX),
    );
    capabilities.set(
        Capabilities::RAY_QUERY,
        features.contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY),
    );
    capabilities
}

/// Validates a parsed shader, and lists its bindings, entry points, overrides, functions and structs. Needs no GPU.
///
/// # Errors
/// The first validation error, at the line in the shader's source file.
pub fn check(
    source: &ShaderSource,
    module: &Module,
    capabilities: Capabilities,
) -> Result<ShaderModuleInfo, ShaderError> {
    declared(source, module, capabilities).map(|(declared, _)| declared)
}

/// Validates the code of a parsed shader that is left under some values of its boolean overrides, and lists the
/// bindings, entry points and overrides of that code. Needs no GPU.
///
/// # Errors
/// The first validation error, at the line in the shader's source file.
pub fn check_part(
    source: &ShaderSource,
    module: &Module,
    capabilities: Capabilities,
    constants: &[(&str, f64)],
) -> Result<ShaderModuleInfo, ShaderError> {
    check(source, &pruned(module, constants), capabilities)
}

/// Parses a shader.
///
/// # Errors
/// The first syntax or type error, at the line in the shader's source file.
pub fn parse(source: &ShaderSource) -> Result<Module, ShaderError> {
    wgsl::parse_str(&source.text).map_err(|error| parse_error(source, &error))
}

/// Declarations of a parsed shader or a part of it, and the results of its validation.
///
/// # Errors
/// The first validation error, at the line in the shader's source file.
pub(super) fn declared(
    source: &ShaderSource,
    module: &Module,
    capabilities: Capabilities,
) -> Result<(ShaderModuleInfo, ModuleInfo), ShaderError> {
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(module)
        .map_err(|error| validation_error(source, &error))?;
    let mut layouter = Layouter::default();
    layouter
        .update(module.to_ctx())
        .map_err(|error| ShaderError::new(&source.file, error.to_string()))?;
    let declared = Reflection {
        source,
        module,
        info: &info,
        layouter: &layouter,
    }
    .reflect()?;
    Ok((declared, info))
}

/// Builder of a [`ShaderModuleInfo`] from a validated module.
struct Reflection<'a> {
    source: &'a ShaderSource,
    module: &'a Module,
    info: &'a ModuleInfo,
    layouter: &'a Layouter,
}

impl Reflection<'_> {
    fn reflect(&self) -> Result<ShaderModuleInfo, ShaderError> {
        let mut entry_points = Vec::new();
        for entry in &self.module.entry_points {
            entry_points.push(EntryPoint {
                name: entry.name.clone(),
                stage: stage_of(entry.stage).ok_or_else(|| {
                    let message = format!("entry point `{}` has an unsupported stage", entry.name);
                    ShaderError::new(&self.source.file, message)
                })?,
                workgroup_size: entry.workgroup_size,
            });
        }
        let overrides = self.module.overrides.iter().map(|(_, value)| {
            let name = value.name.clone().unwrap_or_default();
            Override {
                key: value.id.map_or(name.clone(), |id| id.to_string()),
                name,
                optional: value.init.is_some(),
            }
        });
        let functions = self.module.functions.iter();
        Ok(ShaderModuleInfo {
            name: self.source.name.clone(),
            file: self.source.file.clone(),
            bindings: self.bindings(&entry_points)?,
            entry_points,
            overrides: overrides.collect(),
            functions: functions.filter_map(|(_, f)| f.name.clone()).collect(),
            structs: self.structs(),
        })
    }

    fn structs(&self) -> Vec<StructLayout> {
        let types = self.module.types.iter();
        types
            .filter_map(|(_, ty)| match (&ty.name, &ty.inner) {
                (Some(name), TypeInner::Struct { members, span }) => Some(StructLayout {
                    name: name.clone(),
                    size: *span,
                    fields: members
                        .iter()
                        .map(|member| FieldLayout {
                            name: member.name.clone().unwrap_or_default(),
                            offset: member.offset,
                            size: self.layouter[member.ty].size,
                        })
                        .collect(),
                }),
                _ => None,
            })
            .collect()
    }

    fn bindings(&self, entry_points: &[EntryPoint]) -> Result<Vec<Binding>, ShaderError> {
        let mut bindings = Vec::new();
        for (handle, global) in self.module.global_variables.iter() {
            let Some(slot) = global.binding else { continue };
            let name = global.name.clone().unwrap_or_default();
            let users = entry_points.iter().enumerate();
            let users: Vec<&EntryPoint> = users
                .filter(|(index, _)| !self.info.get_entry_point(*index)[handle].is_empty())
                .map(|(_, entry)| entry)
                .collect();
            let visibility = users
                .iter()
                .fold(wgpu::ShaderStages::NONE, |all, entry| all | entry.stage);
            if visibility.is_empty() {
                continue;
            }
            let span = self.module.global_variables.get_span(handle);
            let at = span.to_range().and_then(|range| self.source.locate(range));
            let ty = self.binding_type(handle).map_err(|message| ShaderError {
                location: at.clone(),
                ..ShaderError::new(&self.source.file, format!("`{name}`: {message}"))
            })?;
            bindings.push(Binding {
                group: slot.group,
                binding: slot.binding,
                name,
                ty,
                visibility,
                entry_points: users.iter().map(|entry| entry.name.clone()).collect(),
                declared_at: at.map_or_else(
                    || self.source.file.to_string(),
                    |at| format!("{}:{}", at.file, at.line),
                ),
            });
        }
        bindings.sort_by_key(|binding| (binding.group, binding.binding));
        Ok(bindings)
    }

    fn binding_type(
        &self,
        handle: Handle<naga::GlobalVariable>,
    ) -> Result<wgpu::BindingType, String> {
        let global = &self.module.global_variables[handle];
        let buffer = |ty| wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(self.layouter[global.ty].size.into()),
        };
        match (global.space, &self.module.types[global.ty].inner) {
            (AddressSpace::Uniform, _) => Ok(buffer(wgpu::BufferBindingType::Uniform)),
            (AddressSpace::Storage { access }, _) => Ok(buffer(wgpu::BufferBindingType::Storage {
                read_only: !access.contains(StorageAccess::STORE),
            })),
            (_, &TypeInner::Sampler { comparison }) => Ok(wgpu::BindingType::Sampler(
                self.sampler_type(handle, comparison),
            )),
            (
                _,
                &TypeInner::Image {
                    dim,
                    arrayed,
                    class,
                },
            ) => self.texture_type(handle, view_dimension(dim, arrayed), class),
            (_, &TypeInner::AccelerationStructure { vertex_return }) => {
                Ok(wgpu::BindingType::AccelerationStructure { vertex_return })
            }
            _ => Err("this kind of resource is not supported".to_owned()),
        }
    }

    fn texture_type(
        &self,
        handle: Handle<naga::GlobalVariable>,
        view_dimension: wgpu::TextureViewDimension,
        class: ImageClass,
    ) -> Result<wgpu::BindingType, String> {
        let sampled = |sample_type, multisampled| wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled,
        };
        match class {
            ImageClass::Depth { multi } => Ok(sampled(wgpu::TextureSampleType::Depth, multi)),
            ImageClass::Sampled { kind, multi } => match kind {
                ScalarKind::Uint => Ok(sampled(wgpu::TextureSampleType::Uint, multi)),
                ScalarKind::Sint => Ok(sampled(wgpu::TextureSampleType::Sint, multi)),
                // Not filterable unless a sampler uses it: a texture that is only loaded may then have a format like
                // r32float.
                _ => Ok(sampled(
                    wgpu::TextureSampleType::Float {
                        filterable: self.pairs().any(|(image, _)| image == handle),
                    },
                    multi,
                )),
            },
            ImageClass::Storage { format, access } => Ok(wgpu::BindingType::StorageTexture {
                access: storage_access(access),
                format: storage_format(format)
                    .ok_or_else(|| format!("{format:?} is not a storage format of core WebGPU"))?,
                view_dimension,
            }),
            ImageClass::External => Err("external textures are not supported".to_owned()),
        }
    }

    /// A sampler filters unless it samples a depth texture without comparing, which WebGPU never filters.
    fn sampler_type(
        &self,
        handle: Handle<naga::GlobalVariable>,
        comparison: bool,
    ) -> wgpu::SamplerBindingType {
        let is_depth = |image: Handle<naga::GlobalVariable>| {
            let ty = self.module.global_variables[image].ty;
            matches!(
                self.module.types[ty].inner,
                TypeInner::Image {
                    class: ImageClass::Depth { .. },
                    ..
                }
            )
        };
        if comparison {
            wgpu::SamplerBindingType::Comparison
        } else if self
            .pairs()
            .any(|(image, s)| s == handle && is_depth(image))
        {
            wgpu::SamplerBindingType::NonFiltering
        } else {
            wgpu::SamplerBindingType::Filtering
        }
    }

    /// Every pair of texture and sampler that are used together.
    fn pairs(
        &self,
    ) -> impl Iterator<Item = (Handle<naga::GlobalVariable>, Handle<naga::GlobalVariable>)> {
        (0..self.module.entry_points.len())
            .flat_map(|index| &self.info.get_entry_point(index).sampling_set)
            .map(|key| (key.image, key.sampler))
    }
}

#[cfg(test)]
#[path = "reflect_tests.rs"]
mod tests;

pub(super) fn stage_of(stage: naga::ShaderStage) -> Option<wgpu::ShaderStages> {
    match stage {
        naga::ShaderStage::Vertex => Some(wgpu::ShaderStages::VERTEX),
        naga::ShaderStage::Fragment => Some(wgpu::ShaderStages::FRAGMENT),
        naga::ShaderStage::Compute => Some(wgpu::ShaderStages::COMPUTE),
        _ => None,
    }
}

pub(super) fn view_dimension(dim: ImageDimension, arrayed: bool) -> wgpu::TextureViewDimension {
    match (dim, arrayed) {
        (ImageDimension::D1, _) => wgpu::TextureViewDimension::D1,
        (ImageDimension::D2, false) => wgpu::TextureViewDimension::D2,
        (ImageDimension::D2, true) => wgpu::TextureViewDimension::D2Array,
        (ImageDimension::D3, _) => wgpu::TextureViewDimension::D3,
        (ImageDimension::Cube, false) => wgpu::TextureViewDimension::Cube,
        (ImageDimension::Cube, true) => wgpu::TextureViewDimension::CubeArray,
    }
}

pub(super) fn storage_access(access: StorageAccess) -> wgpu::StorageTextureAccess {
    match (
        access.contains(StorageAccess::LOAD),
        access.contains(StorageAccess::STORE),
    ) {
        (true, true) => wgpu::StorageTextureAccess::ReadWrite,
        (true, false) => wgpu::StorageTextureAccess::ReadOnly,
        _ => wgpu::StorageTextureAccess::WriteOnly,
    }
}

/// Storage formats that WebGPU guarantees.
pub(super) fn storage_format(format: StorageFormat) -> Option<wgpu::TextureFormat> {
    use StorageFormat as S;
    use wgpu::TextureFormat as T;
    Some(match format {
        S::Rgba8Unorm => T::Rgba8Unorm,
        S::Rgba8Snorm => T::Rgba8Snorm,
        S::Rgba8Uint => T::Rgba8Uint,
        S::Rgba8Sint => T::Rgba8Sint,
        S::Rgba16Uint => T::Rgba16Uint,
        S::Rgba16Sint => T::Rgba16Sint,
        S::Rgba16Float => T::Rgba16Float,
        S::R32Uint => T::R32Uint,
        S::R32Sint => T::R32Sint,
        S::R32Float => T::R32Float,
        S::Rg32Uint => T::Rg32Uint,
        S::Rg32Sint => T::Rg32Sint,
        S::Rg32Float => T::Rg32Float,
        S::Rgba32Uint => T::Rgba32Uint,
        S::Rgba32Sint => T::Rgba32Sint,
        S::Rgba32Float => T::Rgba32Float,
        _ => return None,
    })
}

/// Error for text that does not parse as WGSL.
pub fn parse_error(source: &ShaderSource, error: &wgsl::ParseError) -> ShaderError {
    let mut placed = at_first_place(source, error.message(), error.labels());
    placed.notes.extend(error.notes().map(str::to_owned));
    placed
}

/// Error for WGSL that does not validate.
pub fn validation_error(source: &ShaderSource, error: &WithSpan<ValidationError>) -> ShaderError {
    let mut message = error.as_inner().to_string();
    let mut cause = error.as_inner().source();
    while let Some(inner) = cause {
        message = format!("{message}: {inner}");
        cause = inner.source();
    }
    let labels = error.spans().map(|(span, label)| (*span, label.as_str()));
    at_first_place(source, &message, labels)
}

/// Error with naga's labels: the first label with a location gives the error's location, the others become notes.
fn at_first_place<'a>(
    source: &ShaderSource,
    message: &str,
    labels: impl Iterator<Item = (Span, &'a str)>,
) -> ShaderError {
    let mut error = ShaderError::new(&source.file, message);
    for (span, label) in labels {
        let place = span.to_range().and_then(|range| source.locate(range));
        let label = label.trim();
        match place {
            Some(place) if error.location.is_none() => {
                error.location = Some(place);
                if !label.is_empty() && !message.contains(label) {
                    error.notes.push(label.to_owned());
                }
            }
            Some(at) => {
                let at = format!("{}:{}:{}", at.file, at.line, at.column);
                error.notes.push(format!("{label} ({at})"));
            }
            None if label.is_empty() => {}
            None => error.notes.push(label.to_owned()),
        }
    }
    error
}
