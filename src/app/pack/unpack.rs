//! `unpack`: extracts an untrusted pack into a new folder; after an error, no folder is left.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, BufReader, Read, Seek, Write as _},
    path::{Path, PathBuf},
};

use clap::Args;

use super::{
    super::{args::option_words, error::AppError, print_out, shutdown},
    BUILT_FROM,
    unfinished::Unfinished,
};
use crate::{
    files::{Goal, folder_of, free_bytes, open_regular, sweep},
    output::pack::{self, Manifest, Pack, PackedFile},
    scene::{diagnostic::Diagnostic, project::UNPACKED},
};
use reflet_base::shell::shell_word;

/// Arguments of `unpack`.
#[derive(Clone, Debug, Args)]
pub struct UnpackArgs {
    /// File that `pack` wrote
    pub pack: PathBuf,
    /// Folder to create, which must not exist yet
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Checks every name, length and hash of a pack, extracts it, and prints the command that renders it.
///
/// # Errors
/// [`AppError::Usage`] if the folder exists, [`AppError::Scene`] for a file that is no pack or is damaged,
/// [`AppError::Disk`] for more bytes than the disk has, [`AppError::Interrupted`], and a folder that cannot be
/// written; then no folder is left.
pub fn unpack(args: &UnpackArgs) -> Result<(), AppError> {
    let refuse = |fault: Fault| match fault {
        Fault::Pack(message) => {
            let error = Diagnostic::in_file("bad-pack", &args.pack, message);
            AppError::Scene(vec![error.help("write it again with `reflet pack`")])
        }
        Fault::Disk(path, error) => AppError::unwritten(&path, &error),
        Fault::Interrupted => AppError::Interrupted("stopped; no folder was made".to_owned()),
    };
    shutdown::listen();
    sweep(&[Goal::typed(args.output.clone())]);
    if fs::symlink_metadata(&args.output).is_ok() {
        let folder = args.output.display();
        return Err(AppError::Usage(format!(
            "--output {folder}: it exists; name a new folder"
        )));
    }
    let file = open_regular(&args.pack, false)
        .map_err(|error| refuse(Fault::Pack(format!("cannot be read: {error}"))))?;
    let manifest = extract(file, &args.output).map_err(refuse)?;
    let count = manifest.files.len();
    let files = if count == 1 { "file" } else { "files" };
    let folder = args.output.display();
    reflet_base::error_line!("wrote {folder}: {count} {files}, as packed");
    if manifest.built_from != BUILT_FROM {
        reflet_base::error_line!(
            "note: another build of Reflet ({}) made this pack; pictures of this build may differ",
            manifest.reflet.escape_debug()
        );
    }
    print_out(&command(&manifest, &args.output))
}

/// Text of the file that marks the folder.
const MARK: &str = "`reflet unpack` made this folder. Reflet looks for no project (reflet.toml) in it or above it;\n\
                    `--project` names one.\n";

/// Extracts a pack into a new folder, which is marked as unpacked.
fn extract(file: File, output: &Path) -> Result<Manifest, Fault> {
    let disk = |error| Fault::Disk(output.to_owned(), error);
    let pack_bytes = file.metadata().map_err(disk)?.len();
    let mut pack = Pack::open(BufReader::new(file), pack_bytes)?;
    let manifest = pack.manifest.clone();
    check_disk(&manifest, output)?;
    let made = Unfinished::create(output).map_err(disk)?;
    for file in &manifest.files {
        write_file(&mut pack, file, made.path())?;
    }
    let mark = made.path().join(UNPACKED);
    std::fs::write(&mark, MARK).map_err(|error| Fault::Disk(mark, error))?;
    made.persist().map_err(disk)?;
    Ok(manifest)
}

/// Refuses files that the disk has no room for, before one is written.
fn check_disk(manifest: &Manifest, output: &Path) -> Result<(), Fault> {
    let needed = manifest.disk_bytes();
    match free_bytes(folder_of(output)) {
        Some(free) if free < needed => {
            let mebibytes = |bytes: u64| bytes as f64 / f64::from(1 << 20);
            let message = format!(
                "it needs {:.1} MiB, and the disk has {:.1} MiB left",
                mebibytes(needed),
                mebibytes(free)
            );
            let error = io::Error::new(io::ErrorKind::StorageFull, message);
            Err(Fault::Disk(output.to_owned(), error))
        }
        _ => Ok(()),
    }
}

/// Reason why no folder is made.
enum Fault {
    /// The pack is damaged, or the file is not a pack.
    Pack(String),
    /// A file cannot be written.
    Disk(PathBuf, io::Error),
    /// A signal asked for the end.
    Interrupted,
}

impl From<pack::Fault> for Fault {
    fn from(fault: pack::Fault) -> Self {
        Self::Pack(fault.0)
    }
}

/// Extracts one file, whose name was checked before, until a signal comes.
fn write_file(
    pack: &mut Pack<impl Read + Seek>,
    file: &PackedFile,
    folder: &Path,
) -> Result<(), Fault> {
    let path = folder.join(&file.path);
    let disk = |error| Fault::Disk(path.clone(), error);
    fs::create_dir_all(folder_of(&path)).map_err(disk)?;
    let new = OpenOptions::new().write(true).create_new(true).open(&path);
    let mut goal = new.map_err(disk)?;
    pack.extract(file, |block| match shutdown::is_requested() {
        true => Err(Fault::Interrupted),
        false => goal.write_all(block).map_err(disk),
    })
}

/// Command line that renders the pack.
fn command(manifest: &Manifest, folder: &Path) -> String {
    let inside = |name: &str| {
        let path = folder.join(name).display().to_string();
        match path.starts_with('-') {
            true => format!("./{path}"),
            false => path,
        }
    };
    let mut words = vec![
        "reflet".to_owned(),
        "render".to_owned(),
        inside(&manifest.scene),
    ];
    let mut option = |name: &str, value: String| words.extend(option_words(name, &value));
    (manifest.assets.iter()).for_each(|f| option("--assets", inside(f)));
    (manifest.variant.iter()).for_each(|v| option("--variant", v.clone()));
    manifest.set.iter().for_each(|s| option("--set", s.clone()));
    let output = match manifest.frames {
        Some(_) => {
            option("--frames", "all".to_owned());
            "####.png"
        }
        None => "picture.png",
    };
    option("-o", output.to_owned());
    if let Some(project) = &manifest.project {
        words.extend(option_words("--project", &inside(project)));
    }
    let switches = [
        (manifest.lenient, "--lenient"),
        (manifest.strict, "--strict"),
    ];
    let given = switches.into_iter().filter(|(is_given, _)| *is_given);
    words.extend(given.map(|(_, word)| word.to_owned()));
    let shown = |word: &String| -> String { word.chars().filter(|c| !c.is_control()).collect() };
    let words: Vec<_> = words.iter().map(|word| shell_word(&shown(word))).collect();
    words.join(" ")
}
