//! Textures of a material, and their numbers in the shaders.

/// Number of core textures, which every material may have.
pub const CORE_SLOTS: usize = 5;
/// Number of textures of layers, see [`LayerTexture`].
pub const LAYER_SLOTS: usize = 11;
/// Number of all textures of a material.
pub const TEXTURE_SLOTS: usize = CORE_SLOTS + LAYER_SLOTS;

/// Textures that every material may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoreTexture {
    /// Base color and alpha; sRGB.
    BaseColor,
    /// Roughness in green, metalness in blue; linear.
    MetallicRoughness,
    /// Normal map; linear, tangent space.
    Normal,
    /// Ambient occlusion; linear, red channel.
    Occlusion,
    /// Emission; sRGB.
    Emission,
}

impl CoreTexture {
    /// All core textures, in the order of [`Material::slots`](crate::Material::slots).
    pub const ALL: [Self; CORE_SLOTS] = [
        Self::BaseColor,
        Self::MetallicRoughness,
        Self::Normal,
        Self::Occlusion,
        Self::Emission,
    ];
}

/// Textures of the layers that glTF's extensions add to a material; most are multiplied by a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerTexture {
    /// Factor on the reflectivity; linear, alpha channel.
    Specular,
    /// Color factor on the reflectivity; sRGB.
    SpecularColor,
    /// Color of the sheen; sRGB.
    SheenColor,
    /// Roughness of the sheen; linear, alpha channel.
    SheenRoughness,
    /// Transmission; linear, red channel.
    Transmission,
    /// Strength of the clear coat; linear, red channel.
    Clearcoat,
    /// Roughness of the clear coat; linear, green channel.
    ClearcoatRoughness,
    /// Normal map of the clear coat; linear, tangent space.
    ClearcoatNormal,
    /// Strength of the thin film; linear, red channel.
    Iridescence,
    /// Thickness of the thin film; linear, green channel, from the least thickness to the largest.
    IridescenceThickness,
    /// Anisotropy; linear, direction in red and green, strength in blue.
    Anisotropy,
}

impl LayerTexture {
    /// All textures of layers, in the order of [`Material::layer_textures`](crate::Material::layer_textures).
    pub const ALL: [Self; LAYER_SLOTS] = [
        Self::Specular,
        Self::SpecularColor,
        Self::SheenColor,
        Self::SheenRoughness,
        Self::Transmission,
        Self::Clearcoat,
        Self::ClearcoatRoughness,
        Self::ClearcoatNormal,
        Self::Iridescence,
        Self::IridescenceThickness,
        Self::Anisotropy,
    ];
}
