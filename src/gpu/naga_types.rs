//! Conversion of naga types to wgpu types.

use naga::{ImageDimension, StorageAccess, StorageFormat};

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
