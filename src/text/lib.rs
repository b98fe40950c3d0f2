//! Lines of text: fonts, the places of letters in a line, and the outlines of letters. Looks for no files.

mod charstring;
mod font;
mod lines;
mod names;
mod runs;

pub use self::{
    font::{Font, WrongFont},
    lines::{Letter, Line, Lines},
    names::FontNames,
};
