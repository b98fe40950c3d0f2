//! Pictures with known answers: closed forms, and pairs of renders that must agree.

#[path = "../common/mod.rs"]
mod common;

mod agreement;
mod alpha;
mod animation;
mod audit;
mod bounces;
mod change;
mod chunks;
mod closed_form;
mod coat_normals;
mod counts;
mod culled;
mod decide;
mod deform;
mod edge_cases;
mod emitters;
mod energy;
mod environment;
mod extent;
mod far;
mod film_grooves_dispersion;
mod foreign_worlds;
mod indirect;
mod kit;
mod lamp;
mod layers;
mod lens;
mod light_reuse;
mod material;
mod mesh;
mod moving;
mod oracle;
mod orthographic;
mod panorama;
mod pattern;
mod precision;
mod random_materials;
mod ray_list;
mod sheen;
mod shown;
mod specialized;
mod terminator;
mod textures;
