//! Resolution of URIs inside glTF files: relative or `data:` only, within the allowed folders.

use std::{
    io::Read,
    path::{Component, Path, PathBuf},
};

use data_encoding::BASE64_NOPAD;

use super::{Fault, stand_in};
use reflet_base::files::{File, canonicalize, metadata, similar};
use reflet_scene::dependencies::Dependencies;

/// The folders that files may be read from, canonical.
#[derive(Clone, Debug, Default)]
pub struct Sandbox {
    roots: Vec<PathBuf>,
    /// Largest file that is read, bytes.
    pub max_file_bytes: u64,
    dependencies: Dependencies,
}

impl Sandbox {
    /// The same sandbox, which records searched files in `dependencies`.
    pub fn with_dependencies(self, dependencies: &Dependencies) -> Self {
        let dependencies = dependencies.clone();
        Self {
            dependencies,
            ..self
        }
    }

    /// Allows everything below `roots`; folders that do not exist are left out.
    pub fn new<'a>(roots: impl IntoIterator<Item = &'a Path>, max_file_bytes: u64) -> Self {
        let roots = roots.into_iter().filter_map(|root| {
            let root = if root.as_os_str().is_empty() {
                Path::new(".")
            } else {
                root
            };
            canonicalize(root).ok()
        });
        Self {
            roots: roots.collect(),
            max_file_bytes,
            dependencies: Dependencies::default(),
        }
    }

    /// The canonical path of the relative `name` from `folder`, if it exists inside the sandbox.
    ///
    /// # Errors
    /// `path-escape` when the name is absolute, a URL, or leaves the allowed folders (also through
    /// links); `file-not-found`; `not-a-file` for folders, devices and pipes.
    pub fn resolve(&self, folder: &Path, name: &str) -> Result<PathBuf, Fault> {
        let shown = shorten(name);
        let escape = |why: &str| {
            Fault::new("path-escape", format!("\"{shown}\" {why}")).help(
                "use a name relative to the file that mentions it, inside the scene's folder or a \
                 folder given with --assets",
            )
        };
        let name = name.replace('\\', "/");
        if name.is_empty() || name.contains('\0') {
            return Err(escape("is not a file name"));
        }
        if name.contains("://") {
            let help = "download the file into the scene's folder, and write its name";
            return Err(escape("is a URL").help(help));
        }
        if has_scheme(&name) {
            return Err(escape("is a URL or names a drive"));
        }
        if name.starts_with('/') {
            return Err(escape("is an absolute path"));
        }
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        let named = folder.join(&name);
        let folder = canonicalize(folder)
            .map_err(|e| Fault::new("file-not-found", format!("\"{}\": {e}", folder.display())))?;
        let inside = |path: &Path| self.roots.iter().any(|root| path.starts_with(root));
        // Lexical check first, so that no outside path is accessed.
        let mut path = folder.clone();
        for part in Path::new(&name).components() {
            match part {
                Component::Normal(part) => path.push(part),
                Component::CurDir => {}
                Component::ParentDir if path.pop() => {}
                _ => return Err(escape("leaves the allowed folders")),
            }
        }
        if !inside(&path) {
            return Err(escape("leaves the allowed folders"));
        }
        self.dependencies.add(named);
        let found = canonicalize(&path).map_err(|e| {
            let fault = Fault::new("file-not-found", format!("\"{shown}\": {e}"));
            match similar(&folder, Path::new(&name)) {
                Some(name) => fault.help(format!("it is there as \"{}\"", name.display())),
                None => fault,
            }
        });
        let path = found?;
        if !inside(&path) {
            return Err(escape("is a link that leaves the allowed folders"));
        }
        if !metadata(&path).is_ok_and(|found| found.is_file()) {
            let fault = Fault::new("not-a-file", format!("\"{shown}\" is not a regular file"));
            return Err(fault.help("write the path of a file: folders, devices and pipes are none"));
        }
        Ok(path)
    }

    /// Reads a file that [`Sandbox::resolve`] gave, up to the size cap.
    ///
    /// # Errors
    /// The file cannot be read, is larger than the cap, or stands in for another one (see [`stand_in::refuse`]).
    pub fn read(&self, path: &Path) -> Result<Vec<u8>, Fault> {
        let unreadable =
            |e: std::io::Error| Fault::new("file-unreadable", format!("cannot be read: {e}"));
        let file = File::open(path).map_err(unreadable)?;
        let size = file.metadata().map_err(unreadable)?.len();
        let too_large = || {
            let cap = self.max_file_bytes;
            Fault::new(
                "file-too-large",
                format!("the file is larger than the cap of {cap} bytes"),
            )
        };
        if size > self.max_file_bytes {
            return Err(too_large());
        }
        let mut bytes = Vec::new();
        let size = usize::try_from(size).map_err(|_| too_large())?;
        if bytes.try_reserve_exact(size).is_err() {
            return Err(too_large());
        }
        // The file may grow meanwhile: the limit applies to the bytes read.
        let mut limited = file.take(self.max_file_bytes.saturating_add(1));
        limited.read_to_end(&mut bytes).map_err(unreadable)?;
        if bytes.len() as u64 > self.max_file_bytes {
            return Err(too_large());
        }
        stand_in::refuse(&bytes)?;
        Ok(bytes)
    }
}

/// Parsed URI of a buffer or image.
pub enum Target {
    /// Content of a `data:` URI.
    Data(Vec<u8>),
    /// A relative file name, percent-decoded.
    Relative(String),
}

/// Parses a URI.
pub fn parse(uri: &str) -> Result<Target, Fault> {
    if uri
        .get(..5)
        .is_some_and(|head| head.eq_ignore_ascii_case("data:"))
    {
        return data(&uri[5..]).map(Target::Data);
    }
    if has_scheme(uri) {
        return Ok(Target::Relative(uri.to_owned())); // refused by the sandbox, with its message
    }
    let name = String::from_utf8(percent_decode(uri)).map_err(|_| {
        let shown = shorten(uri);
        Fault::new(
            "uri-broken",
            format!("\"{shown}\" is not UTF-8 after percent-decoding"),
        )
    })?;
    Ok(Target::Relative(name))
}

fn data(rest: &str) -> Result<Vec<u8>, Fault> {
    let broken = |why: &str| Fault::new("uri-broken", format!("the data: URI {why}"));
    let (head, body) = rest.split_once(',').ok_or_else(|| broken("has no comma"))?;
    if head.to_ascii_lowercase().ends_with(";base64") {
        // Some exporters encode `+`, `/` and `=` once more.
        let decoded = body.contains('%').then(|| percent_decode(body));
        let body = decoded.as_deref().unwrap_or(body.as_bytes());
        base64(body).ok_or_else(|| broken("is not valid base64"))
    } else {
        Ok(percent_decode(body))
    }
}

/// Whether `uri` starts with a scheme such as `http:` (or a drive such as `C:`), RFC 3986 §3.1.
fn has_scheme(uri: &str) -> bool {
    uri.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    })
}

/// Replaces `%41` by `A`; other `%` stay, since many exporters do not encode them.
fn percent_decode(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let digit = |at: usize| bytes.get(at).and_then(|b| (*b as char).to_digit(16));
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        match (byte, digit(at + 1), digit(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((high * 16 + low) as u8);
                at += 3;
            }
            _ => {
                out.push(byte);
                at += 1;
            }
        }
    }
    out
}

/// Standard base64, with or without padding, and with any bits after the last byte.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text.strip_suffix(b"=").unwrap_or(text);
    let text = text.strip_suffix(b"=").unwrap_or(text);
    let mut lax = BASE64_NOPAD.specification();
    lax.check_trailing_bits = false;
    lax.encoding().ok()?.decode(text).ok()
}

/// A name shortened for messages.
pub fn shorten(name: &str) -> String {
    const MOST: usize = 80;
    if name.chars().count() <= MOST {
        return name.escape_debug().to_string();
    }
    let head: String = name.chars().take(MOST).collect();
    format!("{}…", head.escape_debug())
}
