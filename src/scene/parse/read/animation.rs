//! Reader of the animation that a model or an instance plays.

use crate::desc::{AnimationDesc, Playback};
use crate::range::ANY;
use crate::table::{Either, Section, Table, value::Names};

impl Section for AnimationDesc {
    const HEADING: &'static str = "animation = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let name = t.need::<Names>("name", ANY).map(|Names(names)| names);
        Some(Self {
            speed: t.get("speed", ANY, 1.0),
            start_s: t.get("start_s", ANY, 0.0),
            repeat: t.get("repeat", ANY, Playback::default()),
            name: name?,
        })
    }
}

/// `animation = "walk"`, or a table.
pub fn animation(t: &mut Table) -> Option<AnimationDesc> {
    t.name_or_table("animation").map(|found| match found {
        Either::Name(name) => AnimationDesc::endless(vec![name]),
        Either::Nested(desc) => desc,
    })
}
