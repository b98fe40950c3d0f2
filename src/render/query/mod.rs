//! Questions about a scene, answered by rays on the processor: which things are visible, and which others hide, light and
//! touch them. `reflet query` prints the answers.

pub mod answer;
mod choices;
mod contacts;
mod lit;
mod surfaces;
mod things;
mod visible;

use std::time::Duration;

use glam::{DVec2, DVec3, Mat4, Vec2};

use self::{
    answer::{Answer, Choices, ModelContents, Named, Pixel, Surface, Thing},
    lit::Lights,
    things::Things,
    visible::Visibility,
};
use crate::{
    decide::view_rays::ViewRays,
    runtime::{SessionError, posing::motion_bounds, scene_text::LoadedScene},
    settings::view::View,
};
use reflet_base::math::Bounds;
use reflet_scene::desc::{InstanceMaterialDesc, MaterialDesc};
use reflet_world::{
    World,
    bvh::{RayHit, Trees},
};

/// Largest number of things, and of entries of their lists.
const MOST_LISTED: usize = 100;
/// Number of points of a thing that are looked at.
const POINTS: usize = 64;
/// Number of points of the picture at which its light is found.
const PICTURE_POINTS: usize = 256;
/// Time in which frames are posed for bounds over the motion.
const POSING: Duration = Duration::from_millis(300);

/// A question about a scene.
#[derive(Clone, Debug, Default)]
pub struct Question {
    /// Name of the camera; without one, the camera of the frame.
    pub camera: Option<String>,
    /// Frame of the timeline; without one, the first.
    pub frame: Option<u32>,
    /// Pixels that are asked about, as column and row.
    pub at: Vec<[u32; 2]>,
    /// Names of instances, of models that no instance places, of groups of placed scenes, or of parts of these; without
    /// any, all things.
    pub of: Vec<String>,
    /// Whether each copy and part of a file is a thing of its own.
    pub parts: bool,
}

/// Answers a question about a scene, which is then posed at the frame of the question.
///
/// # Errors
/// Names, frames and pixels that are not there; a frame that cannot be posed; geometry past the memory.
pub fn ask(loaded: &mut LoadedScene, question: &Question) -> Result<Answer, SessionError> {
    let frame = question.frame.unwrap_or(loaded.scene.first_frame());
    loaded.check_frame(frame)?;
    let mut moving = loaded.world.clone();
    let (motion, posed_frames) = motion_bounds(&loaded.scene, &mut moving, POSING)?;
    loaded.pose(frame)?;
    let camera = match &question.camera {
        Some(name) => loaded.require_camera(Some(name))?,
        None => loaded.camera_at(frame),
    };
    let (scene, world) = (&loaded.scene, &loaded.world);
    let things = Things::new(loaded, question)?;
    let trees = Trees::build(world, u64::MAX).map_err(|error| SessionError::Scene(vec![*error]))?;
    let size = scene.image.size;
    if let Some(at) = question
        .at
        .iter()
        .find(|at| at[0] >= size[0] || at[1] >= size[1])
    {
        return Err(SessionError::Pixel { at: *at, size });
    }
    let unit_m = scene.reflection.unit_m.unwrap_or_else(|| world.unit_m());
    let view = View::new(&world.cameras[camera].value, size, unit_m);
    let rays = ViewRays {
        world,
        trees: &trees,
        view: &view,
    };
    let lights = Lights::new(rays);
    let name_of = |instance| things.name_of(instance).to_owned();
    let visible = Visibility::new(rays, &things, camera, unit_m);
    let mut answer = Answer {
        scene: loaded.name.clone(),
        frame,
        camera: world.cameras[camera].name.clone(),
        view_from_world: rows(view.view_from_world()),
        clip_from_view: rows(view.clip_from_view(Vec2::ZERO)),
        picture_px: size,
        rays: visible.grid,
        background: rounded(visible.background),
        bounds_m: corners(
            motion
                .iter()
                .fold(Bounds::EMPTY, |all, one| all.union(*one)),
        ),
        posed_frames,
        lit_by: lights.shares(&visible.points(None, PICTURE_POINTS), name_of),
        cameras: cameras(loaded),
        lights: (world.all_lights())
            .map(|light| Named {
                name: light.name.clone(),
                kind: Some(light.desc.kind.name().to_owned()),
                place: place_in(&scene.lights, &light.name),
                at_m: light.desc.kind.position().map(|p| numbers(p.as_dvec3())),
                target_m: None,
            })
            .collect(),
        choices: Choices::of_scene(loaded),
        ..Answer::default()
    };
    answer.leave_out(
        lights.left_out,
        "lamps are too weak to be looked at for `lit_by`: the 256 strongest are",
    );
    let mut chosen = things.chosen();
    chosen.sort_by(|a, b| visible.share(*b).total_cmp(&visible.share(*a)));
    answer.leave_out(
        chosen.len().saturating_sub(MOST_LISTED),
        "things are not listed: ask by --of",
    );
    chosen.truncate(MOST_LISTED);
    for index in &chosen {
        let mut thing = things.describe(loaded, *index, &motion);
        visible.describe(*index, &mut thing);
        if !question.of.is_empty() {
            thing.lit_by = lights.shares(&visible.points(Some(*index), POINTS), name_of);
        }
        answer.things.push(thing);
    }
    answer.outside = visible.outside_of_all();
    contacts::find(world, &things, &chosen, &mut answer);
    for at in &question.at {
        let place =
            (DVec2::new(at[0].into(), at[1].into()) + 0.5) / DVec2::from(size.map(f64::from));
        let ray = rays.primary(place);
        let hits: Vec<RayHit> = surfaces::along(&rays, ray).collect();
        let surface = |hit: &RayHit| surface(loaded, &rays, &things, ray.direction, hit);
        let first: Vec<_> = (hits.first().iter())
            .map(|hit| rays.point(hit, ray.direction))
            .collect();
        answer.pixels.push(Pixel {
            at: *at,
            surfaces: hits.iter().map(surface).collect(),
            lit_by: lights.shares(&first, name_of),
        });
    }
    answer.cut_lists();
    Ok(answer)
}

fn rows(matrix: Mat4) -> [[f32; 4]; 4] {
    matrix.transpose().to_cols_array_2d()
}

/// Cuts a list, and returns the number of the entries that are gone.
fn cut<T>(list: &mut Vec<T>) -> usize {
    let surplus = list.len().saturating_sub(MOST_LISTED);
    list.truncate(MOST_LISTED);
    surplus
}

impl Answer {
    /// Cuts all lists that may be longer than [`MOST_LISTED`], and counts what is left out.
    fn cut_lists(&mut self) {
        let choices = &mut self.choices;
        let models = cut(&mut choices.models);
        let mut of_things =
            |list: fn(&mut Thing) -> usize| -> usize { self.things.iter_mut().map(list).sum() };
        let mut of_models = |list: fn(&mut ModelContents) -> usize| -> usize {
            choices.models.iter_mut().map(list).sum()
        };
        let lit_things = of_things(|t| cut(&mut t.lit_by));
        let lit_pixels: usize = self.pixels.iter_mut().map(|p| cut(&mut p.lit_by)).sum();
        let lit = cut(&mut self.lit_by) + lit_things + lit_pixels;
        let left_out = [
            (lit, "lights of `lit_by`"),
            (cut(&mut self.outside), "things outside"),
            (cut(&mut self.cameras), "cameras"),
            (cut(&mut self.lights), "lights"),
            (of_things(|t| cut(&mut t.contacts)), "contacts"),
            (of_things(|t| cut(&mut t.materials)), "materials of things"),
            (of_things(|t| cut(&mut t.hidden_by)), "hiding things"),
            (
                of_things(|t| cut(&mut t.in_pictures_of)),
                "cameras of things",
            ),
            (models, "models"),
            (of_models(|m| cut(&mut m.materials)), "materials of models"),
            (of_models(|m| cut(&mut m.variants)), "variants of models"),
            (
                of_models(|m| m.node_count - m.nodes.len()),
                "nodes of models",
            ),
            (cut(&mut choices.scene_variants), "scene variants"),
            (cut(&mut choices.parameters), "parameters"),
            (cut(&mut choices.cuts), "cuts"),
        ];
        for (count, kind) in left_out.into_iter().filter(|(count, _)| *count > 0) {
            self.left_out
                .push(format!("{kind} that are not listed: {count}"));
        }
    }

    fn leave_out(&mut self, count: usize, what: &str) {
        if count > 0 {
            self.left_out.push(format!("{count} {what}"));
        }
    }
}

fn cameras(loaded: &LoadedScene) -> Vec<Named> {
    let cameras = loaded.world.cameras.iter();
    let named = cameras.map(|camera| Named {
        name: camera.name.clone(),
        kind: None,
        place: place_in(&loaded.scene.cameras, &camera.name),
        at_m: Some(numbers(camera.value.eye.as_dvec3())),
        target_m: Some(numbers(camera.value.target.as_dvec3())),
    });
    named.collect()
}

/// A surface that a ray along `direction` meets.
fn surface(
    loaded: &LoadedScene,
    rays: &ViewRays<'_>,
    things: &Things,
    direction: DVec3,
    hit: &RayHit,
) -> Surface {
    let (world, scene) = (&loaded.world, &loaded.scene);
    let point = rays.point(hit, direction);
    let instance = &world.instances[point.instance];
    let material = &world.materials[instance.material];
    let model = scene.models.get(world.placed_models[point.instance]);
    let overrides: &[_] = model.map_or(&[], |model| &model.value.overrides);
    let of_file = overrides.iter().find(|entry| entry.name == material.name);
    let place = things.place_of(loaded, point.instance);
    let changes_material = changes_material(loaded, point.instance);
    let material_place = match changes_material {
        true => place.clone(),
        false => (of_file.and_then(|entry| entry.at.in_words()))
            .or_else(|| place_in::<MaterialDesc>(&scene.materials, &material.name)),
    };
    let (position, normal) = (point.position.as_vec3(), point.normal.as_vec3());
    let decals = world.covering_decals(point.instance, position, normal);
    Surface {
        thing: things.name_of(point.instance).to_owned(),
        place,
        part: instance.name.clone(),
        triangle: hit.triangle,
        material: material.name.clone(),
        changes_material,
        material_place,
        decals: decals.map(|i| world.decals.list[i].name.clone()).collect(),
        distance_m: rounded(hit.t * direction.length()),
        at_m: numbers(point.position),
        normal: numbers(point.normal),
    }
}

/// Whether an instance of the text changes its material by a table of its own.
fn changes_material(loaded: &LoadedScene, instance: usize) -> bool {
    let written = loaded.world.written[instance].and_then(|i| loaded.scene.instances.get(i));
    let material = written.and_then(|written| written.material.as_ref());
    matches!(material, Some(InstanceMaterialDesc::Override(_)))
}

/// Place of a named table in the text.
fn place_in<T>(entries: &[reflet_scene::desc::Entry<T>], name: &str) -> Option<String> {
    let entry = entries.iter().find(|entry| entry.name == name)?;
    entry.at.clone().shown().in_words()
}

/// Number rounded to five digits.
fn rounded(x: f64) -> f64 {
    // Zero is written without its sign.
    format!("{x:.4e}").parse::<f64>().map_or(x, |x| x + 0.0)
}

fn numbers(v: DVec3) -> [f64; 3] {
    v.to_array().map(rounded)
}

/// Least and greatest corner of a box; `None` for an empty one.
fn corners(bounds: Bounds) -> Option<[[f64; 3]; 2]> {
    let corners = [bounds.min, bounds.max].map(|corner| numbers(corner.as_dvec3()));
    (!bounds.is_empty()).then_some(corners)
}

/// Bounds of instances in the current pose.
fn bounds_of(world: &World, instances: &[usize]) -> Bounds {
    let boxes = instances
        .iter()
        .map(|i| world.bounds_of(&world.instances[*i]));
    boxes.fold(Bounds::EMPTY, Bounds::union)
}
