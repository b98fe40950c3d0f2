//! Why a pixel's reflection is what it is, and where it came from.

use serde::Serialize;

use crate::scene::desc::Method;

/// The outcome of the screen-space march at one pixel. The shaders know it as `CAUSE_` and its name
/// in capitals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(u32)]
pub enum Cause {
    /// Nothing there, or nothing that reflects.
    NotReflective = 0,
    /// Met a surface that the picture shows, by the rule of `reflection.accept`.
    Hit = 1,
    /// Went behind what the picture shows.
    Hidden = 2,
    /// Met a surface from behind.
    BackFace = 3,
    /// Met another reflector.
    Reflector = 4,
    /// Left the picture.
    OffScreen = 5,
    /// Ran out of steps.
    Steps = 6,
    /// Reached its length without meeting anything.
    None = 7,
    /// Rougher than the cut-off.
    Rough = 8,
    /// Method `rt`: was not marched.
    Unmarched = 9,
    /// Crossed what a pixel shows, but neither a triangle nor a plane there confirms it.
    Unconfirmed = 10,
    /// Was not marched: an orthographic camera sees surfaces edge-on, so no pixel shows what is in its way.
    EdgeOn = 11,
}

/// Where a pixel's reflection came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Not a reflective pixel.
    NotReflective,
    /// Found on screen.
    Screen,
    /// Ray traced.
    Traced,
    /// Method `ssr`: left black where a ray would have been traced.
    Failed,
    /// The environment: nothing in reach.
    None,
    /// The environment: too rough.
    Rough,
}

impl Cause {
    /// All causes; the index is the number.
    pub const ALL: [Self; 12] = [
        Self::NotReflective,
        Self::Hit,
        Self::Hidden,
        Self::BackFace,
        Self::Reflector,
        Self::OffScreen,
        Self::Steps,
        Self::None,
        Self::Rough,
        Self::Unmarched,
        Self::Unconfirmed,
        Self::EdgeOn,
    ];

    /// The cause of a texel of the `cause` target, whose upper bits hold what the march has proven
    /// free.
    pub const fn number_in(texel: u32) -> u32 {
        texel & 0xFF
    }

    /// The cause with this number.
    pub fn from_number(number: u32) -> Option<Self> {
        Self::ALL.get(number as usize).copied()
    }

    /// Name in reports and file names.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotReflective => "not_reflective",
            Self::Hit => "hit",
            Self::Hidden => "hidden",
            Self::BackFace => "back_face",
            Self::Reflector => "reflector",
            Self::OffScreen => "off_screen",
            Self::Steps => "steps",
            Self::None => "none",
            Self::Rough => "rough",
            Self::Unmarched => "unmarched",
            Self::Unconfirmed => "unconfirmed",
            Self::EdgeOn => "edge_on",
        }
    }

    /// Whether such a pixel shows its mirror direction, from wherever it is known.
    pub fn reflects(self) -> bool {
        !matches!(self, Self::NotReflective | Self::Rough)
    }

    /// A bit for the number of each cause that `is_in` says.
    pub fn mask(is_in: impl Fn(Self) -> bool) -> u32 {
        let all = Self::ALL.into_iter().filter(|cause| is_in(*cause));
        all.fold(0, |mask, cause| mask | 1 << cause as u32)
    }

    /// Where such a pixel's reflection comes from with this method.
    pub const fn source(self, method: Method) -> Source {
        match self {
            Self::NotReflective => Source::NotReflective,
            Self::Hit => Source::Screen,
            Self::None => Source::None,
            Self::Rough => Source::Rough,
            _ if matches!(method, Method::Ssr) => Source::Failed,
            _ => Source::Traced,
        }
    }

    /// Color in the `cause` picture, sRGB.
    pub const fn color(self) -> [u8; 3] {
        match self {
            Self::NotReflective => [24, 24, 24],
            Self::Hit => [70, 130, 255],
            Self::Hidden => [230, 60, 60],
            Self::BackFace => [250, 160, 40],
            Self::Reflector => [240, 220, 70],
            Self::OffScreen => [250, 90, 200],
            Self::Steps => [150, 70, 220],
            Self::None => [80, 200, 120],
            Self::Rough => [130, 130, 130],
            Self::Unmarched => [255, 150, 200],
            Self::Unconfirmed => [170, 60, 40],
            Self::EdgeOn => [0, 160, 170],
        }
    }
}

impl Source {
    /// All sources; the index is the number in AOVs.
    pub const ALL: [Self; 6] = [
        Self::NotReflective,
        Self::Screen,
        Self::Traced,
        Self::Failed,
        Self::None,
        Self::Rough,
    ];

    /// Color in the `source` picture, sRGB: screen hits blue and traced pink, as in the paper's Fig. 8.
    pub const fn color(self) -> [u8; 3] {
        match self {
            Self::NotReflective => [24, 24, 24],
            Self::Screen => [60, 110, 255],
            Self::Traced => [255, 110, 190],
            Self::Failed => [200, 40, 40],
            Self::None => [80, 200, 120],
            Self::Rough => [130, 130, 130],
        }
    }
}
