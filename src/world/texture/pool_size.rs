//! Sizes at which images are kept on the GPU: each is resampled to one of three squares, a pool of layers each.

use crate::Texture;

/// Number of pools.
pub const NUM_POOLS: usize = 3;
/// Width and height of the smallest pool's images, pixels; others are that times powers of 2.
pub const SMALLEST_POOL_PX: u32 = 512;
/// Width and height of the largest images that are kept, pixels; every device allows them.
pub const LARGEST_KEPT_PX: u32 = 8192;
/// Width and height up to which images are kept whatever they take together, pixels.
const ALWAYS_KEPT_PX: u32 = 2048;
/// Most bytes of all pools, with mips, if an image larger than [`ALWAYS_KEPT_PX`] is kept. A fixed number, for pictures
/// must not depend on the machine.
const BUDGET_BYTES: u64 = 1 << 30;
/// Number of sizes from the smallest to the largest.
const NUM_SIZES: usize = (LARGEST_KEPT_PX / SMALLEST_POOL_PX).ilog2() as usize + 1;

/// Sizes of the pools of a world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoolSizes {
    /// Width and height of each pool's images, pixels, ascending.
    pub px: [u32; NUM_POOLS],
    /// Largest size that the budget leaves, pixels.
    most_px: u32,
}

impl Default for PoolSizes {
    fn default() -> Self {
        Self::for_textures(&[])
    }
}

impl PoolSizes {
    /// The sizes for these images: the largest that they have, as far as the budget goes, and two smaller ones so that
    /// all take the fewest bytes.
    pub fn for_textures(textures: &[Texture]) -> Self {
        let mut most = NUM_SIZES - 1;
        loop {
            let mut counts = [0; NUM_SIZES];
            for texture in textures {
                counts[wanted(texture).min(most)] += 1;
            }
            let sizes = chosen(&counts);
            if px(most) <= ALWAYS_KEPT_PX || bytes(&counts, sizes) <= BUDGET_BYTES {
                return Self {
                    px: sizes.map(px),
                    most_px: px(most),
                };
            }
            most -= 1;
        }
    }

    /// Index of the smallest pool that keeps an image, else of the largest pool.
    pub fn pool_of(&self, texture: &Texture) -> usize {
        let wanted = px(wanted(texture)).min(self.most_px);
        let fits = self.px.iter().position(|&px| wanted <= px);
        fits.unwrap_or(NUM_POOLS - 1)
    }

    /// The size at which an image is kept, with the reason, if it is larger.
    pub fn reduced(&self, texture: &Texture) -> Option<(u32, String)> {
        let edge = texture.width.max(texture.height);
        let kept = self.px[self.pool_of(texture)];
        if edge <= kept {
            return None;
        }
        let reason = if px(wanted(texture)) > kept {
            let budget = BUDGET_BYTES >> 20;
            format!(
                "images above {ALWAYS_KEPT_PX} pixels are kept while all take up to {budget} MiB"
            )
        } else if edge > LARGEST_KEPT_PX {
            format!("devices take {LARGEST_KEPT_PX} pixels")
        } else {
            "it is much longer than wide, and images are kept as squares".into()
        };
        Some((kept, reason))
    }
}

fn px(size: usize) -> u32 {
    SMALLEST_POOL_PX << size
}

/// Size that keeps all texels of an image, or the largest; no larger than 4 texels for each of a large image.
fn wanted(texture: &Texture) -> usize {
    let edge = texture.width.max(texture.height);
    let texels = u64::from(texture.width) * u64::from(texture.height);
    let holds = |size: &usize| edge <= px(*size);
    let mut size = (0..NUM_SIZES).find(holds).unwrap_or(NUM_SIZES - 1);
    while px(size) > ALWAYS_KEPT_PX && u64::from(px(size)).pow(2) > 4 * texels {
        size -= 1;
    }
    size
}

/// Three ascending sizes for so many images of each size.
fn chosen(counts: &[u64; NUM_SIZES]) -> [usize; NUM_POOLS] {
    let largest = counts.iter().rposition(|count| *count > 0).unwrap_or(0);
    let largest = largest.max(NUM_POOLS - 1);
    let pairs =
        (0..largest).flat_map(|middle| (0..middle).map(move |least| [least, middle, largest]));
    let best = pairs.min_by_key(|sizes| bytes(counts, *sizes));
    best.unwrap_or([0, 1, 2])
}

/// Bytes of so many images of each size in pools of three sizes, with mips.
fn bytes(counts: &[u64; NUM_SIZES], sizes: [usize; NUM_POOLS]) -> u64 {
    let of = |(size, count): (usize, &u64)| {
        let kept = sizes.into_iter().find(|kept| *kept >= size);
        count * bytes_of_layer(px(kept.unwrap_or(sizes[NUM_POOLS - 1])))
    };
    counts.iter().enumerate().map(of).sum()
}

/// Bytes of an image of this size with its mips, which are 4/3 of the image.
pub fn bytes_of_layer(px: u32) -> u64 {
    u64::from(px).pow(2) * 4 * 4 / 3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn textures(sizes: &[[u32; 2]]) -> Vec<Texture> {
        let texture = |[width, height]: &[u32; 2]| Texture {
            name: String::new(),
            width: *width,
            height: *height,
            rgba: Vec::new(),
            srgb: true,
        };
        sizes.iter().map(texture).collect()
    }

    /// Lines of `pool_sizes.txt`: widths and heights of images, each perhaps so many times, then the sizes of the pools,
    /// and the size that the last image is kept with.
    #[test]
    fn sizes_follow_the_images_within_the_budget() {
        let number = |text: &str| -> u32 { text.parse().expect(text) };
        for case in include_str!("pool_sizes.txt")
            .lines()
            .filter(|l| !l.starts_with('#'))
        {
            let (images, expected) = case.split_once("=> ").expect(case);
            let images = images.split_whitespace().flat_map(|image| {
                let (size, times) = image.split_once('*').unwrap_or((image, "1"));
                let (width, height) = size.split_once('x').expect(case);
                vec![[width, height].map(number); number(times) as usize]
            });
            let images: Vec<_> = images.collect();
            let expected: Vec<_> = expected.split(' ').map(number).collect();
            let (sizes, kept) = (&expected[..3], expected[3]);
            let images = textures(&images);
            let pools = PoolSizes::for_textures(&images);
            assert_eq!(pools.px, sizes, "{images:?}");
            if let Some(last) = images.last() {
                assert_eq!(pools.px[pools.pool_of(last)], kept, "{images:?}");
                let is_reduced = last.width.max(last.height) > kept;
                assert_eq!(pools.reduced(last).is_some(), is_reduced);
            }
        }
    }
}
