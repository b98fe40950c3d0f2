//! Comparison of settings: runs over methods and settings, stability, and reports.
//!
//! `pareto` is pure (numbers in, numbers out); `run` measures into a table of samples, by the metrics of
//! [`reflet_metric`], and `report` draws from that table alone. Only `log` touches files.

mod cell;
pub mod choose;
pub mod csv;
pub mod hash;
pub mod host;
pub mod log;
pub mod parameter;
pub mod pareto;
pub mod report;
pub mod run;
pub mod sample;
pub mod score;
pub mod seams;
pub mod stability;
pub mod summary;
pub mod system;
pub mod systems;
