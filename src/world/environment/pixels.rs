//! A panorama while it is decoded: its pixels, the limits of its size, and the memory that is held for it.

use crate::gltf::Fault;
use reflet_base::memory::{Budget, Reservation};

/// Largest width and height of a panorama that is kept, pixels; larger ones are reduced.
pub const LARGEST_KEPT: [u32; 2] = [4096, 2048];
/// Largest width or height, pixels, of the reduced copy from which the density is computed.
pub(super) const DENSITY_PX: u32 = 1024;

/// Help text for a file that is truncated or damaged.
pub(super) const BROKEN_HELP: &str =
    "copy or export the panorama again; the file is cut off or damaged";

/// Limits of decoding.
#[derive(Clone, Debug)]
pub struct PanoramaLimits {
    /// Largest width and height, pixels.
    pub max_px: u32,
    /// Maximum size of the decoded picture, bytes (12 per pixel).
    pub budget_bytes: u64,
    /// Memory of the load, of which decoding takes a part for a while.
    pub memory: Budget,
}

/// A decoded picture: linear radiance, top row first.
pub(super) struct Pixels {
    pub width: u32,
    pub height: u32,
    pub rgb: Vec<[f32; 3]>,
}

/// Refuses sizes past the limits.
pub(super) fn check_size(width: u64, height: u64, limits: &PanoramaLimits) -> Result<(), Fault> {
    if width == 0 || height == 0 {
        let text = format!("is {width} × {height} pixels, so it shows nothing");
        return Err(Fault::new("image-broken", text).help(BROKEN_HELP));
    }
    let most = u64::from(limits.max_px);
    if width.max(height) > most {
        let text = format!("is {width} × {height} pixels, expected 1 to {most} each");
        return Err(Fault::new("image-too-large", text).help("scale the panorama down"));
    }
    let bytes = 12 * width * height;
    if bytes > limits.budget_bytes {
        let budget = limits.budget_bytes;
        let text = format!("decodes to {bytes} bytes, more than the budget of {budget} bytes");
        return Err(Fault::new("image-budget", text).help("scale the panorama down"));
    }
    Ok(())
}

/// Upper bound of the memory of a decoded picture and its copies, bytes: neither the kept copy nor the source of the
/// density is larger than the picture.
pub(super) fn decoded_bytes([width, height]: [u64; 2]) -> u64 {
    let pixels = width.saturating_mul(height);
    let kept = pixels.min(LARGEST_KEPT.map(u64::from).iter().product());
    let coarse = pixels.min(u64::from(DENSITY_PX).pow(2));
    // Texels of 12 bytes, reduced texels beside their 16-bit copies, and texels with luminance and density.
    (pixels.saturating_mul(12)).saturating_add(kept * 20 + coarse * 32)
}

/// Takes memory for decoding.
pub(super) fn hold(bytes: u64, limits: &PanoramaLimits) -> Result<Reservation, Fault> {
    limits.memory.hold(bytes).ok_or_else(|| {
        let left = limits.memory.left();
        let text = format!("decoding it takes up to {bytes} bytes, {left} are left");
        Fault::new("image-budget", text)
            .help("scale the panorama down, or save it with the channels R, G and B alone")
    })
}

/// Black pixels.
pub(super) fn zeros([width, height]: [u64; 2]) -> Result<Vec<[f32; 3]>, Fault> {
    let count = (width * height) as usize; // within the limits
    let mut rgb = Vec::new();
    if rgb.try_reserve_exact(count).is_err() {
        let text = format!("decodes to {} bytes, more than is left", 12 * count);
        return Err(Fault::new("image-budget", text).help("scale the panorama down"));
    }
    rgb.resize(count, [0.0; 3]);
    Ok(rgb)
}
