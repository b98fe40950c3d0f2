//! Renderer: the frame, its passes and its statistics; and [`runtime`], the sessions that programs render scenes with.
//!
//! Its folders, each of which uses only folders above it:
//!
//! | folder | contents |
//! |---|---|
//! | [`layout`] | structs shared with the shaders, and how values are packed into them |
//! | [`settings`] | options of a frame, its view, precision, origin and unit of coordinates |
//! | [`lighting`] | lights for the shaders, tables of a lobe's albedo |
//! | [`buffers`] | arrays, textures and uniforms on the device, whatever they hold |
//! | [`plan`] | features and passes that a scene needs |
//! | [`decide`] | settings left to `auto`, chosen from rays that the CPU follows |
//! | [`upload`] | a world on the device |
//! | [`maps`] | maps that are drawn before a frame and kept: shadows, and maps captured for a method |
//! | [`pipeline`] | mechanism of passes: declaration, targets, lists, bindings, shader variants, recording |
//! | [`methods`] | methods of reflections beside rays and the march, a folder each: their maps and passes |
//! | [`passes`] | the passes in their order |
//! | [`renderer`] | a world that is rendered, changed and posed; statistics and error of its frames |
//! | [`picture`] | pictures and AOVs that are read back, tone mapped or encoded as PNG |
//! | [`runtime`] | keyed stages from a scene's text to its picture ([`runtime::Session`]) |
//! | [`query`] | questions about a scene, answered by rays on the CPU |
//!
//! It prints nothing and writes no file; `docs/examples/render_to_pixels.rs` is a program.

pub mod buffers;
pub mod decide;
pub mod error;
pub mod layout;
pub mod lighting;
pub mod maps;
pub mod methods;
pub mod passes;
pub mod picture;
pub mod pipeline;
pub mod plan;
pub mod query;
pub mod renderer;
pub mod runtime;
pub mod settings;
pub mod upload;

pub use error::RenderError;
pub use picture::aov::{Plane, PlaneData};
pub use picture::{PendingPicture, Picture, PictureRequest, so_far::SoFar};
pub use renderer::Renderer;
pub use renderer::error_estimate::ErrorEstimate;
pub use renderer::rebuild_summary::RebuildSummary;
pub use renderer::stages::Poses;
pub use settings::options::{Crop, Draft, RenderOptions, check_size};
pub use upload::validate::check_world;
