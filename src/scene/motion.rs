//! The state of the scene at one frame, as tracks move it: a pure function of the description and the
//! number of the frame.

mod clock;
mod decal;
mod hierarchy;
mod joint;
mod material;
mod mesh;
mod names;
mod parts;
mod placement;
pub(super) mod track;

use std::{
    borrow::Cow,
    collections::{BTreeMap, HashSet},
    sync::Arc,
};

use glam::{Affine3A, Vec3};

pub use self::decal::{DECAL, DECAL_PLACES, DecalPose};
use self::hierarchy::{attach_cameras, attach_lights};
pub use self::hierarchy::{placed_camera, placed_light};
pub use self::joint::JointPose;
pub use self::material::{
    FileMaterial, MaterialChange, ModelTables, NO_VALUES, Values, changing_overrides,
    file_materials, override_of, written_all,
};
pub use self::mesh::MeshPose;
pub use self::names::{Names, ScriptNames};
pub use self::parts::{Kind, ScriptedFields, Unusable, wrong_with_camera, wrong_with_light};
use self::placement::placed;
pub use self::placement::transform;
use self::track::Track;
pub use self::track::key_value;
use super::{
    desc::{
        AnimationDesc, ByName, CAMERA, CameraDesc, Entry, InstanceDesc, InstanceMotionDesc, LIGHT,
        LightDesc, MaterialDesc, PlacementDesc, SceneDesc, TrackDesc, Tracks,
    },
    diagnostic::{Diagnostic, Span},
    number::Field,
};

/// Everything that may differ from frame to frame; the lists are parallel to the lists of [`SceneDesc`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameState {
    /// Number of the frame.
    pub frame: u32,
    /// Time of the frame, or of the sub-frame while the shutter is open, seconds.
    pub time_s: f64,
    /// State of each camera.
    pub cameras: Vec<CameraDesc>,
    /// Transform from model to world space of each instance (of its first copy), then of each group;
    /// relative to its parent until [`Animator`](super::stages::Animator) has posed the frame.
    pub instances: Vec<Affine3A>,
    /// Whether each of these nodes is hidden; that hides its descendants too. Nodes past the end of the list
    /// are shown.
    pub hidden: Vec<bool>,
    /// Playback time of each instance's animations, where the script has set it, seconds.
    pub animation_s: Vec<Option<f64>>,
    /// Poses of nodes that the script has set, by instance and index in [`InstanceDesc::joints`].
    pub joints: BTreeMap<(usize, usize), JointPose>,
    /// Weights that the script has set, by instance and index in [`InstanceDesc::morphs`].
    pub morphs: BTreeMap<(usize, usize), f32>,
    /// Vertices that the script has set, by the index of their model in [`SceneDesc::models`].
    pub meshes: BTreeMap<usize, MeshPose>,
    /// State of each decal.
    pub decals: Vec<DecalPose>,
    /// State of each light.
    pub lights: Vec<LightDesc>,
    /// Values of each `[material.NAME]`.
    pub materials: Vec<MaterialDesc>,
    /// Changed values of each material that [`file_materials`] lists.
    pub file_materials: Vec<MaterialChange>,
    /// Changed values of each instance's own `material = { … }`.
    pub overrides: Vec<MaterialChange>,
    /// Values that scripts have set.
    pub scripted: ScriptedFields,
    /// Lines that scripts printed.
    pub log: Vec<String>,
}

impl FrameState {
    /// Whether an instance or a group is hidden.
    pub fn is_hidden(&self, node: usize) -> bool {
        self.hidden.get(node).is_some_and(|hidden| *hidden)
    }
}

impl SceneDesc {
    /// Animation that an instance plays: its own choice, else its model's; `models` are the scene's.
    pub fn played_by<'a>(
        &'a self,
        instance: &'a InstanceDesc,
        models: &ByName,
    ) -> Option<&'a AnimationDesc> {
        let model = || Some(&self.models[models.index(&instance.model.value)?]);
        let played = instance.animation.as_ref();
        let played = played.or_else(|| model()?.value.animation.as_ref());
        played.filter(|animation| !animation.name.is_empty())
    }

    /// Whether no two frames can differ.
    pub fn is_still(&self) -> bool {
        self.motion.is_empty() && !self.has_frame_script() && !self.plays()
    }

    /// First frame of the timeline, 0 without one.
    pub fn first_frame(&self) -> u32 {
        self.timeline.as_ref().map_or(0, |t| t.start)
    }

    /// Whether some file's animation is played.
    pub fn plays(&self) -> bool {
        let of_models = self.models.iter().map(|m| &m.value.animation);
        let of_instances = self.instances.iter().map(|i| &i.animation);
        let mut played = of_models.chain(of_instances).flatten();
        played.any(|animation| !animation.name.is_empty())
    }
}

/// Whether each instance, then each group, may move: because it is `dynamic`, has motion, or has an
/// ancestor that may move.
pub fn moving(desc: &SceneDesc) -> Vec<bool> {
    let moved = desc.motion.instances.iter().filter(|e| e.value.moves());
    let moved = moved.chain(&desc.motion.groups);
    let named: HashSet<_> = moved.map(|e| e.name.as_str()).collect();
    let groups = desc.groups.iter().map(|group| group.value.dynamic);
    let dynamic = desc.instances.iter().map(|i| i.dynamic).chain(groups);
    let moves = |name: Option<&str>| name.is_some_and(|name| named.contains(name));
    let nodes = dynamic.zip(desc.node_names());
    let mut moving: Vec<_> = nodes.map(|(says, name)| says || moves(name)).collect();
    desc.parents.inherit(&mut moving);
    moving
}

/// Whether a track of `shown`, if there is one, shows its object at a time.
fn is_shown(track: Option<&Track>, time_s: f64) -> bool {
    track.is_none_or(|track| track.value_at(time_s, Vec3::ONE, None).x >= 0.5)
}

/// A scene's motion prepared for posing: names resolved, path lengths measured.
#[derive(Debug)]
pub struct Motion<'a> {
    desc: &'a SceneDesc,
    rest: FrameState,
    names: Arc<Names>,
    placements: Vec<&'a PlacementDesc>,
    instances: Vec<(usize, [Option<Track<'a>>; 3])>,
    shown: Vec<(usize, Track<'a>)>,
    cameras: Vec<Moved<'a>>,
    lights: Vec<Moved<'a>>,
    decals: Vec<(Moved<'a>, [Option<Track<'a>>; 3], Option<Track<'a>>)>,
    materials: Vec<Moved<'a>>,
    file_materials: Vec<Moved<'a>>,
    overrides: Vec<Moved<'a>>,
}

/// A camera, light or material that tracks move, by its index.
#[derive(Debug)]
struct Moved<'a> {
    index: usize,
    at: &'a Span,
    /// Tracks, each with the index of the [`Field`] that it changes.
    tracks: Vec<(usize, Track<'a>)>,
}

impl Moved<'_> {
    /// Sets the moving values of `to`, which must have its values at rest. Tracks that follow nodes see the world
    /// transforms of these in the space of `parent`, if there is one.
    fn pose<T>(
        &self,
        to: &mut T,
        fields: &[Field<T>],
        time_s: f64,
        world: &[Affine3A],
        parent: Option<usize>,
    ) {
        for (field, track) in &self.tracks {
            let field = &fields[*field];
            let rest = (field.get)(to).unwrap_or(Vec3::ZERO);
            let followed = track.followed().map(|node| match parent {
                Some(parent) => world[parent].inverse() * world[node],
                None => world[node],
            });
            field.put_clamped(to, track.value_at(time_s, rest, followed));
        }
    }
}

impl<'a> Motion<'a> {
    /// Prepares the motion of a scene whose names were checked.
    pub fn new(desc: &'a SceneDesc) -> Self {
        let names = Names::from_scene(desc);
        let rest = FrameState {
            cameras: desc.cameras.iter().map(|e| e.value.clone()).collect(),
            instances: desc.placements().map(transform).collect(),
            hidden: vec![false; desc.placements().count()],
            animation_s: vec![None; desc.instances.len()],
            decals: desc.decals_at_rest(),
            lights: desc.lights.iter().map(|e| e.value).collect(),
            materials: desc.materials.iter().map(|e| e.value.clone()).collect(),
            file_materials: vec![MaterialChange::default(); names.file_materials.len()],
            overrides: vec![MaterialChange::default(); desc.instances.len()],
            ..FrameState::default()
        };
        let find = |name: &str| names.instances.get(name).copied();
        let track = |t: &'a Option<TrackDesc>| t.as_ref().map(|t| Track::new(t, find));
        let motion = &desc.motion;
        let placing =
            |m: &'a InstanceMotionDesc| [&m.translation, &m.rotation_deg, &m.scale].map(track);
        let moved = |index: Option<&usize>, at, tracks: &'a Tracks| {
            let track = |(field, t): &'a (usize, TrackDesc)| (*field, Track::new(t, find));
            Some(Moved {
                index: *index?,
                at,
                tracks: tracks.iter().map(track).collect(),
            })
        };
        let nodes = || motion.instances.iter().chain(&motion.groups);
        let node = |name| names.instances.get(name).copied();
        let of_files = motion.models.iter().flat_map(|model| {
            let materials = model.value.materials.iter();
            materials.map(|e| ((model.name.clone(), e.name.clone()), e))
        });
        Self {
            overrides: (motion.instances.iter())
                .filter_map(|e| {
                    let tracks = &e.value.material.as_ref()?.tracks;
                    moved(names.instances.get(&e.name), &e.at, tracks)
                })
                .collect(),
            instances: nodes()
                .filter_map(|e| Some((node(&e.name)?, placing(&e.value))))
                .collect(),
            shown: nodes()
                .filter_map(|e| Some((node(&e.name)?, track(&e.value.shown)?)))
                .collect(),
            cameras: (motion.cameras.iter())
                .filter_map(|e| moved(names.cameras.get(&e.name), &e.at, &e.value.tracks))
                .collect(),
            lights: (motion.lights.iter())
                .filter_map(|e| moved(names.lights.get(&e.name), &e.at, &e.value.tracks))
                .collect(),
            decals: (motion.decals.iter())
                .filter_map(|Entry { name, at, value }| {
                    let moved = moved(names.decals.get(name), at, &value.tracks)?;
                    Some((moved, placing(&value.place), track(&value.place.shown)))
                })
                .collect(),
            materials: (motion.materials.iter())
                .filter_map(|e| moved(names.materials.get(&e.name), &e.at, &e.value.tracks))
                .collect(),
            file_materials: of_files
                .filter_map(|(key, e)| {
                    moved(names.file_materials.get(&key), &e.at, &e.value.tracks)
                })
                .collect(),
            rest,
            names: Arc::new(names),
            placements: desc.placements().collect(),
            desc,
        }
    }

    /// Names that the script may use.
    pub fn names(&self) -> &Arc<Names> {
        &self.names
    }

    /// State of the scene `late_frames` frames after a frame, as tracks move it, before scripts run.
    pub fn pose(&self, frame: u32, late_frames: f64) -> FrameState {
        let fps = self.desc.timeline.as_ref().map_or(24.0, |t| t.fps);
        let mut state = self.rest.clone();
        state.frame = frame;
        state.time_s = (f64::from(frame) + late_frames) / f64::from(fps);
        for (index, tracks) in &self.instances {
            let placement = self.placements[*index];
            state.instances[*index] = placed(placement, tracks, state.time_s);
        }
        for (index, track) in &self.shown {
            state.hidden[*index] = !is_shown(Some(track), state.time_s);
        }
        for (moved, tracks, shown) in &self.decals {
            let decal = &mut state.decals[moved.index];
            let placement = self.desc.decal_placement(moved.index);
            decal.placement = placed(placement, tracks, state.time_s);
            moved.pose(decal, &DECAL, state.time_s, &[], None);
            decal.shown = is_shown(shown.as_ref(), state.time_s);
        }
        for moved in &self.materials {
            let material = &mut state.materials[moved.index];
            material::pose(material, &moved.tracks, state.time_s);
        }
        for moved in &self.file_materials {
            let change = material::change(&moved.tracks, state.time_s);
            state.file_materials[moved.index] = change;
        }
        for moved in &self.overrides {
            let change = material::change(&moved.tracks, state.time_s);
            state.overrides[moved.index] = change;
        }
        self.follow(&mut state, |_, _| true);
        state
    }

    /// Applies the tracks of the cameras and lights that `wanted` selects; tracks may follow instances.
    pub fn follow(&self, state: &mut FrameState, wanted: impl Fn(Kind, usize) -> bool) {
        let (time_s, parents) = (state.time_s, &self.desc.parents);
        let world = parents.world(&state.instances);
        for moved in &self.cameras {
            if wanted(Kind::Camera, moved.index) {
                let camera = &mut state.cameras[moved.index];
                camera.clone_from(&self.rest.cameras[moved.index]);
                let parent = parents.of_camera(moved.index);
                moved.pose(camera, &CAMERA, time_s, &world, parent);
            }
        }
        for moved in &self.lights {
            if wanted(Kind::Light, moved.index) {
                let light = &mut state.lights[moved.index];
                *light = self.rest.lights[moved.index];
                let parent = parents.of_light(moved.index);
                moved.pose(light, &LIGHT, time_s, &world, parent);
                light.settle();
            }
        }
    }

    /// Converts everything from its parent's space to world space; hidden parents hide their lights too.
    pub fn attach(&self, state: &mut FrameState) {
        let parents = &self.desc.parents;
        if let Cow::Owned(world) = parents.world(&state.instances) {
            state.instances = world;
        }
        attach_lights(parents, &mut state.lights, &state.instances);
        parents.inherit(&mut state.hidden);
        for (index, light) in state.lights.iter_mut().enumerate() {
            let parent = parents.of_light(index);
            if parent.is_some_and(|parent| state.hidden[parent]) {
                light.color = Vec3::ZERO;
            }
        }
        attach_cameras(parents, &mut state.cameras, &state.instances);
        for (index, decal) in state.decals.iter_mut().enumerate() {
            let parent = parents.of_decal(index);
            if let Some(parent) = parent {
                decal.placement = state.instances[parent] * decal.placement;
            }
            let is_seen = decal.shown && !parent.is_some_and(|parent| state.hidden[parent]);
            decal.opacity *= f32::from(u8::from(is_seen));
        }
    }

    /// Refuses cameras and lights that motion has left without a direction.
    ///
    /// # Errors
    /// A message for each such camera or light.
    pub fn check(&self, state: &FrameState) -> Result<(), Vec<Diagnostic>> {
        let frame = state.frame;
        let mut errors = Vec::new();
        let mut refuse = |at: &Span, thing: &str, wrong: Unusable| {
            let message = format!("in frame {frame}, {thing} {}", wrong.why);
            errors.push(Diagnostic::new("bad-pose", at.clone(), message).help(wrong.help));
        };
        for Moved { index, at, .. } in &self.cameras {
            if let Some(wrong) = wrong_with_camera(&state.cameras[*index]) {
                let name = &self.desc.cameras[*index].name;
                refuse(at, &format!("camera \"{name}\""), wrong);
            }
        }
        for Moved { index, at, .. } in &self.lights {
            if let Some(wrong) = wrong_with_light(&state.lights[*index]) {
                let name = &self.desc.lights[*index].name;
                refuse(at, &format!("light \"{name}\""), wrong);
            }
        }
        if errors.is_empty() {
            Ok(())
        } else {
            Err(errors)
        }
    }
}
