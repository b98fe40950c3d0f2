//! One call of a command: a process with a time, whose words and picture are read from a temporary folder.

use std::{
    fs::{self, File},
    io::{Cursor, Read as _},
    path::Path,
    process::{ExitStatus, Stdio},
    thread,
    time::Instant,
};

use data_encoding::BASE64;
use image::{GenericImageView as _, ImageFormat, ImageReader};
use rmcp::model::{CallToolResult, ContentBlock};
#[cfg(unix)]
use rustix::process::{Pid, Signal, kill_process_group};
use tempfile::TempDir;

use super::{super::own_process::own_process, TICK, tools::Tool};
use crate::files::read_at_most;

/// Maximum length of the text of an answer, bytes.
const MOST_TEXT: u64 = 1 << 18;
/// Maximum length of messages beside an answer, bytes.
const MOST_MESSAGES: u64 = 1 << 14;
/// Maximum length of the file of a shown picture, bytes, and of its longer side, pixels.
const MOST_FILE: usize = 1 << 19;
const MOST_SIDE: u32 = 1024;
/// Name of the picture in the temporary folder.
const PICTURE: &str = "picture.png";

/// Answer of a call for the client, and its picture in full as a file.
pub type Made = (CallToolResult, Option<Vec<u8>>);

/// Runs a command from `folder` until it ends, `until` has come, or nobody waits for it any more.
///
/// # Errors
/// Messages of a command that fails, takes too long or says too much.
pub fn make(
    tool: &Tool,
    words: &[String],
    folder: &Path,
    until: Instant,
    is_stopped: &dyn Fn() -> bool,
) -> Result<Made, String> {
    let unusable = |error| format!("a process and temporary files: {error}");
    let files = TempDir::new().map_err(unusable)?;
    let create = |name| File::create(files.path().join(name)).map_err(unusable);
    let picture = tool.picture.as_ref();
    let picture =
        picture.map(|option| format!("{option}={}", files.path().join(PICTURE).display()));
    let mut command = own_process().map_err(unusable)?;
    #[cfg(unix)] // so that it ends with processes that it starts, such as the converter of USD
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut process = command
        .arg(&tool.name)
        .args(picture)
        .args(words)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(create("answer")?)
        .stderr(create("messages")?)
        .spawn()
        .map_err(unusable)?;
    loop {
        let why = match process.try_wait() {
            Ok(Some(status)) => return read(tool, files.path(), status),
            Err(error) => unusable(error),
            Ok(None) if is_stopped() => "stopped".to_owned(),
            Ok(None) if Instant::now() > until => {
                "it took too long and was ended; ask for less, such as a smaller `size` and fewer `samples`, or start the \
                 server with a longer `--timeout`"
                    .to_owned()
            }
            Ok(None) => {
                thread::sleep(TICK);
                continue;
            }
        };
        #[cfg(unix)]
        let _ = kill_process_group(Pid::from_child(&process), Signal::KILL);
        let _ = process.kill(); // it may have ended
        let _ = process.wait();
        return Err(why);
    }
}

/// Reads the files of a command that ended.
fn read(tool: &Tool, files: &Path, status: ExitStatus) -> Result<Made, String> {
    let unreadable = |error| format!("its answer: {error}; ask for less");
    let open = |name| File::open(files.join(name)).map_err(unreadable);
    let mut messages = Vec::new();
    let read = open("messages")?
        .take(MOST_MESSAGES)
        .read_to_end(&mut messages);
    read.map_err(unreadable)?;
    let messages = String::from_utf8_lossy(&messages);
    // A place that is gone when the client reads of it, and advice on command lines.
    let own = files.join("").to_string_lossy().into_owned();
    let is_for_client = |line: &&str| {
        let others = ["Usage: ", "For more information", &format!("wrote {own}")];
        !line.is_empty() && !others.iter().any(|other| line.starts_with(other))
    };
    let messages: Vec<_> = messages.lines().filter(is_for_client).collect();
    let messages = messages.join("\n").replace(&own, "");
    match status.code() {
        Some(code) if code == 0 || code == tool.fails => {}
        Some(_) => return Err(messages),
        None => return Err(format!("{messages}\nthe command crashed: {status}")),
    }
    let said = read_at_most(&open("answer")?, MOST_TEXT).map_err(unreadable)?;
    let said = String::from_utf8_lossy(&said);
    let mut answer = match serde_json::from_str(&said) {
        Ok(value) => CallToolResult::structured(value),
        Err(_) => CallToolResult::success(vec![ContentBlock::text(said)]),
    };
    let picture = tool.picture.as_ref();
    let picture = picture
        .map(|_| fs::read(files.join(PICTURE)).map_err(unreadable))
        .transpose()?;
    if let Some(file) = &picture {
        answer.content.extend(match shown(file) {
            Ok((shown, size)) => vec![
                ContentBlock::image(BASE64.encode(&shown), "image/png"),
                ContentBlock::text(size),
            ],
            Err(error) => vec![ContentBlock::text(format!(
                "the picture is not shown: {error}"
            ))],
        });
    }
    answer.content.push(ContentBlock::text(messages));
    let is_said =
        |block: &ContentBlock| !matches!(block, ContentBlock::Text(text) if text.text.is_empty());
    answer.content.retain(is_said);
    Ok((answer, picture))
}

/// A picture as large as an answer may have it, and its size in words.
fn shown(file: &[u8]) -> Result<(Vec<u8>, String), image::ImageError> {
    let reader = || ImageReader::with_format(Cursor::new(file), ImageFormat::Png);
    let (width, height) = reader().into_dimensions()?;
    let size = format!("{width} x {height} pixels");
    let mut side = width.max(height);
    if side <= MOST_SIDE && file.len() <= MOST_FILE {
        return Ok((file.to_owned(), size));
    }
    let whole = reader().decode()?; // refuses more than 512 MiB
    side = side.min(MOST_SIDE);
    loop {
        let small = whole.thumbnail(side, side);
        let mut bytes = Cursor::new(Vec::new());
        small.write_to(&mut bytes, ImageFormat::Png)?;
        if bytes.get_ref().len() <= MOST_FILE {
            let (width, height) = small.dimensions();
            let size = format!("{size}, shown with {width} x {height}");
            return Ok((bytes.into_inner(), size));
        }
        side = side * 3 / 4;
    }
}
