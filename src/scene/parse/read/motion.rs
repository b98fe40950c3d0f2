//! Readers of motion.

use glam::Vec3;

use crate::range::ANY;
use crate::{
    desc::*,
    motion::{DECAL, DECAL_PLACES},
    parse::{
        table::{Section, Table},
        value::Scale,
    },
};

use super::track::{shown, track, tracks};

impl Section for MotionDesc {
    const TYPE: &'static str = "MotionDesc";
    const HEADING: &'static str = "[motion]";

    fn read(t: &mut Table) -> Option<Self> {
        Some(Self {
            cameras: t.entries("camera"),
            instances: t.entries("instance"),
            groups: groups(t),
            decals: t.entries("decal"),
            lights: t.entries("light"),
            materials: t.entries("material"),
            models: t.entries("model"),
        })
    }
}

impl Section for ModelMotionDesc {
    const TYPE: &'static str = "ModelMotionDesc";
    const HEADING: &'static str = "[motion.model.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        Some(Self {
            materials: t.entries("material"),
        })
    }
}

impl Section for CameraMotionDesc {
    const TYPE: &'static str = "CameraMotionDesc";
    const HEADING: &'static str = "[motion.camera.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let tracks = tracks(t, &CAMERA);
        Some(Self { tracks })
    }
}

impl Section for InstanceMotionDesc {
    const TYPE: &'static str = "InstanceMotionDesc";
    const HEADING: &'static str = "[motion.instance.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        Some(Self {
            translation: track::<Vec3>(t, "translation", ANY),
            rotation_deg: track::<Vec3>(t, "rotation_deg", ANY),
            scale: track::<Scale>(t, "scale", ANY),
            shown: shown(t),
            material: t.table("material"),
        })
    }
}

/// The motion of a group: that of an instance without a material.
struct GroupMotion(InstanceMotionDesc);

impl Section for GroupMotion {
    const TYPE: &'static str = "GroupMotionDesc";
    const HEADING: &'static str = "[motion.group.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        Some(Self(InstanceMotionDesc {
            translation: track::<Vec3>(t, "translation", ANY),
            rotation_deg: track::<Vec3>(t, "rotation_deg", ANY),
            scale: track::<Scale>(t, "scale", ANY),
            shown: shown(t),
            material: None,
        }))
    }
}

fn groups(t: &mut Table) -> Vec<Entry<InstanceMotionDesc>> {
    let groups = t.entries::<GroupMotion>("group").into_iter();
    let motion = |group: Entry<GroupMotion>| Entry {
        name: group.name,
        at: group.at,
        value: group.value.0,
    };
    groups.map(motion).collect()
}

impl Section for DecalMotionDesc {
    const TYPE: &'static str = "DecalMotionDesc";
    const HEADING: &'static str = "[motion.decal.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let place = InstanceMotionDesc {
            translation: track::<Vec3>(t, "translation", ANY),
            rotation_deg: track::<Vec3>(t, "rotation_deg", ANY),
            scale: track::<Scale>(t, "scale", ANY),
            shown: shown(t),
            material: None,
        };
        let others = tracks(t, &DECAL[DECAL_PLACES..]).into_iter();
        let tracks = others.map(|(field, track)| (field + DECAL_PLACES, track));
        Some(Self {
            place,
            tracks: tracks.collect(),
        })
    }
}

impl Section for LightMotionDesc {
    const TYPE: &'static str = "LightMotionDesc";
    const HEADING: &'static str = "[motion.light.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(false, &[&["direction"], &["target"]]);
        let tracks = tracks(t, &LIGHT);
        Some(Self { tracks })
    }
}

impl Section for MaterialMotionDesc {
    const TYPE: &'static str = "MaterialMotionDesc";
    const HEADING: &'static str = "[motion.material.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let tracks = tracks(t, &MATERIAL);
        Some(Self { tracks })
    }
}
