//! Unique names for items that may share one, so that they are found again after a reload.

use std::collections::HashMap;

/// Makes names unique: the first keeps its name, the next become `name#2`, `name#3` and so on.
pub fn unique_names<'n>(names: impl IntoIterator<Item = &'n str>) -> Vec<String> {
    let mut counts = HashMap::new();
    let each = names.into_iter().map(|name| {
        let count = counts.entry(name).or_insert(0_usize);
        *count += 1;
        match *count {
            1 => name.to_owned(),
            number => format!("{name}#{number}"),
        }
    });
    each.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        let names = unique_names(["ball", "floor", "ball", "ball"]);
        assert_eq!(names, ["ball", "floor", "ball#2", "ball#3"]);
    }
}
