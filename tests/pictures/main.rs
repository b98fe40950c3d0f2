//! Pictures with known answers: closed forms, and pairs of renders that must agree.

#![allow(clippy::print_stderr, reason = "tests say what they skip")]

#[macro_use]
#[path = "../common/mod.rs"]
mod common;
#[path = "../gpu/mod.rs"]
mod gpu;
#[path = "../light/mod.rs"]
mod light;
#[path = "../shaders/mod.rs"]
mod shaders;
#[path = "../trace_oracle/mod.rs"]
mod trace_oracle;

mod agreement;
mod animation;
mod audit;
mod bounces;
mod box_faces;
mod capsule_normals;
mod capsules;
mod change;
mod chunks;
mod closed_form;
mod coplanar;
mod counts;
mod culled;
mod decal_motion;
mod decals;
mod decide;
mod deform;
mod edge_cases;
mod far;
mod foreign_worlds;
mod kit;
mod light_reuse;
mod material;
mod mesh;
mod moving;
mod near_far;
mod oracle;
mod orthographic;
mod pattern;
mod patterned;
mod precision;
mod probe_panes;
mod probe_seams;
mod probe_upkeep;
mod probes;
mod queries;
mod ray_list;
mod script_mesh;
mod second_layer;
mod shown;
mod skip;
mod specialized;
mod terminator;
mod textures;
mod undersampled;
