//! Picture and film formats by file extension.

use std::{ops::RangeInclusive, path::Path};

use crate::error::OutputError;

/// Contents of an output file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Format {
    /// A format of single pictures, such as PNG.
    Picture(PictureFormat),
    /// A format of whole films, such as MP4.
    Film(&'static FilmFormat),
}

/// The format of one picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// 8 bits, tone-mapped.
    Png,
    /// Linear 32-bit floats, with AOVs as channels.
    Exr,
}

/// The format of a film in one file.
#[derive(Debug, PartialEq)]
pub struct FilmFormat {
    /// File extension, without its dot.
    pub ending: &'static str,
    /// ffmpeg's container, encoder and options, between blanks; none for APNG, which is built in.
    pub ffmpeg: Option<&'static [&'static str]>,
    /// Allowed frame rates.
    pub fps: RangeInclusive<f32>,
}

/// Display colors are sRGB; most players assume BT.709.
const VIDEO: &str = "-crf 18 -pix_fmt yuv420p -colorspace bt709 -color_primaries bt709 -color_trc bt709 \
    -vf scale=out_color_matrix=bt709:out_range=tv,setparams=color_primaries=bt709:color_trc=bt709";
/// Index first, for playback while downloading.
const INDEX_FIRST: &str = "-movflags +faststart";
const MP4: &[&str] = &["-f mp4 -c:v libx264", INDEX_FIRST, VIDEO];
const MOV: &[&str] = &["-f mov -c:v libx264", INDEX_FIRST, VIDEO];
const MKV: &[&str] = &["-f matroska -c:v libx264", VIDEO];
const WEBM: &[&str] = &["-f webm -c:v libvpx-vp9", VIDEO];
/// A palette a frame: one of the whole film has fewer colors for each, and holds all frames in memory until the last.
/// The ordered dither stays where nothing moves; it plays without end.
const GIF: &str = "-f gif -c:v gif -loop 0 \
    -vf split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=bayer:bayer_scale=4";
/// The library converts colors itself, as the format's BT.601 wants. Its encoder of animations, `libwebp_anim`, drops
/// frames that are nearly their predecessors.
const WEBP: &str = "-f webp -c:v libwebp -quality 90 -pix_fmt bgra -loop 0";
/// Most pixels of a side of a WebP picture, by RFC 9649.
pub const MOST_WEBP: u32 = 16383;

/// All film formats.
pub const FILMS: [FilmFormat; 7] = [
    // Frame durations are fractions of 16-bit numbers.
    film("apng", None, 1.0 / 65535.0..=65535.0),
    film("mp4", Some(MP4), 0.001..=1000.0),
    film("mov", Some(MOV), 0.001..=1000.0),
    film("mkv", Some(MKV), 0.001..=1000.0),
    // Times are whole milliseconds; slower films play at 1000 frames a second.
    film("webm", Some(WEBM), 1.0..=1000.0),
    // Times are 16-bit hundredths of a second. Browsers show a frame of less than 2 of them, or of 10 ms, for 100 ms.
    film("gif", Some(&[GIF]), 0.002..=50.0),
    film("webp", Some(&[WEBP]), 0.001..=90.0),
];

const fn film(
    ending: &'static str,
    ffmpeg: Option<&'static [&'static str]>,
    fps: RangeInclusive<f32>,
) -> FilmFormat {
    FilmFormat {
        ending,
        ffmpeg,
        fps,
    }
}

impl Format {
    /// Format of a file extension.
    pub fn from_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "png" => Some(Self::Picture(PictureFormat::Png)),
            "exr" => Some(Self::Picture(PictureFormat::Exr)),
            other => FILMS.iter().find(|f| f.ending == other).map(Self::Film),
        }
    }

    /// Format of a file name, with an error for unknown extensions.
    ///
    /// # Errors
    /// [`OutputError::Usage`] with the known extensions.
    pub fn expect(path: &Path) -> Result<Self, OutputError> {
        Self::from_path(path).ok_or_else(|| unknown(path))
    }

    /// Whether a file name has a film extension.
    pub fn is_film(path: &Path) -> bool {
        matches!(Self::from_path(path), Some(Self::Film(_)))
    }
}

/// Error of an unknown extension.
fn unknown(path: &Path) -> OutputError {
    let of = |is_external: bool| {
        let some = FILMS.iter().filter(|f| f.ffmpeg.is_some() == is_external);
        let endings: Vec<_> = some.map(|f| format!(".{}", f.ending)).collect();
        endings.join(", ")
    };
    OutputError::Usage(format!(
        "--output {}: the name must end in .png or .exr, or for a film in {}, or with ffmpeg in {}",
        path.display(),
        of(false),
        of(true)
    ))
}

impl FilmFormat {
    /// Whether width and height must be even, because colors have half the resolution.
    pub fn has_even_sides(&self) -> bool {
        self.ffmpeg.is_some_and(|options| options.contains(&VIDEO))
    }

    /// Refuses a frame rate that the format cannot store.
    ///
    /// # Errors
    /// Message with the allowed rates and what to do.
    pub fn check_rate(&self, fps: f32) -> Result<(), String> {
        if self.fps.contains(&fps) {
            return Ok(());
        }
        let (least, most) = (self.fps.start(), self.fps.end());
        Err(format!(
            "timeline.fps is {fps}, and .{} can have {least} to {most}; change it with --set \
             timeline.fps=24, or write frames (film.####.png)",
            self.ending
        ))
    }
}
