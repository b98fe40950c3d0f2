//! White furnace: tiles of every lobe in even light, where a surface that loses nothing cannot be seen. Its table in
//! `docs/light.md` and the data of that are written here.

use std::{collections::BTreeMap, env, fmt::Write as _, ops::Range};

use super::kit::*;
use crate::common::cases;

/// Roughnesses of the page; a test compares every second one.
const ROUGHNESSES: [f32; 5] = [0.1, 0.3, 0.5, 0.7, 1.0];
const COSINES: [f32; 3] = [1.0, 0.6, 0.25];
/// Edge of the square of the picture that a tile has, in pixels; it covers more than the inner ones, which are read.
const CELL: usize = 6;
const READ: Range<usize> = 1..5;
/// Largest deviation from 1 where nothing is lost.
const BOUND: f32 = 0.01;

/// A material with `ROUGHNESS`, of a slab where it has `SLAB`, else of a plane; and the name of its lobe.
type Lobe = (&'static str, &'static str);

const FILM: &str = "iridescence = 1\niridescence_thickness_nm = 400";

/// Lobes over white, which lose nothing.
fn lobes() -> Vec<Lobe> {
    cases(include_str!("furnace/lobes.txt"))
}

/// Lobes that emit 1, in the dark.
fn emissive() -> Vec<Lobe> {
    cases(include_str!("furnace/emissive.txt"))
}

/// Tiles of all lobes, roughnesses and angles beside each other, seen in parallel. Planes are hidden from rays, and
/// slabs lie far behind each other, so that no tile sees another, and nothing is smoothed from
/// tile to tile.
fn scene(lobes: &[Lobe], light: f32) -> String {
    let (columns, rows) = (roughnesses().len() * COSINES.len(), lobes.len());
    let mut text = format!(
        "version = 1\n[camera.main]\neye = [0, 0, 50]\ntarget = [0, 0, 0]\northographic_height_m = {}\n\
         [image]\nsize = [{}, {}]\nsamples = {}\ntone_map = \"none\"\n[environment]\ncolor = [{light}, {light}, {light}]\n\
         [reflection]\nmethod = \"rt\"\nray_length_u = 1000\nfilter = false\n",
        2 * rows,
        columns * CELL,
        rows * CELL,
        if is_update() { 128 } else { 33 },
    );
    for (row, (material, _)) in lobes.iter().enumerate() {
        let is_slab = material.starts_with("SLAB\n");
        for column in 0..columns {
            let name = row * columns + column;
            let cosine = COSINES[column % COSINES.len()];
            let roughness = roughnesses()[column / COSINES.len()].to_string();
            let x = 2.0 * column as f32 + 1.0 - columns as f32;
            let y = rows as f32 - 1.0 - 2.0 * row as f32;
            let long = 1.4 / cosine;
            let (shape, z) = match is_slab {
                true => (
                    format!("kind = \"box\", size = [1.4, 0.5, {long}]"),
                    -60.0 * column as f32,
                ),
                false => (format!("kind = \"plane\", size = [1.4, {long}]"), 0.0),
            };
            // Writing to a string cannot fail.
            let _ = write!(
                text,
                "[material.m{name}]\n{}\n[model.t{name}]\nshape = {{ {shape} }}\nmaterial = \"m{name}\"\n[[instance]]\n\
                 model = \"t{name}\"\ntranslation = [{x}, {y}, {z}]\nrotation_deg = [{}, 0, 0]\nin_reflections = {is_slab}\n",
                material
                    .replace("ROUGHNESS", &roughness)
                    .replace("FILM", FILM)
                    .replace("SLAB\n", ""),
                90.0 - cosine.acos().to_degrees(),
            );
        }
    }
    text
}

/// Radiance of each tile: by lobe, roughness and angle, by channel.
fn radiances(lobes: &[Lobe], light: f32, set: &[&str]) -> Option<Vec<[f32; 3]>> {
    let picture = render(gpu()?, &scene(lobes, light), set, &[]);
    let width = picture.size[0] as usize;
    let columns = width / CELL;
    let tiles = (0..columns * lobes.len()).map(|tile| {
        let (row, column) = (tile / columns, tile % columns);
        let mut sum = [0.0; 3];
        for (y, x) in READ.flat_map(|y| READ.map(move |x| (y, x))) {
            let pixel = (row * CELL + y) * width + column * CELL + x;
            for (sum, value) in sum.iter_mut().zip(&picture.color[4 * pixel..]) {
                *sum += value / (READ.len() * READ.len()) as f32;
            }
        }
        sum
    });
    Some(tiles.collect())
}

/// Reflections by rays, and past the cut-off by their replacement.
const SIDES: [(&str, &str); 2] = [
    ("traced", "reflection.roughness_cutoff=1"),
    ("past the cut-off", "reflection.roughness_cutoff=0"),
];

/// A row of the data: lobe, roughness, side, and whether energy is conserved.
type Key = (usize, usize, &'static str, bool);

fn lobe_name(index: usize) -> &'static str {
    let all = [lobes(), emissive()].concat();
    all.get(index).map_or("", |(_, name)| name)
}

fn csv(rows: &BTreeMap<Key, [f32; 3]>) -> String {
    let mut text = String::from("lobe,roughness,side,multiple_scattering");
    let _ = COSINES
        .iter()
        .try_for_each(|cosine| write!(text, ",at {cosine}"));
    text.push('\n');
    for ((lobe, roughness, side, conserved), values) in rows {
        let [a, b, c] = values;
        let (lobe, roughness) = (lobe_name(*lobe), roughnesses()[*roughness]);
        let _ = writeln!(
            text,
            "{lobe},{roughness},{side},{conserved},{a:.3},{b:.3},{c:.3}"
        );
    }
    text
}

/// The table of `docs/light.md`, from the data.
fn table(data: &str) -> String {
    let series = [
        ("traced", "true"),
        ("past the cut-off", "true"),
        ("traced", "false"),
    ];
    let mut text = String::from("| lobe | roughness |");
    for what in ["rays", "past the cut-off", "glTF, rays"] {
        let _ = COSINES
            .iter()
            .try_for_each(|cosine| write!(text, " {what}, at {cosine} |"));
    }
    text.push_str("\n|");
    text.push_str(&" --- |".repeat(2 + series.len() * COSINES.len()));
    text.push('\n');
    let rows: Vec<Vec<&str>> = data
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    for own in rows.iter().filter(|row| (row[2], row[3]) == series[0]) {
        let _ = write!(text, "| {} | {} |", own[0], own[1]);
        for (side, conserved) in series {
            let is_it = |row: &&Vec<&str>| row[..4] == [own[0], own[1], side, conserved];
            let values = rows.iter().find(is_it).map_or(&[][..], |row| &row[4..]);
            let _ = values
                .iter()
                .try_for_each(|value| write!(text, " {value} |"));
        }
        text.push('\n');
    }
    text
}

#[test]
fn nothing_is_lost_in_a_furnace() {
    let mut rows = BTreeMap::new();
    let mut wrong = String::new();
    for (side, cutoff) in SIDES {
        // The figures of glTF's model are for the page.
        let models = if is_update() {
            &[true, false][..]
        } else {
            &[true]
        };
        for &conserved in models {
            let set = format!("reflection.multiple_scattering={conserved}");
            let lit = [(0, lobes(), 1.0), (lobes().len(), emissive(), 0.0)];
            let is_whole = is_long() || is_update() || cutoff == SIDES[0].1;
            let tiles_of = if is_whole { &lit[..] } else { &lit[..1] };
            for (first, lobes, light) in tiles_of {
                let tiles = or_skip!(radiances(lobes, *light, &[cutoff, &set]));
                for (i, tiles) in tiles.chunks_exact(COSINES.len()).enumerate() {
                    let (lobe, roughness) =
                        (first + i / roughnesses().len(), i % roughnesses().len());
                    let is_off = |v: &f32| (v - 1.0).abs() > BOUND;
                    if (conserved || *light == 0.0) && tiles.as_flattened().iter().any(is_off) {
                        let _ = writeln!(
                            wrong,
                            "{} of {}, {side}: {tiles:?}",
                            lobe_name(lobe),
                            roughnesses()[roughness]
                        );
                    }
                    let mean = |tile: &[f32; 3]| tile.iter().sum::<f32>() / 3.0;
                    let values = std::array::from_fn(|k| mean(&tiles[k]));
                    rows.insert((lobe, roughness, side, conserved), values);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    check_page(&csv(&rows));
}

/// Roughnesses that are rendered.
fn roughnesses() -> Vec<f32> {
    let step = if is_update() { 1 } else { 2 };
    ROUGHNESSES.into_iter().step_by(step).collect()
}

fn is_update() -> bool {
    env::var_os("UPDATE_DOCS").is_some()
}

/// Compares the data and the page with this measurement, or writes them anew.
fn check_page(found: &str) {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let [data, page] = ["docs/data/light-furnace.csv", "docs/light.md"].map(|name| root.join(name));
    let read = |path| fs::read_to_string(path).expect("the file is read");
    let text = read(&page);
    let [start, end] = ["<!-- table: furnace -->\n", "<!-- end -->"];
    let (before, rest) = text.split_once(start).expect("the page has the table");
    let (shown, after) = rest.split_once(end).expect("the table has an end");
    if is_update() {
        fs::write(&data, found).expect("the data is written");
        let all = [before, start, &table(found), end, after].concat();
        fs::write(&page, all).expect("the page is written");
        return;
    }
    let stale = "is stale: UPDATE_DOCS=1 cargo test --test pictures furnace";
    let known = read(&data);
    assert_eq!(shown, table(&known), "docs/light.md {stale}");
    for found in found.lines() {
        let agree = |known: &str| {
            let mut pairs = known.split(',').zip(found.split(','));
            pairs.all(|(a, b)| {
                let both = a.parse::<f32>().ok().zip(b.parse::<f32>().ok());
                both.map_or(a == b, |(a, b)| (a - b).abs() <= BOUND)
            })
        };
        assert!(known.lines().any(agree), "the data {stale}: now {found}");
    }
}
