//! Shapes whose triangles are cut finer, smoothed, and moved in and out by noise.

use std::collections::HashMap;

use glam::{DVec2, DVec3, Vec3};
use xxhash_rust::xxh3::xxh3_64;

use super::{
    Fault, Made,
    near_faces::NearFaces,
    solid::{Corner, Solid, check_size},
};
use crate::Mesh;
use reflet_scene::desc::NoiseDesc;

/// A mesh whose vertices are joined by their positions; texture coordinates belong to corners.
struct Surface {
    positions: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
    uv: Vec<[DVec2; 3]>,
}

/// An edge, as its ends in order.
type Edge = (usize, usize);

fn edge(a: usize, b: usize) -> Edge {
    (a.min(b), a.max(b))
}

impl Surface {
    fn from_mesh(mesh: &Mesh) -> Self {
        let mut known: HashMap<[u32; 3], usize> = HashMap::new();
        let mut positions = Vec::new();
        let mut join = |at: Vec3| {
            let at = at + Vec3::ZERO;
            *known
                .entry(at.to_array().map(f32::to_bits))
                .or_insert_with(|| {
                    positions.push(at.as_dvec3());
                    positions.len() - 1
                })
        };
        let mut all = Vec::new();
        for triangle in &mesh.triangles {
            let joined = triangle.map(|i| join(mesh.positions[i as usize]));
            let uv = triangle.map(|i| mesh.uv0[i as usize].as_dvec2());
            let [a, b, c] = joined;
            if a != b && b != c && c != a {
                all.push((joined, uv));
            }
        }
        let (triangles, uv) = all.into_iter().unzip();
        Self {
            positions,
            triangles,
            uv,
        }
    }

    /// Cuts each triangle into four; with `smooth`, moves the vertices as Loop subdivision does (Loop, "Smooth
    /// subdivision surfaces based on triangles", 1987, with the weights of Warren, 1995), else leaves them.
    fn divided(&self, smooth: bool) -> Self {
        let mut opposite: HashMap<Edge, Vec<usize>> = HashMap::new();
        for [a, b, c] in &self.triangles {
            for (from, to, other) in [(*a, *b, *c), (*b, *c, *a), (*c, *a, *b)] {
                opposite.entry(edge(from, to)).or_default().push(other);
            }
        }
        let mut positions = match smooth {
            true => self.smoothed(&opposite),
            false => self.positions.clone(),
        };
        let mut middles: HashMap<Edge, usize> = HashMap::new();
        let mut middle = |a: usize, b: usize| {
            let key = edge(a, b);
            *middles.entry(key).or_insert_with(|| {
                let ends = self.positions[key.0] + self.positions[key.1];
                positions.push(match opposite[&key][..] {
                    [c, d] if smooth => {
                        ends * 0.375 + (self.positions[c] + self.positions[d]) / 8.0
                    }
                    _ => ends / 2.0,
                });
                positions.len() - 1
            })
        };
        let (mut triangles, mut uv) = (Vec::new(), Vec::new());
        for (&[a, b, c], &[p, q, r]) in self.triangles.iter().zip(&self.uv) {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            let [pq, qr, rp] = [(p + q) / 2.0, (q + r) / 2.0, (r + p) / 2.0];
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            uv.extend([[p, pq, rp], [pq, q, qr], [rp, qr, r], [pq, qr, rp]]);
        }
        Self {
            positions,
            triangles,
            uv,
        }
    }

    /// The old vertices of Loop subdivision, moved towards their neighbors; vertices on a rim, towards their neighbors
    /// along it.
    fn smoothed(&self, opposite: &HashMap<Edge, Vec<usize>>) -> Vec<DVec3> {
        let count = self.positions.len();
        let mut inside = vec![(DVec3::ZERO, 0_u32); count];
        let mut rim = inside.clone();
        let mut edges: Vec<_> = opposite.iter().collect();
        edges.sort_unstable(); // sums do not depend on the order of a map
        for (&(a, b), others) in edges {
            let sums = if others.len() == 2 {
                &mut inside
            } else {
                &mut rim
            };
            for (here, there) in [(a, b), (b, a)] {
                sums[here].0 += self.positions[there];
                sums[here].1 += 1;
            }
        }
        let moved = |(i, at): (usize, &DVec3)| match (inside[i], rim[i]) {
            (_, (sum, 2)) => *at * 0.75 + sum / 8.0,
            ((sum, n), (_, 0)) if n > 2 => {
                let n = f64::from(n);
                let weight = if n == 3.0 {
                    3.0 / 16.0
                } else {
                    3.0 / (8.0 * n)
                };
                *at * (1.0 - n * weight) + sum * weight
            }
            _ => *at,
        };
        self.positions.iter().enumerate().map(moved).collect()
    }

    /// Twice the area of each triangle times its normal.
    fn faces(&self) -> Vec<DVec3> {
        let face = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|i| self.positions[i]);
            (b - a).cross(c - a)
        };
        self.triangles.iter().map(face).collect()
    }

    /// Moves vertices along the mean normal of their triangles.
    fn displace(&mut self, noise: &NoiseDesc) {
        let mut normals = vec![DVec3::ZERO; self.positions.len()];
        for (triangle, face) in self.triangles.iter().zip(self.faces()) {
            triangle.iter().for_each(|i| normals[*i] += face);
        }
        for (at, normal) in self.positions.iter_mut().zip(normals) {
            let height = f64::from(noise.height) * fractal(*at, noise);
            *at += normal.normalize_or_zero() * height;
        }
    }

    /// Adds the triangles, with normals that are smooth over bends of less than 40°.
    fn add_to(&self, solid: &mut Solid) {
        let faces = self.faces();
        let mut around: Vec<Vec<usize>> = vec![Vec::new(); self.positions.len()];
        for (number, triangle) in self.triangles.iter().enumerate() {
            triangle.iter().for_each(|i| around[*i].push(number));
        }
        let around = around
            .iter()
            .map(|all| NearFaces::new(all.iter().map(|i| faces[*i])));
        let around: Vec<_> = around.collect();
        for (number, (triangle, uv)) in self.triangles.iter().zip(&self.uv).enumerate() {
            let own = faces[number].normalize_or_zero();
            let corner = |k: usize| {
                let near = around[triangle[k]].sum(own);
                Corner::new(self.positions[triangle[k]], near, uv[k])
            };
            solid.triangle([corner(0), corner(1), corner(2)]);
        }
    }
}

/// Adds a shape cut finer `steps` times, smoothed if `smooth`, and moved by `noise`.
///
/// # Errors
/// `shape-too-large`, before it is made.
pub fn add(
    solid: &mut Solid,
    made: &Made,
    steps: u32,
    smooth: bool,
    noise: &NoiseDesc,
) -> Result<(), Fault> {
    let triangles = made
        .mesh
        .triangles
        .len()
        .saturating_mul(4_usize.saturating_pow(steps));
    check_size(triangles, "`subdivide`, or `segments` of its shape")?;
    let mut surface = Surface::from_mesh(&made.mesh);
    if surface.triangles.is_empty() {
        let message = "there is nothing to displace: a `heightfield` has no triangles here";
        return Err(
            Fault::new("wrong-parts", message).help("displace another shape, such as a `plane`")
        );
    }
    for _ in 0..steps {
        surface = surface.divided(smooth);
    }
    if noise.height != 0.0 {
        surface.displace(noise);
    }
    surface.add_to(solid);
    Ok(())
}

/// Octaves of gradient noise, each half as large and high as its predecessor, -1 to 1.
fn fractal(at: DVec3, noise: &NoiseDesc) -> f64 {
    let (mut sum, mut whole) = (0.0, 0.0);
    for octave in 0..noise.octaves.max(1) {
        let share = 0.5_f64.powi(octave as i32);
        let place = at / (f64::from(noise.size) * share);
        sum += share * gradient_noise(place, noise.seed, octave);
        whole += share;
    }
    sum / whole
}

/// Gradient noise (Perlin, "An image synthesizer", 1985, with the fade of "Improving noise", 2002), -1 to 1.
fn gradient_noise(at: DVec3, seed: u32, octave: u32) -> f64 {
    let cell = at.floor();
    let within = at - cell;
    let fade = within * within * within * (within * (within * 6.0 - 15.0) + 10.0);
    let mut sum = 0.0;
    for corner in 0..8_u32 {
        let step = DVec3::from([0, 1, 2].map(|axis| f64::from(corner >> axis & 1)));
        let place = (cell + step).to_array().map(|x| x as i64);
        let key = [
            place[0],
            place[1],
            place[2],
            i64::from(seed),
            i64::from(octave),
        ];
        let hash = xxh3_64(bytemuck::bytes_of(&key));
        let part = |shift: u32| f64::from((hash >> shift & 0xffff) as u32) / 32767.5 - 1.0;
        let gradient = DVec3::new(part(0), part(16), part(32)).normalize_or(DVec3::Y);
        let near = DVec3::ONE - step + (step * 2.0 - 1.0) * fade;
        sum += near.element_product() * gradient.dot(within - step);
    }
    (sum * 1.5).clamp(-1.0, 1.0)
}
