//! The metrics against stored reference values, closed forms and properties.

mod generate;
mod hits;
mod pinned;
mod properties;
mod regions;
mod temporal;

// Names that most tests of the metrics need.
pub use generate::{Random, flat, generated, picture, scores};
pub use reflet::metric::{
    Maps,
    mask::Mask,
    picture::{Encoding, Pair, Picture, PictureError},
};
