//! Surfaces that light what is around: their triangles, and how much light each sends.

use glam::{Vec3, Vec3A};

use super::{Instance, Mesh, World};

/// Most triangles that light.
pub const MAX_EMITTERS: usize = 1 << 16;

/// Of linear Rec. 709 colors; the shaders weigh alike.
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// A triangle that lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Index into [`World::instances`].
    pub instance: u32,
    /// Index into [`Mesh::triangles`].
    pub triangle: u32,
    /// Area, square meters, by the luminance that its material emits; textures do not count.
    pub power: f32,
}

impl World {
    /// Whether something lights by its surface.
    pub fn has_emitters(&self) -> bool {
        self.lighting_instances().next().is_some()
    }

    /// The instances that light by their surface, with their indices.
    pub fn lighting_instances(&self) -> impl Iterator<Item = (usize, &Instance)> {
        let instances = self.instances.iter().enumerate();
        instances.filter(|(_, i)| self.materials[i.material].light)
    }

    /// Whether what lights by its surface may change from frame to frame.
    pub fn has_moving_emitters(&self) -> bool {
        let changes = |material: usize| {
            let mut moving = self.moving.materials.iter();
            moving.any(|m| m.material == material)
        };
        let mut lighting = self.lighting_instances();
        lighting.any(|(_, i)| i.dynamic || changes(i.material))
    }

    /// Every triangle that lights, as it is posed. Their number depends on no pose.
    pub fn emitters(&self) -> Vec<Emitter> {
        self.emitters_of(&self.meshes)
    }

    /// The same with the world's meshes given.
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
