//! `[image]`: size, sampling, exposure.

/// How linear radiance becomes display color.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ToneMap {
    /// `"none"`: clipped at 1.
    None,
    /// `"neutral"`: Khronos PBR Neutral, which keeps base colors.
    #[default]
    Neutral,
    /// `"aces"`: a filmic curve (Narkowicz's fit of ACES).
    Aces,
    /// `"agx"`: a filmic curve that turns bright colors pale (Sobotka's AgX, Wrensch's fit).
    Agx,
}

/// How bright the picture is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// Stops: +1 doubles the brightness.
    Ev(f32),
    /// Chosen at load, for what the camera sees in the first frame.
    Auto,
}

impl Exposure {
    /// Stops; 0 where they are not chosen yet.
    pub fn ev(self) -> f32 {
        match self {
            Self::Ev(ev) => ev,
            Self::Auto => 0.0,
        }
    }
}

/// How the surface that each pixel shows is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Visibility {
    /// `"raster"`: all triangles are drawn.
    Raster,
    /// `"rays"`: a ray a pixel through the trees; cheaper in small pictures of many triangles.
    Rays,
    /// `"auto"`: the one that a cost model expects to take less time; `raster` where nothing else
    /// follows rays.
    #[default]
    Auto,
}

/// How many bits keep the light of a frame until it is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Radiance {
    /// `"half"`: 16 a channel, which end at 65,504 and are coarse below 0.0001.
    Half,
    /// `"full"`: 32 a channel; takes more memory, and time to write it.
    Full,
    /// `"auto"`: 32 where something shines or is lit brighter than 16,384, or where the exposure shows
    /// the dark of less than 1/32.
    #[default]
    Auto,
}

/// `[image]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageDesc {
    /// Width and height in pixels, each 1 to 16384. Default [1280, 720].
    pub size: [u32; 2],
    /// Sub-frames averaged per picture, 1 to 4096. More smooths edges. Default 1.
    pub samples: u32,
    /// Rays that every pixel of a sub-frame sends towards lamps with a size, each to one of them by how much it may
    /// light, towards suns with a size likewise, towards an environment with `shadow = "ray"` or a `file`, and
    /// towards all surfaces with `light = true` together, 1 to 256. More is less grainy, and takes longer; `samples`
    /// multiplies it. Default 4 with 1 sample, 2 with 2 or 3, else 1.
    pub light_rays: Option<u32>,
    /// Exposure in stops, -20 to 20; +1 doubles the brightness. `"auto"` shows the brightest tenth of
    /// the first frame as light gray or brighter, and keeps that for all frames; `reflet info` says the
    /// number. Default 0.
    pub exposure_ev: Exposure,
    /// How radiance becomes display color; EXR output is never tone-mapped. Default `"neutral"`.
    pub tone_map: ToneMap,
    /// How the surface that each pixel shows is found. Pictures differ only by
    /// rounding: at edges of triangles, and where surfaces lie in each other. Default `"auto"`.
    pub visibility: Visibility,
    /// How many bits keep the light of a frame until it is shown, or written as EXR. Brighter light than
    /// they hold is cut. Default `"auto"`.
    pub radiance: Radiance,
    /// Whether the background is transparent: PNG and EXR files get alpha, the share of each pixel that shows
    /// something (EXR: linear radiance is multiplied by it; PNG: colors are not). The environment still lights the
    /// scene and shows in reflections, but is not seen itself. Glass counts as something, blended alpha by its share. Films stay opaque. Default false.
    pub alpha: bool,
    /// How long the shutter is open around the moment of a frame, in frames, 0 to 1: 0.5 is the 180 degrees of
    /// film. Tracks, animations of files, and scripts that use `ctx.t` move while it is open, one moment a
    /// sub-frame, so it takes many `samples`; the preview shows it where the view rests. Default 0.
    pub shutter: f32,
}

impl ImageDesc {
    /// Rays of a pixel and sub-frame towards each kind of what is sampled.
    pub fn light_rays(&self) -> u32 {
        let default = 4_u32.div_ceil(self.samples.max(1));
        self.light_rays.unwrap_or(default)
    }
}

impl Default for ImageDesc {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            samples: 1,
            light_rays: None,
            exposure_ev: Exposure::Ev(0.0),
            tone_map: ToneMap::Neutral,
            visibility: Visibility::Auto,
            radiance: Radiance::Auto,
            alpha: false,
            shutter: 0.0,
        }
    }
}
