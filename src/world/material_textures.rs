//! Textures of a material, and their numbers in the shaders.

/// A texture of materials in files of glTF.
pub struct FileTexture {
    /// Keys inside of a material, joined with `/`.
    pub path: &'static str,
    /// Whether it has colors, which are sRGB.
    pub is_color: bool,
    /// Key of scene text without which it has no effect; empty if it always has one.
    pub needs: &'static str,
}

/// Declares the textures of materials, each with its keys in a file, whether it has colors or other data, and the key
/// of scene text without which it has no effect.
macro_rules! textures {
    ($(
        $(#[$about:meta])*
        enum $name:ident {
            $($(#[$doc:meta])* $texture:ident: $kind:ident $path:literal, $needs:literal;)*
        }
    )*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub enum $name {
                $($(#[$doc])* $texture,)*
            }

            impl $name {
                /// All of them, in the order of [`Material::slots`](crate::Material::slots).
                pub const ALL: [Self; [$($path),*].len()] = [$(Self::$texture),*];
            }
        )*

        /// The textures in files, in the order of [`Material::slots`](crate::Material::slots).
        pub const FILE_TEXTURES: [FileTexture; TEXTURE_SLOTS] = [$($(FileTexture {
            path: $path,
            is_color: textures!($kind),
            needs: $needs,
        },)*)*];
    };
    (colors) => { true };
    (data) => { false };
}

textures! {
    /// Textures that every material may have.
    enum CoreTexture {
        /// Base color and alpha; sRGB.
        BaseColor: colors "pbrMetallicRoughness/baseColorTexture", "";
        /// Roughness in green, metalness in blue; linear.
        MetallicRoughness: data "pbrMetallicRoughness/metallicRoughnessTexture", "";
        /// Normal map; linear, tangent space.
        Normal: data "normalTexture", "";
        /// Ambient occlusion; linear, red channel.
        Occlusion: data "occlusionTexture", "";
        /// Emission; sRGB.
        Emission: colors "emissiveTexture", "";
    }

    /// Textures of the layers that glTF's extensions add to a material; most are multiplied by a factor.
    enum LayerTexture {
        /// Factor on the reflectivity; linear, alpha channel.
        Specular: data "extensions/KHR_materials_specular/specularTexture", "specular";
        /// Color factor on the reflectivity; sRGB.
        SpecularColor: colors "extensions/KHR_materials_specular/specularColorTexture", "specular_color";
        /// Color of the sheen; sRGB.
        SheenColor: colors "extensions/KHR_materials_sheen/sheenColorTexture", "sheen_color";
        /// Roughness of the sheen; linear, alpha channel.
        SheenRoughness: data "extensions/KHR_materials_sheen/sheenRoughnessTexture", "sheen_color";
        /// Transmission; linear, red channel.
        Transmission: data "extensions/KHR_materials_transmission/transmissionTexture", "transmission";
        /// Share of diffuse light that passes; linear, alpha channel.
        DiffuseTransmission: data "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture", "diffuse_transmission";
        /// Color of the diffuse light that passes; sRGB.
        DiffuseTransmissionColor: colors "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture", "diffuse_transmission";
        /// Strength of the clear coat; linear, red channel.
        Clearcoat: data "extensions/KHR_materials_clearcoat/clearcoatTexture", "clearcoat";
        /// Roughness of the clear coat; linear, green channel.
        ClearcoatRoughness: data "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture", "clearcoat";
        /// Normal map of the clear coat; linear, tangent space.
        ClearcoatNormal: data "extensions/KHR_materials_clearcoat/clearcoatNormalTexture", "clearcoat";
        /// Strength of the thin film; linear, red channel.
        Iridescence: data "extensions/KHR_materials_iridescence/iridescenceTexture", "iridescence";
        /// Thickness of the thin film; linear, green channel, from the least thickness to the largest.
        IridescenceThickness: data "extensions/KHR_materials_iridescence/iridescenceThicknessTexture", "iridescence";
        /// Anisotropy; linear, direction in red and green, strength in blue.
        Anisotropy: data "extensions/KHR_materials_anisotropy/anisotropyTexture", "anisotropy";
    }
}

/// Number of core textures, which every material may have.
pub const CORE_SLOTS: usize = CoreTexture::ALL.len();
/// Number of textures of layers, see [`LayerTexture`].
pub const LAYER_SLOTS: usize = LayerTexture::ALL.len();
/// Number of all textures of a material.
pub const TEXTURE_SLOTS: usize = CORE_SLOTS + LAYER_SLOTS;
