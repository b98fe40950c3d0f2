//! USD stages: converted to glTF by the Python tools in a process of their own, once per content.

use std::{
    collections::BTreeSet,
    env, fs,
    io::ErrorKind,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::{Mutex, PoisonError},
};

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use super::gltf::Fault;
use crate::scene::diagnostic::{Diagnostic, Severity, Span};

/// Environment variable that names the converter's command.
pub const TOOL_ENV: &str = "REFLET_USD";
/// Environment variable that names the folder where conversions are kept.
pub const CACHE_ENV: &str = "REFLET_CACHE";

/// A stage as glTF.
#[derive(Clone, Debug)]
pub struct Converted {
    /// The converted file.
    pub glb: PathBuf,
    /// Every file that the conversion read.
    pub files: Vec<PathBuf>,
    /// What glTF could not carry, and whether the cache was used.
    pub warnings: Vec<Diagnostic>,
}

/// Whether a file is a USD stage, by its name.
pub fn is_stage(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    ["usd", "usda", "usdc", "usdz"]
        .iter()
        .any(|known| extension.eq_ignore_ascii_case(known))
}

/// What the converter writes beside its output.
#[derive(Deserialize, Serialize)]
struct Sidecar {
    #[serde(default)]
    files: Vec<PathBuf>,
    /// Files that were looked for and are not there; a conversion is out of date when they come.
    #[serde(default)]
    absent: Vec<PathBuf>,
    #[serde(default)]
    warnings: Vec<SidecarWarning>,
}

#[derive(Deserialize, Serialize)]
struct SidecarWarning {
    name: String,
    prim: String,
    message: String,
}

/// What is kept of a conversion: good as long as every file still has this content.
#[derive(Deserialize, Serialize)]
struct Record {
    glb: PathBuf,
    content: String,
    sidecar: Sidecar,
}

/// Converts a stage, or finds the conversion of the same content. Layers and textures may lie in
/// `roots` too.
///
/// # Errors
/// A missing converter, with the command that installs it; a stage that it refuses, with its reason;
/// a cache folder that cannot be written.
pub fn convert(stage: &Path, roots: &[PathBuf]) -> Result<Converted, Fault> {
    let cache = cache_folder().join("usd");
    fs::create_dir_all(&cache).map_err(|e| cannot_keep(&cache, &e))?;
    let tool = tool();
    // Other folders or another converter make another file of the same stage.
    let paths = [stage, &tool].into_iter().chain(roots.iter().map(|r| &**r));
    let version = env!("CARGO_PKG_VERSION").as_bytes();
    let name =
        hash_of(std::iter::once(version).chain(paths.map(|p| p.as_os_str().as_encoded_bytes())));
    let record_path = cache.join(format!("{name}.json"));
    if let Some(record) = valid_record(&record_path) {
        if is_news(&name) {
            eprintln!(
                "usd: {} is unchanged, using its conversion {}",
                stage.display(),
                record.glb.display()
            );
        }
        return Ok(converted(stage, record));
    }
    is_news(&name);
    eprintln!("usd: converting {}", stage.display());
    let glb = cache.join(format!("{name}.glb"));
    run(&tool, stage, &glb, roots)?;
    let sidecar = read_sidecar(&glb)?;
    let content = content_of(&sidecar, stage);
    let record = Record {
        glb,
        content,
        sidecar,
    };
    if let Ok(text) = serde_json::to_vec(&record) {
        crate::files::write_whole(&record_path, &text)
            .map_err(|e| cannot_keep(&record_path, &e))?;
    }
    Ok(converted(stage, record))
}

/// Whether this conversion is spoken of for the first time: a command may ask for it twice.
fn is_news(name: &str) -> bool {
    static TOLD: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
    told.insert(name.to_owned())
}

fn converted(stage: &Path, record: Record) -> Converted {
    let warning = |w: SidecarWarning| Diagnostic {
        severity: Severity::Warning,
        name: "usd",
        message: format!("{}: {} [{}]", w.prim, w.message, w.name),
        span: Span::default(),
        file: Some(stage.to_owned()),
        help: (w.name == "asset-outside-roots")
            .then(|| "allow the folder that it is in with --assets FOLDER".to_owned()),
        related: None,
    };
    let mut files = record.sidecar.files;
    if !files.iter().any(|f| f == stage) {
        files.push(stage.to_owned());
    }
    Converted {
        glb: record.glb,
        files,
        warnings: record.sidecar.warnings.into_iter().map(warning).collect(),
    }
}

/// The kept conversion, if it still is one.
fn valid_record(path: &Path) -> Option<Record> {
    let record: Record = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
    let stage = record.sidecar.files.first()?.clone();
    let same = record.glb.is_file() && content_of(&record.sidecar, &stage) == record.content;
    same.then_some(record)
}

/// A hash over the content of all files, or of the stage alone where the converter named none, and
/// of those that are not there, which are empty.
fn content_of(sidecar: &Sidecar, stage: &Path) -> String {
    let stage = [stage.to_owned()];
    let files = if sidecar.files.is_empty() {
        &stage
    } else {
        &sidecar.files[..]
    };
    let contents = files.iter().chain(&sidecar.absent);
    let contents: Vec<Vec<u8>> = contents.map(|f| fs::read(f).unwrap_or_default()).collect();
    hash_of(contents.iter().map(Vec::as_slice))
}

fn hash_of<'a>(parts: impl IntoIterator<Item = &'a [u8]>) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    hash.finalize()
        .iter()
        .take(16)
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// The converter: named by [`TOOL_ENV`], else of the checkout that this binary was built in, else
/// whatever the `PATH` has.
fn tool() -> PathBuf {
    if let Some(named) = env::var_os(TOOL_ENV).filter(|name| !name.is_empty()) {
        return named.into();
    }
    let exe = env::current_exe().ok();
    let checkout = exe.iter().flat_map(|exe| exe.ancestors());
    let venvs = checkout.map(|folder| folder.join(".venv/bin/reflet-usd"));
    venvs
        .into_iter()
        .find(|tool| tool.is_file())
        .unwrap_or_else(|| "reflet-usd".into())
}

fn run(tool: &Path, stage: &Path, glb: &Path, roots: &[PathBuf]) -> Result<(), Fault> {
    let mut command = Command::new(tool);
    command
        .arg("convert")
        .arg(stage)
        .arg("-o")
        .arg(glb)
        .stdin(Stdio::null());
    for root in roots.iter().filter(|root| root.is_dir()) {
        command.arg("--root").arg(root);
    }
    let output = command.output().map_err(|error| missing(tool, &error))?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let errors: Vec<&str> = said
        .lines()
        .filter(|line| !line.starts_with("warning"))
        .collect();
    let mut fault = Fault::new("usd-not-converted", errors.join("; "));
    fault.help = Some(format!(
        "try: {} convert {} -o out.glb",
        tool.display(),
        stage.display()
    ));
    Err(fault)
}

fn missing(tool: &Path, error: &std::io::Error) -> Fault {
    let text = if error.kind() == ErrorKind::NotFound {
        format!(
            "USD stages need the Python tools, and the command `{}` was not found",
            tool.display()
        )
    } else {
        format!("the command `{}` did not start: {error}", tool.display())
    };
    let mut fault = Fault::new("usd-tool-missing", text);
    fault.help = Some(format!(
        "run `pip install ./tools` in Reflet's folder, or name the command in {TOOL_ENV}"
    ));
    fault
}

fn read_sidecar(glb: &Path) -> Result<Sidecar, Fault> {
    let path = PathBuf::from(format!("{}.json", glb.display()));
    let broken = |why: String| {
        Fault::new(
            "usd-sidecar-broken",
            format!("\"{}\": {why}", path.display()),
        )
    };
    let text = fs::read(&path).map_err(|e| broken(e.to_string()))?;
    serde_json::from_slice(&text).map_err(|e| broken(e.to_string()))
}

fn cache_folder() -> PathBuf {
    let set = |name: &str| {
        env::var_os(name)
            .filter(|v| !v.is_empty())
            .map(PathBuf::from)
    };
    set(CACHE_ENV)
        .or_else(|| set("XDG_CACHE_HOME").map(|folder| folder.join("reflet")))
        .or_else(|| set("HOME").map(|home| home.join(".cache/reflet")))
        .or_else(|| set("LOCALAPPDATA").map(|folder| folder.join("reflet")))
        .unwrap_or_else(|| env::temp_dir().join("reflet"))
}

fn cannot_keep(path: &Path, error: &std::io::Error) -> Fault {
    let mut fault = Fault::new(
        "usd-cache",
        format!("\"{}\" cannot be written: {error}", path.display()),
    );
    fault.help = Some(format!("name another folder in {CACHE_ENV}"));
    fault
}
