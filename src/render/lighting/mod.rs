//! Lights as the shaders see them, and the tables of a lobe's albedo.

pub(crate) mod groove_table;
pub mod lights;
pub(crate) mod lobe_table;
pub(crate) mod sheen_table;
pub(crate) mod shown_light;
