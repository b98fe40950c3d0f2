//! Scene text as users write it, read with all its errors at once.

mod confined_read;
pub mod dependencies;
pub mod desc;
pub mod diagnostic;
pub mod manual;
pub mod motion;
pub mod number;
pub mod parse;
pub mod range;
pub mod schema;
pub mod script;
pub mod stages;
mod suggest;
pub mod syntax;
pub mod toml_text;
