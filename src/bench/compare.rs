//! The command `compare`: reads two pictures and a mask, scores them, writes the requested pictures.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{
    file_error,
    metric::{
        Maps, Scores, flip,
        mask::{MIN_AREA_PX, Mask},
    },
    picture::{Encoding, Pair, Picture, PictureError},
    read::{Reading, read_mask, read_picture},
    table::{Comparison, MaskReport, MaskScores},
    write::{encode_png, unwritable},
};
use reflet_base::files::{Inputs, Temporary, write_together};
use reflet_scene::diagnostic::Diagnostic;

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
    let maps = Maps::of(&pair);
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

/// Scores of a pair of pictures of the frame, and inside a mask if there is one; no names, notes and thresholds.
pub fn scored(pair: &Pair, maps: &Maps, mask: Option<&Mask>) -> Comparison {
    let frame = maps.scores(None);
    Comparison {
        test: String::new(),
        reference: String::new(),
        width: pair.test().width(),
        height: pair.test().height(),
        identical: frame.max_difference == 0.0 && frame.rel_mse == 0.0,
        crossed: Vec::new(),
        mask: mask.map(|mask| score_mask(maps, mask)),
        frame,
        difference_gain: None,
        notes: Vec::new(),
    }
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

fn score_mask(maps: &Maps, mask: &Mask) -> MaskReport {
    let area_px = mask.area();
    let area_share = area_px as f64 / mask.inside().len() as f64;
    let scores = if mask.is_scorable() {
        MaskScores::Scored(maps.scores(Some(mask)))
    } else {
        MaskScores::TooSmall(format!(
            "{area_px} px are left of the mask, under {MIN_AREA_PX}: too small to score"
        ))
    };
    MaskReport {
        area_px,
        area_share,
        scores,
    }
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

/// Sentences about how two pictures were read, and what that means for their scores.
pub fn notes(test: &Reading, reference: &Reading) -> Vec<String> {
    let mut notes = [&test.notes[..], &reference.notes[..]].concat();
    let encodings = [test, reference].map(|r| r.picture.encoding());
    if encodings[0] != encodings[1] {
        let [linear, display] = if encodings[0] == Encoding::Linear {
            ["A", "B"]
        } else {
            ["B", "A"]
        };
        notes.push(format!(
            "{linear} is linear and {display} display-referred: exposure and tone mapping that \
             only {display} went through count as errors"
        ));
    }
    let over = [test, reference].map(|r| r.picture.over_white());
    if over != [0, 0] {
        notes.push(format!(
            "{} pixels of A and {} of B exceed display white; only relMSE sees by how much",
            over[0], over[1]
        ));
    }
    if [test, reference]
        .iter()
        .any(|r| r.picture.encoding() == Encoding::Display)
    {
        notes.push(
            "relMSE of PNG pictures is taken on their sRGB values decoded to linear light, which \
             end at 1"
                .to_owned(),
        );
    }
    notes.dedup();
    notes
}

/// Refuses outputs that are no PNG, cannot be written, or replace an input or each other, before
/// any work is done.
fn check_outputs(args: &CompareArgs) -> Result<(), Box<Diagnostic>> {
    let outputs = [&args.difference, &args.flip_map];
    let inputs = [Some(&args.test), Some(&args.reference), args.mask.as_ref()];
    let inputs = Inputs::of(inputs.into_iter().flatten());
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
        Temporary::create(path)
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
        files.push((path.to_owned(), png));
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

/// |test − reference| of the display values times a gain, as RGB bytes. The gain is the largest
/// power of two from 2 to 64 that leaves 99 % of the differing channels unclipped.
pub fn difference_picture(pair: &Pair) -> (u32, Vec<u8>) {
    let (test, reference) = (pair.test().display(), pair.reference().display());
    let values = test.as_flattened().iter().zip(reference.as_flattened());
    let differences: Vec<f32> = values.map(|(a, b)| (a - b).abs()).collect();
    let mut differing: Vec<f32> = differences.iter().copied().filter(|d| *d > 0.0).collect();
    let rank = differing.len() * 99 / 100;
    let high = if differing.is_empty() {
        255.0
    } else {
        *differing.select_nth_unstable_by(rank, f32::total_cmp).1
    };
    let mut gain = 2;
    while gain < 64 && high * (2 * gain) as f32 <= 255.0 {
        gain *= 2;
    }
    let enlarge = |d: &f32| (d * gain as f32).round() as u8; // the cast clips at 255
    (gain, differences.iter().map(enlarge).collect())
}
