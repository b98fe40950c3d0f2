//! Cause and source of a pixel's reflection.

use reflet_scene::{desc::Method, words};

/// Bits of a texel of the target `cause` that hold the cause; the bits above hold the length of the ray that the march
/// has proven free.
pub const CAUSE_MASK: u32 = 0xFF;

/// Declares an enum of words, each with its color in pictures, sRGB.
macro_rules! colored {
    (
        $(#[$attribute:meta])*
        pub enum $name:ident {
            $(
                $(#[doc = $text:literal])*
                $variant:ident = $word:literal $(: $summary:literal)?, $color:expr;
            )*
        }
    ) => {
        words! {
            $(#[$attribute])*
            pub enum $name {
                $($(#[doc = $text])* $variant = $word $(: $summary)?,)*
            }
        }

        impl $name {
            /// Color in pictures, sRGB.
            pub const fn color(self) -> [u8; 3] {
                match self {
                    $(Self::$variant => $color,)*
                }
            }
        }
    };
}

colored! {
    /// Outcome of the screen-space march at one pixel. In shaders it is the constant `CAUSE_` with its name in
    /// capitals.
    #[repr(u32)]
    pub enum Cause {
        /// The pixel shows no surface, or one that does not reflect.
        NotReflective = "not_reflective", [24, 24, 24];
        /// The ray hit a surface that the picture shows, by the rule of `reflection.accept`.
        Hit = "hit", [70, 130, 255];
        /// The ray went behind a surface that the picture shows.
        Hidden = "hidden", [230, 60, 60];
        /// The ray hit a surface from behind.
        BackFace = "back_face", [250, 160, 40];
        /// The ray hit another reflector.
        Reflector = "reflector", [240, 220, 70];
        /// The ray left the picture.
        OffScreen = "off_screen", [250, 90, 200];
        /// The march ran out of steps.
        Steps = "steps", [150, 70, 220];
        /// The ray reached its maximum length without a hit.
        None = "none", [80, 200, 120];
        /// The surface is rougher than the cutoff.
        Rough = "rough", [130, 130, 130];
        /// The pixel was not marched: method `rt`.
        Unmarched = "unmarched", [255, 150, 200];
        /// The ray crossed a surface that a pixel shows, but no triangle or plane there confirms the hit.
        Unconfirmed = "unconfirmed", [170, 60, 40];
        /// The pixel was not marched: an orthographic camera sees surfaces edge-on, and no pixel shows these obstacles.
        EdgeOn = "edge_on", [0, 160, 170];
        /// The ray went behind the visible surfaces, and hit a surface of the second depth layer.
        HitBehind = "hit_behind", [170, 210, 255];
        /// Method `near-far`: the ray hit what the map of far things shows.
        Far = "far", [200, 190, 60];
        /// Method `near-far`: the ray went behind the surfaces of the map of far things, and hit none of them.
        FarHidden = "far_hidden", [110, 30, 90];
        /// Method `ssr+box`: the ray hit what a face of the box sees.
        Box = "box", [120, 140, 60];
        /// Method `ssr+box`: the ray hit nothing that a face sees, and leaves the box where the face across does not
        /// see out of it.
        BoxHidden = "box_hidden", [60, 20, 70];
    }
}

colored! {
    /// Source of a pixel's reflection, with its name for people. Its color has screen hits blue and traced ones pink,
    /// as in the paper's Fig. 8.
    pub enum Source {
        /// Not a reflective pixel.
        NotReflective = "not_reflective": "not reflective", [24, 24, 24];
        /// Screen-space hit.
        Screen = "screen": "screen", [60, 110, 255];
        /// Ray traced.
        Traced = "traced": "traced", [255, 110, 190];
        /// Method `ssr`: the pixel is left black where a ray would have been traced; `near-far` and `ssr+box`: it shows
        /// the environment where the maps do not show what the ray would hit.
        Failed = "failed": "failed", [200, 40, 40];
        /// The environment: the ray hits no surface within its length.
        None = "none": "environment", [80, 200, 120];
        /// The environment: the surface is too rough.
        Rough = "rough": "rough", [130, 130, 130];
        /// Looked up in probes.
        Probe = "probe": "probe", [150, 220, 60];
        /// Found in the map of far things.
        Far = "far": "far map", [200, 190, 60];
        /// Found on a face of the box.
        Box = "box": "face of the box", [120, 140, 60];
    }
}

impl Source {
    /// Whether the reflection is found in maps of a method: these sources come after all others.
    pub const fn is_map(self) -> bool {
        self as u32 > Self::Rough as u32
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

    /// Whether rays that march through maps end with this cause, rather than by a hit of the trees.
    pub fn is_end_in_maps(self) -> bool {
        match self.source(Method::Hybrid) {
            Source::None | Source::Failed => true,
            source => source.is_map(),
        }
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
}
