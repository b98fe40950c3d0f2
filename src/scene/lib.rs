//! Scene text as users write it, read with all its errors at once.
//!
//! This crate owns the scene format ([`desc`]), its manual and schema, the syntax tree of a text ([`syntax`]) and its
//! readers ([`table`], [`parse`]), the sandbox of scripts ([`script`]), animation tracks ([`motion`]), and the
//! diagnostics that all crates report ([`diagnostic`]). It reads texts and no assets, and knows no device.

#[macro_use]
pub mod declared;

mod confined_read;
pub mod dependencies;
pub mod desc;
pub mod diagnostic;
pub mod fonts;
mod forms;
pub mod manual;
pub mod motion;
pub mod number;
pub mod parse;
pub mod project;
pub mod range;
pub mod reach;
pub mod schema;
pub mod script;
pub mod stages;
pub mod suggest;
pub mod svg_path;
pub mod syntax;
pub mod table;
pub mod toml_text;
