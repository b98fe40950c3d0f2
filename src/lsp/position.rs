//! Positions and files in the protocol's form: lines from 0, columns in UTF-16 units, files as URIs.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};
use reflet_scene::diagnostic::Source;
use serde_json::{Value, json};

/// Characters of a path that a URI reference does not encode (RFC 3986): unreserved ones, and the slash.
pub const PLAIN: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~')
    .remove(b'/');

/// Byte offset of a position, at most at the end of its line.
pub fn offset(text: &str, position: &Value) -> usize {
    let number = |key: &str| position[key].as_u64().unwrap_or(0) as usize;
    let mut start = 0;
    for _ in 0..number("line") {
        match text[start..].find('\n') {
            Some(end) => start += end + 1,
            None => return text.len(),
        }
    }
    let line = text[start..].split(['\n', '\r']).next().unwrap_or_default();
    let mut units = 0;
    for (i, c) in line.char_indices() {
        if units >= number("character") {
            return start + i;
        }
        units += c.len_utf16();
    }
    start + line.len()
}

/// A byte range in the protocol's form.
pub fn range(text: &str, range: &Range<usize>) -> Value {
    let position = |offset: usize| {
        let before = &text[..text.floor_char_boundary(offset)];
        let line = before.bytes().filter(|&b| b == b'\n').count();
        let start = before.rfind('\n').map_or(0, |i| i + 1);
        let units: usize = before[start..].chars().map(char::len_utf16).sum();
        json!({ "line": line, "character": units })
    };
    json!({ "start": position(range.start), "end": position(range.end) })
}

/// A byte range of a file in the protocol's form.
pub fn location(file: &Source, at: &Range<usize>) -> Value {
    json!({ "uri": uri_of(&file.path), "range": range(&file.text, at) })
}

/// The file of a `file:` URI.
pub fn path_of(uri: &str) -> Option<PathBuf> {
    let path = uri.strip_prefix("file://")?;
    let path = percent_decode_str(path).decode_utf8().ok()?;
    let path = match cfg!(windows) {
        true => path.trim_start_matches('/'), // file:///C:/…
        false => &path,
    };
    Some(PathBuf::from(path))
}

/// The URI of a file.
pub fn uri_of(path: &Path) -> String {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let text = path.to_string_lossy().replace('\\', "/");
    let root = if text.starts_with('/') { "" } else { "/" };
    format!("file://{root}{}", utf8_percent_encode(&text, PLAIN))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_utf_16_units() {
        let text = "a\nüb𝄞c\r\nd";
        let c = text.find('c').expect("there");
        assert_eq!(
            range(text, &(c..c + 1))["start"],
            json!({ "line": 1, "character": 4 })
        );
        assert_eq!(offset(text, &json!({ "line": 1, "character": 4 })), c);
        assert_eq!(offset(text, &json!({ "line": 1, "character": 99 })), c + 1);
        assert_eq!(
            offset(text, &json!({ "line": 9, "character": 0 })),
            text.len()
        );
        assert_eq!(offset(text, &json!(null)), 0);
    }

    #[cfg(unix)]
    #[test]
    fn files_survive_their_uri() {
        for path in ["/a/b.toml", "/a b/ü%20#?.toml"] {
            assert_eq!(path_of(&uri_of(Path::new(path))), Some(PathBuf::from(path)));
        }
        assert_eq!(path_of("untitled:1"), None);
    }
}
