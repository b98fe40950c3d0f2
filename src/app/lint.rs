//! Lint: likely mistakes in valid scenes. `check` reports them as warnings, each with its place and
//! what to do.

mod capture;
mod conventions;
mod decal;
mod ignored;
mod inside;
mod lamps;
mod overlap;
mod probe;
mod shadow;
mod silent;
pub mod since;
mod size;
mod solids;
mod text;
mod view;

use std::collections::HashSet;

use self::text::{each_value, warning, written};
use crate::{
    render::{
        RenderOptions,
        plan::traces_rays,
        upload::world_key::{TreeKey, has_same_uploads},
    },
    scene::{
        diagnostic::{Diagnostic, Span},
        script::lint::{Params, lint_scripts, used_params},
        stages::Scene,
        suggest::setting,
    },
    world::{Instance, Light, World, bvh::Trees},
};

/// Maximum number of triangles of a scene in which lint rays are traced, so that a check takes seconds.
const MOST_TRIANGLES: usize = 4_000_000;
/// Largest BVH buffer, bytes; the trees stay on the CPU.
const TREE_LIMIT: u64 = 4 << 30;

/// Trees of the scene that was checked last, for others over the same geometry.
#[derive(Default)]
pub struct KeptTrees(Option<(World, TreeKey, Trees)>);

impl KeptTrees {
    /// The trees of a world, cached while its geometry is unchanged; `None` where they cannot be built.
    fn for_world(&mut self, world: &World) -> Option<&Trees> {
        let key = TreeKey::from_world(world);
        let fitting = (self.0.take())
            .filter(|(had, its_key, _)| has_same_uploads(had, world) && *its_key == key);
        let trees = match fitting {
            Some((.., mut trees)) => trees.update_top_level(world).map(|()| trees),
            None => Trees::build(world, TREE_LIMIT),
        };
        let (.., trees) = self.0.insert((world.clone(), key, trees.ok()?));
        Some(trees)
    }
}

/// Collects warnings while frames are posed.
pub struct Lint<'a> {
    scene: &'a Scene,
    trees: &'a mut KeptTrees,
    /// Whether some frame has light.
    is_lit: bool,
    is_first: bool,
    /// The world of the first frame, while no other frame shows anything else.
    still: Option<World>,
    found: Vec<Diagnostic>,
}

impl<'a> Lint<'a> {
    /// Starts with the warnings about texts: unused parameters, and scripts.
    pub fn new(scene: &'a Scene, trees: &'a mut KeptTrees) -> Self {
        let mut found = unused_params(scene);
        if let Some(script) = &scene.script {
            found.extend(lint_scripts(&script.texts, &scene.params));
        }
        Self {
            scene,
            trees,
            is_lit: false,
            is_first: true,
            still: None,
            found,
        }
    }

    /// Names of the likely mistakes at the first frame that are found without tracing rays and that change the
    /// picture, sorted.
    pub fn names_at_first(scene: &Scene, world: &World) -> Vec<&'static str> {
        let mut found = inside::lights(scene, world);
        found.extend(inside::cameras(scene, world));
        found.extend(solids::unseen(scene, world));
        let mut names: Vec<_> = found.iter().map(|d| d.name).collect();
        if scene.timeline.is_none() && !is_lit(world) {
            names.push("no-light");
        }
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Warnings about what takes much longer than a picture.
    pub fn slow(scene: &Scene, world: &World) -> Vec<Diagnostic> {
        let found = capture::slow(scene, world).into_iter();
        found.map(Diagnostic::warning).collect()
    }

    /// Checks a posed frame; geometry is checked in the first frame only.
    pub fn frame(&mut self, world: &World) {
        self.is_lit |= is_lit(world);
        self.still = match self.still.take() {
            None if self.is_first => Some(world.clone()),
            first => first.filter(|first| looks_same(first, world)),
        };
        if !std::mem::replace(&mut self.is_first, false) {
            return;
        }
        let (scene, at, found) = (self.scene, self.scene.own.clone(), &mut self.found);
        found.extend(ignored::lint(scene, world, &at));
        found.extend(silent::lint(scene, world, &at));
        found.extend(solids::lint(scene, world));
        found.extend(decal::lint(scene, world));
        found.extend(conventions::lint(scene, world, &at));
        found.extend(lamps::lint(scene, world, &at));
        found.extend(inside::lights(scene, world));
        found.extend(inside::cameras(scene, world));
        found.extend(inside::probes(scene, world));
        found.extend(probe::empty(scene, world, at.clone()));
        found.extend(capture::slow(scene, world));
        found.extend(shadow::lamps(scene, world));
        found.extend(shadow::memory(scene, world));
        let is_traced = traces_rays(world, &RenderOptions::for_scene(scene));
        found.extend(size::lint(world, is_traced, at));
        let triangles = |i: &Instance| world.meshes[i.mesh].triangles.len();
        let total: usize = world.instances.iter().map(triangles).sum();
        if total > MOST_TRIANGLES || world.instances.is_empty() {
            return;
        }
        if let Some(trees) = self.trees.for_world(world) {
            found.extend(probe::close(scene, world, trees));
            found.extend(view::lint(scene, world, trees));
            found.extend(shadow::lint(scene, world, trees));
        }
    }

    /// All warnings, in the order of the text; `frames` is the number of frames if all were posed.
    pub fn finish(mut self, frames: Option<u32>) -> Vec<Diagnostic> {
        let many = frames.filter(|frames| *frames > 1 && self.scene.variants.is_empty());
        let is_explained = |d: &Diagnostic| ["ignored-key", "idle-function"].contains(&d.name);
        // Tracks that change nothing are told where they are read.
        let is_told = !(self.scene.motion.is_empty() || self.scene.has_frame_script())
            || self.found.iter().any(is_explained);
        let is_still = self.still.is_some() && !is_told;
        if let (Some(frames), true) = (many, is_still) {
            let end = written(&self.scene.own, "timeline", &["end"]).pop();
            let at = end.map_or_else(|| self.scene.own.clone(), |(at, _)| at);
            let help = match self.scene.has_frame_script() {
                true => "let what `frame` sets follow `ctx.t`, the time in seconds",
                false => "write `[motion]` or a script with `frame`, or remove `[timeline]`",
            };
            let message = format!("nothing changes, so all {frames} frames are the same picture");
            self.found.push(warning("still-film", &at, message, help));
        }
        if !self.is_lit {
            let is_dark = |d: &Diagnostic| matches!(d.name, "black-picture" | "black-reflector");
            self.found.retain(|d| !is_dark(d)); // darkness follows from the missing light
            let message = "the scene has no light: no lamp, no environment, nothing that emits";
            let mut help = "write `[environment]` with `color = [0.5, 0.6, 0.8]`, or `[light.sun]` with \
                        `kind = \"directional\"`, `direction = [-1, -2, -1]`, `intensity_lux = 3`";
            if has_placed_environment(self.scene) {
                help = "the `[environment]` of a placed scene is left out: copy it into this scene";
            }
            let dark = Diagnostic::new("no-light", self.scene.own.clone(), message).help(help);
            self.found.insert(0, dark);
        }
        let names: Vec<_> = self.found.iter().map(|d| d.name).collect();
        if names
            .iter()
            .any(|name| ["light-inside", "camera-inside"].contains(name))
        {
            self.found.retain(|d| d.name != "black-picture");
        }
        // The key that the advice adds may be written by a variant, which is checked with it.
        let written = variant_keys(self.scene);
        let is_written = |d: &Diagnostic| {
            let advised = d.help.as_deref().and_then(setting);
            advised.is_some_and(|(key, _)| written.contains(key))
        };
        (self.found).retain(|d| {
            !["ignored-key", "one-sample", "frosted-glass"].contains(&d.name) || !is_written(d)
        });
        let place = |d: &Diagnostic| d.span.range.start;
        self.found.sort_by_key(place);
        self.found.into_iter().map(Diagnostic::warning).collect()
    }

    /// Error that `render` would report on this machine.
    pub fn refused_here(scene: &Scene, world: &World) -> Option<Diagnostic> {
        let is_traced = traces_rays(world, &RenderOptions::for_scene(scene));
        size::refused_here(world, is_traced).or_else(|| capture::refused(scene, world))
    }
}

/// Whether a scene that is placed in this one has an environment, which is left out.
fn has_placed_environment(scene: &Scene) -> bool {
    let mut sources = scene
        .models
        .iter()
        .filter(|it| it.name.contains('.'))
        .filter_map(|it| it.at.source.as_ref());
    let Some(own) = &scene.own.source else {
        return false;
    };
    let has_own = own.syntax().root().get("environment").is_some();
    sources.any(|it| {
        !has_own && it.path != own.path && it.syntax().root().get("environment").is_some()
    })
}

/// Whether two frames place, shape, light and film the same things alike.
fn looks_same(a: &World, b: &World) -> bool {
    a.instances == b.instances
        && a.materials == b.materials
        && a.lights == b.lights
        && a.lamps == b.lamps
        && a.decals == b.decals
        && a.cameras == b.cameras
        && a.main_camera() == b.main_camera()
        && a.deformed.is_empty()
        && b.deformed.is_empty()
}

/// Names of all keys that variants of the scene's text write.
fn variant_keys(scene: &Scene) -> HashSet<String> {
    let mut keys = HashSet::new();
    let root = scene
        .own
        .source
        .as_ref()
        .map(|source| source.syntax().root());
    let variants = root.and_then(|root| root.get("variant")?.get_ref().as_table());
    if let Some(variants) = variants {
        each_value(variants, "", &mut |path, _| {
            keys.extend(path.rsplit('.').next().map(str::to_owned));
        });
    }
    keys
}

/// Whether there is any light: an environment, a light or an emissive instance.
fn is_lit(world: &World) -> bool {
    !world.environment.is_black()
        || world.all_lights().any(shines)
        || world.instances.iter().any(|i| emits(world, i))
}

/// Whether a light has brightness.
fn shines(light: &Light) -> bool {
    light.desc.color.max_element() > 0.0 && light.desc.kind.intensity() > 0.0
}

/// Whether an instance is shown and emits light.
fn emits(world: &World, instance: &Instance) -> bool {
    !instance.is_hidden() && world.materials[instance.material].emission.max_element() > 0.0
}

/// Warnings about parameters that the script does not read.
fn unused_params(scene: &Scene) -> Vec<Diagnostic> {
    let texts = scene.script.iter().flat_map(|s| &s.texts);
    let Params::Named(used) = used_params(texts.map(|(_, text)| text.as_str())) else {
        return Vec::new();
    };
    let unused = scene
        .params
        .iter()
        .filter(|p| !used.contains(p.name.as_str()));
    let warn = |name: &str, at: &Span| {
        let (message, help) = match &scene.script {
            None => (
                format!("nothing reads the parameter \"{name}\": the scene has no script"),
                "write `script = \"….rhai\"`, or remove the parameter".to_owned(),
            ),
            Some(script) => (
                format!("nothing reads the parameter \"{name}\""),
                format!("write `ctx.params.{name}` in {}, or remove it", script.name),
            ),
        };
        Diagnostic::new("unused-param", at.clone(), message).help(help)
    };
    unused.map(|p| warn(&p.name, &p.at)).collect()
}
