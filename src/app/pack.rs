//! `pack` and `unpack`: a scene and everything that it reads as one ZIP file, to be rendered elsewhere.
//!
//! Files keep their relative places, so that every path in scene text, scripts and models still leads to its
//! file; the manifest at the end of the pack says what is rendered, and how.

pub mod unfinished;
pub mod unpack;

use std::{
    cell::RefCell,
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    io::{self, Seek, SeekFrom, Write},
    path::{Component, Path, PathBuf},
};

use clap::Args;

use super::{args::SceneArgs, error::AppError, scene::load, shutdown};
use crate::{
    files::{Goal, Inputs, Temporary, folder_of, open_regular, sweep},
    output::{
        pack::{LIST, Manifest, PackWriter, fault_of_name},
        writable::check_writable,
    },
    runtime::scene_text::{SceneText, asset_folders},
    scene::{dependencies::Dependencies, project::UNPACKED},
};

/// Hash of the program's source and shaders, from `build.rs`.
const BUILT_FROM: &str = env!("REFLET_BUILT_FROM");

/// Arguments of `pack`.
#[derive(Clone, Debug, Args)]
pub struct PackArgs {
    /// Scene file or model
    pub scene: PathBuf,
    /// File to write, such as show.zip
    #[arg(short, long, value_name = "FILE", value_hint = clap::ValueHint::AnyPath)]
    pub output: Goal,
    /// Overrides of scene values, recorded in the pack, whose files stay unchanged
    #[command(flatten)]
    pub from: SceneArgs,
}

/// Writes a scene and its files into one ZIP file.
///
/// # Errors
/// Errors of the scene, [`AppError::Usage`] for names that a pack cannot hold and for an output that must not be
/// replaced, and a file that cannot be read or written; then no pack is left.
pub fn pack(args: &PackArgs) -> Result<(), AppError> {
    shutdown::listen();
    let layout = Layout::for_scene(&args.scene, &args.from)?;
    check_writable(&args.output, &Inputs::identify(layout.files.values()))?;
    sweep(std::slice::from_ref(&args.output));
    let goal = Temporary::create(&args.output)
        .map_err(|error| AppError::unwritten(&args.output, &error))?;
    let count = layout.files.len();
    let unwritten = |error: io::Error| AppError::unwritten(&args.output, &error);
    let full = RefCell::new(None);
    let manifest = write_zip(&goal.file, &full, layout);
    full.take().map_or(Ok(()), |error| Err(unwritten(error)))?;
    let manifest = manifest?;
    let pack_bytes = goal.file.metadata().map_err(unwritten)?.len();
    if let Some(fault) = manifest.fault_of_size(pack_bytes) {
        let output = args.output.display();
        let text = format!("--output {output}: {fault}, so `unpack` would refuse it");
        return Err(AppError::Usage(text));
    }
    let written = goal.file.sync_all();
    written.and_then(|()| goal.persist()).map_err(unwritten)?;
    let bytes = manifest.total_bytes();
    reflet_base::error_line!(
        "wrote {}: {count} {} of {:.1} MiB",
        args.output.display(),
        if count == 1 { "file" } else { "files" },
        bytes as f64 / f64::from(1 << 20)
    );
    Ok(())
}

/// Path of a file in the folder that its own leads to.
fn without_links(path: &Path) -> PathBuf {
    let folder = Path::new(".").join(folder_of(path)).canonicalize();
    let name = path.file_name().unwrap_or_default();
    folder.map_or_else(|_| path.to_owned(), |folder| folder.join(name))
}

/// Files of a pack by their names in it, and its manifest.
pub struct Layout {
    files: BTreeMap<String, PathBuf>,
    manifest: Manifest,
}

/// Folder with a copy of a scene's files.
#[derive(Debug)]
pub struct CopiedScene {
    /// Path of the scene's file.
    pub scene: PathBuf,
    /// Arguments with which it is opened there.
    pub from: SceneArgs,
}

impl Layout {
    /// Layout for a scene, which is loaded to find all of its files and to check it.
    ///
    /// # Errors
    /// Errors of the scene, and [`AppError::Usage`] for names that a pack cannot hold.
    pub fn for_scene(scene: &Path, from: &SceneArgs) -> Result<Self, AppError> {
        match from.project_of(Some(scene))? {
            None => Self::of_path(scene, from),
            // The folder of a project has its links resolved.
            Some(_) => Self::of_path(&without_links(scene), from),
        }
    }

    /// Copies the files into an existing folder, where they keep their places to each other.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn copy_to(&self, folder: &Path) -> io::Result<CopiedScene> {
        for (name, path) in &self.files {
            let goal = folder.join(name);
            fs::create_dir_all(folder_of(&goal))?;
            let mut from = open_regular(path, false)?;
            io::copy(&mut from, &mut fs::File::create(&goal)?)?;
        }
        let manifest = &self.manifest;
        Ok(CopiedScene {
            scene: folder.join(&manifest.scene),
            from: SceneArgs {
                set: manifest.set.clone(),
                variant: manifest.variant.clone(),
                assets: manifest.assets.iter().map(|f| folder.join(f)).collect(),
                lenient: manifest.lenient,
                strict: manifest.strict,
                project: manifest.project.as_ref().map(|own| folder.join(own)),
                no_project: manifest.project.is_none(),
            },
        })
    }

    fn of_path(scene: &Path, from: &SceneArgs) -> Result<Self, AppError> {
        let texts = Dependencies::default();
        let text = SceneText::read(Some(scene), &from.options());
        let text = text.map_err(AppError::Scene)?;
        let name = text.name();
        let opened = text.open(&[], &texts).map_err(AppError::Scene)?;
        let searched = opened.options.dependencies.clone();
        let timeline = opened.scene.timeline.clone();
        let loaded = load(opened, name)?;
        let scene = absolute(scene)?;
        let named = texts.paths().into_iter().chain(searched.paths());
        let paths = all_files(&scene, named, &loaded.world.files)?;
        let mut assets = Vec::new();
        let project = loaded.project.as_deref();
        for folder in asset_folders(&from.assets) {
            let folder = absolute(&folder)?;
            if paths.iter().any(|path| path.starts_with(&folder)) && !assets.contains(&folder) {
                assets.push(folder);
            }
        }
        let own = project.map(|project| project.folder.as_path());
        let places = Places::for_files(&scene, own, &paths, &assets);
        let inside = |path: &Path| places.name(path);
        let manifest = Manifest {
            assets: assets.iter().map(|f| inside(f)).collect::<Result<_, _>>()?,
            set: from.set.clone(),
            variant: from.variant.clone(),
            lenient: from.lenient,
            strict: from.strict,
            project: own.map(inside).transpose()?,
            frames: timeline.map(|t| [t.start, t.end]),
            ..Manifest::new(inside(&scene)?, BUILT_FROM)
        };
        let named = |path: PathBuf| Ok((inside(&path)?, path));
        let files = paths
            .into_iter()
            .map(named)
            .collect::<Result<BTreeMap<_, _>, AppError>>()?;
        if let Some(name) = [LIST, UNPACKED]
            .into_iter()
            .find(|name| files.contains_key(*name))
        {
            let text = format!(
                "a file of the scene is named {name}, as a file of all packs is; rename it"
            );
            return Err(AppError::Usage(text));
        }
        Ok(Self { files, manifest })
    }
}

/// Where files are in a pack.
struct Places {
    /// Folder whose content is at the top of the pack.
    top: PathBuf,
    /// Folders elsewhere, each with its name in the pack.
    moved: Vec<(PathBuf, String)>,
}

impl Places {
    /// Places of the files at `paths`: files of the scene at the top, asset folders elsewhere as `assets`, `assets-2`,
    /// …, so that a pack does not tell where its maker keeps them. Where a text climbs out of its folder by `..`, all
    /// keep their places to each other. Files of a project, in the folder that is given with the scene, keep theirs in
    /// any case.
    fn for_files(
        scene: &Path,
        project: Option<&Path>,
        paths: &BTreeSet<PathBuf>,
        assets: &[PathBuf],
    ) -> Self {
        let is_asset = |path: &Path| assets.iter().any(|folder| path.starts_with(folder));
        let own = paths
            .iter()
            .filter(|path| *path == scene || !is_asset(path));
        let top = common_folder(own.map(|path| folder_of(path)).chain(project));
        // Names in a project do not leave it.
        let may_leave = |path: &Path| project.is_none_or(|folder| !path.starts_with(folder));
        let is_apart = |folder: &&PathBuf| !folder.starts_with(&top) && !top.starts_with(folder);
        let apart: Vec<&PathBuf> = assets.iter().filter(is_apart).collect();
        if apart.is_empty() || paths.iter().any(|path| may_leave(path) && climbs(path)) {
            let folders = paths.iter().map(|path| folder_of(path)).chain(project);
            return Self {
                top: common_folder(folders.chain(assets.iter().map(PathBuf::as_path))),
                moved: Vec::new(),
            };
        }
        let near = assets.iter().filter(|folder| !is_apart(folder));
        let top = common_folder(
            [top.as_path()]
                .into_iter()
                .chain(near.map(PathBuf::as_path)),
        );
        let is_free = |name: &String| !paths.iter().any(|path| path.starts_with(top.join(name)));
        let numbered = (2..).map(|number| format!("assets-{number}"));
        let names = std::iter::once("assets".to_owned())
            .chain(numbered)
            .filter(is_free);
        // Folders inside of others keep their places there.
        let is_outermost = |folder: &&&PathBuf| {
            !apart
                .iter()
                .any(|other| *other != **folder && folder.starts_with(other))
        };
        let outermost = apart.iter().filter(is_outermost);
        let moved = outermost
            .map(|folder| (*folder).clone())
            .zip(names)
            .collect();
        Self { top, moved }
    }

    /// Name of a file or folder in the pack.
    fn name(&self, path: &Path) -> Result<String, AppError> {
        let moved = self
            .moved
            .iter()
            .find(|(folder, _)| path.starts_with(folder));
        let Some((folder, name)) = moved else {
            return name_in(&self.top, path);
        };
        Ok(match name_in(folder, path)?.as_str() {
            "" => name.clone(),
            rest => format!("{name}/{rest}"),
        })
    }
}

/// Whether a text of a scene or a script has a path that begins with `..`, as far as a file that can be read tells.
fn climbs(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    matches!(ending, Some("toml" | "rhai" | "usda"))
        && fs::read(path).is_ok_and(|text| text.windows(3).any(|part| part == b"../"))
}

/// Every file that was read, by the path that named it, since a link in the scene's folder is a file in the
/// pack; files read by no such path, by their own. Paths that were only searched for may not exist.
fn all_files(
    scene: &Path,
    named: impl Iterator<Item = PathBuf>,
    read: &[PathBuf],
) -> Result<BTreeSet<PathBuf>, AppError> {
    let mut paths = BTreeSet::from([scene.to_owned()]);
    for path in named.filter(|path| path.is_file()) {
        paths.insert(absolute(&path)?);
    }
    let real = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let known: BTreeSet<_> = paths.iter().map(|path| real(path)).collect();
    for path in read.iter().filter(|path| !known.contains(&real(path))) {
        paths.insert(absolute(path)?);
    }
    Ok(paths)
}

/// Absolute path without `.` and `..`.
fn absolute(path: &Path) -> Result<PathBuf, AppError> {
    let whole = std::path::absolute(path)
        .map_err(|error| AppError::Usage(format!("{}: {error}", path.display())))?;
    let climbs = whole.components().any(|c| c == Component::ParentDir);
    match (whole.parent(), whole.file_name()) {
        // Only the system can resolve `..` behind a symbolic link.
        (Some(folder), Some(name)) if climbs => fs::canonicalize(folder)
            .map(|folder| folder.join(name))
            .map_err(|error| AppError::Usage(format!("{}: {error}", path.display()))),
        (Some(_), None) if climbs => fs::canonicalize(&whole)
            .map_err(|error| AppError::Usage(format!("{}: {error}", path.display()))),
        _ => Ok(whole),
    }
}

/// Deepest folder that contains all of these folders, or is among them.
fn common_folder<'a>(mut folders: impl Iterator<Item = &'a Path>) -> PathBuf {
    let mut top = folders.next().unwrap_or(Path::new("")).to_owned();
    for folder in folders {
        while !folder.starts_with(&top) && top.pop() {}
    }
    top
}

/// Name of a file or folder in the pack: its path from `top`, with `/`; empty for `top` itself.
fn name_in(top: &Path, path: &Path) -> Result<String, AppError> {
    let refuse = |why: &str| {
        Err(AppError::Usage(format!(
            "{}: a pack cannot hold it: {why}",
            path.display()
        )))
    };
    let Ok(rest) = path.strip_prefix(top) else {
        return refuse("it is on another drive than the scene");
    };
    let parts: Option<Vec<_>> = rest.iter().map(|part| part.to_str()).collect();
    let Some(parts) = parts else {
        return refuse("its name is not UTF-8");
    };
    let name = parts.join("/");
    match fault_of_name(&name) {
        Some(why) if !name.is_empty() => refuse(why),
        _ => Ok(name),
    }
}

/// A file whose reading fails once the program is told to stop.
struct UntilSignal(fs::File);

impl io::Read for UntilSignal {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match shutdown::is_requested() {
            // Not `Interrupted`, after which readers try again.
            true => Err(io::Error::other("the program was told to stop")),
            false => self.0.read(buffer),
        }
    }
}

/// Writes the files in the order of their names, then the manifest; equal files give equal bytes. Ends when `error` holds
/// an error of the ZIP file itself.
fn write_zip(
    file: &fs::File,
    error: &RefCell<Option<io::Error>>,
    layout: Layout,
) -> Result<Manifest, AppError> {
    let failed = |error: io::Error| AppError::unwritten(Path::new("the pack"), &error);
    let goal = io::BufWriter::new(UntilError { file, error });
    let mut pack = PackWriter::new(goal, layout.manifest);
    for (name, path) in layout.files {
        let unread = |error: io::Error| {
            AppError::Internal(format!("cannot read {}: {error}", path.display()))
        };
        let file = open_regular(&path, false).map_err(unread)?;
        let bytes = file.metadata().map_err(unread)?.len();
        let ended = |error: io::Error| match shutdown::is_requested() {
            true => AppError::Interrupted("stopped; no pack was written".to_owned()),
            false => unread(error),
        };
        pack.add(&name, bytes, UntilSignal(file), ended, failed)?;
        if error.borrow().is_some() {
            return Ok(pack.manifest);
        }
    }
    let (mut rest, manifest) = pack.finish().map_err(failed)?;
    rest.flush().map_err(failed)?;
    Ok(manifest)
}

/// Writes and seeks until an error, which it keeps, and then writes nothing more: the library would print words of its
/// own when it is dropped.
struct UntilError<'a> {
    /// The file.
    pub file: &'a File,
    /// The first error.
    pub error: &'a RefCell<Option<io::Error>>,
}

impl Write for UntilError<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.error.borrow().is_none() {
            match self.file.write(bytes) {
                Err(error) if error.kind() != io::ErrorKind::Interrupted => {
                    self.error.replace(Some(error));
                }
                written => return written,
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for UntilError<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}
