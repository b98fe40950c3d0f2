//! Reader of decals.

use glam::Vec3;

use super::instance::placement;
use crate::declared::{Described, TypeDoc};
use crate::range::{ABOVE_0, ANY, DECAL_ANGLE_DEG, UNIT};
use crate::table::{Section, Table, value::Names};
use crate::{
    desc::{DecalChanges, DecalDesc, PlacementDesc},
    parse::hierarchy,
    suggest,
};

impl Section for DecalDesc {
    const ALSO: &'static [&'static TypeDoc] = &[PlacementDesc::DOC];
    const HEADING: &'static str = "[decal.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let material = t.need("material", ANY);
        hierarchy::declare_parent(t);
        let placement = placement(t);
        let only = t.find("only", ANY).map(|Names(names)| names);
        let size = t.get("size", ABOVE_0, Vec3::ONE);
        let dynamic = t.get("dynamic", ANY, false);
        let opacity = t.get("opacity", UNIT, 1.0);
        let max_angle_deg = t.get("max_angle_deg", DECAL_ANGLE_DEG, 75.0);
        let fade_deg = t.get("fade_deg", DECAL_ANGLE_DEG, 15.0);
        let changes = changes(t);
        if only.as_ref().is_some_and(Vec::is_empty) {
            let message = "`only` names nothing, so the decal is projected onto nothing";
            let help = "name instances or groups, or leave `only` out for all instances";
            t.refuse("empty-list", "only", message, help);
        }
        Some(Self {
            material: material?,
            placement,
            size,
            only,
            dynamic,
            opacity,
            max_angle_deg,
            fade_deg,
            changes,
        })
    }
}

/// Properties of a surface that a decal changes.
fn changes(t: &mut Table) -> DecalChanges {
    let words = DecalChanges::WORDS;
    let Some(Names(names)) = t.find("changes", ANY) else {
        return DecalChanges::from_flags([true; 4]);
    };
    let unknown = names
        .iter()
        .find(|name| !words.contains(&name.value.as_str()));
    if let Some(unknown) = unknown {
        let name = suggest::text(&unknown.value);
        let message = format!(
            "a decal changes \"color\", \"metallic\", \"roughness\" or \"normal\", not {name}"
        );
        let help = suggest::hint(&unknown.value, &words, suggest::text, "the words are");
        t.refuse("unknown-word", "changes", &message, &help);
    }
    if names.is_empty() {
        let message = "`changes` is empty, so the decal would not be seen";
        let help = "write `changes = [\"color\"]`, or leave it out for all";
        t.refuse("empty-list", "changes", message, help);
    }
    DecalChanges::from_flags(words.map(|word| names.iter().any(|name| name.value == word)))
}
