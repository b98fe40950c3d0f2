//! Emitters: triangles whose emission lights the scene, each with its power.

use glam::Vec3A;

use super::{Instance, Mesh, World};
use reflet_base::math::LUMINANCE;

/// Maximum number of emitter triangles.
pub const MAX_EMITTERS: usize = 1 << 20;

/// A triangle whose emission lights the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Index into [`World::instances`].
    pub instance: u32,
    /// Index into [`Mesh::triangles`].
    pub triangle: u32,
    /// Area in square meters times the luminance of the material's emission; textures are ignored.
    pub power: f32,
}

impl World {
    /// Whether light trees choose some light: an instance has a material that lights the scene, or there are lamps.
    pub fn has_emitters(&self) -> bool {
        !self.lamps.is_empty() || self.lighting_instances().next().is_some()
    }

    /// The instances whose material lights the scene, with their indices.
    pub fn lighting_instances(&self) -> impl Iterator<Item = (usize, &Instance)> {
        let instances = self.instances.iter().enumerate();
        instances.filter(|(_, i)| self.materials[i.material].light)
    }

    /// Whether emissive surfaces may change from frame to frame.
    pub fn has_moving_emitters(&self) -> bool {
        let changes = |material: usize| {
            let mut moving = self.moving.materials.iter();
            moving.any(|m| m.material == material)
        };
        let mut lighting = self.lighting_instances();
        lighting.any(|(_, i)| i.dynamic || changes(i.material))
    }

    /// All emitters in the current pose; their number is the same in every pose.
    pub fn emitters(&self) -> Vec<Emitter> {
        self.emitters_of(&self.meshes)
    }

    /// All emitters, with the world's meshes given.
    pub(super) fn emitters_of(&self, meshes: &[Mesh]) -> Vec<Emitter> {
        let mut emitters = Vec::new();
        for (index, instance) in self.lighting_instances() {
            let mesh = &meshes[instance.mesh];
            let posed = match self.deformed.get(&instance.mesh) {
                Some(deformed) => deformed.posed(),
                None => mesh.at_rest(),
            };
            let luminance = self.materials[instance.material].emission.dot(LUMINANCE);
            let place = instance.world_from_object;
            emitters.extend(mesh.triangles.iter().zip(0..).map(|(corners, triangle)| {
                let [a, b, c] = posed.corners(*corners).map(Vec3A::from);
                let [u, v] = [b - a, c - a].map(|edge| place.transform_vector3a(edge));
                Emitter {
                    instance: index as u32,
                    triangle,
                    power: luminance * 0.5 * u.cross(v).length(),
                }
            }));
        }
        emitters
    }
}
