//! Cause and source of a pixel's reflection.

use serde::Serialize;

use reflet_scene::{desc::Method, words};

/// Bits of a texel of the target `cause` that hold the cause; the bits above hold the length of the ray that the march
/// has proven free.
pub const CAUSE_MASK: u32 = 0xFF;

words! {
    /// Outcome of the screen-space march at one pixel. In shaders it is the constant `CAUSE_` with its name in capitals.
    #[derive(Serialize)]
    #[serde(rename_all = "snake_case")]
    #[repr(u32)]
    pub enum Cause {
        /// The pixel shows no surface, or one that does not reflect.
        NotReflective = "not_reflective",
        /// The ray hit a surface that the picture shows, by the rule of `reflection.accept`.
        Hit = "hit",
        /// The ray went behind a surface that the picture shows.
        Hidden = "hidden",
        /// The ray hit a surface from behind.
        BackFace = "back_face",
        /// The ray hit another reflector.
        Reflector = "reflector",
        /// The ray left the picture.
        OffScreen = "off_screen",
        /// The march ran out of steps.
        Steps = "steps",
        /// The ray reached its maximum length without a hit.
        None = "none",
        /// The surface is rougher than the cutoff.
        Rough = "rough",
        /// The pixel was not marched: method `rt`.
        Unmarched = "unmarched",
        /// The ray crossed a surface that a pixel shows, but no triangle or plane there confirms the hit.
        Unconfirmed = "unconfirmed",
        /// The pixel was not marched: an orthographic camera sees surfaces edge-on, and no pixel shows these obstacles.
        EdgeOn = "edge_on",
        /// The ray went behind the visible surfaces, and hit a surface of the second depth layer.
        HitBehind = "hit_behind",
        /// Method `near-far`: the ray hit what the map of far things shows.
        Far = "far",
        /// Method `near-far`: the ray went behind the surfaces of the map of far things, and hit none of them.
        FarHidden = "far_hidden",
        /// Method `ssr+box`: the ray hit what a face of the box sees.
        Box = "box",
        /// Method `ssr+box`: the ray hit nothing that a face sees, and leaves the box where the face across does not see out
        /// of it.
        BoxHidden = "box_hidden",
    }
}

words! {
    /// Source of a pixel's reflection.
    #[derive(Serialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Source {
        /// Not a reflective pixel.
        NotReflective = "not_reflective",
        /// Screen-space hit.
        Screen = "screen",
        /// Ray traced.
        Traced = "traced",
        /// Method `ssr`: the pixel is left black where a ray would have been traced; `near-far` and `ssr+box`: it shows the
        /// environment where the maps do not show what the ray would hit.
        Failed = "failed",
        /// The environment: the ray hits no surface within its length.
        None = "none",
        /// The environment: the surface is too rough.
        Rough = "rough",
        /// Looked up in probes.
        Probe = "probe",
        /// Found in the map of far things.
        Far = "far",
        /// Found on a face of the box.
        Box = "box",
    }
}

impl Cause {
    /// Number of the cause in a texel of the `cause` target, whose upper bits hold the ray length that the march has
    /// proven free.
    pub const fn number_in(texel: u32) -> u32 {
        texel & CAUSE_MASK
    }

    /// The cause with this number.
    pub fn from_number(number: u32) -> Option<Self> {
        Self::ALL.get(number as usize).copied()
    }

    /// Whether a pixel of this cause shows a reflection along its mirror direction, from whichever source.
    pub fn reflects(self) -> bool {
        !matches!(self, Self::NotReflective | Self::Rough)
    }

    /// Bit mask of the numbers of all causes for which `is_in` is true.
    pub fn mask(is_in: impl Fn(Self) -> bool) -> u32 {
        let all = Self::ALL.into_iter().filter(|cause| is_in(*cause));
        all.fold(0, |mask, cause| mask | 1 << cause as u32)
    }

    /// Source of the reflection at a pixel of this cause, with this method.
    pub const fn source(self, method: Method) -> Source {
        match self {
            Self::NotReflective => Source::NotReflective,
            Self::Hit | Self::HitBehind => Source::Screen,
            Self::None => Source::None,
            Self::Rough => Source::Rough,
            Self::Far => Source::Far,
            Self::Box => Source::Box,
            Self::FarHidden | Self::BoxHidden => Source::Failed,
            _ if matches!(method, Method::Ssr) => Source::Failed,
            _ if method.looks_up() => Source::Probe,
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
            Self::HitBehind => [170, 210, 255],
            Self::Far => [200, 190, 60],
            Self::FarHidden => [110, 30, 90],
            Self::Box => [120, 140, 60],
            Self::BoxHidden => [60, 20, 70],
        }
    }
}

impl Source {
    /// Color in the `source` picture, sRGB: screen hits blue and traced pink, as in the paper's Fig. 8.
    pub const fn color(self) -> [u8; 3] {
        match self {
            Self::NotReflective => [24, 24, 24],
            Self::Screen => [60, 110, 255],
            Self::Traced => [255, 110, 190],
            Self::Probe => [150, 220, 60],
            Self::Far => [200, 190, 60],
            Self::Box => [120, 140, 60],
            Self::Failed => [200, 40, 40],
            Self::None => [80, 200, 120],
            Self::Rough => [130, 130, 130],
        }
    }
}
