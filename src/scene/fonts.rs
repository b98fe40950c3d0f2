//! Fonts that a scene names, by their file or by the name that they have inside of it.

use std::{path::PathBuf, sync::OnceLock};

use reflet_base::{
    files::{entries_below, has_extension, open_regular, path_below},
    guard,
};
use reflet_text::FontNames;

use super::{
    confined_read::{self, Found, Kind, Problem},
    dependencies::Dependencies,
    reach::Reach,
    suggest,
};

/// Extensions of font files.
const FONT_FILES: [&str; 3] = ["ttf", "otf", "ttc"];
/// Extensions of other files that may be named in place of a font file, which are no part of the name of a font.
const OTHER_FILES: [&str; 4] = ["woff", "woff2", "pfb", "dfont"];
/// Limits of the search: folders within each other, entries below each folder of the scene, bytes of names, and fonts whose
/// letters are read.
const DEPTH: usize = 8;
const MOST_ENTRIES: usize = 10_000;
const MOST_NAMES: u64 = 1 << 26;
const MOST_READ: usize = 50;

/// Words and limits of font files.
const FONTS: Kind = Kind {
    one: "a font",
    names: "file names of fonts start from the scene's folder, or a folder that --assets DIR adds, and end in .ttf, .otf or .ttc",
    inside: "fonts are read only from the scene's folder, asset folders, and the folders below",
    most_mib: 64,
};

/// Folder of the system's fonts.
const SYSTEM: &str = match () {
    () if cfg!(windows) => "C:\\Windows\\Fonts",
    () if cfg!(target_os = "macos") => "/System/Library/Fonts",
    () => "/usr/share/fonts",
};

/// Fonts that a scene can name.
#[derive(Debug, Default)]
pub struct Fonts {
    reach: Reach,
    dependencies: Dependencies,
    /// Font files in the folders of the scene, which are looked for once.
    files: OnceLock<Vec<FontFile>>,
}

/// A file of fonts.
#[derive(Debug)]
struct FontFile {
    /// The scene's own folder, or a folder of assets.
    folder: PathBuf,
    /// Name from there.
    name: String,
    fonts: Vec<FontNames>,
}

impl Fonts {
    /// Fonts in the folders of a scene and in the folders below. Font files that are read or have no names are added to
    /// `dependencies`, and where a font is missing the folders of the scene with their folders `fonts`.
    pub fn new(reach: &Reach, dependencies: &Dependencies) -> Self {
        Self {
            reach: reach.clone(),
            dependencies: dependencies.clone(),
            files: OnceLock::new(),
        }
    }

    /// Whether there are no folders to read from.
    pub fn is_nowhere(&self) -> bool {
        self.reach.folders().is_empty()
    }

    /// The font file of a name, or with a font of this name inside.
    ///
    /// # Errors
    /// A name or a link that leads out of the folders; a font that is missing, a file that is too large.
    pub fn read(&self, name: &str) -> Result<Found<Vec<u8>>, Problem> {
        let names_a_file = name.contains(['/', '\\'])
            || name.rsplit_once('.').is_some_and(|(_, end)| {
                let mut all = FONT_FILES.iter().chain(&OTHER_FILES);
                all.any(|known| end.eq_ignore_ascii_case(known))
            });
        let by_file = || confined_read::read_bytes(&self.reach, name, &FONTS, &self.dependencies);
        if names_a_file {
            let near = |mut problem: Problem| {
                problem.help = self.near(name).unwrap_or(problem.help);
                problem
            };
            return by_file().map_err(|problem| problem.or_missing(near));
        }
        let fit = |file: &FontFile| file.fonts.iter().filter_map(|font| font.fit(name)).min();
        let fitting = (self.files().iter()).filter_map(|file| Some((fit(file)?, file)));
        match fitting.min_by_key(|(fit, _)| *fit) {
            Some((_, file)) => self.read_file(file),
            None => by_file().map_err(|problem| problem.or_missing(|_| self.missing(name))),
        }
    }

    /// Name of the first font file in which a font has all that is wanted, such as the letters of a text.
    pub fn file_with(&self, has_all: impl Fn(&[u8]) -> bool) -> Option<&str> {
        let mut files = self.files().iter().take(MOST_READ);
        let file = files.find(|file| self.read_file(file).is_ok_and(|found| has_all(&found.data)));
        file.map(|file| file.name.as_str())
    }

    fn read_file(&self, file: &FontFile) -> Result<Found<Vec<u8>>, Problem> {
        let reach = self.reach.with_folders(vec![file.folder.clone()]);
        confined_read::read_bytes(&reach, &file.name, &FONTS, &self.dependencies)
    }

    fn files(&self) -> &[FontFile] {
        self.files.get_or_init(|| {
            let below = |folder: &PathBuf| {
                let folder = match folder.as_os_str().is_empty() {
                    true => PathBuf::from("."),
                    false => folder.clone(),
                };
                let mut left = MOST_NAMES;
                let entries = entries_below(&folder, DEPTH, false).take(MOST_ENTRIES);
                let fonts = entries.filter(|entry| {
                    entry.file_type().is_file() && has_extension(entry, &FONT_FILES)
                });
                let files = fonts.filter_map(|entry| {
                    let mut names = || {
                        let file = open_regular(entry.path(), false).ok()?;
                        guard::catch(|| FontNames::read(file, &mut left))
                    };
                    let mut fonts = names()?;
                    if fonts.iter().all(|names| *names == FontNames::default()) {
                        // It may still be written.
                        self.dependencies.add(entry.path().to_owned());
                        fonts = names()?;
                    }
                    Some(FontFile {
                        name: path_below(&entry, &folder)?,
                        folder: folder.clone(),
                        fonts,
                    })
                });
                files.collect::<Vec<_>>()
            };
            self.reach.folders().iter().flat_map(below).collect()
        })
    }

    fn missing(&self, name: &str) -> Problem {
        let others = self.reach.folders().iter().skip(1);
        let others: String = (others.map(|f| format!(", nor in \"{}\"", f.display()))).collect();
        let name_of_font = suggest::text(name);
        let message =
            format!("no font {name_of_font} was found in or below the scene's folder{others}");
        let has_system = self.reach.folders().iter().any(|f| f.starts_with(SYSTEM));
        let help = self.near(name).unwrap_or_else(|| match has_system {
            true => "put its file into a folder of the scene".to_owned(),
            false => format!(
                "put its file into a folder of the scene, or let the scene read the system's fonts: `--assets {SYSTEM}`, \
                 or REFLET_ASSETS={SYSTEM}"
            ),
        });
        // The font may be put there.
        for folder in self.reach.folders() {
            self.dependencies.add(PathBuf::from(".").join(folder));
            self.dependencies.add(folder.join("fonts"));
        }
        Problem::new(message, help)
    }

    /// Advice to write the name of a font or of its file that is spelled alike.
    fn near(&self, name: &str) -> Option<String> {
        let files = self.files().iter();
        let names = files.flat_map(|file| {
            let fonts = file.fonts.iter().flat_map(FontNames::full);
            fonts.chain([file.name.as_str()])
        });
        let near = suggest::nearest(name, names.take(suggest::MOST_NAMES))?;
        Some(format!("did you mean {}?", suggest::text(near)))
    }
}
