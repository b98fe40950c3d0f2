//! Constants and files of shaders that features choose, and the sets of features whose shaders tests validate.

use super::{feature_table::FeatureRow, features::Features};

impl Features {
    /// Values of the pipeline constants, by name.
    pub fn constants(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let value =
            |row: &FeatureRow<Self>| Some((row.constant?, f64::from(u8::from((row.get)(self)))));
        Self::ROWS.iter().filter_map(value)
    }

    /// Imports of shaders, each with the ending of the file that stands for it.
    pub fn imports(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        Self::ROWS.iter().flat_map(|row| {
            let is_on = usize::from((row.get)(self));
            row.files
                .iter()
                .map(move |files| (files.import, files.endings[is_on]))
        })
    }

    /// Sets in which every two of the constants and files that features choose meet, to find bindings that are too many
    /// and names that are missing or double: none, all, and for each feature that chooses some the least set with it
    /// and the largest without. Their constants or files differ.
    pub fn variants() -> Vec<Self> {
        let with = |rows: &[&FeatureRow<Self>]| {
            let mut set = Self::default();
            for own in rows.iter().filter_map(|row| row.own) {
                *own(&mut set) = true;
            }
            set.with_followers()
        };
        let own: Vec<_> = Self::ROWS.iter().filter(|row| row.own.is_some()).collect();
        let mut sets = vec![Self::default(), with(&own)];
        let is_choice = |row: &&FeatureRow<Self>| row.constant.is_some() || !row.files.is_empty();
        for chosen in Self::ROWS.iter().filter(is_choice) {
            let brings = |row: &&&FeatureRow<Self>| (chosen.get)(&with(&[**row]));
            let least: Vec<_> = own.iter().filter(brings).take(1).copied().collect();
            let others: Vec<_> = own.iter().filter(|row| !brings(row)).copied().collect();
            sets.extend([with(&least), with(&others)]);
        }
        let mut seen: Vec<(Vec<_>, Vec<_>)> = Vec::new();
        sets.retain(|set| {
            let choices = (set.imports().collect(), set.constants().collect());
            let is_new = !seen.contains(&choices);
            seen.push(choices);
            is_new
        });
        sets
    }
}
