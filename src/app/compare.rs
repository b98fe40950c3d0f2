//! The command `compare`: reads two pictures and a mask, scores them, writes the requested pictures.

use std::{
    fs,
    io::Cursor,
    path::{Path, PathBuf},
};

use crate::{
    files::{Goal, Inputs, Temporary, write_together},
    metric::{
        Maps, Scores,
        comparison::{Comparison, MaskReport, MaskScores, notes, scored},
        difference::difference_picture,
        file_error, flip,
        mask::Mask,
        picture::{Pair, Picture, PictureError},
        read::{Reading, read_mask, read_picture},
    },
    scene::diagnostic::Diagnostic,
};

/// Judges a picture against a reference.
#[derive(Clone, Debug, clap::Args)]
pub struct CompareArgs {
    /// The picture to judge: PNG (taken as sRGB) or OpenEXR (linear); alpha is put over black.
    #[arg(value_name = "A")]
    pub test: PathBuf,
    /// Reference picture, of the same size.
    #[arg(value_name = "B")]
    pub reference: PathBuf,
    /// A gray picture of the same size whose values are Fresnel-weighted reflectance (255 or 1.0 is
    /// all): pixels over 1/255, less 5 pixels at every edge, are scored apart. `render --aov
    /// reflectance` writes it: OUT.reflectance.png beside a PNG, the channel reflectance.Y in an
    /// OpenEXR file, which is taken before its colors.
    #[arg(long, value_name = "M")]
    pub mask: Option<PathBuf>,
    /// Print JSON instead of a table.
    #[arg(long)]
    pub json: bool,
    /// Write |A − B| as a PNG, its contrast enlarged (the factor is printed).
    #[arg(long, value_name = "PNG")]
    pub difference: Option<PathBuf>,
    /// Write the FLIP error as a PNG heat map: black is 0 (the same), through purple and orange, to
    /// light yellow, 1 (as different as can be seen); the scale is always 0 to 1.
    #[arg(long, value_name = "PNG")]
    pub flip_map: Option<PathBuf>,
    /// Exit with 6 when the mean FLIP of the frame, or inside the mask, is above this (0 to 1).
    #[arg(long, value_name = "X", value_parser = unit_interval)]
    pub max_flip: Option<f64>,
    /// Exit with 6 when the SSIM of the frame, or inside the mask, is below this (0 to 1).
    #[arg(long, value_name = "Y", value_parser = unit_interval)]
    pub min_ssim: Option<f64>,
}

/// Parses a threshold.
fn unit_interval(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(v) if (0.0..=1.0).contains(&v) => Ok(v),
        _ => Err("expected a number from 0 to 1".to_owned()),
    }
}

/// Runs the command except for printing; `Comparison::crossed` lists the crossed thresholds.
///
/// # Errors
/// When a file cannot be read, holds no picture, differs in size from the others, or an output
/// cannot be written or would replace an input. Pictures are written only after everything else
/// succeeded.
pub fn compare(args: &CompareArgs) -> Result<Comparison, Box<Diagnostic>> {
    check_outputs(args)?;
    let test = read_picture(&args.test)?;
    let reference = read_picture(&args.reference)?;
    let pair = Pair::new(&test.picture, &reference.picture)
        .map_err(|e| size_error(e, &args.test, &args.reference))?;
    let mut notes = notes(&test, &reference);
    let mask = match &args.mask {
        Some(path) => Some(mask_of(path, args, &reference.picture, &mut notes)?),
        None => None,
    };
    let maps = Maps::compare(&pair);
    let mut comparison = Comparison {
        test: args.test.display().to_string(),
        reference: args.reference.display().to_string(),
        notes,
        ..scored(&pair, &maps, mask.as_ref())
    };
    comparison.crossed = crossed(args, &comparison.frame, comparison.mask.as_ref());
    write_pictures(args, &pair, &maps, &mut comparison)?;
    Ok(comparison)
}

/// Mask of the reflective pixels of a mask picture, eroded.
fn mask_of(
    path: &Path,
    args: &CompareArgs,
    reference: &Picture,
    notes: &mut Vec<String>,
) -> Result<Mask, Box<Diagnostic>> {
    let Reading {
        picture,
        notes: of_mask,
    } = read_mask(path)?;
    notes.extend(of_mask);
    Pair::new(&picture, reference).map_err(|e| size_error(e, path, &args.reference))?;
    Mask::reflective(picture.width(), picture.height(), &picture.weights()).map_err(|e| {
        file_error(
            "bad-pixels",
            path,
            e.to_string(),
            "write a mask of finite weights",
        )
    })
}

fn size_error(error: PictureError, file: &Path, other: &Path) -> Box<Diagnostic> {
    let help = format!(
        "render {} and {} at the same size",
        file.display(),
        other.display()
    );
    file_error("different-sizes", file, error.to_string(), help)
}

/// Messages on thresholds that were crossed, or that cannot be checked: a check without data must not
/// pass.
fn crossed(args: &CompareArgs, frame: &Scores, mask: Option<&MaskReport>) -> Vec<String> {
    let mut regions = vec![("of the frame", Some(frame))];
    if let Some(mask) = mask {
        let scores = match &mask.scores {
            MaskScores::Scored(scores) => Some(scores),
            MaskScores::TooSmall(_) => None,
        };
        regions.push(("inside the mask", scores));
    }
    let mut crossed = Vec::new();
    for (region, scores) in regions {
        if let Some(limit) = args.max_flip {
            match scores.map(|s| s.flip_mean) {
                Some(value) if value <= limit => {}
                Some(value) => crossed.push(format!(
                    "mean FLIP {region} is {value:.6}, above --max-flip {limit}"
                )),
                None => crossed.push(format!(
                    "mean FLIP {region} cannot be judged (too few pixels), so --max-flip fails"
                )),
            }
        }
        if let Some(limit) = args.min_ssim {
            match scores.and_then(|s| s.ssim) {
                Some(value) if value >= limit => {}
                Some(value) => crossed.push(format!(
                    "SSIM {region} is {value:.6}, below --min-ssim {limit}"
                )),
                None => crossed.push(format!(
                    "SSIM {region} cannot be judged (too few pixels), so --min-ssim fails"
                )),
            }
        }
    }
    crossed
}

/// Refuses outputs that are no PNG, cannot be written, or replace an input or each other, before
/// any work is done.
fn check_outputs(args: &CompareArgs) -> Result<(), Box<Diagnostic>> {
    let outputs = [&args.difference, &args.flip_map];
    let inputs = [Some(&args.test), Some(&args.reference), args.mask.as_ref()];
    let inputs = Inputs::identify(inputs.into_iter().flatten());
    for path in outputs.into_iter().flatten() {
        let refuse = |message: &str, help: &str| Err(file_error("bad-output", path, message, help));
        if !path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("png"))
        {
            return refuse("pictures are written as PNG", "end the name with .png");
        }
        if inputs.hold(path) {
            return refuse(
                "this would replace a picture that is compared",
                "choose another name",
            );
        }
        // Creating a file is the only reliable test of permissions.
        Temporary::create(&Goal::typed(path.clone()))
            .map_err(|e| unwritable(path, &format!("cannot be written: {e}")))?;
    }
    match outputs {
        [Some(a), Some(b)] if real(a) == real(b) => {
            let message = "both pictures would be written here";
            Err(file_error("bad-output", a, message, "choose two names"))
        }
        _ => Ok(()),
    }
}

/// Canonical path by which files are compared: links are followed, `.` and `..` resolved. For a file
/// that does not exist yet, its folder is resolved.
fn real(path: &Path) -> PathBuf {
    let in_folder = || {
        let path = std::path::absolute(path).ok()?;
        let folder = fs::canonicalize(path.parent()?).ok()?;
        Some(folder.join(path.file_name()?))
    };
    let found = fs::canonicalize(path).ok().or_else(in_folder);
    found.unwrap_or_else(|| path.to_owned())
}

fn write_pictures(
    args: &CompareArgs,
    pair: &Pair,
    maps: &Maps,
    comparison: &mut Comparison,
) -> Result<(), Box<Diagnostic>> {
    let (width, height) = (comparison.width, comparison.height);
    let mut files = Vec::new();
    let mut add = |path: &Path, rgb| {
        let png = encode_png(width, height, rgb).map_err(|why| unwritable(path, &why))?;
        files.push((Goal::typed(path.to_owned()), png));
        Ok::<_, Box<Diagnostic>>(())
    };
    if let Some(path) = &args.difference {
        let (gain, rgb) = difference_picture(pair);
        add(path, rgb)?;
        comparison.difference_gain = Some(gain);
    }
    if let Some(path) = &args.flip_map {
        add(path, flip::heat(&maps.flip))?;
    }
    write_together(&files)
        .map_err(|(path, e)| unwritable(&path, &format!("cannot be written: {e}")))
}

/// Encodes an 8-bit sRGB PNG from tightly packed RGB bytes.
///
/// # Errors
/// Message, when `rgb` is not `3 * width * height` bytes.
fn encode_png(width: usize, height: usize, rgb: Vec<u8>) -> Result<Vec<u8>, String> {
    let mut encoded = Cursor::new(Vec::new());
    image::RgbImage::from_raw(width as u32, height as u32, rgb)
        .ok_or_else(|| format!("the pixels are not {width} × {height}"))?
        .write_to(&mut encoded, image::ImageFormat::Png)
        .map_err(|e| format!("cannot be encoded: {e}"))?;
    Ok(encoded.into_inner())
}

/// Error about a picture that cannot be written.
fn unwritable(path: &Path, message: &str) -> Box<Diagnostic> {
    let help = "choose a folder that exists and can be written to";
    file_error("unwritable-picture", path, message, help)
}
