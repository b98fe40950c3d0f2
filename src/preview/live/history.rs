//! Changes of texts on disk, written in one step each, with undo and redo.

use std::path::PathBuf;

use crate::write_back::Change;
use reflet_base::files::replace_content;

/// Written edits, for undo and redo.
#[derive(Debug, Default)]
pub struct History {
    done: Vec<Change>,
    undone: Vec<Change>,
    /// Number of times that a text was written.
    writes: u64,
}

impl History {
    /// Number of times that a text was written.
    pub fn writes(&self) -> u64 {
        self.writes
    }

    /// Writes a change and records it for undo; a change without effect is skipped. One that was made from an
    /// older text than the last written one is refused.
    ///
    /// # Errors
    /// A file that is read-only, or was changed meanwhile: nothing is written.
    pub fn write(&mut self, change: Change) -> Result<(), String> {
        if change.before == change.after {
            return Ok(());
        }
        Self::replace(&change, [&change.before, &change.after])?;
        self.writes += 1;
        self.done.push(change);
        self.undone.clear();
        Ok(())
    }

    /// Undoes the last change, or with `again` redoes the change that was undone last; returns its file, or `None` if
    /// there is none.
    ///
    /// # Errors
    /// Same errors as [`History::write`]; the change can still be undone or redone then.
    pub fn undo(&mut self, again: bool) -> Result<Option<PathBuf>, String> {
        let (from, to) = match again {
            true => (&mut self.undone, &mut self.done),
            false => (&mut self.done, &mut self.undone),
        };
        let Some(change) = from.last() else {
            return Ok(None);
        };
        match again {
            true => Self::replace(change, [&change.before, &change.after])?,
            false => Self::replace(change, [&change.after, &change.before])?,
        }
        let path = change.path.clone();
        self.writes += 1;
        to.extend(from.pop());
        Ok(Some(path))
    }

    /// Replaces the text `from` of a changed file by the text `to`.
    fn replace(change: &Change, [from, to]: [&str; 2]) -> Result<(), String> {
        let shown = change.path.display();
        let failed = |error: std::io::Error| format!("{shown} cannot be written: {error}");
        // Symbolic links stay, and lead to the same file.
        let path = change.path.canonicalize().map_err(failed)?;
        match replace_content(&path, from.as_bytes(), to.as_bytes(), || {}).map_err(failed)? {
            true => Ok(()),
            false => Err(format!(
                "{shown} was changed on disk and is not shown yet; nothing is written"
            )),
        }
    }
}
