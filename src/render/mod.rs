//! World → picture: the frame, its passes and what it reports.

pub mod aov;
mod build;
pub mod cause;
pub mod constants;
pub mod cull;
pub mod debug_readback;
pub mod download;
pub mod error;
pub mod frame;
pub mod geometry;
pub mod lights;
pub mod options;
pub mod pass;
pub mod passes;
pub mod picture;
pub mod plan;
pub mod probe;
pub mod ray_list;
pub mod recorder;
pub mod renderer;
pub mod scene;
pub mod stats;
pub mod targets;
pub mod textures;
pub mod types;
pub mod validate;
pub mod view;

pub use error::RenderError;
pub use options::RenderOptions;
pub use picture::{PendingPicture, Picture, PictureRequest, Plane, PlaneData};
pub use renderer::{RebuildSummary, Renderer};
pub use validate::check_world;
