//! Options of a renderer.

use std::fmt;

use super::pixel_share::needs_moments;
use reflet_scene::desc::{ImageDesc, Method, ReflectionDesc, SceneDesc, ShadowMode};
use reflet_world::{Light, World};

/// Options of a renderer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// Reflection settings.
    pub reflection: ReflectionDesc,
    /// Picture size, number of sub-frames, exposure and tone mapping.
    pub image: ImageDesc,
    /// Lights, a bit for each by its index in [`World::lights`], whose maps shadow rays stand in for: where light may pass
    /// something that casts a shadow, which the one depth of a texel cannot tell, and where a decision chose rays.
    pub rays_for_maps: u64,
    /// Index of the camera whose view decides `auto` settings; `None` for [`World::main_camera`].
    pub camera: Option<usize>,
    /// Smaller picture to render with the decisions of the whole one; `None` renders the whole.
    pub draft: Option<Draft>,
    /// Part of the picture that is shown; outside of it, what is not needed there is left out, and the picture is
    /// undefined.
    pub crop: Option<Crop>,
    /// Whether to trace rays for some of the screen hits, for `audit` in the statistics.
    pub audit: bool,
    /// Whether to sum guides for a denoiser.
    pub guides: bool,
    /// Whether to drop no features, to compare with the planned frame.
    pub general: bool,
}

/// A smaller picture of fewer sub-frames with the decisions of the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draft {
    /// Size, pixels.
    pub size: [u32; 2],
    /// Sub-frames, 1 or more.
    pub samples: u32,
}

/// Number of sub-frames up to which rough reflections and indirect light are smoothed as far as one sub-frame is.
const FEW_SAMPLES: u32 = 16;

/// Number of sub-frames from which samples alone are smooth.
const ENOUGH_SAMPLES: u32 = 256;

/// Greatest number of sub-frames that share the taps of one, as each turns them differently.
const SHARED_TAPS: u32 = 4;

/// Distance that light is smoothed over at most, as a share of the picture's height, by all steps of a pass.
pub const SMOOTHED_OVER: f32 = 0.4;

/// Distance within which a pass looks for the radius of its steps, pixels.
const LOOKED_OVER_PX: f32 = 24.0;

/// Rectangle of pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Left and top edge, pixels from the left and from the top.
    pub at: [u32; 2],
    /// Width and height, pixels, 1 or more.
    pub size: [u32; 2],
}

impl Crop {
    /// Whether it lies inside of a picture of this size.
    pub fn is_in(&self, size: [u32; 2]) -> bool {
        let end = |axis: usize| self.at[axis].checked_add(self.size[axis]);
        [0, 1]
            .into_iter()
            .all(|axis| self.size[axis] > 0 && end(axis).is_some_and(|end| end <= size[axis]))
    }
}

/// Left and top edge, width and height, as on a command line.
impl fmt::Display for Crop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([x, y], [width, height]) = (self.at, self.size);
        write!(f, "{x},{y},{width},{height}")
    }
}

/// Refuses a picture of such a width and height, pixels.
///
/// # Errors
/// Message with the range.
pub fn check_size(size: [u32; 2]) -> Result<(), String> {
    match size.iter().all(|side| (1..=16384).contains(side)) {
        true => Ok(()),
        false => Err("each side must be 1 to 16384 pixels".to_owned()),
    }
}

impl RenderOptions {
    /// The length U of a world in these options, meters.
    pub fn unit_m(&self, world: &World) -> f32 {
        (self.reflection.unit_m).unwrap_or_else(|| world.unit_m())
    }

    /// Options of a scene, with unused features dropped.
    pub fn for_scene(desc: &SceneDesc) -> Self {
        Self {
            reflection: desc.reflection,
            image: desc.image,
            ..Self::default()
        }
    }

    /// The options with the settings that the method implies.
    pub fn settled(&self) -> Self {
        Self {
            reflection: self.reflection.settled(),
            ..*self
        }
    }

    /// Whether pixels of one sub-frame show different moments of an open shutter.
    pub fn has_moments(&self) -> bool {
        self.image.shutter > 0.0 && needs_moments(self.image.samples.count())
    }

    /// Whether rough reflections and indirect light are smoothed over neighbors. A denoiser cleans more than few samples
    /// better than smoothed ones, whose grain is as wide as details.
    pub fn smooths(&self) -> bool {
        let is_denoised = self.guides && self.image.samples.count() >= FEW_SAMPLES;
        self.reflection.filter && !is_denoised && self.smoothing() > 0.0
    }

    /// Share of its whole radius by which light is smoothed. It shrinks with the octaves of sub-frames past few of them,
    /// ever faster: the gain of smoothing falls with each, its own error does not.
    pub fn smoothing(&self) -> f32 {
        let octaves = |count: u32| (count.max(FEW_SAMPLES) as f32 / FEW_SAMPLES as f32).log2();
        let share = octaves(self.image.samples.count()) / octaves(ENOUGH_SAMPLES);
        (1.0 - share * share).max(0.0)
    }

    /// Number of taps of one sub-frame of this picture, where a picture of one has `whole`.
    pub fn taps(&self, whole: u32) -> u32 {
        whole.div_ceil((self.image.samples.count() / FEW_SAMPLES).clamp(1, SHARED_TAPS))
    }

    /// Whether light outside of the crop and its surroundings is left out. Pixels inside need none of it unless it is
    /// blurred over neighbors, or they reuse the light of the pixels that screen hits are shown at.
    pub fn leaves_out_light(&self) -> bool {
        let reflection = &self.reflection;
        let has_hits = reflection.method.marches() || reflection.method.looks_up();
        let shares = reflection.blur_px > 0.0 || reflection.reuse_light && has_hits;
        self.crop.is_some() && !shares
    }

    /// Left, top, right and bottom edge of the crop and the surroundings that its light is smoothed with, pixels; the
    /// picture's edges without a crop.
    pub fn lit_edges(&self) -> [f32; 4] {
        let [width, height] = self.image.size;
        let whole = Crop {
            at: [0, 0],
            size: [width, height],
        };
        let Crop { at, size } = self.crop.unwrap_or(whole);
        let edges = [at[0], at[1], at[0] + size[0], at[1] + size[1]].map(|edge| edge as f32);
        let around = match self.smooths() {
            true => self.smoothing() * SMOOTHED_OVER * height as f32 + LOOKED_OVER_PX,
            false => 0.0,
        };
        let [left, top, right, bottom] = edges;
        [left - around, top - around, right + around, bottom + around]
    }

    /// Whether all light is path traced without bias.
    pub fn is_unbiased(&self) -> bool {
        self.reflection.method == Method::Path
    }

    /// Shadow mode of a light of [`World::lights`] with its index, with `auto` decided.
    pub fn shadow_of(&self, index: usize, light: &Light) -> ShadowMode {
        let by_rays = self.is_unbiased() || self.rays_for_maps >> index & 1 != 0;
        match light.desc.shadow {
            ShadowMode::Default | ShadowMode::Map | ShadowMode::Auto if by_rays => ShadowMode::Ray,
            ShadowMode::Default | ShadowMode::Auto => ShadowMode::Map,
            mode => mode,
        }
    }

    /// Lights of a world, with their indices, whose shadow mode is still to decide.
    pub fn undecided_lights<'a>(
        &'a self,
        world: &'a World,
    ) -> impl Iterator<Item = (usize, &'a Light)> + Clone {
        let is_decided = |index: usize| self.rays_for_maps >> index & 1 != 0;
        let is_left = |mode| matches!(mode, ShadowMode::Default | ShadowMode::Auto);
        let lights = world.lights.iter().enumerate();
        lights.filter(move |(i, l)| is_left(l.desc.shadow) && !is_decided(*i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_scene::desc::Samples;

    #[test]
    fn smoothing_fades_out_with_the_number_of_samples() {
        let of = |samples: u32| {
            let mut options = RenderOptions::default();
            options.image.samples = Samples::Count(samples);
            (options.smooths(), options.smoothing(), options.taps(20))
        };
        let some = [1, 16, 64, 255].map(of);
        let last = some[3].1;
        assert_eq!(
            some[..3],
            [(true, 1.0, 20), (true, 1.0, 20), (true, 0.75, 5)]
        );
        assert!(some[3].0 && last > 0.0 && last < 0.01, "{last}");
        assert_eq!([256, 4096].map(of), [(false, 0.0, 5); 2]);
        let denoised = |samples: u32| {
            let mut options = RenderOptions {
                guides: true,
                ..RenderOptions::default()
            };
            options.image.samples = Samples::Count(samples);
            options.smooths()
        };
        assert_eq!([1, 15, 16, 255].map(denoised), [true, true, false, false]);
    }

    #[test]
    fn light_is_left_out_where_no_neighbor_needs_it() {
        let of = |method: Method, change: &dyn Fn(&mut RenderOptions)| {
            let mut options = RenderOptions::default();
            options.reflection.method = method;
            options.reflection.filter = false;
            options.crop = Some(Crop {
                at: [1, 2],
                size: [3, 4],
            });
            change(&mut options);
            (options.leaves_out_light(), options.lit_edges())
        };
        let edges = [1.0, 2.0, 4.0, 6.0];
        for method in [Method::Rt, Method::Path] {
            assert_eq!(of(method, &|_| ()), (true, edges));
        }
        let reuses = |on: bool| move |o: &mut RenderOptions| o.reflection.reuse_light = on;
        assert_eq!(of(Method::Hybrid, &reuses(true)), (false, edges));
        assert_eq!(of(Method::Hybrid, &reuses(false)), (true, edges));
        let smoothed = of(Method::Rt, &|o| o.reflection.filter = true);
        assert_eq!(smoothed, (true, [-311.0, -310.0, 316.0, 318.0]));
        assert!(!of(Method::Rt, &|o| o.reflection.blur_px = 1.0).0);
        let whole = of(Method::Rt, &|o| o.crop = None);
        assert_eq!(whole, (false, [0.0, 0.0, 1280.0, 720.0]));
    }
}
