//! Scenes and settings of the frames that `calibrate` times.

use crate::{
    render::RenderOptions,
    scene::desc::{Method, ShadowMode, Visibility},
    world::World,
};

/// Test scene: a mirror floor under diffuse balls, lit by the sun or by a panel above them. `COUNT` and `SEGMENTS` are
/// replaced by the number of balls along each axis and by the segments of each.
pub const SCENE: &str = r#"
version = 1
[camera.main]
eye = [0, 5, 13]
target = [0, 0.5, 0]
[material.mirror]
metallic = 1
roughness = 0
[material.dull]
roughness = 0.9
[model.floor]
shape = { kind = "plane", size = [24, 24] }
material = "mirror"
[material.panel]
emission = [1, 1, 1]
[model.panel]
shape = { kind = "plane", size = [4, 4] }
material = "panel"
[model.ball]
shape = { kind = "sphere", radius = 0.45, segments = SEGMENTS }
material = "dull"
[[instance]]
model = "floor"
[[instance]]
model = "panel"
rotation_deg = [180, 0, 0]
translation = [0, 9, -6]
[[instance]]
model = "ball"
translation = [-6, 0.6, 0]
repeat = { count = COUNT, step = [1.3, 1.2, -1.3] }
[light.sun]
kind = "directional"
direction = [0.3, -1, -0.2]
intensity_lux = 3
shadow = "auto"
shadow_px = 1024
"#;

/// Number of balls along each axis, and segments of each: from scenes where rays visit few BVH nodes to many.
pub const BALLS: [([u32; 3], u32); 3] = [([2, 1, 1], 8), ([10, 1, 4], 24), ([10, 3, 10], 64)];

/// Settings of a timed frame.
#[derive(Clone, Copy)]
pub struct FrameSetup {
    method: Method,
    visibility: Visibility,
    shadow: ShadowMode,
    /// Whether the panel lights the scene.
    panel: bool,
    diffuse_bounces: u32,
}

/// A frame with all rays but light rays.
const RAYS: FrameSetup = FrameSetup {
    method: Method::Rt,
    visibility: Visibility::Rays,
    shadow: ShadowMode::None,
    panel: false,
    diffuse_bounces: 0,
};

/// Settings of the timed frames; together they run every pass that has a unit cost.
pub const SETUPS: [FrameSetup; 5] = [
    FrameSetup {
        method: Method::Hybrid,
        visibility: Visibility::Raster,
        shadow: ShadowMode::Map,
        ..RAYS
    },
    RAYS,
    FrameSetup {
        method: Method::Ssr,
        visibility: Visibility::Raster,
        shadow: ShadowMode::Ray,
        ..RAYS
    },
    FrameSetup {
        panel: true,
        ..RAYS
    },
    FrameSetup {
        diffuse_bounces: 2,
        ..RAYS
    },
];

impl FrameSetup {
    /// The world and the options of its frames.
    pub fn applied(self, world: &World, options: &RenderOptions) -> (World, RenderOptions) {
        let (mut world, mut options) = (world.clone(), *options);
        for light in &mut world.lights {
            light.desc.shadow = self.shadow;
        }
        for material in &mut world.materials {
            material.light = self.panel && material.emission.max_element() > 0.0;
        }
        // With scattered light the environment gets light rays, which are measured by the panel.
        if self.diffuse_bounces > 0 {
            world.environment.desc.intensity = 0.0;
        }
        options.reflection.method = self.method;
        options.reflection.diffuse_bounces = self.diffuse_bounces;
        options.image.visibility = self.visibility;
        (world, options)
    }
}
