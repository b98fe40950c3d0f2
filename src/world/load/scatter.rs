//! Places of the copies of an instance along a curve and over a surface.

use glam::{Affine3A, DVec3, Mat3A, Quat, Vec3, Vec3A};
use xxhash_rust::xxh3::xxh3_64;

use super::{Loader, Source, error_at};
use crate::{
    Mesh,
    shape::{self, Curve},
};
use reflet_scene::desc::{AlongDesc, InstanceDesc, OverDesc};

/// Steps from one point to the next of a curve that bends.
const STEPS: u32 = 64;

impl Loader<'_> {
    /// Places of the copies of an instance that a table, a curve or a surface gives, relative to the instance.
    pub fn copy_places(
        &mut self,
        instance: &InstanceDesc,
        sources: &[Source],
    ) -> Option<Vec<Affine3A>> {
        if let Some(file) = &instance.instances_from {
            return Some(self.points(file));
        }
        if let Some(along) = &instance.along {
            return Some(self.along(along));
        }
        let over = instance.over.as_ref()?;
        Some(self.over(over, sources))
    }

    /// Places along a curve, relative to the instance.
    fn along(&mut self, along: &AlongDesc) -> Vec<Affine3A> {
        match frames_along(along) {
            Ok(places) => places,
            Err(fault) => {
                let mut error = error_at(fault.name, &along.at.0, fault.message);
                error.help = fault.help;
                self.errors.push(error);
                Vec::new()
            }
        }
    }

    /// Places over the surface of a model, relative to the instance.
    fn over(&mut self, over: &OverDesc, sources: &[Source]) -> Vec<Affine3A> {
        let index = self.models.index(&over.model.value);
        let Some(source) = index.and_then(|index| sources.get(index)) else {
            return Vec::new(); // its name was refused
        };
        match source {
            Source::Shape(mesh) => places_over(&self.world.meshes[*mesh], over),
            Source::Broken => Vec::new(),
            Source::File(_) => {
                let text = "`over` names a model of a file; only shapes can be covered";
                let help =
                    "name a model with a `shape`, such as a `plane`, `heightfield` or `mesh`";
                self.errors
                    .push(error_at("wrong-source", &over.model.at, text).help(help));
                Vec::new()
            }
        }
    }
}

fn frames_along(along: &AlongDesc) -> Result<Vec<Affine3A>, shape::Fault> {
    let curve = Curve::through(&along.points, along.curve, along.closed, STEPS)?;
    let gaps = if along.closed {
        along.count
    } else {
        (along.count - 1).max(1)
    };
    let frame = |(at, way, up): (DVec3, DVec3, DVec3)| {
        if !along.turned {
            return Affine3A::from_translation(at.as_vec3());
        }
        let axes = [way, up, way.cross(up)].map(|axis| Vec3A::from(axis.as_vec3()));
        Affine3A {
            matrix3: Mat3A::from_cols(axes[0], axes[1], axes[2]),
            translation: at.as_vec3().into(),
        }
    };
    let places = curve.walk(along.count as usize, f64::from(gaps));
    Ok(places.into_iter().map(frame).collect())
}

/// Number from 0 to 1 for a copy.
fn random(over: &OverDesc, copy: u32, what: u32) -> f32 {
    let hash = xxh3_64(bytemuck::bytes_of(&[over.seed, copy, what]));
    (hash >> 40) as f32 / (1_u64 << 24) as f32
}

/// Places over a mesh: one at a random place of each of `count` equal shares of its area, in the order of its
/// triangles.
fn places_over(mesh: &Mesh, over: &OverDesc) -> Vec<Affine3A> {
    let mut areas = Vec::with_capacity(mesh.triangles.len());
    let mut whole = 0.0_f64;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        whole += (b - a).cross(c - a).length();
        areas.push(whole);
    }
    if whole <= 0.0 {
        return Vec::new();
    }
    let place = |copy: u32| {
        let share = (f64::from(copy) + f64::from(random(over, copy, 0))) / f64::from(over.count);
        let found = areas.partition_point(|area| *area < share * whole);
        let triangle = mesh.triangles[found.min(areas.len() - 1)];
        let [u, v] = [1, 2].map(|what| random(over, copy, what));
        // Uniform over a triangle (Turk, "Generating random points in triangles", Graphics Gems, 1990).
        let root = u.sqrt();
        let weights = [1.0 - root, root * (1.0 - v), root * v];
        let mix = |values: &[Vec3]| -> Vec3 {
            (0..3)
                .map(|k| values[triangle[k] as usize] * weights[k])
                .sum()
        };
        let up = match over.upright {
            true => mix(&mesh.normals).normalize_or(Vec3::Y),
            false => Vec3::Y,
        };
        let spin = if over.spun {
            std::f32::consts::TAU * random(over, copy, 3)
        } else {
            0.0
        };
        let rotation = Quat::from_rotation_arc(Vec3::Y, up) * Quat::from_rotation_y(spin);
        let [least, most] = over.scale;
        let size = least + (most - least) * random(over, copy, 4);
        let at = mix(&mesh.positions);
        Affine3A::from_scale_rotation_translation(Vec3::splat(size), rotation, at)
    };
    (0..over.count).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_scene::desc::{At, ShapeDesc, SweepCurve, Written};

    fn over(count: u32) -> OverDesc {
        OverDesc {
            model: At {
                value: "ground".into(),
                at: Default::default(),
            },
            count,
            seed: 3,
            upright: true,
            spun: true,
            scale: [0.5, 2.0],
        }
    }

    #[test]
    fn copies_along_a_curve_are_at_equal_distances_and_look_along_it() {
        let along = |closed| AlongDesc {
            points: vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 2.0]],
            curve: SweepCurve::Linear,
            closed,
            count: 7,
            turned: true,
            at: Written(Default::default()),
        };
        let places = frames_along(&along(false)).expect("a curve");
        let at: Vec<Vec3> = places.iter().map(|p| p.translation.into()).collect();
        for (i, place) in at.iter().enumerate() {
            let want = match i {
                0..=4 => Vec3::new(i as f32, 0.0, 0.0),
                _ => Vec3::new(4.0, 0.0, i as f32 - 4.0),
            };
            assert!(place.distance(want) < 1e-5, "{i}: {place}");
        }
        let way: Vec3 = places[6].matrix3.x_axis.into();
        assert!(way.distance(Vec3::Z) < 1e-5, "{way}");
        for place in &places {
            assert!((place.matrix3.determinant() - 1.0).abs() < 1e-5);
            assert!(place.matrix3.y_axis.y > 0.999);
        }
        let around = frames_along(&along(true)).expect("a curve");
        let last: Vec3 = around[6].translation.into();
        assert!(last.length() > 1.0, "the last is not on the first: {last}");
    }

    #[test]
    fn copies_over_a_surface_lie_on_it_and_are_as_many_everywhere() {
        let sphere = ShapeDesc::Sphere {
            radius: 2.0,
            segments: Some(64),
        };
        let mesh = shape::make(&sphere, &shape::Supplies::default())
            .expect("a sphere")
            .mesh;
        let places = places_over(&mesh, &over(2000));
        let mut upper = 0;
        for place in &places {
            let at = Vec3::from(place.translation);
            assert!((1.98..=2.001).contains(&at.length()), "{at}");
            let up = Vec3::from(place.matrix3.y_axis);
            assert!((0.5..=2.001).contains(&up.length()), "{up}");
            assert!(up.normalize().dot(at.normalize()) > 0.999);
            upper += usize::from(at.y > 0.0);
        }
        // Each share of the area has one: half of them, and some on the rows at the equator.
        assert!((960..=1040).contains(&upper), "{upper}");
        assert_eq!(places, places_over(&mesh, &over(2000)));
    }
}
