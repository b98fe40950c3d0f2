//! Readers of motion.

use glam::Vec3;

use crate::declared::{Described, TypeDoc};
use crate::range::ANY;
use crate::table::{Section, Table, value::Scale};
use crate::{
    desc::*,
    motion::{DECAL, DECAL_PLACES},
};

use super::track::{shown, track, tracks};

impl Section for MotionDesc {
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
    const HEADING: &'static str = "[motion.model.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        Some(Self {
            materials: t.entries("material"),
        })
    }
}

impl Section for CameraMotionDesc {
    const HEADING: &'static str = "[motion.camera.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let tracks = tracks(t, &CAMERA);
        Some(Self { tracks })
    }
}

impl Section for InstanceMotionDesc {
    const HEADING: &'static str = "[motion.instance.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let place = place(t);
        Some(Self {
            material: t.table("material"),
            ..place
        })
    }
}

/// Tracks of a place, without a material.
fn place(t: &mut Table) -> InstanceMotionDesc {
    InstanceMotionDesc {
        translation: track::<Vec3>(t, "translation", ANY),
        rotation_deg: track::<Vec3>(t, "rotation_deg", ANY),
        scale: track::<Scale>(t, "scale", ANY),
        shown: shown(t),
        material: None,
    }
}

/// The motion of a group: an instance's, without a material.
struct GroupMotion(InstanceMotionDesc);

impl Described for GroupMotion {
    const DOC: &'static TypeDoc = GroupMotionDesc::DOC;
}

impl Section for GroupMotion {
    const HEADING: &'static str = "[motion.group.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        Some(Self(place(t)))
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
    const HEADING: &'static str = "[motion.decal.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let place = place(t);
        let others = tracks(t, &DECAL[DECAL_PLACES..]).into_iter();
        let tracks = others.map(|(field, track)| (field + DECAL_PLACES, track));
        Some(Self {
            place,
            tracks: tracks.collect(),
        })
    }
}

impl Section for LightMotionDesc {
    const HEADING: &'static str = "[motion.light.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(false, &[&["direction"], &["target"]]);
        let tracks = tracks(t, &LIGHT);
        Some(Self { tracks })
    }
}

impl Section for MaterialMotionDesc {
    const HEADING: &'static str = "[motion.material.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let tracks = tracks(t, &MATERIAL);
        for field in &MATERIAL {
            t.explain(field.key, || field.track_text());
        }
        Some(Self { tracks })
    }
}
