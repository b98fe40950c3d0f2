//! Decodes PNG, JPEG, WebP and KTX2 into [`Texture`]s: headers first, within stated limits, on all cores. The memory
//! budget counts the decoders' working memory, so that as many images are decoded at once as fit.

use std::path::PathBuf;

use image::RgbaImage;
use rayon::prelude::*;

use self::{
    decoder::{Need, Opened},
    encoded::Encoded,
};
use super::{
    Texture,
    gltf::{Fault, ImageSource},
};
use reflet_base::{
    guard,
    memory::{Budget, wave_length},
};
use reflet_scene::diagnostic::Diagnostic;

mod basis;
mod decoder;
mod encoded;
mod floats;
mod jpeg;
mod ktx2;
mod png_color;
pub mod pool_size;
pub mod resample;
mod specular_glossiness;
mod webp;

pub(super) use self::png_color::other_than_srgb;
pub(super) use self::webp::{Watched, largest_frame_bytes};

/// Limits of decoding.
#[derive(Clone, Debug)]
pub struct TextureLimits {
    /// Largest width and height, pixels.
    pub max_px: u32,
    /// Most decoded bytes of all images together.
    pub budget_bytes: u64,
    /// Largest encoded image file, bytes.
    pub max_file_bytes: u64,
    /// Memory of the load, which decoded images are taken from.
    pub memory: Budget,
}

/// An image to decode.
#[derive(Clone, Debug)]
pub struct TextureRequest {
    /// Name of the image in `file`, for messages.
    pub name: String,
    /// User of the image, for messages; may be empty.
    pub used_by: String,
    /// File for error messages.
    pub file: PathBuf,
    /// Encoded bytes.
    pub source: ImageSource,
    /// Whether the bytes are sRGB-encoded, see [`Texture::srgb`].
    pub srgb: bool,
    /// Image that the file has for readers that cannot show this one.
    pub fallback: Option<Box<TextureRequest>>,
}

impl TextureRequest {
    fn place(&self) -> String {
        match self.used_by.as_str() {
            "" => self.name.clone(),
            used_by => format!("{}, {used_by}", self.name),
        }
    }
}

/// Message about texels that are too few or too many.
const OTHER_SIZE: &str = "it decodes to another size than its header says";

fn fault(name: &'static str, text: impl Into<String>) -> Fault {
    let fault = Fault::new(name, text);
    match name {
        "image-broken" | "image-damaged" => fault.help("copy or export the image again"),
        _ => fault,
    }
}

/// Decoded images with their faults.
#[derive(Default)]
pub struct Decoded {
    /// Images in the order of their requests.
    pub textures: Vec<Texture>,
    /// Index and error of each forgiven image, which is a white pixel, or its fallback where the index is `None`.
    pub broken: Vec<(Option<usize>, Diagnostic)>,
    /// Damage of images that are shown.
    pub damaged: Vec<Diagnostic>,
}

/// Decodes all requests, in their order, and takes their memory from the budget of `limits`. An image that is broken
/// behind its header, and that `is_forgiven`, gives way to its fallback or a white pixel.
///
/// # Errors
/// One error for every image that is broken, of another format, or too large; `image-budget` when all
/// together are more than the budget, or decoding one takes more memory than they leave (found from the headers,
/// before anything is decoded).
pub fn decode_all(
    requests: &[TextureRequest],
    limits: &TextureLimits,
    is_forgiven: &dyn Fn(&TextureRequest) -> bool,
) -> Result<Decoded, Vec<Diagnostic>> {
    let blame =
        |request: &TextureRequest, f: Fault| f.placed(&request.place()).in_file(&request.file);
    let mut errors = Vec::new();
    let mut needs = Vec::with_capacity(requests.len());
    for request in requests {
        match guarded(|| need(&request.source, limits)) {
            Ok(need) => needs.push(need),
            Err(f) => report_once(&mut errors, blame(request, f)),
        }
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    take_kept(requests, &needs, limits).map_err(|(at, f)| vec![blame(&requests[at], f)])?;
    let mut all = Decoded::default();
    let mut start = 0;
    while start < requests.len() {
        let working = needs[start..].iter().map(|need| need.working);
        let wave = start..start + wave_length(working, limits.memory.left());
        let working = needs[wave.clone()].iter().map(|need| need.working).sum();
        let held = (limits.memory.hold(working))
            .ok_or_else(|| vec![blame(&requests[start], short(working, limits))])?;
        let jobs = (requests[wave.clone()].par_iter()).zip(&needs[wave.clone()]);
        let decoded: Vec<_> = jobs
            .map(|(request, need)| guarded(|| decode(request, *need, limits)))
            .collect();
        drop(held);
        for (request, result) in requests[wave.clone()].iter().zip(decoded) {
            match result {
                Ok((texture, damage)) => {
                    all.damaged
                        .extend(damage.map(|f| blame(request, f).warning()));
                    all.textures.push(texture);
                }
                Err(f) if is_forgiven(request) => {
                    let index = all.textures.len();
                    let Some(fallback) = request.fallback.as_deref() else {
                        all.broken.push((Some(index), blame(request, f)));
                        all.textures.push(Texture {
                            name: request.place(),
                            width: 1,
                            height: 1,
                            rgba: vec![255; 4],
                            srgb: request.srgb,
                        });
                        continue;
                    };
                    all.broken.push((None, blame(request, f)));
                    match decode_all(std::slice::from_ref(fallback), limits, is_forgiven) {
                        Ok(other) => {
                            let broken = other.broken.into_iter();
                            (all.broken).extend(broken.map(|(lost, e)| (lost.map(|_| index), e)));
                            all.damaged.extend(other.damaged);
                            all.textures.extend(other.textures);
                        }
                        Err(others) => errors.extend(others),
                    }
                }
                Err(f) => report_once(&mut errors, blame(request, f)),
            }
        }
        start = wave.end;
    }
    if errors.is_empty() {
        Ok(all)
    } else {
        Err(errors)
    }
}

/// Takes the memory of all decoded images from the budget; errors come with the index of the image past it.
fn take_kept(
    requests: &[TextureRequest],
    needs: &[Need],
    limits: &TextureLimits,
) -> Result<(), (usize, Fault)> {
    let budget = limits.budget_bytes.min(limits.memory.left());
    let mut total = 0u64;
    let mut over = None;
    for (at, need) in needs.iter().enumerate() {
        total = total.saturating_add(need.kept);
        if total > budget {
            over.get_or_insert(at);
        }
    }
    if let Some(at) = over {
        let text = format!(
            "the scene's images decode to {total} bytes, more than the budget of {budget} bytes"
        );
        return Err((at, fault("image-budget", text).help("use smaller images")));
    }
    // Cannot fail: it was compared with the memory that is left.
    let _ = limits.memory.take(total);
    let left = limits.memory.left();
    match (0..requests.len()).find(|at| needs[*at].working > left) {
        Some(at) => Err((at, short(needs[at].working, limits))),
        None => Ok(()),
    }
}

fn short(working: u64, limits: &TextureLimits) -> Fault {
    let left = limits.memory.left();
    let text =
        format!("decoding it takes up to {working} bytes beside its pixels, {left} are left");
    fault("image-budget", text).help("use smaller images")
}

/// Adds an error unless it is listed: two images that are made of the same maps have the same error.
fn report_once(errors: &mut Vec<Diagnostic>, error: Diagnostic) {
    if !errors.contains(&error) {
        errors.push(error);
    }
}

/// Panic boundary: third-party decoders process untrusted bytes.
fn guarded<T>(work: impl FnOnce() -> Result<T, Fault>) -> Result<T, Fault> {
    guard::catch(work).unwrap_or_else(|| {
        Err(fault(
            "internal",
            "the image decoder panicked; please report this",
        ))
    })
}

/// Memory that decoding an image takes, from the headers of its files.
fn need(source: &ImageSource, limits: &TextureLimits) -> Result<Need, Fault> {
    let file_bytes = |encoded: &Encoded| match source {
        ImageSource::File(_) => encoded.bytes.len() as u64,
        _ => 0,
    };
    match source {
        ImageSource::SpecularGlossiness(maps) => {
            let maps = [&maps.diffuse, &maps.specular].into_iter().flatten();
            let (mut working, mut size) = (0u64, [1u64; 2]);
            for map in maps {
                let encoded = Encoded::read(map, limits)?;
                let opened = Opened::new(&encoded, limits)?;
                let file_bytes = encoded.bytes.len() as u64;
                let own = opened.need.kept + opened.need.working + file_bytes;
                working = working.saturating_add(own);
                size = [0, 1].map(|axis| size[axis].max(opened.size[axis].into()));
            }
            // The result is as large as the larger of both on each axis.
            let kept = size[0] * size[1] * 4;
            Ok(Need { kept, working })
        }
        source => {
            let encoded = Encoded::read(source, limits)?;
            let opened = Opened::new(&encoded, limits)?;
            Ok(Need {
                working: opened.need.working.saturating_add(file_bytes(&encoded)),
                ..opened.need
            })
        }
    }
}

/// Reads the header of an image, within the limits.
///
/// # Errors
/// Files that are missing or too large, formats that are not supported, broken headers.
pub fn check_header(source: &ImageSource, limits: &TextureLimits) -> Result<(), Fault> {
    guarded(|| need(source, limits).map(drop))
}

/// The image of a request, for which `need` was held, and its damage.
fn decode(
    request: &TextureRequest,
    need: Need,
    limits: &TextureLimits,
) -> Result<(Texture, Option<Fault>), Fault> {
    let (levels, damage) = levels(&request.source, request.srgb, need, limits)?;
    let (width, height) = levels[0].dimensions();
    let rgba = levels.into_iter().map(RgbaImage::into_raw);
    let texture = Texture {
        name: format!("{}: {}", request.file.display(), request.name),
        width,
        height,
        rgba: rgba
            .reduce(|mut all, level| {
                all.extend(level);
                all
            })
            .unwrap_or_default(),
        srgb: request.srgb,
    };
    Ok((texture, damage))
}

/// The pixels of an image, for which `need` was held, and of the levels that it states; also its damage.
fn levels(
    source: &ImageSource,
    srgb: bool,
    need: Need,
    limits: &TextureLimits,
) -> Result<(Vec<RgbaImage>, Option<Fault>), Fault> {
    if let ImageSource::SpecularGlossiness(maps) = source {
        let mut damage = None;
        let mut decoded = |map: &Option<ImageSource>| {
            let levels = map.as_ref().map(|map| levels(map, true, need, limits));
            Ok(levels.transpose()?.map(|(mut levels, damaged)| {
                damage = damage.take().or(damaged);
                levels.swap_remove(0)
            }))
        };
        let (diffuse, specular) = (decoded(&maps.diffuse)?, decoded(&maps.specular)?);
        let picture = specular_glossiness::convert(maps, diffuse, specular);
        return Ok((vec![picture], damage));
    }
    // The memory of the file was held with the rest.
    let unlimited = TextureLimits {
        memory: Budget::default(),
        ..limits.clone()
    };
    let encoded = Encoded::read(source, &unlimited)?;
    let opened = Opened::new(&encoded, limits)?;
    if opened.need.kept > need.kept || opened.need.working > need.working {
        return Err(fault("image-broken", "it changed while it was read"));
    }
    opened.decode(srgb)
}
