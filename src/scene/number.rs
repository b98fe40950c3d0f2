//! Descriptions of the numeric values that may change from frame to frame. Tables of them stand beside
//! the structs that have the values; `[motion]`, scripts and posing work from these tables.

use glam::Vec3;

use super::range::Range;

/// Number of components of a value, and their meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// One number, stored in all three components.
    Number,
    /// Two numbers; the third component is 0.
    Pair,
    /// Three numbers that are not a position, so that tracks cannot `follow` or `orbit`.
    Color,
    /// A point or a direction.
    Vector,
}

/// One value of a `T` that may change.
#[derive(Debug)]
pub struct Field<T: 'static> {
    /// Its key in scene text, in `[motion]` and in scripts.
    pub key: &'static str,
    /// Number and meaning of its components.
    pub form: Form,
    /// Range of each component.
    pub range: Range,
    /// The value; `None` where this `T` has none.
    pub get: fn(&T) -> Option<Vec3>,
    /// Sets the value; does nothing where this `T` cannot have one.
    pub put: fn(&mut T, Vec3),
}

impl<T> Field<T> {
    /// Sets the value, clamped to its range.
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
    /// The value as three components, as tracks store it.
    fn lanes(self) -> Vec3;
    /// The value from the three components that tracks store.
    fn from_lanes(lanes: Vec3) -> Self;
}

impl Lanes for f32 {
    fn lanes(self) -> Vec3 {
        Vec3::splat(self)
    }
    fn from_lanes(lanes: Vec3) -> Self {
        lanes.x
    }
}

impl Lanes for [f32; 2] {
    fn lanes(self) -> Vec3 {
        Vec3::new(self[0], self[1], 0.0)
    }
    fn from_lanes(lanes: Vec3) -> Self {
        [lanes.x, lanes.y]
    }
}

impl Lanes for Vec3 {
    fn lanes(self) -> Vec3 {
        self
    }
    fn from_lanes(lanes: Vec3) -> Self {
        lanes
    }
}

/// A field that is a plain value of its struct.
macro_rules! plain {
    ($key:ident, $form:ident, $range:expr) => {
        $crate::number::Field {
            key: stringify!($key),
            form: $crate::number::Form::$form,
            range: $range,
            get: |it| Some($crate::number::Lanes::lanes(it.$key)),
            put: |it, value| it.$key = $crate::number::Lanes::from_lanes(value),
        }
    };
}
pub(super) use plain;
