//! Procedural patterns of scene text: of two colors, and of any number or color of a material.

use glam::Vec3;

/// `checker = { colors = [[…], […]], size_m = 0.5 }`: a checkerboard of two colors, aligned with the object's
/// axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckerDesc {
    /// Linear colors of the two kinds of cells, each three numbers 0 to 1.
    pub colors: [Vec3; 2],
    /// Edge length of one cell, meters in object space, above 0.
    pub size_m: f32,
    /// Kind of the pattern.
    pub kind: PatternKind,
}

/// Procedural patterns of two colors or two numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PatternKind {
    /// `"checker"`: cubes of both colors in turn.
    #[default]
    Checker,
    /// `"brick"`: bricks in a running bond, of the first color, with mortar of the second; a brick is `size_m`
    /// long along X, a third of that high along Y, and half of it deep along Z.
    Brick,
    /// `"noise"`: clouds, about `size_m` wide.
    Noise,
    /// `"marble"`: bent veins across X, two `size_m` apart.
    Marble,
    /// `"stripes"`: bands across X, of both colors in turn, each `size_m` wide.
    Stripes,
    /// `"gradient"`: from the first color at 0 along X to the second at `size_m`, and constant beyond.
    Gradient,
    /// `"dots"`: disks of the second color on the first, with centers `size_m` apart and 0.6 `size_m` wide, on the
    /// faces along which the surface lies.
    Dots,
}

impl PatternKind {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Checker,
        Self::Brick,
        Self::Noise,
        Self::Marble,
        Self::Stripes,
        Self::Gradient,
        Self::Dots,
    ];

    /// Name of the pattern in scene text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Checker => "checker",
            Self::Brick => "brick",
            Self::Noise => "noise",
            Self::Marble => "marble",
            Self::Stripes => "stripes",
            Self::Gradient => "gradient",
            Self::Dots => "dots",
        }
    }
}

/// `pattern = { kind = "brick", colors = [[…], […]], size_m = 0.25 }`: a procedural pattern of two colors, aligned
/// with the object's axes. Detail finer than a pixel shows its mean color.
///
/// - `kind`: kind of the pattern. Default `"checker"`.
/// - `colors`: linear colors of the two parts of the pattern, each three numbers 0 to 1.
/// - `size_m`: size of one cell, brick or cloud, meters in object space, above 0.
pub struct PatternDesc;

/// `roughness = { pattern = "noise", from = 0.1, to = 0.6, size_m = 0.2 }`: a number of a material that varies over the
/// surface, in object space, between two values. Textures multiply it. Detail finer than a pixel shows its mean.
///
/// - `pattern`: kind of the pattern.
/// - `from`: value of the first part of the pattern, in the range of the number.
/// - `to`: value of the second part of the pattern, in the range of the number.
/// - `size_m`: size of one cell, brick, band or cloud, meters in object space, above 0.
/// - `axis`: direction of the pattern's own X, three numbers, not all 0; its Y and Z turn with it by the smallest
///   rotation. Default [1, 0, 0].
/// - `offset_m`: place of the pattern's origin, meters in object space, three numbers. Default [0, 0, 0].
pub struct NumberPatternDesc;

/// `base_color = { pattern = "noise", from = "#803010", to = "#e0e0e0", size_m = 0.2 }`: as a number that follows a
/// pattern, with two colors.
///
/// - `pattern`: kind of the pattern.
/// - `from`: color of the first part of the pattern, linear, or sRGB text, in the range of the color.
/// - `to`: color of the second part of the pattern, linear, or sRGB text, in the range of the color.
/// - `size_m`: size of one cell, brick, band or cloud, meters in object space, above 0.
/// - `axis`: direction of the pattern's own X, three numbers, not all 0; its Y and Z turn with it by the smallest
///   rotation. Default [1, 0, 0].
/// - `offset_m`: place of the pattern's origin, meters in object space, three numbers. Default [0, 0, 0].
pub struct ColorPatternDesc;

/// Declares the numbers and colors of a material that may follow a pattern, each with its key.
macro_rules! patterned {
    ($($name:ident $key:literal),* $(,)?) => {
        /// A number or color of a material that may follow a pattern.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum PatternedKey {
            $(#[doc = concat!("Key `", $key, "`.")] $name,)*
        }

        impl PatternedKey {
            /// All of them.
            pub const ALL: [Self; [$($key),*].len()] = [$(Self::$name),*];

            /// Key in scene text.
            pub const fn key(self) -> &'static str {
                match self {
                    $(Self::$name => $key,)*
                }
            }
        }
    };
}
patterned! {
    BaseColor "base_color",
    Metallic "metallic",
    Roughness "roughness",
    Emission "emission",
    Alpha "alpha",
    Reflectivity "reflectivity",
    Transmission "transmission",
    Clearcoat "clearcoat",
    ClearcoatRoughness "clearcoat_roughness",
    Specular "specular",
    SpecularColor "specular_color",
    SheenColor "sheen_color",
    SheenRoughness "sheen_roughness",
    Iridescence "iridescence",
    IridescenceThickness "iridescence_thickness_nm",
    Anisotropy "anisotropy",
}

/// Largest number of values of one material that follow patterns.
pub const MOST_PATTERNED: usize = 6;

/// A number or color of a material that follows a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternedDesc {
    /// Number or color that varies.
    pub value: PatternedKey,
    /// Kind of the pattern.
    pub kind: PatternKind,
    /// Value of its first part; a number is in all three components.
    pub from: Vec3,
    /// Value of its second part.
    pub to: Vec3,
    /// Size of one cell, meters in object space, above 0.
    pub size_m: f32,
    /// Direction of the pattern's X in object space, unit length.
    pub axis: Vec3,
    /// Origin of the pattern in object space, meters.
    pub offset_m: Vec3,
}
