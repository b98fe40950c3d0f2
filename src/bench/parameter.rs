//! Parameters of a bench: the settings that trade time for accuracy, and the variants made of their values.

use reflet_scene::{
    desc::{Accept, Bounces, Method, ReflectionDesc},
    range::{
        ABOVE_0, BOUNCES, BOX_FACE_PX, EDGE_PX, LAYERS, NEAREST_PROBES, RATE, RAY_LENGTH_U, Range,
        SEPARATION_M, STEPS, THRESHOLD_U, range,
    },
    words,
};

/// Largest number of march steps that a scene may ask for.
pub const MAX_STEPS: u32 = STEPS.max as u32;

words! {
    /// A setting that trades time for accuracy.
    pub enum Parameter {
        /// Depth threshold `reflection.threshold_u`, with `accept = "threshold"`.
        ThresholdU = "threshold_u",
        /// Tolerance at pixel edges, `reflection.edge_px`, with `accept = "verified"`.
        EdgePx = "edge_px",
        /// Reuse of the picture's light at hits, `reflection.reuse_light`, 0 or 1.
        ReuseLight = "reuse_light",
        /// Largest number of march steps, `reflection.steps`.
        Steps = "steps",
        /// Number of depth layers of the march, `reflection.layers`.
        Layers = "layers",
        /// Distance of the second layer behind the first, `reflection.separation_m`, with `layers = 2`.
        SeparationM = "separation_m",
        /// Number of rays of which one is traced first, `reflection.rate`.
        Rate = "rate",
        /// Length of reflection rays, `reflection.ray_length_u`.
        RayLengthU = "ray_length_u",
        /// Largest number of reflections in a row, `reflection.bounces`.
        Bounces = "bounces",
        /// Maximum number of blended probes, `probes.nearest`.
        Nearest = "nearest",
        /// Half the size of the box in which rays are traced, `near_far.half_size_m`.
        HalfSizeM = "half_size_m",
        /// Width of the faces of the box, `box_faces.face_px`.
        FacePx = "face_px",
        /// Side of the rendered picture divided by the side of the shown picture, into which it is enlarged bilinearly.
        Scale = "scale",
    }
}

/// One method with one set of settings, which a bench measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// Method that finds reflections; the same as in `reflection`.
    pub method: Method,
    /// Parameter that is varied; none where the scene's own settings are measured.
    pub parameter: Option<Parameter>,
    /// Value of the parameter; none where it has no effect on the method.
    pub value: Option<f64>,
    /// All reflection settings, including the parameter's value.
    pub reflection: ReflectionDesc,
    /// Render scale, see [`Parameter::Scale`].
    pub scale: f64,
}

/// Names of the curves in charts: one per method, with curves of their own for `hybrid` that accepts by the
/// paper's threshold, for two depth layers, and for methods that trace shadow rays at hits anew.
pub const SERIES: [&str; 14] = [
    Method::Ssr.name(),
    SSR_LAYERS_SERIES,
    Method::Probe.name(),
    Method::SsrProbe.name(),
    Method::SsrBox.name(),
    Method::NearFar.name(),
    THRESHOLD_SERIES,
    Method::Hybrid.name(),
    HYBRID_LAYERS_SERIES,
    HYBRID_RATE_SERIES,
    Method::Rt.name(),
    RT_RATE_SERIES,
    HYBRID_ANEW_SERIES,
    RT_ANEW_SERIES,
];
/// Name of the curve of `hybrid` with `accept = "threshold"`.
pub const THRESHOLD_SERIES: &str = "hybrid (threshold)";
/// Name of the curve of `ssr` with `layers = 2`.
pub const SSR_LAYERS_SERIES: &str = "ssr (2 layers)";
/// Name of the curve of `hybrid` with `layers = 2`.
pub const HYBRID_LAYERS_SERIES: &str = "hybrid (2 layers)";
/// Name of the curve of `hybrid` with `rate` above 1.
pub const HYBRID_RATE_SERIES: &str = "hybrid (undersampled)";
/// Name of the curve of `rt` with `rate` above 1.
pub const RT_RATE_SERIES: &str = "rt (undersampled)";
/// Name of the curve of `hybrid` with `reuse_light = false`.
pub const HYBRID_ANEW_SERIES: &str = "hybrid (no light reuse)";
/// Name of the curve of `rt` with `reuse_light = false`.
pub const RT_ANEW_SERIES: &str = "rt (no light reuse)";

impl Parameter {
    /// Parameters that are varied for a method when none is chosen: they change its results most.
    pub const fn own(method: Method) -> &'static [Self] {
        match method {
            Method::Ssr => &[Self::Steps],
            Method::Probe => &[Self::Nearest],
            Method::SsrProbe => &[Self::Steps, Self::Nearest],
            Method::SsrBox => &[Self::Steps, Self::FacePx],
            Method::NearFar => &[Self::HalfSizeM],
            Method::Rt | Method::Path => &[Self::Bounces, Self::ReuseLight],
            Method::Hybrid | Method::Auto => &[Self::ThresholdU, Self::EdgePx, Self::ReuseLight],
        }
    }

    /// Whether varying the parameter can change the picture of this method.
    pub const fn acts_on(self, method: Method) -> bool {
        match self {
            Self::ThresholdU => method.marches(),
            Self::Steps | Self::Layers | Self::SeparationM => {
                method.marches() || matches!(method, Method::NearFar)
            }
            Self::HalfSizeM => matches!(method, Method::NearFar),
            Self::FacePx => matches!(method, Method::SsrBox),
            Self::EdgePx => matches!(method, Method::Hybrid | Method::Auto),
            // Methods that trace no ray follow one reflection and nothing beyond it.
            Self::Bounces | Self::Rate => method.traces(),
            Self::Nearest => method.looks_up(),
            Self::RayLengthU | Self::ReuseLight => !matches!(method, Method::Probe),
            Self::Scale => true,
        }
    }

    /// Values that are compared when none are listed.
    pub const fn default_values(self) -> &'static [f64] {
        match self {
            Self::ThresholdU => &[0.001, 0.005, 0.025, 0.065, 0.2],
            Self::ReuseLight => &[0.0, 1.0],
            Self::EdgePx => &[0.0, 0.125, 0.25, 0.5, 1.0],
            Self::Steps => &[16.0, 32.0, 64.0, 128.0, 256.0],
            Self::Layers => &[1.0, 2.0],
            Self::SeparationM => &[0.0, 0.03, 0.1, 0.3, 1.0],
            Self::Rate => &[1.0, 2.0, 4.0],
            Self::RayLengthU => &[1.0, 2.0, 4.0, 8.0, 16.0],
            Self::Bounces => &[1.0, 2.0, 3.0, 4.0, 6.0],
            Self::Nearest => &[1.0, 2.0, 3.0, 4.0],
            Self::HalfSizeM => &[0.5, 1.0, 2.0, 4.0, 8.0],
            Self::FacePx => &[32.0, 64.0, 128.0, 256.0, 512.0],
            Self::Scale => &[0.25, 0.375, 0.5, 0.75, 1.0],
        }
    }

    /// Checks a value against the setting's range.
    ///
    /// # Errors
    /// Message with the allowed range.
    pub fn check(self, value: f64) -> Result<(), String> {
        let refused = |words: &str| format!("{} = {value:?}: must be {words}", self.name());
        let range = self.range();
        if matches!(
            self,
            Self::Steps
                | Self::Layers
                | Self::Rate
                | Self::Bounces
                | Self::ReuseLight
                | Self::Nearest
                | Self::FacePx
        ) {
            let is_gap = self == Self::Rate && value == 3.0;
            return if value.fract() == 0.0 && range.contains(value) && !is_gap {
                Ok(())
            } else if self == Self::Rate {
                Err(refused("1, 2 or 4"))
            } else {
                Err(refused(&format!(
                    "a whole number from {} to {}",
                    range.min, range.max
                )))
            };
        }
        range.check(value).map_err(|words| refused(&words))
    }

    /// Range that a scene allows for the setting.
    const fn range(self) -> Range {
        match self {
            Self::ThresholdU => THRESHOLD_U,
            Self::EdgePx => EDGE_PX,
            Self::ReuseLight => range(0.0, 1.0),
            Self::Steps => STEPS,
            Self::Layers => LAYERS,
            Self::SeparationM => SEPARATION_M,
            Self::Rate => RATE,
            Self::RayLengthU => RAY_LENGTH_U,
            Self::Bounces => BOUNCES,
            Self::Nearest => NEAREST_PROBES,
            Self::HalfSizeM => ABOVE_0,
            Self::FacePx => BOX_FACE_PX,
            Self::Scale => range(0.05, 1.0),
        }
    }

    /// Writes the value into the settings; `scale` is not part of them.
    fn apply(self, value: f64, settings: &mut ReflectionDesc) {
        match self {
            Self::ThresholdU => {
                settings.accept = Accept::Threshold;
                settings.threshold_u = value as f32;
            }
            Self::EdgePx => {
                settings.accept = Accept::Verified;
                settings.edge_px = value as f32;
            }
            Self::ReuseLight => settings.reuse_light = value != 0.0,
            Self::Steps => settings.steps = value as u32,
            Self::Layers => settings.layers = value as u32,
            Self::SeparationM => {
                settings.layers = 2;
                settings.separation_m = Some(value as f32);
            }
            Self::Rate => settings.rate = value as u32,
            Self::RayLengthU => settings.ray_length_u = value as f32,
            Self::Bounces => settings.bounces = Bounces::AtMost(value as u32),
            Self::Nearest => settings.probes.nearest = value as u32,
            Self::HalfSizeM => settings.near_far.half_size_m = Some(value as f32),
            Self::FacePx => settings.box_faces.face_px = value as u32,
            Self::Scale => {}
        }
    }
}

impl Variant {
    /// Variant of the scene's own settings with another method.
    pub fn fixed(method: Method, settings: &ReflectionDesc) -> Self {
        Self {
            method,
            parameter: None,
            value: None,
            reflection: ReflectionDesc {
                method,
                ..*settings
            },
            scale: 1.0,
        }
    }

    /// Variants for a list of values: one per value, or a single one where the parameter has no effect on the method.
    pub fn sweep(
        method: Method,
        settings: &ReflectionDesc,
        parameter: Parameter,
        values: &[f64],
    ) -> Vec<Self> {
        let fixed = Self {
            parameter: Some(parameter),
            ..Self::fixed(method, settings)
        };
        if !parameter.acts_on(method) {
            return vec![fixed];
        }
        let with_value = |&value: &f64| {
            let mut variant = fixed;
            variant.value = Some(value);
            parameter.apply(value, &mut variant.reflection);
            if parameter == Parameter::Scale {
                variant.scale = value;
            }
            variant
        };
        values.iter().map(with_value).collect()
    }

    /// Size in pixels at which a picture of `size` is rendered.
    pub fn rendered_size(&self, size: [u32; 2]) -> [u32; 2] {
        size.map(|side| ((f64::from(side) * self.scale).round() as u32).max(1))
    }

    /// Name for people, such as `hybrid, threshold_u = 0.025`.
    pub fn label(&self) -> String {
        let method = self.method.name();
        match (self.parameter, self.value) {
            (Some(parameter), Some(value)) => format!("{method}, {} = {value}", parameter.name()),
            _ => method.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests;
