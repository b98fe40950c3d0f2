//! AOVs: quantities of the frame as image planes, decoded from the intermediate textures.

use std::{array, borrow::Cow};

use glam::{DVec2, Vec2, Vec3};

use reflet_gpu::{Gpu, GpuError};
use reflet_scene::desc::{CameraDesc, LightGroup};
use reflet_world::World;

use crate::{
    layout::{types::NONE, unit_vector::unpack_unit},
    pipeline::{
        cause::Cause,
        targets::{FAR_M, HIT_LAYERS, Target},
    },
    renderer::{Renderer, download::TargetValues},
};

/// Pixels of one quantity, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Name of the AOV in files: [`Aov::plane_name`].
    pub name: Cow<'static, str>,
    /// Channel names, such as `R`, `G`, `B`.
    pub channels: &'static [&'static str],
    /// `width * height * channels` values.
    pub data: PlaneData,
}

/// A plane's values.
#[derive(Clone, Debug, PartialEq)]
pub enum PlaneData {
    /// Measured quantities.
    F32(Vec<f32>),
    /// Ids and enum values.
    U32(Vec<u32>),
}

/// Declares the AOVs but light groups, each with its name and the targets that it is decoded from.
macro_rules! aovs {
    ($($(#[doc = $doc:literal])* $aov:ident = $name:literal: $($target:ident),+;)*) => {
        /// A quantity that can be written beside the picture.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Aov {
            $($(#[doc = $doc])* $aov,)*
            /// Linear radiance of a light group alone, from a picture of its own: [`Session::begin`] makes it.
            ///
            /// [`Session::begin`]: crate::runtime::Session::begin
            Light(LightGroup),
        }

        impl Aov {
            /// All AOVs except light groups.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$aov),*];

            /// Name on the command line and in files.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$aov => $name,)*
                    Self::Light(_) => "light",
                }
            }

            /// The targets that the AOV is decoded from.
            pub const fn targets(self) -> &'static [Target] {
                match self {
                    $(Self::$aov => &[$(Target::$target),+],)*
                    Self::Light(_) => &[],
                }
            }
        }
    };
}

aovs! {
    /// Meters along the view direction; infinite where the pixel shows no surface.
    Depth = "depth": ViewDepth;
    /// World-space shading normal.
    Normal = "normal": Surface, ViewDepth;
    /// Linear base color.
    BaseColor = "base_color": Colors;
    /// Perceptual roughness, metallic, reflectivity.
    Material = "material": Surface, ViewDepth;
    /// Linear emitted radiance.
    Emission = "emission": Colors;
    /// View-independent radiance.
    Radiance = "radiance": Radiance;
    /// View-dependent radiance of lights and environment.
    Specular = "specular": Specular;
    /// Radiance along the mirror ray.
    Reflection = "reflection": Reflection, Cause;
    /// Fresnel-weighted reflectance of reflective pixels, mean over the channels.
    Reflectance = "reflectance": Surface, ViewDepth, Cause, Colors;
    /// Source of the reflection: a [`Source`](crate::pipeline::cause::Source) as a number.
    Source = "source": Cause;
    /// Cause of that source: a [`Cause`] as a number.
    Cause = "cause": Cause;
    /// Distance along the mirror ray to its hit, meters; infinite without a hit.
    HitDistance = "hit_distance": Hit, Cause;
    /// Instance and triangle of the mirror ray's hit.
    HitIds = "hit_ids": Hit, Cause;
    /// Instance and triangle that the pixel shows.
    Ids = "ids": Ids;
}

const RGB: &[&str] = &["R", "G", "B"];

impl Aov {
    /// Name of its plane in files and layers: `light_NAME` for a light group, else [`Self::name`].
    pub fn plane_name(self) -> Cow<'static, str> {
        match self {
            Self::Light(group) => format!("light_{}", group.name()).into(),
            _ => self.name().into(),
        }
    }

    /// The AOV of this name; a light group's is `light:NAME`.
    pub fn from_name(name: &str) -> Option<Self> {
        if let Some(group) = name.strip_prefix("light:") {
            return LightGroup::new(group).map(Self::Light);
        }
        Self::ALL.into_iter().find(|aov| aov.name() == name)
    }

    /// The AOVs of a name in a scene: `light:*` names all of its light groups. `None` for a name that it lacks.
    pub fn named(name: &str, world: &World) -> Option<Vec<Self>> {
        let groups = world.light_groups();
        if name.strip_prefix("light:") == Some(LightGroup::ALL) {
            return Some(groups.into_iter().map(Self::Light).collect());
        }
        let is_there = |aov: &Self| !matches!(aov, Self::Light(group) if !groups.contains(group));
        Self::from_name(name).filter(is_there).map(|aov| vec![aov])
    }

    /// Names that [`Self::named`] knows.
    pub fn names_in(world: &World) -> Vec<String> {
        let groups = world.light_groups();
        let lights = groups.iter().map(|g| format!("light:{}", g.name()));
        let plain = Self::ALL.iter().map(|aov| aov.name().to_owned());
        plain.chain(lights).chain(["light:*".to_owned()]).collect()
    }

    /// Reads the plane of the last picture back from the GPU.
    ///
    /// # Errors
    /// A readback error.
    pub fn plane(
        self,
        gpu: &Gpu,
        renderer: &Renderer,
        camera: &CameraDesc,
    ) -> Result<Plane, GpuError> {
        let values = renderer.download(gpu, self.targets(), false)?.take(gpu)?;
        Ok(self.decode(&values, camera))
    }

    /// Plane of a light group, from linear radiance of four channels.
    pub(crate) fn plane_of_light(self, color: &[f32]) -> Plane {
        let pixels = color.chunks_exact(4);
        let channels = pixels.flat_map(|p| [p[0], p[1], p[2]]);
        Plane {
            name: self.plane_name(),
            channels: RGB,
            data: PlaneData::F32(channels.collect()),
        }
    }

    /// Decodes the plane of a frame whose [`Aov::targets`] were downloaded, seen by `camera`.
    pub fn decode(self, values: &TargetValues, camera: &CameraDesc) -> Plane {
        let rgb = |target| {
            let first = |p: [f32; 4]| [p[0], p[1], p[2]];
            let channels: Vec<f32> = if values.precision.full {
                values.texels(target).into_iter().flat_map(first).collect()
            } else {
                let texels = values.texels::<[u16; 4]>(target).into_iter();
                let floats = texels.map(|p| p.map(|h| half(u32::from(h))));
                floats.flat_map(first).collect()
            };
            (RGB, PlaneData::F32(channels))
        };
        let (channels, data) = match self {
            Self::Depth => {
                let depths = values.texels::<f32>(Target::ViewDepth).into_iter();
                let (_, nearer_m) = values.coordinates.view(camera, &values.drawn, values.unit);
                let scale_m = values.coordinates.meters();
                let meters = |d: f32| match d < FAR_M {
                    true => d * scale_m + nearer_m,
                    false => f32::INFINITY,
                };
                let far = depths.map(meters);
                (&["Z"][..], PlaneData::F32(far.collect()))
            }
            Self::BaseColor => (RGB, PlaneData::F32(packed_colors(values, 0))),
            Self::Emission => {
                let mut emitted = packed_colors(values, 4);
                let scale = values.precision.emission_scale();
                emitted.iter_mut().for_each(|channel| *channel *= scale);
                (RGB, PlaneData::F32(emitted))
            }
            Self::Radiance => rgb(Target::Radiance),
            Self::Specular => rgb(Target::Specular),
            Self::Reflection => {
                let (channels, mut data) = rgb(Target::Reflection);
                if let PlaneData::F32(data) = &mut data {
                    let pixels = data.chunks_exact_mut(3).zip(causes(values));
                    let blank = pixels.filter(|(_, cause)| !reflects(*cause));
                    blank.for_each(|(pixel, _)| pixel.fill(0.0));
                }
                (channels, data)
            }
            Self::Normal | Self::Material | Self::Reflectance => self.surface(values, camera),
            Self::Cause => (&["cause"][..], PlaneData::U32(causes(values))),
            Self::Source => {
                let source =
                    |c: u32| Cause::from_number(c).map_or(0, |c| c.source(values.method) as u32);
                let sources = causes(values).into_iter().map(source);
                (&["source"][..], PlaneData::U32(sources.collect()))
            }
            Self::HitDistance => {
                let distance = |h: [u32; 4]| {
                    if h[1] == NONE {
                        f32::INFINITY
                    } else {
                        f32::from_bits(h[0]) * values.coordinates.meters()
                    }
                };
                let distances = hits(values).into_iter().map(distance);
                (&["Z"][..], PlaneData::F32(distances.collect()))
            }
            Self::HitIds => {
                let ids = hits(values).into_iter().flat_map(|h| [h[1], h[2]]);
                (&["instance", "triangle"][..], PlaneData::U32(ids.collect()))
            }
            Self::Ids => (
                &["instance", "triangle"][..],
                PlaneData::U32(values.texels(Target::Ids)),
            ),
            Self::Light(_) => (RGB, PlaneData::F32(Vec::new())),
        };
        Plane {
            name: self.plane_name(),
            channels,
            data,
        }
    }

    fn surface(
        self,
        values: &TargetValues,
        camera: &CameraDesc,
    ) -> (&'static [&'static str], PlaneData) {
        let packed: Vec<[u32; 4]> = values.texels(Target::Surface);
        let depths: Vec<f32> = values.texels(Target::ViewDepth);
        let seen = packed
            .iter()
            .zip(&depths)
            .map(|(p, d)| (*d < FAR_M).then_some(*p));
        match self {
            Self::Normal => {
                let normals =
                    seen.flat_map(|p| p.map_or(Vec3::ZERO, |p| unpack_unit(p[0])).to_array());
                (&["X", "Y", "Z"], PlaneData::F32(normals.collect()))
            }
            Self::Material => {
                let numbers = seen.flat_map(|p| {
                    p.map_or([0.0; 3], |p| [half(p[2]), half(p[2] >> 16), half(p[3])])
                });
                (
                    &["roughness", "metallic", "reflectivity"],
                    PlaneData::F32(numbers.collect()),
                )
            }
            _ => (
                &["Y"],
                PlaneData::F32(reflectance(values, camera, &packed, &depths)),
            ),
        }
    }
}

/// Schlick's reflectance at each reflective pixel as compose weights it, 0 elsewhere.
fn reflectance(
    values: &TargetValues,
    camera: &CameraDesc,
    packed: &[[u32; 4]],
    depths: &[f32],
) -> Vec<f32> {
    let causes = causes(values);
    let base = packed_colors(values, 0);
    let size = values.size;
    let view = crate::settings::view::View::new(camera, size, 1.0);
    let at = |i: usize| {
        if !reflects(causes[i]) || depths[i] >= FAR_M {
            return 0.0;
        }
        let [x, y] = [i as u32 % size[0], i as u32 / size[0]].map(|v| v as f32 + 0.5);
        let ndc = Vec2::new(x / size[0] as f32, y / size[1] as f32) * 2.0 - 1.0;
        let (_, ray) = view.ray(DVec2::new(ndc.x.into(), (-ndc.y).into()));
        let ray = ray.normalize().as_vec3();
        let cosine = -unpack_unit(packed[i][0]).dot(ray);
        let (metallic, reflectivity) = (half(packed[i][2] >> 16), half(packed[i][3]));
        let f0 = Vec3::from_slice(&base[3 * i..]);
        let f0 = Vec3::splat(reflectivity).lerp(f0, metallic);
        let f90 = (50.0 * f0.element_sum() / 3.0).clamp(0.0, 1.0);
        let fresnel = f0 + (Vec3::splat(f90) - f0) * (1.0 - cosine.clamp(0.0, 1.0)).powi(5);
        fresnel.element_sum() / 3.0
    };
    (0..causes.len()).map(at).collect()
}

/// Hits of the mirror rays; no hit where the frame has no reflections.
fn hits(values: &TargetValues) -> Vec<[u32; HIT_LAYERS]> {
    let layers: Vec<u32> = values.texels(Target::Hit);
    let pixels = layers.len() / HIT_LAYERS;
    let hit = |pixel: usize| array::from_fn(|layer| layers[layer * pixels + pixel]);
    let mut hits: Vec<[u32; HIT_LAYERS]> = (0..pixels).map(hit).collect();
    for (hit, cause) in hits.iter_mut().zip(causes(values)) {
        if !values.reflections || !reflects(cause) {
            *hit = [0, NONE, NONE, 0];
        }
    }
    hits
}

fn causes(values: &TargetValues) -> Vec<u32> {
    let texels = values.texels::<u32>(Target::Cause).into_iter();
    texels.map(Cause::number_in).collect()
}

/// Whether pixels of this cause have a reflection; elsewhere the reflection targets hold leftovers of earlier
/// frames.
fn reflects(cause: u32) -> bool {
    Cause::from_number(cause).is_some_and(Cause::reflects)
}

/// Three 16-bit floats of each texel of `colors`, starting at index `first`.
fn packed_colors(values: &TargetValues, first: usize) -> Vec<f32> {
    let texels = values.texels::<[u16; 8]>(Target::Colors).into_iter();
    let channels = texels.flat_map(|t| [t[first], t[first + 1], t[first + 2]]);
    channels.map(|h| half(u32::from(h))).collect()
}

/// Value of the 16-bit float in the low half.
fn half(bits: u32) -> f32 {
    half::f16::from_bits(bits as u16).to_f32()
}
