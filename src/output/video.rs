//! Video files: APNG built in, other formats through ffmpeg. The file gets its name once it is
//! complete.

use std::{
    fs::File,
    io::{self, BufWriter, ErrorKind, Read, Write as _},
    path::{self, Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::mpsc::{self, SyncSender, TrySendError},
    thread::{self, JoinHandle},
    time::Duration,
};

use super::{
    format::{FilmFormat, MOST_WEBP},
    writable::check_writable,
};
use crate::error::OutputError;
use reflet_base::files::{Goal, Inputs, Temporary};
use reflet_render::picture::png_file::rgb;

/// Maximum length of ffmpeg's output in a message, bytes; its end is quoted.
const MAX_MESSAGE_BYTES: usize = 600;

/// Interval in which a request to stop is noticed while ffmpeg reads nothing or does not end.
const POLL: Duration = Duration::from_millis(10);

/// Threads of ffmpeg's encoder, whose number changes the bytes of a film.
const ENCODER_THREADS: &str = "4";

/// Path of a process's standard output as a file, on Linux.
const OPEN_FILE: &str = "/proc/self/fd/1";

/// A video file being written.
pub struct Film {
    path: PathBuf,
    temporary: Temporary,
    encoder: Encoder,
}

enum Encoder {
    Apng(Box<png::Writer<BufWriter<File>>>),
    Ffmpeg(Pipe),
}

/// An ffmpeg process that reads pixels from a pipe; killed on drop.
struct Pipe {
    child: Child,
    /// Frames for the writer; closed at the end.
    frames: Option<SyncSender<Vec<u8>>>,
    /// Thread that writes to ffmpeg, which may read nothing for ever.
    writer: Option<JoinHandle<io::Result<()>>>,
    /// Thread that drains ffmpeg's standard error, since a full pipe would block ffmpeg.
    stderr: Option<JoinHandle<String>>,
}

impl Film {
    /// Checks the path and starts the encoder.
    ///
    /// # Errors
    /// [`OutputError::Usage`] for a path that cannot be written, a size or rate that the format cannot
    /// have, or a missing ffmpeg.
    pub fn new(
        path: &Goal,
        format: &FilmFormat,
        size: [u32; 2],
        fps: f32,
        frames: usize,
    ) -> Result<Self, OutputError> {
        check_writable(path, &Inputs::default())?;
        let shown = path.display();
        let usage = |why: String| OutputError::Usage(format!("--output {shown}: {why}"));
        format.check_rate(fps).map_err(usage)?;
        let temporary = Temporary::create(path).map_err(|e| usage(e.to_string()))?;
        let encoder = match format.ffmpeg {
            None => apng(&temporary, size, fps, frames).map_err(usage)?,
            Some(_) if format.has_even_sides() && size.iter().any(|side| side % 2 == 1) => {
                return Err(usage(odd(size)));
            }
            Some(_) if format.ending == "webp" && size.iter().any(|side| *side > MOST_WEBP) => {
                let why = format!("a WebP has at most {MOST_WEBP} pixels a side; write .apng");
                return Err(usage(why));
            }
            Some(options) => ffmpeg(&temporary, size, fps, options).map_err(usage)?,
        };
        Ok(Self {
            path: path.to_path_buf(),
            temporary,
            encoder,
        })
    }

    /// Final path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a frame, RGBA; waits for the encoder until `is_stopped`.
    ///
    /// # Errors
    /// [`OutputError::Disk`] with the encoder's message, and [`OutputError::Stopped`]; no film is written then.
    pub fn add(&mut self, rgba: &[u8], is_stopped: fn() -> bool) -> Result<(), OutputError> {
        let result = match &mut self.encoder {
            Encoder::Apng(writer) => writer.write_image_data(&rgb(rgba)).map_err(apng_failed),
            Encoder::Ffmpeg(pipe) => pipe.add(rgb(rgba), is_stopped),
        };
        result.map_err(|why| failed(&self.path, &why))
    }

    /// Completes the file and renames it to its final path; waits for the encoder until `is_stopped`.
    ///
    /// # Errors
    /// Same errors as [`Film::add`].
    pub fn finish(self, is_stopped: fn() -> bool) -> Result<PathBuf, OutputError> {
        let path = self.path;
        let ended = match self.encoder {
            Encoder::Apng(writer) => writer.finish().map_err(apng_failed),
            Encoder::Ffmpeg(mut pipe) => pipe.end(is_stopped),
        };
        let synced = ended.and_then(|()| {
            let file = &self.temporary.file;
            if file.metadata().map_err(FilmError::from)?.len() == 0 {
                return Err(FilmError::Encoder(
                    "the encoder has written nothing".to_owned(),
                ));
            }
            file.sync_all().map_err(FilmError::from)
        });
        synced
            .and_then(|()| self.temporary.persist().map_err(FilmError::from))
            .map_err(|why| failed(&path, &why))?;
        Ok(path)
    }
}

/// Reason why a film cannot be written.
enum FilmError {
    /// File error.
    File(String),
    /// Encoder error.
    Encoder(String),
    /// The program is asked to stop.
    Stopped,
}

impl From<io::Error> for FilmError {
    fn from(error: io::Error) -> Self {
        Self::File(error.to_string())
    }
}

fn apng_failed(error: png::EncodingError) -> FilmError {
    match error {
        png::EncodingError::IoError(error) => error.into(),
        other => FilmError::Encoder(other.to_string()),
    }
}

/// Error with its cause and what to do.
fn failed(path: &Path, why: &FilmError) -> OutputError {
    let frames = path.with_extension("####.png");
    let (path, frames) = (path.display(), frames.display());
    OutputError::Disk(match why {
        FilmError::Stopped => return OutputError::Stopped,
        FilmError::File(why) => format!(
            "cannot write {path}: {why}; there is no film: free disk space, or write frames ({frames}), \
             with which --resume goes on"
        ),
        FilmError::Encoder(why) => format!(
            "cannot write {path}: {why}; there is no film: fix that, or write .apng or frames \
             ({frames})"
        ),
    })
}

impl Pipe {
    fn add(&mut self, mut pixels: Vec<u8>, is_stopped: fn() -> bool) -> Result<(), FilmError> {
        while let Some(frames) = &self.frames {
            match frames.try_send(pixels) {
                Ok(()) => break,
                Err(TrySendError::Full(_)) if is_stopped() => return Err(FilmError::Stopped),
                Err(TrySendError::Full(back)) => {
                    pixels = back;
                    thread::sleep(POLL);
                }
                Err(TrySendError::Disconnected(_)) => return self.end(is_stopped),
            }
        }
        Ok(())
    }

    /// Waits for ffmpeg's end. Some failed writes leave exit code 0, so its output and its input are checked too.
    fn end(&mut self, is_stopped: fn() -> bool) -> Result<(), FilmError> {
        self.frames = None; // closes its input
        let status = loop {
            match self.child.try_wait()? {
                Some(status) => break status,
                None if is_stopped() => return Err(FilmError::Stopped),
                None => thread::sleep(POLL),
            }
        };
        let stderr = self.stderr.take().and_then(|stderr| stderr.join().ok());
        let stderr = stderr.unwrap_or_default();
        let written = self.writer.take().and_then(|writer| writer.join().ok());
        match written {
            _ if !stderr.is_empty() => Err(FilmError::Encoder(format!("ffmpeg says: {stderr}"))),
            _ if !status.success() => {
                Err(FilmError::Encoder(format!("ffmpeg ended with {status}")))
            }
            Some(Err(error)) => {
                let why = format!("ffmpeg accepts no input: {error}");
                Err(FilmError::Encoder(why))
            }
            _ => Ok(()),
        }
    }
}

/// Reads all output and returns its end.
fn end_of(mut from: impl Read) -> String {
    let (mut said, mut part) = (Vec::new(), [0; 4096]);
    while let Ok(length @ 1..) = from.read(&mut part) {
        said.extend_from_slice(&part[..length]);
        if said.len() > MAX_MESSAGE_BYTES {
            said.drain(..said.len() - MAX_MESSAGE_BYTES);
        }
    }
    let cut = said.len() == MAX_MESSAGE_BYTES;
    let text = String::from_utf8_lossy(&said);
    let text = text.trim();
    // The first line may be cut off.
    let whole = text.split_once('\n').filter(|_| cut);
    whole.map_or(text, |(_, rest)| rest).replace('\n', "; ")
}

impl Drop for Pipe {
    fn drop(&mut self) {
        // No effect after a normal end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn apng(temporary: &Temporary, size: [u32; 2], fps: f32, frames: usize) -> Result<Encoder, String> {
    let file = temporary.file.try_clone().map_err(|e| e.to_string())?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    let (numerator, denominator) = delay(fps);
    encoder
        .set_animated(frames as u32, 0)
        .and_then(|()| encoder.set_frame_delay(numerator, denominator))
        .and_then(|()| encoder.write_header())
        .map(|writer| Encoder::Apng(Box::new(writer)))
        .map_err(|e| e.to_string())
}

/// Frame duration in seconds as a fraction of 16-bit numbers.
fn delay(fps: f32) -> (u16, u16) {
    if fps < 0.5 {
        // Whole seconds; 65535 is the format's maximum.
        ((1.0 / fps).round() as u16, 1)
    } else if fps.fract() == 0.0 || fps > 65.0 {
        (1, fps.round() as u16)
    } else {
        (1000, (fps * 1000.0).round() as u16)
    }
}

/// Message of a size that a format of half the resolution for colors cannot have.
fn odd([width, height]: [u32; 2]) -> String {
    let even = [width, height].map(|side| side.next_multiple_of(2));
    format!(
        "{width}x{height} is not even, which this format needs; choose --size {}x{}, or write .apng",
        even[0], even[1]
    )
}

fn ffmpeg(
    temporary: &Temporary,
    size: [u32; 2],
    fps: f32,
    options: &[&str],
) -> Result<Encoder, String> {
    let size = format!("{}x{}", size[0], size[1]);
    let rate = fps.to_string();
    // On Linux ffmpeg gets the open file, whose name may have become a link meanwhile. It reads a relative path with a
    // colon as a protocol.
    let (path, output) = match cfg!(target_os = "linux") {
        true => (
            OPEN_FILE.into(),
            temporary.file.try_clone().map(Stdio::from),
        ),
        false => (temporary.path(), Ok(Stdio::null())),
    };
    let path = path::absolute(path).map_err(|e| e.to_string())?;
    let mut command = Command::new("ffmpeg");
    command
        // `-xerror` exits on a failed write.
        .args([
            "-hide_banner",
            "-loglevel",
            "error",
            "-xerror",
            "-nostdin",
            "-y",
        ])
        .args([
            "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size, "-r", &rate, "-i", "pipe:0",
        ])
        .arg("-an")
        .args(options.iter().flat_map(|some| some.split_whitespace()))
        // The same bytes in every run: no random numbers in Matroska, no versions, and not as many threads as cores.
        .args(["-fflags", "+bitexact", "-flags:v", "+bitexact"])
        .args(["-threads", ENCODER_THREADS])
        .stdin(Stdio::piped())
        .stdout(output.map_err(|e| e.to_string())?)
        .stderr(Stdio::piped());
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt as _;
        // Ctrl-C in a terminal must reach this program only, which reports it.
        command.process_group(0);
    }
    let child = command.arg(path).spawn();
    let mut child = child.map_err(|error| match error.kind() {
        ErrorKind::NotFound => {
            "ffmpeg is not installed, and films other than .apng need it; install it, or write \
             .apng or frames (film.####.png)"
                .to_owned()
        }
        _ => format!("ffmpeg cannot be started: {error}"),
    })?;
    let mut pixels = child.stdin.take().ok_or("ffmpeg has no input")?;
    let errors = child.stderr.take().ok_or("ffmpeg has no errors")?;
    let (frames, queue) = mpsc::sync_channel::<Vec<u8>>(1);
    let write = move || queue.iter().try_for_each(|frame| pixels.write_all(&frame));
    Ok(Encoder::Ffmpeg(Pipe {
        child,
        frames: Some(frames),
        writer: Some(thread::spawn(write)),
        stderr: Some(thread::spawn(move || end_of(errors))),
    }))
}

#[cfg(test)]
mod tests {
    use super::{MAX_MESSAGE_BYTES, delay, end_of};

    #[test]
    fn reports_the_last_line_of_the_encoder() {
        assert_eq!(end_of(&b"one\ntwo \n"[..]), "one; two");
        let long = "noise\n".repeat(9000) + "No space left\n";
        let told = end_of(long.as_bytes());
        assert!(
            told.len() < 2 * MAX_MESSAGE_BYTES && told.starts_with("noise; "),
            "{told}"
        );
        assert!(told.ends_with("; No space left"), "{told}");
    }

    #[test]
    fn delays_are_never_without_a_denominator() {
        for (fps, fraction) in [
            (24.0, (1, 24)),
            (23.976, (1000, 23976)),
            (0.5, (1000, 500)),
            (0.1, (10, 1)),
            (0.0004, (2500, 1)),
            (1.0 / 65535.0, (65535, 1)),
        ] {
            assert_eq!(delay(fps), fraction, "{fps}");
        }
    }
}
