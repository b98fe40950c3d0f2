//! Changes over time in scene text: the frames of a film, motion, and the parameters of the script.

use glam::Vec3;

use super::{
    At, CameraMotionDesc, Entry, LightMotionDesc, MaterialMotionDesc, TrackDesc, Tracks,
    track::{shown, track},
};
use crate::{
    range::{ANY, Range, range},
    table::{Section, Table, value::Scale},
};

/// Range of frame numbers.
pub const FRAMES: Range = range(0.0, 1e6);

declared! {
    /// `[timeline]`: the frames of a film.
    ///
    /// - `cuts`: camera that is shown from a frame on, unless `--camera` chooses one. Before the first cut it is
    ///   the camera of a scene without cuts: `main`, else the first.
    #[derive(Clone, Debug, PartialEq)]
    #[keys]
    pub struct TimelineDesc {
        /// Frames per second, above 0 and at most 1000. Frame F shows the time F / fps. Default 24.
        pub fps: f32 [range(0.0, 1000.0).above()] = 24.0,
        /// Number of the first frame, 0 to 1000000. Default 0.
        pub start: u32 [FRAMES] = 0,
        /// Number of the last frame, which is shown too, 0 to 1000000; not before `start`.
        pub end: u32 [FRAMES],
    }

    /// `cuts = [{ frame = 48, camera = "close" }, …]`, in the order of frames.
    #[derive(Clone, Debug, PartialEq)]
    #[table("cuts = [{ frame = …, camera = … }, …]", refers(camera: "camera"))]
    pub struct CutDesc {
        /// First frame of the cut, 0 to 1000000.
        pub frame: u32 [FRAMES],
        /// Name of the camera that is shown from that frame on.
        pub camera: At<String>,
    }

    /// `[motion]`: tracks that change the scene over time, by the names of things; a thing without motion keeps the
    /// values of its own table.
    #[derive(Clone, Debug, Default, PartialEq)]
    #[table("[motion]")]
    pub struct MotionDesc {
        /// `camera.NAME`: path and lens of a camera.
        #[by(|t| Some(t.entries("camera")))]
        pub cameras: Vec<Entry<CameraMotionDesc>>,
        /// `instance.NAME`: motion of an instance, by its `name`; it is dynamic then. Also changes numbers of its
        /// own `material`.
        #[by(|t| Some(t.entries("instance")))]
        pub instances: Vec<Entry<InstanceMotionDesc>>,
        /// `group.NAME`: motion of a group, and with it of everything attached to it.
        #[by(groups)]
        pub groups: Vec<Entry<InstanceMotionDesc>>,
        /// `decal.NAME`: motion of a decal's box, and its changing opacity.
        #[by(|t| Some(t.entries("decal")))]
        pub decals: Vec<Entry<DecalMotionDesc>>,
        /// `light.NAME`: motion and changing brightness of a light.
        #[by(|t| Some(t.entries("light")))]
        pub lights: Vec<Entry<LightMotionDesc>>,
        /// `material.NAME`: changing numbers of a `[material.NAME]`.
        #[by(|t| Some(t.entries("material")))]
        pub materials: Vec<Entry<MaterialMotionDesc>>,
        /// `model.NAME`: changing numbers of the materials inside a model's file.
        #[by(|t| Some(t.entries("model")))]
        pub models: Vec<Entry<ModelMotionDesc>>,
    }
}

impl MotionDesc {
    /// Whether nothing moves.
    pub fn is_empty(&self) -> bool {
        self.cameras.is_empty()
            && self.instances.is_empty()
            && self.groups.is_empty()
            && self.decals.is_empty()
            && self.lights.is_empty()
            && self.materials.is_empty()
            && self.models.is_empty()
    }
}

declared! {
    /// `[motion.instance.NAME]`: `translation`, `rotation_deg` and `scale` need an instance that is placed by these
    /// or `rotation_quat`, not by `matrix`.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub struct InstanceMotionDesc {
        /// Track of the position of the model's origin, meters.
        pub translation: Option<TrackDesc>,
        /// Track of the rotation, degrees about X, then Y, then Z, all fixed axes. Without `keys` it is applied
        /// before the instance's own rotation, so about the model's own axes.
        pub rotation_deg: Option<TrackDesc>,
        /// Track of the factor on the model's size, one number or three; must not pass through 0, except by a
        /// `"step"`.
        pub scale: Option<TrackDesc>,
        /// Track that shows or hides the instance and everything attached to it. While hidden it is not seen, not
        /// reflected and blocks no light; lights attached to it are dark. Default: always shown.
        pub shown: Option<TrackDesc>,
        /// Tracks of numbers of the instance's own `material = { … }`, which it must have and which may be empty;
        /// numbers left out there start from the material below it.
        pub material: Option<MaterialMotionDesc>,
    }
}

impl InstanceMotionDesc {
    /// Whether more than its material changes.
    pub fn moves(&self) -> bool {
        self.material.is_none() || self.shown.is_some() || self.is_placed_by_tracks()
    }

    /// Whether its translation, rotation or scale changes.
    pub fn is_placed_by_tracks(&self) -> bool {
        let tracks = [&self.translation, &self.rotation_deg, &self.scale];
        tracks.iter().any(|track| track.is_some())
    }
}

declared! {
    /// `[motion.decal.NAME]`: `translation`, `rotation_deg` and `scale` need a decal that is placed by these or
    /// `rotation_quat`, not by `matrix`.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub struct DecalMotionDesc {
        /// - `translation`: track of the position of the middle of the box, meters.
        /// - `rotation_deg`: track of the rotation, degrees about X, then Y, then Z, all fixed axes. Without `keys` it
        ///   is applied before the decal's own rotation, so about its own axes.
        /// - `scale`: track of the factor on the size of the box, one number or three; must not pass through 0, except
        ///   by a `"step"`.
        /// - `shown`: track that shows or hides the decal, whatever its `opacity`. Default: always shown.
        pub place: InstanceMotionDesc,
        /// Tracks of its size and opacity, by their index in [`DECAL`](crate::motion::DECAL).
        ///
        /// - `size`: track of the size of the box along its axes, meters, each above 0.
        pub tracks: Tracks,
    }

    /// `[motion.group.NAME]`: `translation`, `rotation_deg` and `scale` need a group that is placed by these or
    /// `rotation_quat`, not by `matrix`.
    ///
    /// - `translation`: track of the position of the group's origin, meters.
    /// - `rotation_deg`: track of the rotation, degrees about X, then Y, then Z, all fixed axes. Without `keys` it
    ///   is applied before the group's own rotation, so about its own axes.
    /// - `scale`: track of the factor on the size of everything attached to the group, one number or three; must
    ///   not pass through 0, except by a `"step"`.
    /// - `shown`: track that shows or hides everything attached to the group. While hidden it is not seen, not
    ///   reflected and blocks no light; lights attached to it are dark. Default: always shown.
    pub struct GroupMotionDesc(InstanceMotionDesc);

    /// `[motion.model.NAME]`: changing materials of a model with a `file`.
    #[derive(Clone, Debug, Default, PartialEq)]
    #[table("[motion.model.NAME]")]
    pub struct ModelMotionDesc {
        /// `material.NAME`: tracks of numbers of the file's material of that name, or of all of them as `"*"`, over
        /// the values of `[model.M.material.NAME]`; an instance's own `material` wins.
        #[by(|t| Some(t.entries("material")))]
        pub materials: Vec<Entry<MaterialMotionDesc>>,
    }
}

/// Tracks of a place, without a material.
pub(crate) fn place(t: &mut Table) -> Option<InstanceMotionDesc> {
    Some(InstanceMotionDesc {
        translation: track::<Vec3>(t, "translation", ANY),
        rotation_deg: track::<Vec3>(t, "rotation_deg", ANY),
        scale: track::<Scale>(t, "scale", ANY),
        shown: shown(t),
        material: None,
    })
}

impl Section for InstanceMotionDesc {
    const HEADING: &'static str = "[motion.instance.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let place = place(t)?;
        Some(Self {
            material: t.table("material"),
            ..place
        })
    }
}

impl Section for GroupMotionDesc {
    const HEADING: &'static str = "[motion.group.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        place(t).map(Self)
    }
}

fn groups(t: &mut Table) -> Option<Vec<Entry<InstanceMotionDesc>>> {
    let motion = |group: Entry<GroupMotionDesc>| Entry {
        name: group.name,
        at: group.at,
        value: group.value.0,
    };
    Some(t.entries("group").into_iter().map(motion).collect())
}
