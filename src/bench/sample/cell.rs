//! Conversion of a sample's cells to text and back.

/// Type of a cell's value.
pub(super) trait Cell: Sized {
    fn text(&self) -> String;
    fn of(text: &str) -> Option<Self>;
}

macro_rules! plain_cells {
    ($($kind:ty),*) => {$(
        impl Cell for $kind {
            fn text(&self) -> String {
                self.to_string()
            }
            fn of(text: &str) -> Option<Self> {
                text.parse().ok()
            }
        }
    )*};
}

plain_cells!(String, u32, u64, f32, f64, bool);

/// An empty cell is `None`.
impl<T: Cell> Cell for Option<T> {
    fn text(&self) -> String {
        self.as_ref().map_or(String::new(), Cell::text)
    }
    fn of(text: &str) -> Option<Self> {
        if text.is_empty() {
            Some(None)
        } else {
            T::of(text).map(Some)
        }
    }
}
