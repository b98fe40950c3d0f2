//! Pictures with known answers: closed forms, and pairs of renders that must agree.

#[path = "../common/mod.rs"]
mod common;

mod agreement;
mod animation;
mod change;
mod closed_form;
mod counts;
mod decide;
mod edge_cases;
mod environment;
mod extent;
mod foreign_worlds;
mod kit;
mod lamp;
mod layers;
mod light_reuse;
mod material;
mod mesh;
mod moving;
mod oracle;
mod panorama;
mod ray_list;
mod specialized;
mod textures;
