//! A list of scenes and models to open, folder by folder.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use eframe::egui::{self, Align2, RichText, ScrollArea, Ui};

use reflet_render::runtime::model_viewer_scene::is_bare;

/// A folder and its entries.
#[derive(Debug)]
pub struct FileChooser {
    folder: PathBuf,
    folders: Vec<String>,
    files: Vec<String>,
    /// Error, if the folder cannot be read.
    problem: Option<String>,
}

/// Choice of the user in a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// No choice yet.
    Open,
    /// A file was chosen.
    File(PathBuf),
    /// The chooser was closed without a choice.
    Closed,
}

impl FileChooser {
    /// Shows a folder.
    pub fn new(folder: &Path) -> Self {
        let mut chooser = Self {
            folder: folder.to_owned(),
            folders: Vec::new(),
            files: Vec::new(),
            problem: None,
        };
        chooser.problem = chooser.list().err().map(|error| error.to_string());
        chooser
    }

    /// Scenes, models and visible folders, sorted.
    fn list(&mut self) -> io::Result<()> {
        for entry in fs::read_dir(&self.folder)? {
            let path = entry?.path();
            let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
                continue; // a name that is not UTF-8 cannot be shown
            };
            if name.starts_with('.') {
                continue;
            }
            if path.is_dir() {
                self.folders.push(name.to_owned());
            } else if is_bare(&path) || path.extension().is_some_and(|e| e == "toml") {
                self.files.push(name.to_owned());
            }
        }
        self.folders.sort_unstable();
        self.files.sort_unstable();
        Ok(())
    }

    /// Shows the chooser; `is_closing` if a key closes it.
    pub fn show(&mut self, ui: &Ui, is_closing: bool) -> Choice {
        let mut is_open = !is_closing;
        let mut choice = Choice::Open;
        let room = ui.ctx().content_rect().shrink(8.0);
        egui::Window::new("Open a scene or model")
            .open(&mut is_open)
            .constrain_to(room)
            .pivot(Align2::CENTER_CENTER)
            .default_pos(room.center())
            .default_size([420.0_f32.min(room.width()), 360.0_f32.min(room.height())])
            .collapsible(false)
            .show(ui.ctx(), |ui| self.rows(ui, &mut choice));
        match is_open {
            true => choice,
            false => Choice::Closed,
        }
    }

    fn rows(&mut self, ui: &mut Ui, choice: &mut Choice) {
        ui.label(RichText::new(self.folder.display().to_string()).monospace());
        if let Some(problem) = &self.problem {
            ui.colored_label(ui.visuals().error_fg_color, problem);
        }
        ui.separator();
        let mut next = None;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            if let Some(above) = self.folder.parent().filter(|above| above.is_dir())
                && ui.selectable_label(false, "../").clicked()
            {
                next = Some(above.to_owned());
            }
            for name in &self.folders {
                if ui.selectable_label(false, format!("{name}/")).clicked() {
                    next = Some(self.folder.join(name));
                }
            }
            for name in &self.files {
                if ui.selectable_label(false, name).clicked() {
                    *choice = Choice::File(self.folder.join(name));
                }
            }
            if self.files.is_empty() && self.problem.is_none() {
                ui.weak("no .toml, .gltf, .glb or USD file is here");
            }
        });
        if let Some(folder) = next {
            *self = Self::new(&folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::{Harness, kittest::Queryable as _};

    #[test]
    fn folders_are_entered_and_a_scene_is_chosen() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        fs::create_dir_all(folder.join("shots")).expect("a folder");
        for name in ["shots/a.toml", "shots/notes.txt", "shots/.hidden.toml"] {
            fs::write(folder.join(name), "version = 1\n").expect("a file");
        }
        let state = (FileChooser::new(folder), Choice::Open);
        let mut harness = Harness::new_ui_state(
            |ui, (chooser, choice): &mut (FileChooser, Choice)| {
                if *choice == Choice::Open {
                    *choice = chooser.show(ui, false);
                }
            },
            state,
        );
        harness.get_by_label("shots/").click();
        harness.run();
        assert!(harness.query_by_label("notes.txt").is_none());
        assert!(harness.query_by_label(".hidden.toml").is_none());
        harness.get_by_label("a.toml").click();
        harness.run();
        let chosen = Choice::File(folder.join("shots/a.toml"));
        assert_eq!(harness.state().1, chosen);
        let gone = FileChooser::new(&folder.join("none"));
        assert!(gone.problem.is_some());
    }
}
