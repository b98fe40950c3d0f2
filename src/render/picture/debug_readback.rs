//! Debug readback: shadow maps as distances, and the list of traced rays.

use glam::{Mat4, Vec3};

use reflet_gpu::{
    Gpu, GpuError,
    readback::{read_buffer, read_texture_layer, values},
};
use reflet_scene::desc::ShadowMode;
use reflet_world::Light;

use crate::{
    lighting::lights::{CUBE_FACES, has_cube_map, in_order},
    passes::trace,
    pipeline::{cause::Cause, ray_list::RAY_COUNTER},
    renderer::Renderer,
    settings::options::RenderOptions,
};

/// Number of shadow map faces of a light with its index: six for a point light, one for other lights, none where the
/// shadow is not mapped.
pub fn shadow_faces(index: usize, light: &Light, options: &RenderOptions) -> usize {
    match options.shadow_of(index, light) {
        ShadowMode::Map if has_cube_map(&light.desc.kind) => CUBE_FACES.len(),
        ShadowMode::Default | ShadowMode::Map | ShadowMode::Auto => 1,
        ShadowMode::None | ShadowMode::Ray => 0,
    }
}

/// Distance along the map's axis of a stored depth, in the renderer's lengths: from the light where the map is a
/// perspective view, else from the near side of the box that the map covers. Infinite where no caster was drawn.
fn distance_m(clip_from_world: &Mat4, depth: f32) -> f32 {
    if depth <= 0.0 {
        return f32::INFINITY;
    }
    let is_perspective = clip_from_world.row(3).truncate() != Vec3::ZERO;
    if is_perspective {
        return clip_from_world.row(2).w / depth;
    }
    let depth_per_m = clip_from_world.row(2).truncate().length();
    (1.0 - depth) / depth_per_m
}

impl Renderer {
    /// One face of a light's shadow map as drawn for the last picture: its width in texels, and for each texel the
    /// distance in meters along the map's axis, rows from the top. `None` where the light has no such map.
    ///
    /// # Errors
    /// A readback error.
    pub fn shadow_map(
        &self,
        gpu: &Gpu,
        light: usize,
        face: usize,
    ) -> Result<Option<(u32, Vec<f32>)>, GpuError> {
        let world = &self.world;
        let faces = |index: usize, light: &Light| shadow_faces(index, light, &self.options);
        if face >= world.lights.get(light).map_or(0, |l| faces(light, l)) {
            return Ok(None);
        }
        let (lights, _) = in_order(&world.lights);
        let before = lights.take_while(|(index, _)| *index != light);
        let before: usize = before.map(|(index, l)| faces(index, l)).sum();
        let (_, views) = self.lights();
        let Some(view) = views.get(before + face) else {
            return Ok(None);
        };
        let maps = if view.cube {
            &self.bindings.maps.cubes
        } else {
            &self.bindings.maps.maps
        };
        let texture = maps.texture();
        let depths: Vec<f32> = values(&read_texture_layer(gpu, texture, view.layer)?);
        let meters = self.coordinates.meters();
        let distance = |depth| distance_m(&view.clip_from_world, depth) * meters;
        Ok(Some((
            texture.width(),
            depths.into_iter().map(distance).collect(),
        )))
    }

    /// Pixels that the last sub-frame traced, x and y from the top left, in the order of the list. `None` where the
    /// frame has no list: nothing reflects, or the method traces no rays.
    ///
    /// # Errors
    /// A readback error.
    pub fn ray_list(&self, gpu: &Gpu) -> Result<Option<Vec<[u32; 2]>>, GpuError> {
        if !self.bindings.passes.records(&trace::PASS) || !trace::is_enabled(&self.options) {
            return Ok(None);
        }
        let counters: Vec<u32> = read_buffer(gpu, &self.bindings.ray_list.counters)?;
        let [count, unmarched] = [RAY_COUNTER, Cause::Unmarched as usize]
            .map(|at| counters.get(at).copied().unwrap_or(0) as usize);
        let lists: Vec<u32> = read_buffer(gpu, &self.bindings.ray_list.lists)?;
        let [width, height] = self.options.image.size;
        let (before, refused) = lists.split_at((width * height) as usize);
        let rays = before.iter().take(unmarched).chain(refused);
        let place = |ray: &u32| [ray & 0xFFFF, ray >> 16];
        Ok(Some(rays.take(count).map(place).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lighting::lights::{ShadowSizes, lights, map_near_m};
    use reflet_base::math::Bounds;
    use reflet_scene::{
        desc::{Entry, LightDesc},
        stages::Scene,
    };

    /// A point, a spot and a directional light, which have depth maps.
    fn lamps() -> Vec<Light> {
        let text = include_str!("debug_readback.toml");
        let read = Scene::from_text(text, "lights.toml".as_ref(), &[]);
        let lights = &read.expect("it is right").0.desc.lights;
        let light = |light: &Entry<LightDesc>| Light {
            name: light.name.clone(),
            desc: light.value,
            range_m: None,
            moves: false,
        };
        lights.iter().map(light).collect()
    }

    /// Draws a point into the map and reads its depth back: the distance is the point's.
    #[test]
    fn stored_depths_are_the_distances_that_were_drawn() {
        let bounds = Bounds {
            min: Vec3::new(-2.0, 0.0, -3.0),
            max: Vec3::new(4.0, 5.0, 6.0),
        };
        let point = Vec3::new(0.7, 1.25, 0.8);
        for (lamp, expected_m) in lamps().into_iter().zip([2.75, 2.75, 3.75]) {
            let all = [lamp];
            let options = RenderOptions::default();
            let (_, views) = lights(
                &all,
                ShadowSizes::for_lights(&all, &options),
                &bounds,
                map_near_m(2.0),
                &options,
            );
            assert_eq!(views.len(), shadow_faces(0, &all[0], &options));
            // The fourth view, the cube face that looks down; the only view of other maps.
            let view = views.get(3).unwrap_or(&views[0]);
            let clip = view.clip_from_world * point.extend(1.0);
            let depth = clip.z / clip.w;
            let got_m = distance_m(&view.clip_from_world, depth);
            assert!((got_m - expected_m).abs() < 1e-3, "{got_m} {expected_m}");
            let none = distance_m(&view.clip_from_world, 0.0);
            assert_eq!(none, f32::INFINITY);
        }
    }

    #[test]
    fn only_lights_with_maps_have_faces() {
        let mut lamp = lamps().pop().expect("the last one");
        assert_eq!(shadow_faces(0, &lamp, &RenderOptions::default()), 1);
        lamp.desc.shadow = ShadowMode::Ray;
        assert_eq!(shadow_faces(0, &lamp, &RenderOptions::default()), 0);
    }
}
