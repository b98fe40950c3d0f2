//! Parameters of a bench: the settings that trade time for accuracy, and the variants made of their values.

use reflet_scene::{
    desc::{Accept, Bounces, Method, ReflectionDesc, reflection::BoxFacesDesc},
    range::{
        ABOVE_0, BOUNCES, EDGE_PX, LAYERS, NEAREST_PROBES, RATE, RAY_LENGTH_U, Range, SEPARATION_M,
        STEPS, THRESHOLD_U, UNIT, range,
    },
    words,
};

/// Largest number of march steps that a scene may ask for.
pub const MAX_STEPS: u32 = STEPS.max as u32;

/// Form of the values of a parameter.
#[derive(PartialEq)]
enum Form {
    Number,
    Whole,
}

/// Values of a parameter, and the setting that they change.
struct Row {
    /// Values that a scene allows.
    range: Range,
    form: Form,
    /// Values that are compared when none are listed.
    compared: &'static [f64],
    /// Whether varying the parameter can change the picture of a method.
    acts_on: fn(Method) -> bool,
    /// Writes a value into settings.
    set: fn(&mut ReflectionDesc, f64),
}

/// Declares the parameters, each with its row.
macro_rules! parameters {
    ($(
        #[doc = $text:literal]
        $variant:ident = $word:literal, $form:ident, $range:expr, $compared:expr,
        $acts_on:expr => $set:expr;
    )*) => {
        words! {
            /// A setting that trades time for accuracy.
            pub enum Parameter {
                $(#[doc = $text] $variant = $word,)*
            }
        }

        impl Parameter {
            const fn row(self) -> &'static Row {
                match self {
                    $(Self::$variant => const {
                        &Row {
                            range: $range,
                            form: Form::$form,
                            compared: &$compared,
                            acts_on: $acts_on,
                            set: $set,
                        }
                    },)*
                }
            }
        }
    };
}

parameters! {
    /// Depth threshold `reflection.threshold_u`, with `accept = "threshold"`.
    ThresholdU = "threshold_u", Number, THRESHOLD_U, [0.001, 0.005, 0.025, 0.065, 0.2],
        Method::marches => |settings, value| {
            settings.accept = Accept::Threshold;
            settings.threshold_u = value as f32;
        };
    /// Tolerance at pixel edges, `reflection.edge_px`, with `accept = "verified"`.
    EdgePx = "edge_px", Number, EDGE_PX, [0.0, 0.125, 0.25, 0.5, 1.0],
        |m| m == Method::Hybrid => |settings, value| {
            settings.accept = Accept::Verified;
            settings.edge_px = value as f32;
        };
    /// Reuse of the picture's light at hits, `reflection.reuse_light`, 0 or 1.
    ReuseLight = "reuse_light", Whole, UNIT, [0.0, 1.0],
        has_hits => |settings, value| settings.reuse_light = value != 0.0;
    /// Largest number of march steps, `reflection.steps`.
    Steps = "steps", Whole, STEPS, [16.0, 32.0, 64.0, 128.0, 256.0],
        marches_somewhere => |settings, value| settings.steps = value as u32;
    /// Number of depth layers of the march, `reflection.layers`.
    Layers = "layers", Whole, LAYERS, [1.0, 2.0],
        marches_somewhere => |settings, value| settings.layers = value as u32;
    /// Distance of the second layer behind the first, `reflection.separation_m`, with `layers = 2`.
    SeparationM = "separation_m", Number, SEPARATION_M, [0.0, 0.03, 0.1, 0.3, 1.0],
        marches_somewhere => |settings, value| {
            settings.layers = 2;
            settings.separation_m = Some(value as f32);
        };
    /// Number of rays of which one is traced first, `reflection.rate`.
    Rate = "rate", Whole, RATE, [1.0, 2.0, 4.0],
        Method::traces => |settings, value| settings.rate = value as u32;
    /// Length of reflection rays, `reflection.ray_length_u`.
    RayLengthU = "ray_length_u", Number, RAY_LENGTH_U, [1.0, 2.0, 4.0, 8.0, 16.0],
        has_hits => |settings, value| settings.ray_length_u = value as f32;
    /// Largest number of reflections in a row, `reflection.bounces`: methods that trace no ray follow one.
    Bounces = "bounces", Whole, BOUNCES, [1.0, 2.0, 3.0, 4.0, 6.0],
        Method::traces => |settings, value| settings.bounces = Bounces::AtMost(value as u32);
    /// Maximum number of blended probes, `probes.nearest`.
    Nearest = "nearest", Whole, NEAREST_PROBES, [1.0, 2.0, 3.0, 4.0],
        Method::looks_up => |settings, value| settings.probes.nearest = value as u32;
    /// Half the size of the box in which rays are traced, `near_far.half_size_m`.
    HalfSizeM = "half_size_m", Number, ABOVE_0, [0.5, 1.0, 2.0, 4.0, 8.0],
        |m| m == Method::NearFar => |settings, value| {
            settings.near_far.half_size_m = Some(value as f32);
        };
    /// Width of the faces of the box, `box_faces.face_px`.
    FacePx = "face_px", Whole, BoxFacesDesc::FACE_PX, [32.0, 64.0, 128.0, 256.0, 512.0],
        |m| m == Method::SsrBox => |settings, value| settings.box_faces.face_px = value as u32;
    /// Side of the rendered picture divided by the side of the shown picture, into which it is enlarged bilinearly.
    Scale = "scale", Number, range(0.05, 1.0), [0.25, 0.375, 0.5, 0.75, 1.0],
        |_| true => |_, _| {}; // no setting
}

/// Whether a method finds hits, by a march or by rays.
fn has_hits(method: Method) -> bool {
    method.marches() || method.traces()
}

/// Whether a method marches through the picture, or rays through its maps.
fn marches_somewhere(method: Method) -> bool {
    method.marches() || method.traces() && method.maps().is_some()
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

impl Parameter {
    /// Parameters that are varied for a method when none is chosen: they change its results most.
    pub fn own(method: Method) -> Vec<Self> {
        match method {
            Method::Auto | Method::Rt | Method::Path => vec![Self::Bounces, Self::ReuseLight],
            Method::Hybrid => vec![Self::ThresholdU, Self::EdgePx, Self::ReuseLight],
            // Its march, and parameters of its own.
            _ => {
                let acts_on = |p: &Self, method| (p.row().acts_on)(method);
                let is_own = |p: &Self| match p {
                    Self::Steps => method.marches(),
                    _ => acts_on(p, method) && !acts_on(p, Method::Ssr) && !acts_on(p, Method::Rt),
                };
                Self::ALL.into_iter().filter(is_own).collect()
            }
        }
    }

    /// Values that are compared when none are listed.
    pub const fn default_values(self) -> &'static [f64] {
        self.row().compared
    }

    /// Checks a value against the setting's range.
    ///
    /// # Errors
    /// Message with the allowed range.
    pub fn check(self, value: f64) -> Result<(), String> {
        let refused = |words: &str| format!("{} = {value:?}: must be {words}", self.name());
        let Row { range, form, .. } = self.row();
        let is_fit = value.fract() == 0.0 && range.contains(value);
        match self {
            Self::Rate if !is_fit || value == 3.0 => Err(refused("1, 2 or 4")),
            _ if *form == Form::Whole && !is_fit => Err(refused(&format!(
                "a whole number from {} to {}",
                range.min, range.max
            ))),
            _ => range.check(value).map_err(|words| refused(&words)),
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
        if !(parameter.row().acts_on)(method) {
            return vec![fixed];
        }
        let with_value = |&value: &f64| {
            let mut variant = fixed;
            variant.value = Some(value);
            (parameter.row().set)(&mut variant.reflection, value);
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
