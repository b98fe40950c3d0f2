//! USD stages: converted to glTF by the Python tools in a process of their own, once per content.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    time::SystemTime,
};

use sha2::{Digest as _, Sha256};

use self::{
    advice::in_reflet,
    conversion_record::{Inputs, Record, Sidecar, SidecarWarning},
    tool::Tool,
};
use super::gltf::Fault;
use reflet_base::{
    cache::{CACHE_ENV, folder},
    files::{Goal, hex, write_whole},
};
use reflet_scene::{desc::StageDesc, diagnostic::Diagnostic};

mod advice;
mod conversion_record;
mod tool;

/// Environment variable with the converter's command.
pub const TOOL_ENV: &str = "REFLET_USD";
/// Folder of conversions, below the user's cache folder.
pub const CACHE_FOLDER: &str = "usd";

/// A stage as glTF.
#[derive(Clone, Debug)]
pub struct Converted {
    /// The converted file.
    pub glb: PathBuf,
    /// Every file that the conversion read.
    pub files: Vec<PathBuf>,
    /// Conversion losses, and whether the cache was used.
    pub warnings: Vec<Diagnostic>,
}

/// Converted parts of a stage, as arguments of the converter; empty by default.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Choice(Vec<String>);

impl Choice {
    /// Choice that the scene text makes.
    pub fn from_desc(desc: &StageDesc) -> Self {
        let mut arguments = Vec::new();
        for variant in &desc.variants {
            arguments.extend(["--variant".to_owned(), variant.value.clone()]);
        }
        if !desc.purpose.is_empty() {
            let words: Vec<_> = desc
                .purpose
                .iter()
                .map(|word| word.value.as_str())
                .collect();
            arguments.extend(["--purpose".to_owned(), words.join(",")]);
        }
        if desc.subdiv > 0 {
            arguments.extend(["--subdiv".to_owned(), desc.subdiv.to_string()]);
        }
        Self(arguments)
    }
}

/// Maximum number of conversions of a stage whose files change meanwhile.
const MOST_TRIES: usize = 3;

/// Converts the chosen parts of a stage, the file of `model`, or finds a cached conversion
/// of the same content. Layers and textures may lie in `roots` too.
///
/// # Errors
/// A missing converter, with the command that installs it; a stage that it refuses, with its reason;
/// a cache folder that cannot be written.
pub fn convert(
    stage: &Path,
    model: &str,
    choice: &Choice,
    roots: &[PathBuf],
) -> Result<Converted, Fault> {
    if cfg!(target_arch = "wasm32") {
        let fault = Fault::new("usd-tool-missing", "a page cannot convert USD stages");
        return Err(fault.help("convert it on a machine that has Reflet, and drop the `.glb`"));
    }
    let cache = folder().join(CACHE_FOLDER);
    fs::create_dir_all(&cache).map_err(|e| cannot_keep(&cache, &e))?;
    let tool = Tool::find()?;
    // Each choice, list of folders and converter makes a different file of the same stage.
    let paths = [stage, &tool.path].into_iter();
    let paths = paths.chain(roots.iter().map(|r| &**r));
    let version = env!("CARGO_PKG_VERSION").as_bytes();
    let paths = paths.map(|p| p.as_os_str().as_encoded_bytes());
    let chosen = choice.0.iter().map(String::as_bytes);
    let name = hash_of([version].into_iter().chain(chosen).chain(paths));
    let record_path = cache.join(format!("{name}.json"));
    let glb = cache.join(format!("{name}.glb"));
    let earlier = Record::read(&record_path);
    let is_news = is_news(&name);
    if let Some(record) = &earlier
        && record.holds(&glb, &tool.version)
    {
        if is_news {
            reflet_base::error_line!(
                "usd: {} is unchanged, using its conversion {}",
                stage.display(),
                glb.display()
            );
        }
        return Ok(converted(stage, model, glb, record));
    }
    let known = earlier.map_or_else(Inputs::default, |record| record.inputs);
    let (record, is_steady) = run_conversion(&tool, stage, model, choice, roots, &glb, known)?;
    let mut result = converted(stage, model, glb, &record);
    if !is_steady {
        let message = format!(
            "its files changed during each of {MOST_TRIES} conversions, so the result may mix old and \
             new content; the conversion is not cached"
        );
        result.warnings.push(warning(stage, message, None));
    } else if let Ok(text) = serde_json::to_vec(&record) {
        write_whole(&Goal::in_folder(&record_path), &text)
            .map_err(|e| cannot_keep(&record_path, &e))?;
    }
    Ok(result)
}

/// Converts a stage to `glb`, again if its files change meanwhile; returns whether they were stable in the last
/// conversion. `known` are files that it probably reads.
fn run_conversion(
    tool: &Tool,
    stage: &Path,
    model: &str,
    choice: &Choice,
    roots: &[PathBuf],
    glb: &Path,
    mut known: Inputs,
) -> Result<(Record, bool), Fault> {
    let fresh = Fresh(glb.with_extension(format!("{}.glb", std::process::id())));
    let mut attempt = 0;
    loop {
        attempt += 1;
        reflet_base::error_line!("usd: converting {}", stage.display());
        let stage_path = stage.to_owned();
        let before = Inputs::hash(known.paths().chain([&stage_path]));
        let since = SystemTime::now();
        tool.convert(stage, model, &choice.0, &fresh.0, roots)?;
        let sidecar = read_sidecar(&fresh.sidecar())?;
        let read = sidecar.files.iter().chain(&sidecar.absent);
        let inputs = Inputs::hash(read.chain([&stage_path]));
        let is_steady = inputs.are_steady(&before, since);
        if is_steady || attempt == MOST_TRIES {
            let output = conversion_record::output(&fresh.0);
            fs::rename(&fresh.0, glb).map_err(|e| cannot_keep(glb, &e))?;
            let record = Record {
                converter: tool.version.clone(),
                glb: output.unwrap_or_default(),
                inputs,
                files: sidecar.files,
                warnings: sidecar.warnings,
            };
            return Ok((record, is_steady));
        }
        known = inputs;
    }
}

/// Temporary output of the converter, moved to its place at the end; another process may convert the same stage.
struct Fresh(PathBuf);

impl Fresh {
    fn sidecar(&self) -> PathBuf {
        PathBuf::from(format!("{}.json", self.0.display()))
    }
}

impl Drop for Fresh {
    fn drop(&mut self) {
        for path in [&self.0, &self.sidecar()] {
            let _ = fs::remove_file(path); // moved, or never written
        }
    }
}

/// Whether this conversion was not reported yet: a command may request it twice.
fn is_news(name: &str) -> bool {
    static TOLD: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
    told.insert(name.to_owned())
}

fn converted(stage: &Path, model: &str, glb: PathBuf, record: &Record) -> Converted {
    let mut files = record.files.clone();
    if !files.iter().any(|f| f == stage) {
        files.push(stage.to_owned());
    }
    Converted {
        glb,
        files,
        warnings: summarize(stage, model, &record.warnings),
    }
}

/// Name of the converter's warning about a stage without meshes, which lists what the stage has instead. Scenes do
/// without it: the reader of the output warns too, unless the stage has lights or cameras, which scenes use.
pub const STAGE_EMPTY: &str = "stage-empty";

/// Maximum number of listed warnings of one name; if there are more, only the first is shown, with a count.
const MOST_OF_A_NAME: usize = 3;

/// Summary of the converter's warnings.
fn summarize(stage: &Path, model: &str, warnings: &[SidecarWarning]) -> Vec<Diagnostic> {
    let mut names: Vec<&str> = Vec::new();
    for warning in warnings {
        if !names.contains(&warning.name.as_str()) {
            names.push(&warning.name);
        }
    }
    let of_name = |name: &str| {
        warnings
            .iter()
            .filter(move |w| w.name == name)
            .collect::<Vec<_>>()
    };
    let groups = names.into_iter().map(of_name);
    groups
        .flat_map(|group| summarize_name(stage, model, &group))
        .collect()
}

fn summarize_name(stage: &Path, model: &str, group: &[&SidecarWarning]) -> Vec<Diagnostic> {
    let is_long = group.len() > MOST_OF_A_NAME;
    let shown = if is_long { &group[..1] } else { group };
    let one = |w: &&SidecarWarning| {
        let said = in_reflet(&w.message, model);
        if w.name == STAGE_EMPTY {
            return Diagnostic {
                name: STAGE_EMPTY,
                ..warning(stage, said, None)
            };
        }
        let mut message = format!("{}: {said} [{}]", w.prim, w.name);
        let mut help = None;
        if is_long {
            message += &format!(", and {} more of that name", group.len() - 1);
            let inspect = format!("`reflet-usd inspect --json {}`", stage.display());
            help = Some(format!("{inspect} lists all"));
        }
        warning(stage, message, help)
    };
    shown.iter().map(one).collect()
}

fn warning(stage: &Path, message: String, help: Option<String>) -> Diagnostic {
    let warning = Diagnostic::in_file("usd", stage, message).warning();
    Diagnostic { help, ..warning }
}

fn hash_of<'a>(parts: impl IntoIterator<Item = &'a [u8]>) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    hex(&hash.finalize()[..16])
}

fn read_sidecar(path: &Path) -> Result<Sidecar, Fault> {
    let broken = |why: String| {
        Fault::new(
            "usd-sidecar-broken",
            format!("\"{}\": {why}", path.display()),
        )
    };
    let text = fs::read(path).map_err(|e| broken(e.to_string()))?;
    serde_json::from_slice(&text).map_err(|e| broken(e.to_string()))
}

fn cannot_keep(path: &Path, error: &std::io::Error) -> Fault {
    let mut fault = Fault::new(
        "usd-cache",
        format!("\"{}\" cannot be written: {error}", path.display()),
    );
    fault.help = Some(format!("name another folder in {CACHE_ENV}"));
    fault
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_of_one_name_are_merged() {
        let of = |name: &str, prim: &str| SidecarWarning {
            name: name.into(),
            prim: prim.into(),
            message: "is left out".into(),
        };
        let mut warnings = vec![of("a", "/A"), of("b", "/B"), of("a", "/C"), of("a", "/D")];
        let messages = |warnings: &[SidecarWarning]| -> Vec<String> {
            let told = summarize(Path::new("s.usda"), "model", warnings);
            told.into_iter().map(|warning| warning.message).collect()
        };
        let one_by_one = ["/A", "/C", "/D"].map(|prim| format!("{prim}: is left out [a]"));
        let b = "/B: is left out [b]".to_owned();
        assert_eq!(
            messages(&warnings),
            [&one_by_one[..], std::slice::from_ref(&b)].concat()
        );
        warnings.push(of("a", "/E"));
        let first = "/A: is left out [a], and 3 more of that name".to_owned();
        assert_eq!(messages(&warnings), [first, b]);
    }
}
