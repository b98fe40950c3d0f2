//! Files that others put in the place of a model or a picture.

use super::Fault;

/// Number of first bytes that tell such files.
pub const STAND_IN_BYTES: usize = 64;

/// Refuses pointers of Git LFS, web pages and errors of servers, by the first bytes of a file.
///
/// # Errors
/// `git-lfs-pointer` and `web-page`.
pub fn refuse(bytes: &[u8]) -> Result<(), Fault> {
    let start = &bytes[..bytes.len().min(STAND_IN_BYTES)];
    let text = String::from_utf8_lossy(start).to_ascii_lowercase();
    if text.starts_with("version https://git-lfs.github.com/spec/") {
        let text = "is a pointer of Git LFS, in the place of the file itself";
        return Err(Fault::new("git-lfs-pointer", text)
            .help("run `git lfs pull` in the repository that it is of"));
    }
    let words = text.trim_start_matches('\u{feff}').trim_start();
    if words.starts_with("<!doctype html") || words.starts_with("<html") {
        let text = "is a web page, in the place of the file itself";
        return Err(Fault::new("web-page", text).help(
            "download it anew: pages that show a file have a button \"Raw\" or \"Download\"",
        ));
    }
    if words.starts_with("<?xml") && words.contains("<error>") {
        let text = "is an error of a server, in the place of the file itself";
        return Err(Fault::new("web-page", text).help("download it anew"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stand_ins_are_told_from_files() {
        let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12\n";
        for (bytes, name) in [
            (pointer.as_bytes(), Some("git-lfs-pointer")),
            (b"<!DOCTYPE html>\n<html>", Some("web-page")),
            (
                "\u{feff}\n  <HTML lang=\"en\">".as_bytes(),
                Some("web-page"),
            ),
            (b"{\"asset\": {\"version\": \"2.0\"}}", None),
            (b"<?xml version=\"1.0\"?><svg/>", None),
            (b"<?xml version=\"1.0\"?>\n<Error>", Some("web-page")),
            (b"version 1", None),
            (b"glTF\xff\xfe", None),
            (b"", None),
        ] {
            assert_eq!(refuse(bytes).err().map(|fault| fault.name), name);
        }
    }
}
