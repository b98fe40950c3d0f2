//! The metrics against stored reference values, closed forms and properties.

mod generate;
mod hits;
mod pinned;
mod properties;
mod regions;
mod temporal;
