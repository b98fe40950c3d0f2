//! Every number of cameras, lights and materials that may change from frame to frame: the one table
//! from which `[motion]`, scripts and posing work.

use glam::Vec3;

use crate::scene::{
    desc::{CameraDesc, LightDesc, LightKind, MaterialDesc},
    range::{ABOVE_0, ANY, FROM_0, Range, UNIT, range},
};

/// How many numbers a value has, and what they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// One, kept three times.
    Number,
    /// Two, the third is 0.
    Pair,
    /// Three that are no place: nothing to follow or to orbit.
    Color,
    /// A point or a direction.
    Vector,
}

/// One value of a `T` that may change.
#[derive(Debug)]
pub struct Field<T: 'static> {
    /// Its key in scene text, in `[motion]` and in scripts.
    pub key: &'static str,
    /// What it consists of.
    pub form: Form,
    /// Of each of its numbers.
    pub range: Range,
    /// The value; `None` where this `T` has none.
    pub get: fn(&T) -> Option<Vec3>,
    /// Sets the value; does nothing where this `T` cannot have one.
    pub put: fn(&mut T, Vec3),
}

impl<T> Field<T> {
    /// Sets the value, cut off at the ends of its range.
    pub fn put_clamped(&self, to: &mut T, value: Vec3) {
        let [x, y, z] = value.to_array().map(|x| self.range.clamp(x));
        (self.put)(to, Vec3::new(x, y, z));
    }
}

/// The field of a key.
pub fn find<T>(fields: &'static [Field<T>], key: &str) -> Option<&'static Field<T>> {
    fields.iter().find(|field| field.key == key)
}

/// A value that consists of one, two or three numbers.
pub trait Lanes {
    /// As tracks keep it.
    fn lanes(self) -> Vec3;
    /// Back from what tracks keep.
    fn of(lanes: Vec3) -> Self;
}

impl Lanes for f32 {
    fn lanes(self) -> Vec3 {
        Vec3::splat(self)
    }
    fn of(lanes: Vec3) -> Self {
        lanes.x
    }
}

impl Lanes for [f32; 2] {
    fn lanes(self) -> Vec3 {
        Vec3::new(self[0], self[1], 0.0)
    }
    fn of(lanes: Vec3) -> Self {
        [lanes.x, lanes.y]
    }
}

impl Lanes for Vec3 {
    fn lanes(self) -> Vec3 {
        self
    }
    fn of(lanes: Vec3) -> Self {
        lanes
    }
}

/// A field that is a plain value of its struct.
macro_rules! plain {
    ($key:ident, $form:ident, $range:expr) => {
        Field {
            key: stringify!($key),
            form: Form::$form,
            range: $range,
            get: |it| Some(it.$key.lanes()),
            put: |it, value| it.$key = Lanes::of(value),
        }
    };
}

/// A field that is an `Option` of its struct.
macro_rules! optional {
    ($key:ident, $form:ident, $range:expr) => {
        Field {
            key: stringify!($key),
            form: Form::$form,
            range: $range,
            get: |it| it.$key.map(Lanes::lanes),
            put: |it, value| it.$key = Some(Lanes::of(value)),
        }
    };
}

/// A field that some kinds of lights have.
macro_rules! of_lights {
    ($key:ident, $form:ident, $range:expr, $($kind:ident)|+) => {
        Field {
            key: stringify!($key),
            form: Form::$form,
            range: $range,
            get: |light| match light.kind {
                $(LightKind::$kind { $key, .. })|+ => Some($key.lanes()),
                _ => None,
            },
            put: |light, value| match &mut light.kind {
                $(LightKind::$kind { $key, .. })|+ => *$key = Lanes::of(value),
                _ => {}
            },
        }
    };
}

/// A field of a material's checker.
macro_rules! of_checkers {
    ($key:literal, $form:ident, $range:expr, |$checker:ident| $value:expr) => {
        Field {
            key: $key,
            form: Form::$form,
            range: $range,
            get: |it| it.checker.as_ref().map(|$checker| $value.lanes()),
            put: |it, value| {
                if let Some($checker) = &mut it.checker {
                    $value = Lanes::of(value);
                }
            },
        }
    };
}

/// What changes of a camera.
pub static CAMERA: [Field<CameraDesc>; 5] = [
    plain!(eye, Vector, ANY),
    plain!(target, Vector, ANY),
    plain!(up, Vector, ANY),
    plain!(fov_deg, Number, range(1.0, 170.0)),
    plain!(near_m, Number, ABOVE_0),
];

/// What changes of a light. After any of it, [`settle`].
pub static LIGHT: [Field<LightDesc>; 8] = [
    of_lights!(position, Vector, ANY, Point | Spot),
    Field {
        key: "direction",
        form: Form::Vector,
        range: ANY,
        get: |light| direction(light),
        put: |light, value| match &mut light.kind {
            LightKind::Point { .. } => {}
            LightKind::Spot {
                direction, target, ..
            } => (*direction, *target) = (value, None),
            LightKind::Directional { direction, .. } => *direction = value,
        },
    },
    Field {
        key: "target",
        form: Form::Vector,
        range: ANY,
        get: |light| match light.kind {
            LightKind::Spot {
                position,
                direction,
                target,
                ..
            } => Some(target.unwrap_or(position + direction)),
            _ => None,
        },
        put: |light, value| {
            if let LightKind::Spot { target, .. } = &mut light.kind {
                *target = Some(value);
            }
        },
    },
    of_lights!(intensity_cd, Number, FROM_0, Point | Spot),
    of_lights!(intensity_lux, Number, FROM_0, Directional),
    plain!(color, Color, FROM_0),
    of_lights!(inner_deg, Number, range(0.0, 90.0).below(), Spot),
    of_lights!(outer_deg, Number, range(0.0, 90.0).below().above(), Spot),
];

/// In which direction a light shines, if in one.
pub fn direction(light: &LightDesc) -> Option<Vec3> {
    match light.kind {
        LightKind::Point { .. } => None,
        LightKind::Spot { direction, .. } | LightKind::Directional { direction, .. } => {
            Some(direction)
        }
    }
}

/// Makes a light whose numbers were set consistent: its direction, 0 where there is none, points at
/// its target, and the lit part of its cone is no wider than the cone.
pub fn settle(light: &mut LightDesc) {
    let unit = |v: Vec3| {
        let v = v.as_dvec3().try_normalize();
        v.map_or(Vec3::ZERO, |v| v.as_vec3())
    };
    match &mut light.kind {
        LightKind::Point { .. } => {}
        LightKind::Spot {
            position,
            direction,
            target,
            inner_deg,
            outer_deg,
            ..
        } => {
            *direction = unit(target.map_or(*direction, |target| target - *position));
            *inner_deg = inner_deg.min(*outer_deg);
        }
        LightKind::Directional { direction, .. } => *direction = unit(*direction),
    }
}

/// How many values of a material may change.
pub const MATERIAL_FIELDS: usize = 13;

/// What changes of a material.
pub static MATERIAL: [Field<MaterialDesc>; MATERIAL_FIELDS] = [
    optional!(base_color, Color, UNIT),
    optional!(metallic, Number, UNIT),
    optional!(roughness, Number, UNIT),
    optional!(normal_scale, Number, range(0.0, 4.0)),
    optional!(occlusion_strength, Number, UNIT),
    optional!(emission, Color, FROM_0),
    optional!(emission_strength, Number, FROM_0),
    optional!(uv_scale, Pair, ANY),
    optional!(alpha_cutoff, Number, UNIT),
    optional!(reflectivity, Number, UNIT),
    of_checkers!("checker_a", Color, UNIT, |checker| checker.colors[0]),
    of_checkers!("checker_b", Color, UNIT, |checker| checker.colors[1]),
    of_checkers!("checker_size_m", Number, ABOVE_0, |checker| checker.size_m),
];

/// What a material's table leaves open.
pub const PLAIN: MaterialDesc = MaterialDesc {
    base_color: Some(Vec3::ONE),
    base_color_texture: None,
    checker: None,
    metallic: Some(0.0),
    roughness: Some(1.0),
    metallic_roughness_texture: None,
    normal_texture: None,
    normal_scale: Some(1.0),
    occlusion_strength: Some(1.0),
    emission: Some(Vec3::ZERO),
    emission_strength: Some(1.0),
    emission_texture: None,
    uv_scale: Some([1.0, 1.0]),
    alpha_cutoff: None,
    double_sided: None,
    reflection: None,
    reflectivity: Some(0.04),
};

impl Field<MaterialDesc> {
    /// What must stand in a material's own table before this may change, as scene text; `None`
    /// where its default does. A material is drawn and traced as it was made, and one that is
    /// never cut out, say, is not asked for its alpha.
    pub fn lacks(&self, material: &MaterialDesc) -> Option<&'static str> {
        if (self.get)(material).is_some() || (self.get)(&PLAIN).is_some() {
            return None;
        }
        Some(if self.key == "alpha_cutoff" {
            "alpha_cutoff = 0"
        } else {
            "checker = { colors = [[1, 1, 1], [0, 0, 0]], size_m = 1 }"
        })
    }
}
