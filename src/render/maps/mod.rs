//! Maps that are drawn before a frame and kept: shadow maps, probes, the far view of `near-far`, faces of boxes.

pub mod box_faces;
pub(crate) mod captured;
pub mod far_maps;
pub mod map_keys;
pub mod map_size;
pub mod probe_boxes;
pub mod probe_choice;
pub mod probe_key;
pub(crate) mod probe_light;
pub mod probe_maps;
pub(crate) mod shadow_maps;
