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

use model_files::ModelFiles;
use names::border_of;
use outline::Part;
pub use position::{PLAIN, range};
use position::{offset, path_of, uri_of};
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

/// Extent of a check.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Extent {
    /// The text and the script's `setup`, at each change.
    Text,
    /// Everything that `check` does, at opening and saving.
    Whole,
}

/// Open texts of one client, and answers about them.
pub struct Server {
    whole_check: WholeCheck,
    /// Open texts, by URI.
    open: BTreeMap<String, Arc<Source>>,
    changed: BTreeMap<String, Extent>,
    /// Diagnostics that the editor shows.
    published: Published,
    /// Files that the last check of each scene read or looked for, by the scene's URI.
    read: BTreeMap<String, Vec<PathBuf>>,
    /// Whether the client takes snippets.
    snippets: bool,
    models: ModelFiles,
}

impl Server {
    /// A server for a client with these parameters of `initialize`; opening and saving a text runs the check.
    pub fn new(client: &Value, whole_check: WholeCheck) -> Self {
        let items = &client["capabilities"]["textDocument"]["completion"]["completionItem"];
        Self {
            whole_check,
            open: BTreeMap::new(),
            changed: BTreeMap::new(),
            published: Published::default(),
            read: BTreeMap::new(),
            snippets: items["snippetSupport"] == true,
            models: ModelFiles::default(),
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
        let file = params["textDocument"]["uri"]
            .as_str()
            .and_then(|uri| self.open.get(uri))
            .filter(|file| self.is_served(file));
        let at = file.map_or(0, |file| offset(&file.text, &params["position"]));
        let is_script = file.is_some_and(|file| is_script(&file.path));
        let scenes = || {
            let open: Vec<_> = self.open.values().collect();
            file.map_or_else(Vec::new, |file| script::scenes_of(&file.path, &open))
        };
        Ok(match (method, file) {
            ("textDocument/completion", Some(file)) if is_script => {
                json!(script::complete(&file.text, at, &scenes(), self.snippets))
            }
            ("textDocument/completion", Some(file)) => {
                json!(answer::complete(file, at, self.snippets, &self.models))
            }
            ("textDocument/hover", Some(file)) if is_script => {
                json!(script::hover(&file.text, at, &scenes()))
            }
            ("textDocument/hover", Some(file)) => json!(answer::hover(file, at)),
            ("textDocument/definition", Some(file)) if is_script => {
                json!(script::definition(&file.text, at, &scenes()))
            }
            ("textDocument/definition", Some(file)) => json!(answer::definition(file, at)),
            (
                "textDocument/references" | "textDocument/prepareRename" | "textDocument/rename",
                Some(file),
            ) => {
                (self.about_name(method, params, file, at)).map_err(|why| (REQUEST_FAILED, why))?
            }
            ("textDocument/documentSymbol", Some(file)) => json!(structure::symbols(file)),
            ("textDocument/signatureHelp", Some(file)) if is_script => {
                json!(call::signature_help(&file.text, at))
            }
            ("textDocument/signatureHelp", Some(_)) => Value::Null,
            ("textDocument/formatting", Some(_)) if is_script => Value::Null,
            ("textDocument/formatting", Some(file)) => {
                json!(format::edits(&file.text, &params["options"]))
            }
            ("textDocument/foldingRange", Some(file)) => json!(structure::folds(file)),
            ("textDocument/documentColor", Some(_)) if is_script => json!([] as [Value; 0]),
            ("textDocument/documentColor", Some(file)) => json!(colors::colors(file)),
            ("textDocument/colorPresentation", Some(file)) => {
                json!(colors::presentations(file, params))
            }
            ("textDocument/codeAction", Some(file)) => {
                let uri = params["textDocument"]["uri"].as_str().unwrap_or_default();
                json!(actions::actions(file, uri, params))
            }
            (method, None) if method.starts_with("textDocument/") => Value::Null,
            (method, _) => {
                return Err((METHOD_NOT_FOUND, format!("there is no method {method}")));
            }
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
            "textDocument/prepareRename" => Ok(range(&file.text, &name.range)),
            "textDocument/rename" => {
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
                    self.mark_changed(&uri, Extent::Whole);
                }
            }
            "textDocument/didChange" => {
                let changes = params["contentChanges"].as_array();
                let text = changes.and_then(|changes| changes.last()?["text"].as_str());
                if let (Some(file), Some(text)) = (self.open.get_mut(&uri), text) {
                    *file = Arc::new(Source::new(&file.path, text));
                    let path = file.path.clone();
                    self.mark_changed(&uri, Extent::Text);
                    self.mark_readers(&path);
                }
            }
            "textDocument/didSave" => {
                self.models.clear();
                // Other open scenes may read the saved file.
                let all: Vec<_> = self.open.keys().cloned().collect();
                all.iter()
                    .for_each(|uri| self.mark_changed(uri, Extent::Whole));
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

    fn mark_changed(&mut self, uri: &str, extent: Extent) {
        let known = self.changed.entry(uri.to_owned()).or_insert(extent);
        *known = extent.max(*known);
    }

    /// Marks the open scenes that read a file.
    fn mark_readers(&mut self, path: &Path) {
        let reads = |files: &Vec<PathBuf>| files.iter().any(|file| same(file, path));
        let readers = self.read.iter().filter(|(_, files)| reads(files));
        let readers: Vec<_> = readers.map(|(uri, _)| uri.clone()).collect();
        for uri in readers {
            self.mark_changed(&uri, Extent::Text);
        }
    }

    /// Checks what has changed since the last call: new diagnostics for the client. One call serves several changes.
    pub fn check_changed(&mut self) -> Vec<Value> {
        let mut all = Vec::new();
        let unsaved = UnsavedTexts::new(self.open.values());
        for (uri, extent) in std::mem::take(&mut self.changed) {
            let is_checked = |file: &&Arc<Source>| {
                !is_script(&file.path) && is_scene(file) || is_project(&file.path)
            };
            let Some(file) = self.open.get(&uri).filter(is_checked) else {
                continue;
            };
            let mut by_file = BTreeMap::from([(uri.clone(), Vec::new())]);
            let files = Dependencies::default();
            for message in self.check(file, extent, &unsaved, &files) {
                let place = message.span.source.as_ref();
                let at = match place {
                    Some(source) if source.path != file.path => uri_of(&source.path),
                    _ => uri.clone(),
                };
                by_file
                    .entry(at)
                    .or_default()
                    .push(protocol_diagnostic(&message));
            }
            self.read.insert(uri.clone(), files.paths());
            all.extend(self.publish_diagnostics(&uri, by_file));
        }
        all
    }

    /// Notifications with the diagnostics of a scene's check, which clear diagnostics that it does not find any more.
    fn publish_diagnostics(
        &mut self,
        scene: &str,
        by_file: BTreeMap<String, Vec<Value>>,
    ) -> Vec<Value> {
        let all = self.published.replace(scene, by_file).into_iter();
        all.map(|(uri, diagnostics)| {
            let params = json!({ "uri": uri, "diagnostics": diagnostics });
            json!({ "jsonrpc": "2.0", "method": "textDocument/publishDiagnostics", "params": params })
        })
        .collect()
    }

    /// Messages about a scene or a project, with the texts of other open files; adds what it reads to `files`.
    fn check(
        &self,
        file: &Arc<Source>,
        extent: Extent,
        unsaved: &UnsavedTexts,
        files: &Dependencies,
    ) -> Vec<Diagnostic> {
        if extent == Extent::Whole || is_project(&file.path) {
            return (self.whole_check)(file, unsaved, files);
        }
        let options = SceneOptions {
            project: ProjectChoice::Search,
            unsaved: unsaved.clone(),
            ..SceneOptions::default()
        };
        let text = SceneText::from_source(Arc::clone(file), &options);
        let opened = text.open(&[], files);
        opened.map_or_else(|errors| errors, |opened| opened.warnings)
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

/// Diagnostics by the scene whose check found them, and by the file that has them.
#[derive(Default)]
struct Published(BTreeMap<String, BTreeMap<String, Vec<Value>>>);

impl Published {
    /// Replaces the diagnostics of a scene's check by new ones; returns all diagnostics of each file in either, also
    /// from checks of other scenes.
    pub fn replace(
        &mut self,
        scene: &str,
        found: BTreeMap<String, Vec<Value>>,
    ) -> BTreeMap<String, Vec<Value>> {
        let mut files: BTreeSet<String> = found.keys().cloned().collect();
        files.extend(
            self.0
                .insert(scene.to_owned(), found)
                .into_iter()
                .flatten()
                .map(|(file, _)| file),
        );
        let all = |file: String| {
            let mut own: Vec<Value> = Vec::new();
            for one in self.0.values().filter_map(|of| of.get(&file)).flatten() {
                if !own.contains(one) {
                    own.push(one.clone());
                }
            }
            (file, own)
        };
        files.into_iter().map(all).collect()
    }
}
