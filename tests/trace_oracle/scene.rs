//! World and rays for traversal tests.

use glam::{Affine3A, DVec2, EulerRot, Quat, Vec3};
use reflet::{
    math::Bounds,
    scene::desc::{BevelDesc, ShapeDesc},
    world::{Instance, Material, Mesh, World, bvh::Ray, shape},
};

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers on every machine.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn point(&mut self, extent: f32) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| self.within(-extent, extent)))
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point(1.0);
            if (0.01..1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }
}

/// Unconnected triangles of very different sizes.
fn soup(random: &mut Random, count: usize) -> Mesh {
    let mut mesh = Mesh {
        name: "soup".into(),
        ..Mesh::default()
    };
    for i in 0..count as u32 {
        let (center, size) = (random.point(1.0), random.within(0.02, 0.5));
        mesh.positions
            .extend([(); 3].map(|()| center + random.point(size)));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh.bounds = Bounds::around(mesh.positions.iter().copied());
    mesh
}

/// Alpha test of cut-out triangles; the kernel's `alpha_passes` is the same rule.
pub fn alpha_passes(instance: u32, triangle: u32, bary: DVec2) -> bool {
    !(instance + triangle).is_multiple_of(3) && bary.x < ALPHA_EDGE
}

pub const ALPHA_EDGE: f64 = 0.6;

fn placement(random: &mut Random, extent: f32) -> Affine3A {
    let mut scale = Vec3::from_array([(); 3].map(|()| random.within(0.3, 2.0)));
    if random.below(3) == 0 {
        scale[random.below(3)] *= -1.0;
    }
    let [x, y, z] = [(); 3].map(|()| random.within(-3.0, 3.0));
    Affine3A::from_scale_rotation_translation(
        scale,
        Quat::from_euler(EulerRot::XYZ, x, y, z),
        random.point(extent),
    )
}

/// All shapes and a soup, single and double sided, cut out and not, mirrored, stretched, shared;
/// a room's floor below. Everything is moved by `offset`.
pub fn world(offset: Vec3) -> World {
    let mut random = Random(7);
    let mut meshes: Vec<_> = [
        ShapeDesc::Sphere {
            radius: 1.0,
            segments: Some(24),
        },
        ShapeDesc::Box {
            size: Vec3::ONE,
            bevel: BevelDesc::default(),
        },
        ShapeDesc::Cylinder {
            radius: 0.5,
            height: 2.0,
            segments: 20,
        },
        ShapeDesc::Cone {
            radius: 0.7,
            height: 1.5,
            segments: 20,
        },
        ShapeDesc::Plane { size: [2.0, 1.0] },
    ]
    .iter()
    .map(|shape| {
        shape::make(shape, &shape::Supplies::default())
            .expect("a shape")
            .mesh
    })
    .collect();
    meshes.push(soup(&mut random, 200));
    let materials = [
        (None, false),
        (None, true),
        (Some(0.5), false),
        (Some(0.5), true),
    ]
    .map(|(alpha_cutoff, double_sided)| {
        let mut material = Material {
            double_sided,
            ..Material::default()
        };
        material.alpha_cutoff = alpha_cutoff;
        material
    });
    let mut instances = vec![Instance {
        name: "floor".into(),
        mesh: 4,
        material: 0,
        world_from_object: Affine3A::from_scale_rotation_translation(
            Vec3::new(12.0, 1.0, 24.0),
            Quat::IDENTITY,
            Vec3::new(0.0, -8.0, 0.0),
        ),
        dynamic: false,
        shown: Default::default(),
    }];
    for i in 0..48 {
        instances.push(Instance {
            name: format!("thing {i}"),
            mesh: random.below(meshes.len()),
            material: random.below(materials.len()),
            world_from_object: placement(&mut random, 8.0),
            dynamic: i % 2 == 1,
            shown: Default::default(),
        });
    }
    for instance in &mut instances {
        instance.world_from_object.translation += glam::Vec3A::from(offset);
    }
    World {
        meshes: meshes.into(),
        materials: materials.into(),
        instances,
        ..World::default()
    }
}

/// A ray whose numbers are exact in f32, so that both sides trace the same one.
pub fn ray(origin: Vec3, direction: Vec3, t_min: f32, t_max: f32) -> Ray {
    Ray {
        origin: origin.as_dvec3(),
        direction: direction.as_dvec3(),
        t_min: f64::from(t_min),
        t_max: f64::from(t_max),
        passes: 0,
    }
}

/// Random rays from in and around the scene; directions of any length.
pub fn random_rays(world: &World, offset: Vec3, count: usize) -> Vec<Ray> {
    let mut random = Random(11);
    (0..count)
        .map(|_| {
            let origin = offset + random.point(12.0);
            let aimed = random.below(2) == 0;
            let direction = if aimed {
                let instance = &world.instances[random.below(world.instances.len())];
                Vec3::from(instance.world_from_object.translation) + random.point(1.0) - origin
            } else {
                random.direction() * random.within(0.1, 3.0)
            };
            let t_max = [1e30, 1e30, 1e30, random.within(0.01, 5.0)][random.below(4)];
            ray(origin, direction, [0.0, 1e-3][random.below(2)], t_max)
        })
        .collect()
}

/// Rays along axes and in coordinate planes, from surfaces, with tiny and empty intervals.
pub fn special_rays(world: &World, offset: Vec3) -> Vec<Ray> {
    let mut random = Random(13);
    let mut rays = Vec::new();
    for _ in 0..200 {
        let origin = offset + random.point(9.0);
        for axis in 0..3 {
            let mut along = Vec3::ZERO;
            along[axis] = [1.0, -1.0][random.below(2)];
            let mut in_plane = random.direction();
            in_plane[axis] = [0.0, -0.0, 1e-30, -1e-12][random.below(4)];
            rays.push(ray(origin, along, 0.0, 1e30));
            rays.push(ray(origin, in_plane, 0.0, 1e30));
            rays.push(ray(origin, random.direction(), 0.0, 1e-6));
            rays.push(ray(origin, random.direction(), 1.0, 1.0));
        }
        // From a point on a surface, as reflection and shadow rays start.
        let instance = &world.instances[random.below(world.instances.len())];
        let mesh = &world.meshes[instance.mesh];
        let corners =
            mesh.triangles[random.below(mesh.triangles.len())].map(|i| mesh.positions[i as usize]);
        let on = corners[0] * 0.4 + corners[1] * 0.35 + corners[2] * 0.25;
        let start = instance.world_from_object.transform_point3(on);
        rays.push(ray(start, random.direction(), 1e-3, 1e30));
    }
    rays
}

/// A turned, stretched, finely tessellated ball, seen from both sides.
pub fn closed_shape(offset: Vec3, dynamic: bool) -> World {
    World {
        meshes: vec![
            shape::make(
                &ShapeDesc::Sphere {
                    radius: 3.0,
                    segments: Some(256),
                },
                &shape::Supplies::default(),
            )
            .expect("a sphere")
            .mesh,
        ]
        .into(),
        materials: vec![Material {
            double_sided: true,
            ..Material::default()
        }],
        instances: vec![Instance {
            name: "ball".into(),
            mesh: 0,
            material: 0,
            world_from_object: Affine3A::from_scale_rotation_translation(
                Vec3::new(1.0, 0.6, 1.7),
                Quat::from_euler(EulerRot::XYZ, 0.3, 1.1, -0.7),
                offset,
            ),
            dynamic,
            shown: Default::default(),
        }],
        ..World::default()
    }
}

/// Rays from around the middle of the first instance to its vertices and points of its edges.
pub fn rays_at_edges(world: &World, count: usize) -> Vec<Ray> {
    let mut random = Random(23);
    let instance = &world.instances[0];
    let mesh = &world.meshes[instance.mesh];
    (0..count)
        .map(|_| {
            let triangle = mesh.triangles[random.below(mesh.triangles.len())];
            let [a, b] = [0, 1].map(|k| mesh.positions[triangle[k] as usize]);
            let along = [0.0, 0.5, random.within(0.0, 1.0)][random.below(3)];
            let target = instance
                .world_from_object
                .transform_point3(a.lerp(b, along));
            let origin = Vec3::from(instance.world_from_object.translation) + random.point(1.0);
            ray(origin, target - origin, 0.0, 1e30)
        })
        .collect()
}

/// Spheres and capsules of very different lengths, placed stretched and mirrored, static and moving, single and double
/// sided, cut out and not, among triangles.
pub fn capsules() -> World {
    let mut random = Random(23);
    let mut wires = Mesh {
        name: "wires".into(),
        capsule_radius_m: Some(0.1),
        ..Mesh::default()
    };
    for i in 0..60 {
        let (center, size) = (random.point(1.0), random.within(0.01, 1.5));
        wires
            .positions
            .extend([center, center + random.point(size)]);
        let ends = [2 * i, 2 * i + u32::from(i % 3 > 0)];
        wires.triangles.push([ends[0], ends[1], ends[1]]);
    }
    wires.bounds = wires.bounds_at_rest();
    let mut world = world(Vec3::ZERO);
    world.meshes.push(wires);
    for instance in world.instances.iter_mut().skip(1).filter(|i| i.mesh < 5) {
        instance.mesh = 6;
    }
    world
}
