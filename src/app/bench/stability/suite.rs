//! Choice of the scored scenes: modes of the suite, and scene files.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::{
    app::{bench::args::StabilityArgs, error::AppError},
    bench::stability::ratchet::Ratchet,
};

/// A scene of the suite or of the user.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Its number in the suite.
    pub number: Option<u32>,
    /// File name without its ending.
    pub name: String,
    /// The scene file.
    pub path: PathBuf,
}

/// Scenes that the arguments name; else the ratchet's scenes, else the whole suite.
///
/// # Errors
/// A scene that does not exist, two scenes of one name, and a suite with a gap.
pub fn choices(args: &StabilityArgs, ratchet: Option<&Ratchet>) -> Result<Vec<Choice>, AppError> {
    let held = ratchet
        .map(Ratchet::modes)
        .filter(|modes| !modes.is_empty());
    let named = match held {
        Some(modes) if args.modes.is_empty() => modes,
        _ => args.modes.clone(),
    };
    if named.is_empty() {
        return suite(&args.suite);
    }
    let mut choices: Vec<Choice> = Vec::new();
    for name in &named {
        let path = Path::new(name);
        let choice = if path.extension().is_some() || path.components().count() > 1 {
            let stem = path.file_stem().unwrap_or(path.as_os_str());
            Choice {
                number: None,
                name: stem.to_string_lossy().into_owned(),
                path: path.to_owned(),
            }
        } else {
            of_suite(&args.suite, name)?
        };
        if let Some(twin) = choices.iter().find(|c| c.name == choice.name) {
            return Err(AppError::Usage(format!(
                "{name}: {} has the same name; score one of them at a time",
                twin.path.display()
            )));
        }
        choices.push(choice);
    }
    Ok(choices)
}

/// A mode of the suite by its number or name.
fn of_suite(folder: &Path, name: &str) -> Result<Choice, AppError> {
    let suite = suite(folder)?;
    let number: Option<u32> = name.parse().ok();
    let is_named = |c: &&Choice| c.name == name || (number.is_some() && c.number == number);
    suite.iter().find(is_named).cloned().ok_or_else(|| {
        let names: Vec<&str> = suite.iter().map(|c| c.name.as_str()).collect();
        AppError::Usage(format!(
            "{name}: {} has no such mode; it has: {}. Scene files are named with their ending, \
             .toml",
            folder.display(),
            names.join(", ")
        ))
    })
}

/// All modes of the suite, in order.
fn suite(folder: &Path) -> Result<Vec<Choice>, AppError> {
    let usage = |text: String| AppError::Usage(format!("--suite {}: {text}", folder.display()));
    let entries = fs::read_dir(folder).map_err(|error| {
        usage(format!(
            "{error}; it must be a folder of scenes NN-name.toml, as scenes/fail in the repository"
        ))
    })?;
    let mut suite = Vec::new();
    for entry in entries {
        let path = entry.map_err(|error| usage(error.to_string()))?.path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let name = path.file_stem().unwrap_or_default();
        let name = name.to_string_lossy().into_owned();
        let number = name.split_once('-').and_then(|(n, _)| n.parse().ok());
        if number.is_none() {
            return Err(usage(format!("{name}.toml is not named NN-name.toml")));
        }
        suite.push(Choice { number, name, path });
    }
    suite.sort_by_key(|c| c.number);
    for (expected, choice) in (1..).zip(&suite) {
        if choice.number != Some(expected) {
            return Err(usage(format!(
                "mode {expected} is missing or there twice: {} is where it should be",
                choice.path.display()
            )));
        }
    }
    if suite.is_empty() {
        return Err(usage("there are no scenes NN-name.toml".to_owned()));
    }
    Ok(suite)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_suite_is_whole() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fail");
        let suite = suite(&folder).expect("a suite");
        assert_eq!(suite.len(), 30);
        assert!(suite[11].name.contains("sizes") && suite[25].name.contains("far-away"));
        let is_rails = |choice: Choice| choice.name == "03-rails";
        assert!(of_suite(&folder, "3").is_ok_and(is_rails));
        assert!(of_suite(&folder, "03-rails").is_ok_and(is_rails));
        let Err(AppError::Usage(says)) = of_suite(&folder, "99") else {
            panic!("there is no mode 99");
        };
        assert!(
            says.starts_with("99: ") && says.contains("28-curved-mirrors"),
            "{says}"
        );
    }
}
