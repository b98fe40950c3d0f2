//! Unique names for items that may share one, in time that grows with their number.

use std::collections::HashMap;

/// Names that are taken.
#[derive(Clone, Debug, Default)]
pub struct UniqueNames {
    /// Each name, with the largest number that was tried for it.
    taken: HashMap<String, usize>,
}

impl UniqueNames {
    /// Takes a name: the first item keeps it, the next become `name#2`, `name#3` and so on, without taken names.
    pub fn take(&mut self, name: &str) -> String {
        let Some(mut number) = self.taken.get(name).copied() else {
            self.taken.insert(name.to_owned(), 1);
            return name.to_owned();
        };
        let unique = loop {
            number += 1;
            let numbered = format!("{name}#{number}");
            if !self.taken.contains_key(&numbered) {
                break numbered;
            }
        };
        self.taken.insert(name.to_owned(), number);
        self.taken.insert(unique.clone(), 1);
        unique
    }
}

/// Makes names unique, in their order, as [`UniqueNames::take`].
pub fn unique_names<'n>(names: impl IntoIterator<Item = &'n str>) -> Vec<String> {
    let mut taken = UniqueNames::default();
    names.into_iter().map(|name| taken.take(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        let names = unique_names(["ball", "floor", "ball", "ball"]);
        assert_eq!(names, ["ball", "floor", "ball#2", "ball#3"]);
        let names = unique_names(["a", "a#2", "a", "a#2", "a"]);
        assert_eq!(names, ["a", "a#2", "a#3", "a#2#2", "a#4"]);
    }
}
