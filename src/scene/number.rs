//! Descriptions of the numeric values that may change from frame to frame. Tables of them stand beside
//! the structs that have the values; `[motion]`, scripts and posing work from these tables.

use glam::Vec3;

use super::range::{ANY, Range};

/// Number of components of a value, and their meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// One number, stored in all three components.
    Number,
    /// Two numbers; the third component is 0.
    Pair,
    /// A linear color.
    Color,
    /// Three numbers that are no color and no position: sizes and angles.
    Triple,
    /// A point or a direction, which tracks can `follow` and `orbit`.
    Vector,
}

impl Form {
    /// Number of components.
    pub const fn lanes(self) -> usize {
        match self {
            Self::Number => 1,
            Self::Pair => 2,
            Self::Color | Self::Triple | Self::Vector => 3,
        }
    }
}

/// One value of a `T` that may change.
#[derive(Debug)]
pub struct Field<T: 'static> {
    /// Its key in scene text, in `[motion]` and in scripts.
    pub key: &'static str,
    /// Its quantity, for the text of its track in the manual; empty where it has no track, or a comment has the text.
    pub what: &'static str,
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
    /// Quantity and range of its track, for the manual.
    pub fn track_words(&self) -> String {
        match self.range {
            ANY => format!("Track of the {}", self.what),
            range => format!("Track of the {}, {}", self.what, range.words()),
        }
    }

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

/// A value that may change: a value of numbers, or one that may be left out.
pub trait Changing {
    /// Its components; `None` where it is left out.
    fn value(&self) -> Option<Vec3>;
    /// Sets its components.
    fn put(&mut self, lanes: Vec3);
}

impl<L: Lanes + Copy> Changing for L {
    fn value(&self) -> Option<Vec3> {
        Some(self.lanes())
    }
    fn put(&mut self, lanes: Vec3) {
        *self = L::from_lanes(lanes);
    }
}

impl<L: Lanes + Copy> Changing for Option<L> {
    fn value(&self) -> Option<Vec3> {
        self.map(Lanes::lanes)
    }
    fn put(&mut self, lanes: Vec3) {
        *self = Some(L::from_lanes(lanes));
    }
}

/// A field that is a plain value of its struct.
macro_rules! plain {
    ($key:ident, $what:literal, $form:ident, $range:expr) => {
        $crate::number::Field {
            key: stringify!($key),
            what: $what,
            form: $crate::number::Form::$form,
            range: $range,
            get: |it| $crate::number::Changing::value(&it.$key),
            put: |it, value| $crate::number::Changing::put(&mut it.$key, value),
        }
    };
}
pub(super) use plain;
