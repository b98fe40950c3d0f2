//! Pictures of lights, environments and materials with known answers: closed forms and integrals.

mod alpha;
mod coat_normals;
mod cutoff;
mod emitters;
mod energy;
mod environment;
mod extent;
mod film_grooves_dispersion;
mod first_pictures;
mod fog;
mod fog_closed_form;
mod furnace;
mod groups;
mod indirect;
mod kit;
mod lamp;
mod layers;
mod lens;
mod light_tree;
mod light_tree_kernel;
mod many_lamps;
mod near;
mod panorama;
mod passed;
mod random_materials;
mod sheen;
