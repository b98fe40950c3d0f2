//! `manual`: the manual of scene text, or the part about a table, a key or a function of scripts.

use std::{path::PathBuf, sync::Arc};

use clap::Args;
use reflet_lsp::values;

use super::{error::AppError, print_out};
use crate::scene::{
    diagnostic::Source, manual::manual as of_scenes, parse, script::api::manual as of_scripts,
};

/// Arguments of `manual`.
#[derive(Clone, Debug, Args)]
pub struct ManualArgs {
    /// Table, key, or function of scripts to explain, such as light, material.roughness or noise
    pub key: Option<String>,
    /// Scene file whose names and files are listed where the key takes them
    #[arg(long, value_name = "FILE", requires = "key")]
    pub scene: Option<PathBuf>,
}

/// Prints the manual.
///
/// # Errors
/// [`AppError::Usage`] for a key that the manual does not have, [`AppError::Scene`] for a scene that cannot be read.
pub fn manual(args: &ManualArgs) -> Result<(), AppError> {
    let Some(key) = &args.key else {
        return print_out(&of_scenes());
    };
    let mut text = part(key);
    if text.is_empty() {
        let help = "`reflet manual` has all of scene text, `reflet scripting` all of scripts";
        return Err(AppError::Usage(format!(
            "there is no table, key or function `{key}`; {help}"
        )));
    }
    if let (Some(path), Some((table, key))) = (&args.scene, key.rsplit_once('.')) {
        let file = parse::read(path).map_err(AppError::Scene)?;
        let file = Arc::new(Source::new(path, file));
        let table: Vec<_> = table.split('.').map(str::to_owned).collect();
        let mut values = values(&file, &table, key);
        values.extend(values.is_empty().then(|| "no names or files".to_owned()));
        text += &format!("\nIn {}: {}\n", path.display(), values.join(", "));
    }
    print_out(&text)
}

/// The sections of the manuals about a table, and the rows of their tables about a key or function.
fn part(path: &str) -> String {
    let words: Vec<_> = path.split('.').collect();
    let (last, above) = words.split_last().expect("one at least");
    let text = [of_scenes(), of_scripts()].concat();
    let mut out = String::new();
    for section in text.split("\n## ").skip(1) {
        let (heading, body) = section.split_once('\n').unwrap_or((section, ""));
        let named = heading.split(|c: char| !c.is_alphanumeric() && c != '_');
        let named: Vec<_> = named.filter(|word| !word.is_empty()).collect();
        let begins = |path: &[&str]| {
            let mut both = path.iter().zip(&named);
            path.len() <= named.len() && both.all(|(word, own)| word == own || *own == "NAME")
        };
        let is_table = begins(&words) && named[words.len() - 1] == *last;
        if is_table {
            out += &format!("## {section}\n");
        } else if begins(above) {
            let name = |row: &str| {
                let cell = row.trim_start_matches("| ").split(['(', ' ', '=']).next()?;
                let name = cell.trim_matches('`').rsplit('.').next()?;
                Some(name.to_owned())
            };
            let is_own =
                |row: &&str| row.starts_with("| `") && name(row).is_some_and(|name| name == *last);
            let rows: Vec<_> = body.lines().filter(is_own).collect();
            if !rows.is_empty() {
                out += &format!("## {heading}\n{}\n\n", rows.join("\n"));
            }
        }
    }
    out
}
