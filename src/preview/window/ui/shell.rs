//! The window over time: it shows one scene until another is opened in it.

use std::{
    env,
    path::{Path, PathBuf},
};

use eframe::{
    App,
    egui::{self, Align2, Color32, FontId, Key, KeyboardShortcut, Modifiers, Ui, ViewportCommand},
};

use super::{
    file_chooser::{Choice, FileChooser},
    opener::{Opener, Opening},
    window::Window,
};

/// The window, and the opener of further scenes.
pub struct Shell {
    window: Window,
    opener: Opener,
    chooser: Option<FileChooser>,
    /// Folder in which the file chooser starts.
    folder: PathBuf,
    opening: Option<Opening>,
}

impl Shell {
    /// Shows a window on a scene file, or on the built-in scene.
    pub fn new(opener: Opener, window: Window, scene: Option<&Path>) -> Self {
        let here = || env::current_dir().unwrap_or_else(|_| PathBuf::from("."));
        let folder = scene
            .and_then(Path::parent)
            .and_then(|f| f.canonicalize().ok());
        Self {
            window,
            opener,
            chooser: None,
            folder: folder.unwrap_or_else(here),
            opening: None,
        }
    }

    fn choose(&mut self, ui: &Ui) {
        let opens = KeyboardShortcut::new(Modifiers::COMMAND, Key::O);
        if ui.input_mut(|i| i.consume_shortcut(&opens)) && self.chooser.is_none() {
            self.chooser = Some(FileChooser::new(&self.folder));
        }
        let Some(chooser) = &mut self.chooser else {
            return;
        };
        let is_closing = ui.input(|i| i.key_pressed(Key::Escape));
        match chooser.show(ui, is_closing) {
            Choice::Open => {}
            Choice::Closed => self.chooser = None,
            Choice::File(path) => {
                self.chooser = None;
                self.open(path, ui);
            }
        }
    }

    fn drop_files(&mut self, ui: &Ui) {
        if ui.input(|i| !i.raw.hovered_files.is_empty()) {
            let rect = ui.ctx().content_rect();
            let layer = egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop"));
            let painter = ui.ctx().layer_painter(layer);
            painter.rect_filled(rect, 0.0, Color32::from_black_alpha(160));
            let text = "drop a scene or model to open it";
            let font = FontId::proportional(22.0);
            painter.text(
                rect.center(),
                Align2::CENTER_CENTER,
                text,
                font,
                Color32::WHITE,
            );
        }
        let dropped = ui.input(|i| i.raw.dropped_files.first().map(|f| f.path().to_owned()));
        if let Some(path) = dropped {
            self.open(path, ui);
        }
    }

    fn open(&mut self, path: PathBuf, ui: &Ui) {
        if let Some(folder) = path.parent() {
            self.folder = folder.to_owned();
        }
        self.window
            .message
            .set(format!("opening {}", path.display()));
        self.opening = Some(Opening::begin(&self.opener, path, ui.ctx()));
    }

    /// Shows a scene that has been opened; after an error the former scene stays.
    fn show_opened(&mut self, ui: &Ui) {
        let Some(opening) = &self.opening else { return };
        let Some(outcome) = opening.outcome() else {
            return;
        };
        match outcome {
            Ok(opened) => {
                let title = self.opener.title(&opened);
                ui.ctx().send_viewport_cmd(ViewportCommand::Title(title));
                let mut window = self.opener.start(opened, ui.ctx());
                // The textures are freed when the next picture is registered.
                window.textures = std::mem::take(&mut self.window.textures);
                self.window = window;
            }
            Err(why) => {
                let path = opening.path.display();
                self.window
                    .message
                    .set(format!("{path} is not opened: {why}"));
            }
        }
        self.opening = None;
    }
}

impl App for Shell {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        self.choose(ui);
        self.drop_files(ui);
        self.show_opened(ui);
        self.window.ui(ui, frame);
    }
}
