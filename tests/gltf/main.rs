//! glTF loading: features, hostile files and external corpora.

#[path = "../common/mod.rs"]
mod common;

mod animation;
mod animation_corpus;
mod animation_hidden;
mod animation_names;
mod assets;
mod corpus;
mod geometry;
mod hostile;
mod image;
mod judge;
mod kit;
mod limits;
mod material;
mod overrides;
mod scene;
mod skin;
