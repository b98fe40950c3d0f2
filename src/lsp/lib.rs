//! The language server of scene text and scripts (Language Server Protocol 3.17) without its transport: messages of JSON-RPC →
//! answers. The program passes them on between its standard input and output, a page between its editor and a worker.

mod actions;
mod answer;
mod call;
mod colors;
mod format;
mod model_files;
mod names;
mod outline;
mod position;
mod references;
mod scopes;
mod script;
mod script_map;
mod structure;

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    sync::Arc,
};

use reflet_render::runtime::scene_text::{SceneOptions, SceneText};
use reflet_scene::{
    dependencies::Dependencies,
    diagnostic::{Diagnostic, Severity, Source, Span},
    parse::tables::{is_project, is_scene, is_scene_text},
    project::ProjectChoice,
    reach::UnsavedTexts,
};
use serde_json::{Value, json};

pub use actions::quick_fix;
use model_files::ModelFiles;
use names::border_of;
use outline::Part;
pub use position::{PLAIN, offset, range};
use position::{path_of, uri_of};
use references::same;

/// Codes of errors in the protocol.
const METHOD_NOT_FOUND: i32 = -32601;
const REQUEST_FAILED: i32 = -32803;

/// Check of all about a scene or project, in which texts of open files stand for the files; it adds the paths that it reads.
pub type WholeCheck = fn(&Arc<Source>, &UnsavedTexts, &Dependencies) -> Vec<Diagnostic>;

/// Abilities of the server, for the answer to `initialize`.
pub fn capabilities() -> Value {
    json!({
        "textDocumentSync": { "openClose": true, "change": 1, "save": true },
        "completionProvider": { "triggerCharacters": ["\"", "[", ".", "="] },
        "hoverProvider": true,
        "definitionProvider": true,
        "referencesProvider": true,
        "renameProvider": { "prepareProvider": true },
        "documentSymbolProvider": true,
        "foldingRangeProvider": true,
        "signatureHelpProvider": { "triggerCharacters": ["(", ","] },
        "documentFormattingProvider": true,
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        "colorProvider": true,
    })
}

/// Open texts of one client, and answers about them.
#[derive(Default)]
pub struct Server {
    /// Open texts, by URI.
    open: BTreeMap<String, Arc<Source>>,
    /// Changed texts, by URI, and whether each was opened or saved, for which all is checked.
    changed: BTreeMap<String, bool>,
    /// Diagnostics that the editor shows, by the scene whose check found them, and by the file that has them.
    published: BTreeMap<String, BTreeMap<String, Vec<Value>>>,
    /// Files that the last check of each scene read or looked for, by the scene's URI.
    read: BTreeMap<String, Vec<PathBuf>>,
    /// Whether the client takes snippets.
    snippets: bool,
    models: ModelFiles,
}

impl Server {
    /// A server for a client with these parameters of `initialize`.
    pub fn new(client: &Value) -> Self {
        let items = &client["capabilities"]["textDocument"]["completion"]["completionItem"];
        Self {
            snippets: items["snippetSupport"] == true,
            ..Self::default()
        }
    }

    /// Messages for the client that follow from a request or notification of it, as JSON-RPC.
    pub fn handle(&mut self, message: &Value) -> Vec<Value> {
        let Some(method) = message["method"].as_str() else {
            return Vec::new(); // answers to nothing that was asked
        };
        let (id, params) = (&message["id"], &message["params"]);
        if id.is_null() {
            return self.handle_notification(method, params);
        }
        vec![match self.answer(method, params) {
            Ok(result) => json!({ "jsonrpc": "2.0", "id": id, "result": result }),
            Err((code, text)) => {
                json!({ "jsonrpc": "2.0", "id": id, "error": { "code": code, "message": text } })
            }
        }]
    }

    /// Result of a request, or code and text of an error.
    fn answer(&self, method: &str, params: &Value) -> Result<Value, (i32, String)> {
        let none = || (METHOD_NOT_FOUND, format!("there is no method {method}"));
        let asked = method.strip_prefix("textDocument/").ok_or_else(none)?;
        let uri = params["textDocument"]["uri"].as_str().unwrap_or_default();
        let Some(file) = self.open.get(uri).filter(|file| self.is_served(file)) else {
            return Ok(Value::Null);
        };
        let (text, at) = (&file.text, offset(&file.text, &params["position"]));
        let scenes = || script::scenes_of(&file.path, &self.open.values().collect::<Vec<_>>());
        Ok(match (asked, is_script(&file.path)) {
            ("completion", true) => json!(script::complete(text, at, &scenes(), self.snippets)),
            ("completion", _) => json!(answer::complete(file, at, self.snippets, &self.models)),
            ("hover", true) => json!(script::hover(text, at, &scenes())),
            ("hover", _) => json!(answer::hover(file, at)),
            ("definition", true) => json!(script::definition(text, at, &scenes())),
            ("definition", _) => json!(answer::definition(file, at)),
            ("references" | "prepareRename" | "rename", _) => {
                let result = self.about_name(asked, params, file, at);
                result.map_err(|why| (REQUEST_FAILED, why))?
            }
            ("documentSymbol", _) => json!(structure::symbols(file)),
            ("signatureHelp", true) => json!(call::signature_help(text, at)),
            ("signatureHelp", _) | ("formatting", true) => Value::Null,
            ("formatting", _) => json!(format::edits(text, &params["options"])),
            ("foldingRange", _) => json!(structure::folds(file)),
            ("documentColor", true) => json!([]),
            ("documentColor", _) => json!(colors::colors(file)),
            ("colorPresentation", _) => json!(colors::presentations(file, params)),
            ("codeAction", _) => json!(actions::actions(file, uri, params)),
            _ => return Err(none()),
        })
    }

    /// Whether a file is a text of Reflet: other TOML files get no answers.
    fn is_served(&self, file: &Source) -> bool {
        let reads = |files: &Vec<PathBuf>| files.iter().any(|known| same(known, &file.path));
        is_script(&file.path)
            || is_scene_text(file)
            || border_of(&file.path).project.is_some()
            || self.read.values().any(reads)
    }

    /// References of the name at a byte offset, its range for renaming, or the edits that rename it.
    fn about_name(
        &self,
        method: &str,
        params: &Value,
        file: &Arc<Source>,
        at: usize,
    ) -> Result<Value, String> {
        let open: Vec<_> = self.open.values().collect();
        let texts = references::texts(file, &open);
        let Some((target, name)) = references::target(file, at, &texts) else {
            return Ok(Value::Null);
        };
        match method {
            "prepareRename" => Ok(range(&file.text, &name.range)),
            "rename" => {
                let new = params["newName"].as_str().unwrap_or_default();
                references::rename(&target, new, &texts)
            }
            _ => {
                let all = params["context"]["includeDeclaration"] != false;
                let places = references::places(&target, &texts);
                Ok(json!(references::locations(&places, all)))
            }
        }
    }

    fn handle_notification(&mut self, method: &str, params: &Value) -> Vec<Value> {
        let document = &params["textDocument"];
        let Some(uri) = document["uri"].as_str().map(str::to_owned) else {
            return Vec::new();
        };
        match method {
            "textDocument/didOpen" => {
                let text = document["text"].as_str().unwrap_or_default().to_owned();
                if let Some(path) = path_of(&uri) {
                    let source = Arc::new(Source::new(path, text));
                    self.open.insert(uri.clone(), source);
                    self.mark_changed(&uri, true);
                }
            }
            "textDocument/didChange" => {
                let changes = params["contentChanges"].as_array();
                let text = changes.and_then(|changes| changes.last()?["text"].as_str());
                if let (Some(file), Some(text)) = (self.open.get_mut(&uri), text) {
                    *file = Arc::new(Source::new(&file.path, text));
                    let path = file.path.clone();
                    self.mark_changed(&uri, false);
                    self.mark_readers(&path);
                }
            }
            "textDocument/didSave" => {
                self.models.clear();
                // Other open scenes may read the saved file.
                let all = self.open.keys().map(|uri| (uri.clone(), true));
                self.changed.extend(all);
            }
            "textDocument/didClose" => {
                let closed = self.open.remove(&uri);
                self.changed.remove(&uri);
                self.read.remove(&uri);
                closed.iter().for_each(|file| self.mark_readers(&file.path));
                return self.publish_diagnostics(&uri, BTreeMap::new());
            }
            _ => {}
        }
        Vec::new()
    }

    fn mark_changed(&mut self, uri: &str, is_saved: bool) {
        *self.changed.entry(uri.to_owned()).or_default() |= is_saved;
    }

    /// Marks the open scenes that read a file.
    fn mark_readers(&mut self, path: &Path) {
        let reads = |files: &Vec<PathBuf>| files.iter().any(|file| same(file, path));
        let readers = self.read.iter().filter(|(_, files)| reads(files));
        let readers: Vec<_> = readers.map(|(uri, _)| uri.clone()).collect();
        readers.iter().for_each(|uri| self.mark_changed(uri, false));
    }

    /// Checks what has changed since the last call: new diagnostics for the client. One call serves several changes.
    /// A text that was opened or saved gets the whole check.
    pub fn check_changed(&mut self, whole_check: WholeCheck) -> Vec<Value> {
        let mut all = Vec::new();
        let unsaved = UnsavedTexts::new(self.open.values());
        for (uri, is_saved) in std::mem::take(&mut self.changed) {
            let is_checked = |file: &&Arc<Source>| {
                !is_script(&file.path) && is_scene(file) || is_project(&file.path)
            };
            let Some(file) = self.open.get(&uri).filter(is_checked) else {
                continue;
            };
            let mut by_file = BTreeMap::from([(uri.clone(), Vec::new())]);
            let files = Dependencies::default();
            let check = match is_saved || is_project(&file.path) {
                true => whole_check,
                false => check_text,
            };
            for message in check(file, &unsaved, &files) {
                let place = message.span.source.as_ref();
                let other = place.filter(|source| source.path != file.path);
                let at = other.map_or_else(|| uri.clone(), |source| uri_of(&source.path));
                let found = by_file.entry(at).or_default();
                found.push(protocol_diagnostic(&message));
            }
            self.read.insert(uri.clone(), files.paths());
            all.extend(self.publish_diagnostics(&uri, by_file));
        }
        all
    }

    /// Notifications with the diagnostics of a scene's check in place of the last one's, beside diagnostics of other checks
    /// about the same files.
    fn publish_diagnostics(
        &mut self,
        scene: &str,
        by_file: BTreeMap<String, Vec<Value>>,
    ) -> Vec<Value> {
        let mut files: BTreeSet<String> = by_file.keys().cloned().collect();
        let last = self.published.insert(scene.to_owned(), by_file);
        files.extend(last.into_iter().flatten().map(|(file, _)| file));
        let notification = |uri: String| {
            let mut own: Vec<&Value> = Vec::new();
            let all = self.published.values().filter_map(|of| of.get(&uri));
            for one in all.flatten() {
                if !own.contains(&one) {
                    own.push(one);
                }
            }
            let params = json!({ "uri": uri, "diagnostics": own });
            json!({ "jsonrpc": "2.0", "method": "textDocument/publishDiagnostics", "params": params })
        };
        files.into_iter().map(notification).collect()
    }
}

/// Words, names and files that the value of a key may be in a scene.
pub fn values(file: &Arc<Source>, table: &[String], key: &str) -> Vec<String> {
    let word = outline::Word {
        table: table.to_vec(),
        part: Part::Value(key.to_owned()),
        text: String::new(),
        range: 0..0,
    };
    let items = answer::values(file, &word, key, false);
    let label = |item: &Value| item["label"].as_str().map(str::to_owned);
    items.iter().filter_map(label).collect()
}

fn is_script(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == "rhai")
}

/// Messages about a scene's text and script, with the texts of other open files; adds the paths that it reads to `files`.
fn check_text(file: &Arc<Source>, unsaved: &UnsavedTexts, files: &Dependencies) -> Vec<Diagnostic> {
    let options = SceneOptions {
        project: ProjectChoice::Search,
        unsaved: unsaved.clone(),
        ..SceneOptions::default()
    };
    let text = SceneText::from_source(Arc::clone(file), &options);
    let opened = text.open(&[], files);
    opened.map_or_else(|errors| errors, |opened| opened.warnings)
}

/// A diagnostic in the protocol's form.
fn protocol_diagnostic(message: &Diagnostic) -> Value {
    let place = |span: &Span| match &span.source {
        Some(source) => range(&source.text, &span.range),
        None => range("", &(0..0)),
    };
    let mut text = message.message.clone();
    if let Some(file) = &message.file {
        text = format!("{}: {text}", file.display());
    }
    if let Some(help) = &message.help {
        text += &format!("\nhelp: {help}");
    }
    let related = message.related.iter().filter_map(|(span, note)| {
        let uri = uri_of(&span.source.as_ref()?.path);
        Some(json!({ "location": { "uri": uri, "range": place(span) }, "message": note }))
    });
    json!({
        "range": place(&message.span),
        "severity": if message.severity == Severity::Error { 1 } else { 2 },
        "code": message.name,
        "source": "reflet",
        "message": text,
        "relatedInformation": related.collect::<Vec<_>>(),
    })
}
