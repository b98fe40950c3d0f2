//! Places and boxes of the probes of a world: from its text, from a grid, or one in the middle.

use glam::{DVec3, Vec3};

use reflet_base::math::Bounds;
use reflet_scene::{
    desc::{Entry, ProbeDesc, ProbesDesc},
    diagnostic::{Diagnostic, Span},
};
use reflet_world::World;

use crate::{
    layout::gpu_struct::{Shared as _, gpu_struct},
    maps::cube::still_bounds,
};

/// Half the size of the box of a scene without extent along an axis, in the renderer's lengths.
const LEAST_HALF_M: f32 = 1e-3;

gpu_struct! {
    /// A probe; see `shaders/methods/probes/lib/probes.wgsl`. The fourth numbers are unused.
    pub struct ProbeBox = padded "Probe" {
        /// Position from which it sees, meters.
        position: [f32; 4],
        /// Middle of the box in which it counts, meters.
        middle: [f32; 4],
        /// Half the size of that box, meters, above 0.
        half_size: [f32; 4],
        /// Least corner of the box that stands for its surroundings, meters.
        proxy_min: [f32; 4],
        /// Greatest corner of that box, meters.
        proxy_max: [f32; 4],
    }
}

impl ProbeBox {
    fn new(position: Vec3, counts_in: Bounds, proxy: Bounds) -> Self {
        let half_size = 0.5 * (counts_in.max - counts_in.min);
        let four = |v: Vec3| v.extend(0.0).to_array();
        Self {
            position: four(position),
            middle: four(counts_in.center()),
            half_size: four(half_size.max(Vec3::splat(LEAST_HALF_M))),
            proxy_min: four(proxy.min),
            proxy_max: four(proxy.max),
            ..Self::ZERO
        }
    }
}

/// The probes of a world in these settings, 1 to [`ProbesDesc::MOST`]: the probes of its text and of the grid, or one
/// in the middle of all that never moves. A length of one is `meters` of the scene.
///
/// # Errors
/// More than [`ProbesDesc::MOST`], with the least spacing of a grid that has no more.
pub fn probe_boxes(
    world: &World,
    settings: &ProbesDesc,
    meters: f32,
) -> Result<Vec<ProbeBox>, Box<Diagnostic>> {
    let still = still_bounds(world);
    let mut boxes: Vec<ProbeBox> = world.probes.iter().map(|e| placed(e, still)).collect();
    if let Some(spacing_m) = settings.spacing_m {
        let room = ProbesDesc::MOST.saturating_sub(boxes.len());
        let counts = grid_counts(still, spacing_m);
        let total: f64 = counts.iter().product();
        if total > room as f64 {
            let size_m = (still.max - still.min).as_dvec3() * f64::from(meters);
            return Err(too_many(size_m, total, room));
        }
        boxes.extend(grid(still, counts.map(|count| count as u32)));
    }
    if boxes.is_empty() {
        boxes.push(ProbeBox::new(still.center(), still, still));
    }
    Ok(boxes)
}

fn placed(entry: &Entry<ProbeDesc>, still: Bounds) -> ProbeBox {
    let probe = &entry.value;
    let of = |min: Option<Vec3>, max: Option<Vec3>| {
        Some(Bounds {
            min: min?,
            max: max?,
        })
    };
    let counts_in = of(probe.box_min, probe.box_max).unwrap_or(still);
    let proxy = of(probe.proxy_min, probe.proxy_max).unwrap_or(counts_in);
    ProbeBox::new(probe.position, counts_in, proxy)
}

/// Number of probes of a grid along each axis.
fn grid_counts(still: Bounds, spacing_m: f32) -> [f64; 3] {
    let counts = (still.max - still.min).as_dvec3() / f64::from(spacing_m);
    counts.to_array().map(|count| count.ceil().max(1.0))
}

/// Probes in the middles of equal cells of the bounds; each counts up to the places of its neighbors.
fn grid(still: Bounds, counts: [u32; 3]) -> impl Iterator<Item = ProbeBox> {
    let [nx, ny, nz] = counts;
    let cell = (still.max - still.min) / Vec3::new(nx as f32, ny as f32, nz as f32);
    let indices =
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    indices.map(move |[x, y, z]| {
        let middle = still.min + cell * (Vec3::new(x as f32, y as f32, z as f32) + 0.5);
        let counts_in = Bounds {
            min: middle - cell,
            max: middle + cell,
        };
        ProbeBox::new(middle, counts_in, still)
    })
}

fn too_many(size_m: DVec3, total: f64, room: usize) -> Box<Diagnostic> {
    let message = format!("the grid of `[probes]` has {total:.0} probes; there is room for {room}");
    let error = Diagnostic::new("too-many-probes", Span::default(), message);
    let fits = |spacing_m: f64| {
        let counts = (size_m / spacing_m)
            .to_array()
            .map(|count| count.ceil().max(1.0));
        counts.iter().product::<f64>() <= room as f64
    };
    let (mut low, mut high) = (0.0, size_m.max_element().max(f64::MIN_POSITIVE));
    if room == 0 || !fits(high) {
        return Box::new(error.help("leave out `spacing_m`, or some of the `[probe.NAME]`"));
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match fits(middle) {
            true => high = middle,
            false => low = middle,
        }
    }
    Box::new(error.help(format!(
        "write a `spacing_m` of {} or more",
        rounded_up(high)
    )))
}

/// A length of three digits, a little larger than this one.
fn rounded_up(length_m: f64) -> f64 {
    let step = 10_f64.powf(length_m.log10().floor() - 2.0);
    let rounded = (length_m / step * 1.001).ceil() * step;
    // Without the digits of a rounding error.
    format!("{rounded:.2e}").parse().unwrap_or(rounded)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(size: Vec3) -> Bounds {
        Bounds {
            min: Vec3::ZERO,
            max: size,
        }
    }

    fn three([x, y, z, _]: [f32; 4]) -> Vec3 {
        Vec3::new(x, y, z)
    }

    /// Weights of neighbors of a grid, before they are divided by their sum: the share of the way from border to
    /// middle.
    fn depth(probe: &ProbeBox, point: Vec3) -> f32 {
        let away = (point - three(probe.middle)).abs() / three(probe.half_size);
        1.0 - away.max_element()
    }

    #[test]
    fn a_grid_covers_the_bounds_and_its_boxes_meet_at_their_neighbors() {
        let still = bounds(Vec3::new(6.0, 2.0, 4.0));
        let counts = grid_counts(still, 2.0);
        assert_eq!(counts, [3.0, 1.0, 2.0]);
        let all: Vec<_> = grid(still, counts.map(|c| c as u32)).collect();
        assert_eq!(all.len(), 6);
        assert_eq!(three(all[0].position), Vec3::ONE);
        assert_eq!(three(all[5].position), Vec3::new(5.0, 1.0, 3.0));
        // At a probe only that one has weight, and halfway to its neighbor both have half.
        let halfway = Vec3::new(2.0, 1.0, 1.0);
        assert_eq!(
            [
                depth(&all[0], three(all[0].position)),
                depth(&all[1], three(all[0].position))
            ],
            [1.0, 0.0]
        );
        assert_eq!(
            [depth(&all[0], halfway), depth(&all[1], halfway)],
            [0.5, 0.5]
        );
    }

    #[test]
    fn a_grid_of_too_many_probes_says_which_spacing_fits() {
        let still = bounds(Vec3::new(100.0, 10.0, 50.0));
        let counts = grid_counts(still, 2.0);
        let size_m = (still.max - still.min).as_dvec3();
        let error = too_many(size_m, counts.iter().product(), ProbesDesc::MOST);
        assert!(
            error.message.contains("6250 probes; there is room for 42"),
            "{}",
            error.message
        );
        let help = error.help.expect("advice");
        let advised: f32 =
            (help.split_whitespace().find_map(|word| word.parse().ok())).expect("a number");
        let total = |spacing_m| grid_counts(still, spacing_m).iter().product::<f64>();
        assert!(
            total(advised) <= 42.0 && total(0.9 * advised) > 42.0,
            "{advised}"
        );
    }

    #[test]
    fn a_flat_or_empty_scene_has_one_probe_with_a_box() {
        for size in [Vec3::ZERO, Vec3::new(4.0, 0.0, 4.0)] {
            let still = bounds(size);
            let all: Vec<_> = grid(still, grid_counts(still, 8.0).map(|c| c as u32)).collect();
            assert_eq!(all.len(), 1);
            assert!(three(all[0].half_size).min_element() > 0.0);
        }
    }
}
