//! Names of files that people take for the same: systems that ignore case, and forms of Unicode, tell them apart
//! elsewhere.

use std::{
    fs,
    path::{Component, Path, PathBuf},
};

/// Maximum number of names of a folder that are compared.
const MOST_NAMES: usize = 10_000;

/// Name below `folder` of a file that is there, and differs from `name` in the case of letters or the Unicode form of
/// letters with accents alone. `name` is relative.
/// No folder outside of `folder` is listed, also where a link leads there.
pub fn similar(folder: &Path, name: &Path) -> Option<PathBuf> {
    let root = folder.canonicalize().ok()?;
    let mut found = PathBuf::new();
    for part in name.components() {
        let here = folder.join(&found);
        let Component::Normal(wanted) = part else {
            found.push(part);
            continue;
        };
        if here.join(wanted).exists() {
            found.push(wanted);
            continue;
        }
        let here = here.canonicalize().ok()?;
        if !here.starts_with(&root) {
            return None;
        }
        let wanted = folded(wanted.to_str()?);
        let names = fs::read_dir(here).ok()?.take(MOST_NAMES).flatten();
        let mut names = names.map(|entry| entry.file_name());
        found.push(names.find(|name| name.to_str().is_some_and(|name| folded(name) == wanted))?);
    }
    Some(found)
}

/// Name in lower case, with a star for each letter that is not of ASCII or has accents of its own: "é" as one
/// character, and as "e" with a combining accent.
fn folded(name: &str) -> String {
    let mut folded = String::new();
    for letter in name.chars().flat_map(char::to_lowercase) {
        match letter {
            '\u{300}'..='\u{36f}' => {
                folded.pop();
                folded.push('*');
            }
            letter if letter.is_ascii() => folded.push(letter),
            _ => folded.push('*'),
        }
    }
    folded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_another_case_or_unicode_form_are_found() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let inner = folder.join("Maps");
        fs::create_dir_all(&inner).unwrap();
        for name in ["Wood.PNG", "cafe\u{301}.png"] {
            fs::write(inner.join(name), "").unwrap();
        }
        for (asked, expected) in [
            ("Maps/Wood.PNG", Some("Maps/Wood.PNG")),
            ("maps/wood.png", Some("Maps/Wood.PNG")),
            ("./maps/../maps/wood.png", Some("./Maps/../Maps/Wood.PNG")),
            ("Maps/caf\u{e9}.png", Some("Maps/cafe\u{301}.png")),
            ("Maps/cafe.png", None),
            ("Maps/wool.png", None),
            ("none/wood.png", None),
        ] {
            let found = similar(folder, Path::new(asked));
            assert_eq!(found.as_deref(), expected.map(Path::new), "{asked}");
        }
        assert_eq!(similar(&inner, Path::new("../maps/Wood.PNG")), None);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../Maps", inner.join("here")).unwrap();
            std::os::unix::fs::symlink("..", inner.join("out")).unwrap();
            let through = |name: &str| similar(&inner, Path::new(name));
            assert_eq!(through("here/wood.png"), Some("here/Wood.PNG".into()));
            assert_eq!(through("out/maps/wood.png"), None);
        }
    }
}
