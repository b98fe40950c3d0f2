//! Collects messages while a scene is read, and maps byte ranges to places in files.

use std::{
    collections::{HashMap, HashSet},
    ops::Range,
    sync::Arc,
};

use crate::{
    diagnostic::{Diagnostic, MOST_SHOWN as MOST, Severity, Source, Span, left_out},
    syntax::{Entries, MOST_TABLES, MOST_TEXT_BYTES, tables_in},
};

/// Messages so far, and the texts they point into.
///
/// All texts share one range of positions: the file begins at 0, then the `--set` texts one after another. A tree
/// node's range therefore says by itself where it was written.
#[derive(Clone, Debug, Default)]
pub struct Report {
    sources: Vec<(usize, Arc<Source>)>,
    list: Vec<Diagnostic>,
    /// The last error beyond [`MOST`], kept only so that [`Report::error`] can return a reference.
    surplus: Option<Diagnostic>,
    left_out: usize,
    errors: usize,
    /// Positions of values that are floats, though they are written as integers.
    floats: HashSet<usize>,
    lacks_names: bool,
    /// Models of instances that a layer has removed.
    unplaced: HashSet<String>,
    /// Removals by layers, by the path that is removed.
    removed: HashMap<String, Removal>,
    /// The variant that is laid over the scene.
    variant: Option<String>,
    /// Variants whose tables are read; `None` for all.
    kept_variants: Option<HashSet<String>>,
    /// Tables of the texts of the scene.
    tables: usize,
}

/// Removal of a path by a layer.
#[derive(Clone, Debug)]
struct Removal {
    /// Place of the path in the layer's `remove`.
    at: Range<usize>,
    /// Name of the variant that removes the path; `None` for a base, or if the variant defines it anew.
    by: Option<String>,
    /// Name of a later variant that has keys at the path.
    changed_by: Option<String>,
}

impl Report {
    /// Same messages over other texts, in this order.
    pub fn with_sources(mut self, sources: impl Iterator<Item = Arc<Source>>) -> Self {
        self.sources.clear();
        self.tables = 0;
        for source in sources {
            self.add(&source);
        }
        self
    }

    /// Adds a text and returns the position where it begins.
    pub fn add(&mut self, source: &Arc<Source>) -> usize {
        let start = self.end();
        self.sources.push((start, Arc::clone(source)));
        self.tables += tables_in(&source.text);
        start
    }

    /// Adds the text of a file that is named at `at`, unless the scene's texts become too large by it, which is
    /// reported.
    pub fn admit(&mut self, source: &Arc<Source>, at: &Span) -> bool {
        let tables = self.tables + tables_in(&source.text);
        let excess = if self.end() + source.text.len() > MOST_TEXT_BYTES {
            format!("{} MiB", MOST_TEXT_BYTES >> 20)
        } else if tables > MOST_TABLES {
            format!("{MOST_TABLES} tables")
        } else {
            self.add(source);
            return true;
        };
        let message = format!("with this file, the texts of the scene have more than {excess}");
        let error = Diagnostic::new("scene-too-large", at.clone(), message);
        self.push(error.help("geometry belongs in glTF files, named by `file`"));
        self.note_lacking_names();
        false
    }

    /// Leaves out the tables of all variants but these, of which the scene does not read the others.
    pub fn keep_variants(&mut self, names: &[String]) {
        self.kept_variants = Some(names.iter().cloned().collect());
    }

    /// Entries of a text at its position, with the variants that are read.
    pub fn tree_of(&self, source: &Arc<Source>) -> Entries {
        let start = self.start_of(source);
        match &self.kept_variants {
            Some(kept) => (source.syntax()).moved_with_variants(start, |name| kept.contains(name)),
            None => source.syntax().moved(start),
        }
    }

    /// Position where an added text begins.
    pub fn start_of(&self, source: &Arc<Source>) -> usize {
        let mut all = self.sources.iter();
        let found = all.find(|(_, own)| Arc::ptr_eq(own, source));
        found.map_or_else(|| self.end(), |(start, _)| *start)
    }

    /// Notes that the value at a position is a float, though it is written as an integer.
    pub fn keep_float(&mut self, start: usize) {
        self.floats.insert(start);
    }

    /// Whether the value at a position is a float, though it is written as an integer.
    pub fn is_float(&self, start: usize) -> bool {
        self.floats.contains(&start)
    }

    /// Notes that a layer has removed a path such as `light.lamp`; `at` is the place of its `remove`.
    pub fn note_removed(&mut self, path: &str, at: &Range<usize>) {
        let removal = Removal {
            at: at.clone(),
            by: self.variant.clone(),
            changed_by: None,
        };
        self.removed.insert(path.to_owned(), removal);
    }

    /// Notes that a variant is laid over the scene now.
    pub fn begin_variant(&mut self, name: &str) {
        self.variant = Some(name.to_owned());
    }

    /// Notes that the variant is laid over the scene; `is_there` says which removed paths exist again.
    pub fn end_variant(&mut self, mut is_there: impl FnMut(&str) -> bool) {
        let variant = self.variant.take();
        for (path, removal) in &mut self.removed {
            // A path that the same variant removes and defines anew is an entry of its own.
            if removal.by == variant && is_there(path) {
                removal.by = None;
            }
            let is_new = removal.changed_by.is_none() && removal.by != variant;
            if is_new && is_there(path) {
                removal.changed_by.clone_from(&variant);
            }
        }
    }

    /// The variant that removes a path, and a later one that still has keys at it.
    pub fn disputed(&self, path: &str) -> Option<(&str, &str)> {
        let removal = self.removed.get(path)?;
        Some((removal.by.as_deref()?, removal.changed_by.as_deref()?))
    }

    /// Notes that a layer has removed an instance of a model.
    pub fn note_unplaced(&mut self, model: &str) {
        self.unplaced.insert(model.to_owned());
    }

    /// Replaces the models of removed instances by another scene's; returns the previous models.
    pub fn swap_unplaced(&mut self, other: HashSet<String>) -> HashSet<String> {
        std::mem::replace(&mut self.unplaced, other)
    }

    /// Whether a layer has removed an instance of a model.
    pub fn is_unplaced(&self, model: &str) -> bool {
        self.unplaced.contains(model)
    }

    /// Place where a layer removes a path.
    pub fn removed(&self, path: &str) -> Option<Span> {
        self.removed.get(path).map(|removal| self.span(&removal.at))
    }

    /// Notes that a script or an included file would add names to the scene, and failed to.
    pub fn note_lacking_names(&mut self) {
        self.lacks_names = true;
    }

    /// Whether an unknown name may be one that a failed script or file would have added.
    pub fn lacks_names(&self) -> bool {
        self.lacks_names
    }

    /// A separate report, for reading the same values without reporting their mistakes.
    pub fn silent(&self) -> Self {
        Self {
            floats: self.floats.clone(),
            ..Self::default()
        }
    }

    /// The first position after all texts; one is left free between texts, so that ends are unambiguous.
    fn end(&self) -> usize {
        let last = self.sources.last();
        last.map_or(0, |(base, source)| base + source.text.len() + 1)
    }

    /// The place of a range of positions.
    pub fn span(&self, at: &Range<usize>) -> Span {
        let index = self.sources.partition_point(|(base, _)| *base <= at.start);
        match self.sources.get(index.wrapping_sub(1)) {
            Some((base, source)) => Span {
                source: Some(Arc::clone(source)),
                range: at.start - base..at.end.max(at.start) - base,
            },
            None => Span::default(),
        }
    }

    /// Errors so far; equal counts before and after mean that nothing went wrong between.
    pub fn errors(&self) -> usize {
        self.errors
    }

    /// Whether further errors would only be counted, so that costly hints can be spared.
    pub fn is_full(&self) -> bool {
        self.list.len() >= MOST
    }

    /// Number of messages that are only counted so far, where there is no room for more.
    pub fn surplus(&self) -> Option<usize> {
        self.is_full().then_some(self.left_out)
    }

    /// Takes later messages out of the count, as they only follow from earlier ones.
    pub fn restore_surplus(&mut self, count: usize) {
        self.left_out = count;
    }

    /// Keeps a message.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        if diagnostic.severity == Severity::Error {
            self.errors += 1;
        }
        if self.is_full() {
            self.left_out += 1;
        } else {
            self.list.push(diagnostic);
        }
    }

    /// Keeps an error at a range; returns it for `help` and `related`.
    pub fn error(
        &mut self,
        name: &'static str,
        at: &Range<usize>,
        message: impl Into<String>,
    ) -> &mut Diagnostic {
        self.errors += 1;
        if self.is_full() {
            // This error is never shown, and finding its place may take long.
            self.left_out += 1;
            let diagnostic = Diagnostic::new(name, Span::default(), message);
            return self.surplus.insert(diagnostic);
        }
        let diagnostic = Diagnostic::new(name, self.span(at), message);
        self.list.push(diagnostic);
        let last = self.list.len() - 1;
        &mut self.list[last]
    }

    /// Replaces the help of the newest message.
    pub fn advise(&mut self, help: String) {
        if let Some(newest) = self.list.last_mut().filter(|_| self.left_out == 0) {
            newest.help = Some(help);
        }
    }

    /// Whether the newest message is kept and has no help.
    pub fn lacks_advice(&self) -> bool {
        let newest = self.list.last().filter(|_| self.left_out == 0);
        newest.is_some_and(|newest| newest.help.is_none())
    }

    /// Whether a message with that diagnostic name was kept.
    pub fn has(&self, name: &str) -> bool {
        self.list.iter().any(|d| d.name == name)
    }

    /// Advice of the message with this diagnostic name about a range.
    pub fn advice_at(&self, name: &str, at: &Range<usize>) -> Option<&str> {
        let span = self.span(at);
        let mut list = self.list.iter();
        let found = list.find(|it| it.name == name && it.span.range == span.range)?;
        found.help.as_deref()
    }

    /// Drops messages that `keep` rejects, such as consequences of an earlier mistake.
    pub fn retain(&mut self, keep: impl FnMut(&Diagnostic) -> bool) {
        self.list.retain(keep);
    }

    /// Same as [`Report::retain`], for a `keep` that may change the messages.
    pub fn retain_mut(&mut self, keep: impl FnMut(&mut Diagnostic) -> bool) {
        self.list.retain_mut(keep);
    }

    /// Merges errors that a loop of a script repeats into one, with their number, and errors of a scene that is placed
    /// several times, whose tables have another prefix each time.
    fn merge_repeated(&mut self) {
        let mut times: Vec<usize> = Vec::new();
        let mut kept: Vec<Diagnostic> = Vec::new();
        for next in self.list.drain(..) {
            let is_own = |s: &Arc<Source>| self.sources.iter().any(|(_, t)| Arc::ptr_eq(s, t));
            let in_script = next.span.source.as_ref().is_some_and(|s| !is_own(s));
            let alike = |d: &Diagnostic| d.name == next.name && d.span == next.span;
            let is_placed_again =
                |d: &Diagnostic| alike(d) && d.help.is_some() && d.help == next.help;
            match kept.iter().position(alike).filter(|_| in_script) {
                Some(first) => times[first] += 1,
                None if !in_script && kept.iter().any(is_placed_again) => {}
                None => {
                    kept.push(next);
                    times.push(0);
                }
            }
        }
        for (diagnostic, more) in kept.iter_mut().zip(times).filter(|(_, more)| *more > 0) {
            diagnostic.message += &format!(" (and {more} more like it)");
        }
        self.list = kept;
    }

    /// All messages in the order of the text, file first; true if there were errors.
    pub fn finish(mut self) -> (Vec<Diagnostic>, bool) {
        let order = |d: &Diagnostic| {
            let source = d.span.source.as_ref();
            let index = source.map(|s| self.sources.iter().position(|(_, t)| Arc::ptr_eq(s, t)));
            // Scripts come last.
            let index = index.map(|index| index.unwrap_or(usize::MAX));
            (index, d.span.range.start, d.span.range.end)
        };
        self.list.sort_by_cached_key(order);
        self.list.dedup(); // a mistake in a value that several tables share by `extends`
        self.merge_repeated();
        let failed = self.errors > 0;
        if self.left_out > 0 {
            self.list.push(left_out(self.left_out, failed));
        }
        (self.list, failed)
    }
}
