//! Supplies of shapes beside their descriptions: font and SVG files, and a budget of work for all shapes of a scene.

use std::collections::HashMap;

use reflet_base::{digits::grouped, memory::Budget};

use super::Fault;

/// Triangles, chords and crossings that the shapes of a scene may have together, with the triangles of each two parts
/// that are combined, and four for each pair of triangles near each other: half a minute of work, and a gigabyte of
/// memory.
pub const MOST_WORK: u64 = 1 << 24;

/// Font and SVG files, and the work that shapes may still take; clones share the work.
#[derive(Clone, Debug, Default)]
pub struct Supplies {
    /// Bytes of the files by their names in the scene.
    pub files: HashMap<String, Vec<u8>>,
    /// Work that is left; by default without a limit.
    pub work: Budget,
}

impl Supplies {
    /// Takes work, before it is done where its extent is known.
    ///
    /// # Errors
    /// `shapes-too-large` where less is left.
    pub fn spend(&self, work: usize) -> Result<(), Fault> {
        if self.work.take(work as u64) {
            return Ok(());
        }
        let most = grouped(MOST_WORK);
        let message = format!(
            "with this shape the shapes of the scene take more work than {most}: their triangles, chords of outlines \
             and crossings, and the triangles of parts, with the pairs near each other, each time that they are combined"
        );
        let help = "lower `segments`, place one model several times, or combine fewer parts";
        Err(Fault::new("shapes-too-large", message).help(help))
    }
}
