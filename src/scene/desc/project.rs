//! `reflet.toml`: settings that all scenes of a project share.

use super::{At, Entry};
use crate::{diagnostic::Diagnostic, range::range, table::Table};

declared! {
    /// `reflet.toml`: the file of a project. Its folder is the border of the scenes in it and below: names of files may
    /// begin with `../` as long as they stay inside, and files are also looked for in this folder itself, after the
    /// asset folders. It is looked for in the folder of a scene and in the folders above, see `docs/project.md`. All
    /// keys may be left out; it never runs anything.
    ///
    /// - `sizes`: sizes of pictures by names of your choice, `draft = [640, 360]`, for `--size draft`.
    #[derive(Clone, Debug, Default, PartialEq)]
    #[table("reflet.toml", check(Self::check))]
    pub struct ProjectDesc {
        /// Name of the project in messages. Default: the name of its folder.
        pub name: Option<String>,
        /// Folders of the project where files are looked for after a scene's own folder and the folders of `--assets`,
        /// such as `assets = ["lib", "textures"]`.
        pub assets: Vec<At<String>>,
        /// Folder of the project with scripts that all scenes may name and import, looked for after all other folders.
        pub scripts: Option<At<String>>,
        /// Camera of scenes that have one of this name, where neither `--camera` nor a cut names another.
        pub camera: Option<At<String>>,
        /// Variants of scenes that have variants of these names, where `--variant` names none; `--variant ""` is none
        /// at all.
        pub variant: Vec<At<String>>,
        /// File in the project that `render` writes without `--output`, such as `"renders/{scene}.{camera}.####.exr"`:
        /// `{scene}` is the name of the scene's file, `{camera}` the name of the camera, `{variant}` the variants, and
        /// `####` the number of the frame, which is left out where a scene has no frames. Missing folders are made.
        pub output: Option<At<String>>,
        /// Sizes by their names.
        #[by(|t| Some(t.values_by_name("sizes", range(1.0, 16384.0), "pairs of whole numbers")))]
        pub sizes: Vec<Entry<[u32; 2]>>,
    }
}

impl ProjectDesc {
    /// Name of the file.
    pub const FILE: &str = "reflet.toml";

    fn check(&self, t: &mut Table) {
        for size in &self.sizes {
            let is_plain = |c: char| c.is_alphanumeric() || "-_".contains(c);
            if !size.name.chars().all(is_plain)
                || size.name.starts_with(|c: char| !c.is_alphabetic())
            {
                let message = "the name of a size is one word that begins with a letter";
                let error = Diagnostic::new("wrong-name", size.at.clone(), message);
                t.report
                    .push(error.help("write such as `draft = [640, 360]`, for `--size draft`"));
            }
        }
    }
}
