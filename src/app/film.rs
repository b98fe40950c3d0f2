//! Films in one file: APNG built in, the others through ffmpeg. The file gets its name when it is
//! complete.

use std::{
    fs::File,
    io::{BufWriter, ErrorKind, Read as _, Write as _},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, Stdio},
};

use super::{
    error::AppError,
    output::{check_writable, rgb},
};
use crate::files::Temporary;

/// What a film's name says about it: its ending, ffmpeg's container and encoder.
const CONTAINERS: [(&str, &str, &str); 4] = [
    ("mp4", "mp4", "libx264"),
    ("mov", "mov", "libx264"),
    ("mkv", "matroska", "libx264"),
    ("webm", "webm", "libvpx-vp9"),
];

/// A film that is being written.
pub struct Film {
    goal: PathBuf,
    temporary: Temporary,
    encoder: Encoder,
}

enum Encoder {
    Apng(Box<png::Writer<BufWriter<File>>>),
    Ffmpeg(Pipe),
}

/// An ffmpeg that takes pixels; it does not outlive this.
struct Pipe {
    child: Child,
    pixels: Option<ChildStdin>,
}

/// Whether a name is that of a film.
pub fn is_film(path: &Path) -> bool {
    let ending = ending(path);
    ending == "apng" || CONTAINERS.iter().any(|c| c.0 == ending)
}

/// What names of films end in, in words.
pub fn endings() -> String {
    let others: Vec<_> = CONTAINERS.iter().map(|c| format!(".{}", c.0)).collect();
    format!(".apng, or with ffmpeg in {}", others.join(", "))
}

fn ending(path: &Path) -> String {
    let ending = path.extension().and_then(|e| e.to_str());
    ending.unwrap_or_default().to_ascii_lowercase()
}

impl Film {
    /// Checks the path and starts the encoder.
    ///
    /// # Errors
    /// [`AppError::Usage`] for a path that cannot be written, a size that the format cannot have,
    /// or a missing ffmpeg.
    pub fn new(path: &Path, size: [u32; 2], fps: f32, frames: usize) -> Result<Self, AppError> {
        check_writable(path)?;
        let shown = path.display();
        let usage = |why: String| AppError::Usage(format!("--output {shown}: {why}"));
        let temporary = Temporary::create(path).map_err(|e| usage(e.to_string()))?;
        let container = CONTAINERS.iter().find(|c| c.0 == ending(path));
        let encoder = match container {
            None => apng(&temporary, size, fps, frames).map_err(usage)?,
            Some((_, container, codec)) => {
                ffmpeg(temporary.path(), size, fps, container, codec).map_err(usage)?
            }
        };
        Ok(Self {
            goal: path.to_owned(),
            temporary,
            encoder,
        })
    }

    /// The name that it will have.
    pub fn goal(&self) -> &Path {
        &self.goal
    }

    /// Adds a frame, RGBA.
    ///
    /// # Errors
    /// [`AppError::Internal`] with what the encoder says.
    pub fn add(&mut self, rgba: &[u8]) -> Result<(), AppError> {
        let result = match &mut self.encoder {
            Encoder::Apng(writer) => writer
                .write_image_data(&rgb(rgba))
                .map_err(|e| e.to_string()),
            Encoder::Ffmpeg(pipe) => pipe.add(&rgb(rgba)),
        };
        result.map_err(|why| failed(&self.goal, &why))
    }

    /// Ends the film and gives it its name.
    ///
    /// # Errors
    /// As [`Film::add`].
    pub fn finish(self) -> Result<PathBuf, AppError> {
        let goal = self.goal;
        let ended = match self.encoder {
            Encoder::Apng(writer) => writer.finish().map_err(|e| e.to_string()),
            Encoder::Ffmpeg(pipe) => pipe.finish(),
        };
        ended.map_err(|why| failed(&goal, &why))?;
        // The encoder has written through its own handle.
        let synced = File::open(self.temporary.path()).and_then(|file| file.sync_all());
        synced
            .and_then(|()| self.temporary.rename_to(&goal))
            .map_err(|e| failed(&goal, &e.to_string()))?;
        Ok(goal)
    }
}

fn failed(goal: &Path, why: &str) -> AppError {
    AppError::Internal(format!("cannot write {}: {why}", goal.display()))
}

impl Pipe {
    fn add(&mut self, pixels: &[u8]) -> Result<(), String> {
        let written = self.pixels.as_mut().map(|pipe| pipe.write_all(pixels));
        match written {
            Some(Err(error)) => Err(self.last_words().unwrap_or_else(|| error.to_string())),
            _ => Ok(()),
        }
    }

    fn finish(mut self) -> Result<(), String> {
        self.pixels = None; // the end of its input
        let words = self.last_words();
        match self.child.wait() {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(words.unwrap_or_else(|| format!("ffmpeg ended with {status}"))),
            Err(error) => Err(error.to_string()),
        }
    }

    /// What ffmpeg has to say, when it is at its end.
    fn last_words(&mut self) -> Option<String> {
        let mut text = String::new();
        self.child.stderr.take()?.read_to_string(&mut text).ok()?;
        let text = text.trim();
        (!text.is_empty()).then(|| format!("ffmpeg says: {text}"))
    }
}

impl Drop for Pipe {
    fn drop(&mut self) {
        // After a finished film these find nothing to do.
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

/// Seconds of a frame as a fraction of 16-bit numbers.
fn delay(fps: f32) -> (u16, u16) {
    if fps < 0.5 {
        // Whole seconds; 65535 is the longest that the format has.
        ((1.0 / fps).round() as u16, 1)
    } else if fps.fract() == 0.0 || fps > 65.0 {
        (1, fps.round() as u16)
    } else {
        (1000, (fps * 1000.0).round() as u16)
    }
}

fn ffmpeg(
    goal: &Path,
    size: [u32; 2],
    fps: f32,
    container: &str,
    codec: &str,
) -> Result<Encoder, String> {
    let [width, height] = size;
    if width % 2 == 1 || height % 2 == 1 {
        return Err(format!(
            "{width}x{height} is not even, which this format needs; choose --size, or write .apng"
        ));
    }
    let size = format!("{width}x{height}");
    let rate = fps.to_string();
    let child = Command::new("ffmpeg")
        .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-y"])
        .args([
            "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size, "-r", &rate, "-i", "pipe:0",
        ])
        .args(["-an", "-c:v", codec, "-crf", "18", "-pix_fmt", "yuv420p"])
        // Display colors are sRGB; most players take BT.709 for granted.
        .args([
            "-vf",
            "scale=out_color_matrix=bt709:out_range=tv,\
             setparams=color_primaries=bt709:color_trc=bt709",
            "-colorspace",
            "bt709",
        ])
        .args([
            "-color_primaries",
            "bt709",
            "-color_trc",
            "bt709",
            "-f",
            container,
        ])
        .arg(goal)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = child.map_err(|error| match error.kind() {
        ErrorKind::NotFound => {
            "ffmpeg is not installed, and films other than .apng need it; install it, or write \
             .apng or frames (film.####.png)"
                .to_owned()
        }
        _ => format!("ffmpeg cannot be started: {error}"),
    })?;
    let pixels = child.stdin.take().ok_or("ffmpeg has no input")?;
    Ok(Encoder::Ffmpeg(Pipe {
        child,
        pixels: Some(pixels),
    }))
}

#[cfg(test)]
mod tests {
    use super::delay;

    #[test]
    fn delays_are_never_without_a_denominator() {
        for (fps, fraction) in [
            (24.0, (1, 24)),
            (23.976, (1000, 23976)),
            (0.5, (1000, 500)),
            (0.1, (10, 1)),
            (0.0004, (2500, 1)),
            (1e-9, (65535, 1)),
        ] {
            assert_eq!(delay(fps), fraction, "{fps}");
        }
    }
}
