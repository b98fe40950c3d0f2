//! Reading scene text: good scenes, bad scenes with their exact messages, hostile ones, the manual.

mod bad;
mod docs;
mod hostile;
mod schema;
mod set;
mod text;
