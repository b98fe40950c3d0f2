//! Scene text: what people write, read with all its errors at once.

mod below;
pub mod desc;
pub mod diagnostic;
pub mod manual;
pub mod motion;
pub mod parse;
pub mod schema;
pub mod script;
pub mod trail;
