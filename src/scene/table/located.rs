//! Values of scene text together with the places where they are written.

use crate::diagnostic::Span;

/// A named table such as `[camera.main]`, in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry<T> {
    /// The name after the dot.
    pub name: String,
    /// Place where the name is written.
    pub at: Span,
    /// The table's content.
    pub value: T,
}

/// A value together with the place where it is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct At<T> {
    /// The value.
    pub value: T,
    /// Place where the value is written.
    pub at: Span,
}

/// Place of a value, for messages; equal to any other place, so that text that only moved is no change.
#[derive(Clone, Debug)]
pub struct Written(pub Span);

impl PartialEq for Written {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
