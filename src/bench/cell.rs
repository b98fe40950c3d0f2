//! Conversion of values to cells of a table and back, and structs whose fields are columns.

/// Value that a cell shows.
pub(crate) trait Cell {
    fn text(&self) -> String;
}

/// Value that a cell is read as.
pub(crate) trait FromCell: Sized {
    /// Whether a table may lack the column: its cells are then empty.
    const MAY_LACK: bool = false;

    fn parse(text: &str) -> Option<Self>;
}

macro_rules! plain_cells {
    ($($kind:ty),*) => {$(
        impl Cell for $kind {
            fn text(&self) -> String {
                self.to_string()
            }
        }
        impl FromCell for $kind {
            fn parse(text: &str) -> Option<Self> {
                text.parse().ok()
            }
        }
    )*};
}

plain_cells!(String, u32, u64, usize, f32, f64, bool);

/// An empty cell is `None`.
impl<T: Cell> Cell for Option<T> {
    fn text(&self) -> String {
        self.as_ref().map_or(String::new(), Cell::text)
    }
}

impl<T: FromCell> FromCell for Option<T> {
    const MAY_LACK: bool = true;

    fn parse(text: &str) -> Option<Self> {
        if text.is_empty() {
            Some(None)
        } else {
            T::parse(text).map(Some)
        }
    }
}

/// A column of a table: its name, and the text of its cell in a row.
pub(crate) struct Column<R>(pub &'static str, pub fn(&R) -> String);

/// Names of the columns.
pub(crate) fn names<R>(columns: &[Column<R>]) -> impl Iterator<Item = &'static str> + Clone {
    columns.iter().map(|column| column.0)
}

/// Cells of a row, in the order of the columns.
pub(crate) fn cells<R>(columns: &[Column<R>], row: &R) -> Vec<String> {
    columns.iter().map(|column| (column.1)(row)).collect()
}

/// Declares a struct whose fields are columns of a table.
macro_rules! columns {
    ($(#[$about:meta])* pub struct $Name:ident { $($(#[$doc:meta])* pub $name:ident: $kind:ty,)* }) => {
        $(#[$about])*
        pub struct $Name {
            $($(#[$doc])* pub $name: $kind,)*
        }

        impl $Name {
            /// Names of the columns.
            const COLUMNS: &[&str] = &[$(stringify!($name)),*];

            /// Cells in the order of the columns.
            fn cells(&self) -> Vec<String> {
                vec![$($crate::cell::Cell::text(&self.$name)),*]
            }
        }
    };
}
pub(crate) use columns;
