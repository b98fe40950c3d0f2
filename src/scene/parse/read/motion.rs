//! Readers of the timeline and of motion.

use glam::Vec3;

use crate::scene::range::{ANY, Range, range};
use crate::scene::{
    desc::*,
    diagnostic::Diagnostic,
    parse::{
        table::{Section, Table},
        value::Scale,
    },
};

use super::track::{track, tracks};

/// Frame numbers.
const FRAMES: Range = range(0.0, 1e6);

/// `[timeline]`, with its cuts.
pub struct Film {
    pub timeline: TimelineDesc,
    pub cuts: Vec<CutDesc>,
}

impl Section for CutDesc {
    const TYPE: &'static str = "CutDesc";
    const HEADING: &'static str = "cuts = [{ frame = …, camera = … }, …]";

    fn read(t: &mut Table) -> Option<Self> {
        let frame = t.need("frame", FRAMES);
        let camera = t.need("camera", ANY);
        Some(Self {
            frame: frame?,
            camera: camera?,
        })
    }
}

fn cuts(t: &mut Table) -> Vec<CutDesc> {
    let cuts: Vec<CutDesc> = t.list("cuts");
    for pair in cuts.windows(2) {
        if pair[1].frame <= pair[0].frame {
            let before = pair[0].frame;
            let message =
                format!("`frame` must be after that of the cut before, which is {before}");
            let at = pair[1].camera.at.clone();
            let error = Diagnostic::at("key-order", at, message);
            t.report
                .push(error.related(pair[0].camera.at.clone(), "the cut before is here"));
        }
    }
    cuts
}

impl Section for Film {
    const TYPE: &'static str = "TimelineDesc";
    const HEADING: &'static str = "[timeline]";

    fn read(t: &mut Table) -> Option<Self> {
        let fps = t.get("fps", range(0.0, 1000.0).above(), 24.0);
        let start = t.get("start", FRAMES, 0);
        let end: Option<u32> = t.need("end", FRAMES);
        if t.clean() && end.is_some_and(|end| end < start) {
            let message = format!("`end` must not be before `start`, which is {start}");
            t.refuse("empty-timeline", "end", &message, "both frames are shown");
        }
        let cuts = cuts(t);
        let timeline = TimelineDesc {
            fps,
            start,
            end: end?,
        };
        Some(Self { timeline, cuts })
    }
}

impl Section for MotionDesc {
    const TYPE: &'static str = "MotionDesc";
    const HEADING: &'static str = "[motion]";

    fn read(t: &mut Table) -> Option<Self> {
        Some(Self {
            cameras: t.entries("camera"),
            instances: t.entries("instance"),
            groups: groups(t),
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
