//! glTF loading: features, hostile files and external corpora.

#![allow(clippy::print_stderr, reason = "tests say what they skip")]

#[macro_use]
#[path = "../common/mod.rs"]
mod common;
#[path = "../usd/mod.rs"]
mod usd;

mod animation;
mod animation_corpus;
mod animation_hidden;
mod animation_names;
mod assets;
mod buffers;
mod corpus;
mod default_camera;
mod deform;
mod draco;
mod equal_names;
mod extensions;
mod forgiven;
mod geometry;
mod hostile;
mod image;
mod image_light;
mod interchange;
mod judge;
mod kit;
mod ktx2;
mod ktx2_plain;
mod layers;
mod limits;
mod material;
mod material_faults;
mod memory;
mod meshopt;
mod node_chains;
mod overrides;
mod pointer;
mod promises;
mod reach;
mod scale;
mod scene;
mod scripted;
mod skin;
mod specular_glossiness;
mod variants;
mod wire;
mod work;
